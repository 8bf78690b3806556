//! One row of figures for each estimator.

use std::collections::BTreeMap;

use bench_image::{SUBJECTS, Subject};
use estimator_core::Sample;
use rayon::prelude::*;
use serde::Serialize;

use crate::board::{Job, Ran, on_board};
use crate::image::{Image, Level};
use crate::traces::{self, BenchTrace, CHIRP, RATES_HZ};

/// Updates at level 3 that are followed instruction by instruction, which is slow: at the end of [`CHIRP`] at
/// each rate.
const FOLLOWED: usize = 200;

/// Updates at the start of each trace that the errors ignore.
const SKIPPED: usize = 200;

/// Figures at one optimisation level.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Cost {
    /// Instructions an update: mean of the traces' means.
    pub mean: f64,
    /// Most instructions of any update.
    pub most: u32,
    /// Mean at rest.
    pub at_rest: f64,
    /// Estimated cycles for one instruction, over the updates that are followed; `None` where none is.
    pub cycles_per_instruction: Option<f64>,
    /// Bytes of code and literals that an update reaches.
    pub code: usize,
}

/// Figures of one estimator.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Row {
    /// Its name.
    pub name: String,
    /// Whether it is a filter of another library.
    pub peer: bool,
    /// Whether it is the velocity algorithm of another project, written anew.
    pub comparator: bool,
    /// Costs by [`Level::ALL`].
    pub cost: [Cost; 2],
    /// Bytes of its state.
    pub state: usize,
    /// RMS error by [`traces::RATES_HZ`], the simulated moving traces pooled, rad/s.
    pub rms_rad_s: [f64; 2],
    /// Whether it is Pareto-optimal in run time and error, by rate.
    pub front: [bool; 2],
    /// Highest control rate of the whole task with it on the large motor at half load, by the most
    /// cycles, Hz.
    pub highest_rate_hz: f64,
    /// Mean and most instructions at level 3 by trace and rate.
    pub traces: BTreeMap<String, (f64, u32)>,
}

impl Row {
    /// Estimated cycles of an update at level 3, mean.
    #[must_use]
    pub fn cycles(&self) -> f64 {
        self.cost[0].mean * self.cycles_per_instruction()
    }

    /// Estimated cycles of an update at level 3, most.
    #[must_use]
    pub fn cycles_most(&self) -> f64 {
        f64::from(self.cost[0].most) * self.cycles_per_instruction()
    }

    fn cycles_per_instruction(&self) -> f64 {
        self.cost[0].cycles_per_instruction.unwrap_or(f64::NAN)
    }
}

/// Measures everything.
///
/// # Errors
/// One line if an image does not build or run, or differs from the host in any bit.
pub fn measure() -> Result<Vec<Row>, String> {
    let traces = traces::all()?;
    let images: Result<Vec<_>, String> = Level::ALL.into_par_iter().map(Image::build).collect();
    let images = images?;
    let hostile = RATES_HZ.map(|rate_hz| (rate_hz, traces::hostile(rate_hz)));
    let run = |image| run(image, &traces, &hostile);
    let runs: Result<Vec<_>, String> = images.par_iter().map(run).collect();
    let mut rows: Vec<Row> = Vec::new();
    for (level, (image, counted)) in images.iter().zip(runs?).enumerate() {
        for (index, subject) in SUBJECTS.iter().enumerate() {
            let row = match rows.iter().position(|row| row.name == subject.to_string()) {
                Some(row) => row,
                None => {
                    rows.push(Row {
                        name: subject.to_string(),
                        peer: subject.is_peer() && !subject.is_comparator(),
                        comparator: subject.is_comparator(),
                        state: subject.state,
                        ..Row::default()
                    });
                    rows.len() - 1
                }
            };
            let of = |(job, _): &&(Job<'_>, Ran)| job.subject == index;
            let own: Vec<_> = counted.iter().filter(of).collect();
            let row = &mut rows[row];
            let cost = &mut row.cost[level];
            *cost = worst(*cost, cost_of(image, subject, &own)?);
            if level == 0 {
                errors(row, &traces, &own);
            }
        }
    }
    for rate in 0..2 {
        for k in 0..rows.len() {
            let better = |other: &Row| {
                !other.comparator
                    && other.cost[0].mean <= rows[k].cost[0].mean
                    && other.rms_rad_s[rate] <= rows[k].rms_rad_s[rate]
                    && (other.cost[0].mean < rows[k].cost[0].mean
                        || other.rms_rad_s[rate] < rows[k].rms_rad_s[rate])
            };
            rows[k].front[rate] = !rows[k].comparator && !rows.iter().any(better);
        }
    }
    Ok(rows)
}

/// The rows of estimators and libraries, and those of comparators.
#[must_use]
pub fn split(rows: Vec<Row>) -> (Vec<Row>, Vec<Row>) {
    rows.into_iter().partition(|row| !row.comparator)
}

type Runs<'a> = Vec<(Job<'a>, Ran)>;

/// Runs every subject over the traces of its rate, and over stress traces, whose runs are only compared
/// with the host.
fn run<'a>(
    image: &Image,
    traces: &'a [BenchTrace],
    hostile: &'a [(u32, Vec<Sample>)],
) -> Result<Runs<'a>, String> {
    let jobs_of = |traces: &[(u32, &'a [Sample], usize)]| -> Vec<Job<'a>> {
        let subjects = SUBJECTS.iter().enumerate();
        let pairs = subjects.flat_map(|pair| traces.iter().map(move |trace| (pair, *trace)));
        pairs
            .filter(|((_, subject), (rate_hz, ..))| [0, *rate_hz].contains(&subject.rate_hz))
            .map(|((subject, _), (_, samples, follow))| Job {
                subject,
                samples,
                follow,
            })
            .collect()
    };
    let counted = traces.iter().map(|one| {
        let is_followed = one.name == CHIRP && image.level == Level::Speed;
        let follow = if is_followed { FOLLOWED } else { 0 };
        (one.rate_hz, &one.samples[..], follow)
    });
    let jobs = jobs_of(&counted.collect::<Vec<_>>());
    let compared = hostile
        .iter()
        .map(|(rate_hz, samples)| (*rate_hz, &samples[..], 0));
    let compared = jobs_of(&compared.collect::<Vec<_>>());
    let mut ran = on_board(image, &[&jobs[..], &compared[..]].concat())?;
    let compared: Vec<_> = compared
        .into_iter()
        .zip(ran.split_off(jobs.len()))
        .collect();
    let counted: Vec<_> = jobs.into_iter().zip(ran).collect();
    for (job, ran) in counted.iter().chain(&compared) {
        let subject = &SUBJECTS[job.subject];
        let mut board = ran.velocities.iter();
        let mut same = true;
        (subject.run)(&mut job.samples.iter().copied(), &mut |velocity| {
            same &= board
                .next()
                .is_some_and(|v| v.to_bits() == velocity.to_bits());
        });
        if !same || ran.instructions.len() != job.samples.len() - 1 {
            let level = image.level.name();
            return Err(format!(
                "{subject} at {} Hz and opt-level {level}: velocities of board and host differ",
                subject.rate_hz
            ));
        }
    }
    Ok(counted)
}

fn mean(values: impl ExactSizeIterator<Item = f64>) -> f64 {
    let n = values.len() as f64;
    values.sum::<f64>() / n
}

fn mean_count(counts: &[u32]) -> f64 {
    mean(counts.iter().copied().map(f64::from))
}

fn cost_of(image: &Image, subject: &Subject, own: &[&(Job<'_>, Ran)]) -> Result<Cost, String> {
    let still = |(job, _): &&&(Job<'_>, Ran)| job.samples.iter().all(|s| s == &job.samples[0]);
    let settled = |(_, ran): &(Job<'_>, Ran)| mean_count(&ran.instructions[SKIPPED..]);
    let followed = |counts: fn(&Ran) -> &[u32]| -> f64 {
        let all = own.iter().filter(|(job, _)| job.follow > 0);
        let ends = all.flat_map(|(job, ran)| &counts(ran)[counts(ran).len() - job.follow..]);
        ends.copied().map(f64::from).sum()
    };
    let instructions = followed(|ran| &ran.instructions);
    let reached = image.code.reached(image.update(subject)?);
    Ok(Cost {
        mean: mean(own.iter().map(|one| settled(one))),
        most: own
            .iter()
            .flat_map(|(_, ran)| ran.instructions.iter().copied())
            .max()
            .unwrap_or(0),
        at_rest: own.iter().find(still).map_or(f64::NAN, |one| settled(one)),
        cycles_per_instruction: (instructions > 0.0)
            .then(|| followed(|ran| &ran.cycles) / instructions),
        code: reached
            .iter()
            .map(|at| image.code.function(*at).len())
            .sum(),
    })
}

/// The larger of each figure: presets of two rates are one row.
fn worst(a: Cost, b: Cost) -> Cost {
    Cost {
        mean: a.mean.max(b.mean),
        most: a.most.max(b.most),
        at_rest: a.at_rest.max(b.at_rest),
        cycles_per_instruction: [a, b]
            .into_iter()
            .filter_map(|cost| cost.cycles_per_instruction)
            .reduce(f64::max),
        code: a.code.max(b.code),
    }
}

fn errors(row: &mut Row, traces: &[BenchTrace], own: &[&(Job<'_>, Ran)]) {
    let mut squares = [0.0; 2];
    let mut samples = [0.0; 2];
    for (job, ran) in own {
        let trace = traces
            .iter()
            .find(|trace| std::ptr::eq(&trace.samples[..], job.samples))
            .expect("a job of these traces");
        let settled = &ran.instructions[SKIPPED..];
        row.traces.insert(
            format!("{}, {} Hz", trace.name, trace.rate_hz),
            (
                mean_count(settled),
                settled.iter().copied().max().unwrap_or(0),
            ),
        );
        let Some(truth) = &trace.truth else { continue };
        let rate = usize::from(trace.rate_hz != RATES_HZ[0]);
        // The first sample has no velocity.
        for (estimate, truth) in ran.velocities.iter().zip(&truth[1..]).skip(SKIPPED) {
            squares[rate] += ((f64::from(*estimate) - truth) * trace.scale).powi(2);
            samples[rate] += 1.0;
        }
    }
    for rate in 0..2 {
        if samples[rate] > 0.0 {
            row.rms_rad_s[rate] = (squares[rate] / samples[rate]).sqrt();
        }
    }
}
