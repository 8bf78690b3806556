//! Replay of recordings through the estimators.

mod board;
mod run;

use std::io::{self, Write};

use rayon::prelude::*;
use serde::Serialize;

use crate::reference::Reference;
use crate::table;
use catalogue::estimators::Kind;
use catalogue::parameters::Parameters;
use recordings::recording::Recording;
use scoring::evaluation::{Estimate, Row};
use scoring::score::{Field, Score};
use simulation::device::Device;
use simulation::trace::Trace;
use terminal::failure::Failure;

pub use board::BoardSummary;
pub use run::{Run, section_rows};

/// Results of a replay.
#[derive(Clone, Debug)]
pub struct Replay {
    /// One estimate per estimator, in the requested order.
    pub estimates: Vec<Estimate>,
    /// The scores, empty without a velocity to score against.
    pub rows: Vec<Row>,
    /// Estimators left out, each with the missing column.
    pub left_out: Vec<(&'static str, &'static str)>,
    /// One line per estimator whose parameters were tuned for another encoder or rate.
    pub mismatched_presets: Vec<String>,
}

/// Runs the estimators `kinds` on a recording called `name`, scores them against its true velocity, if
/// it has one, and calls `done` after each.
///
/// # Errors
/// [`Failure::Input`] if an estimator cannot be built.
pub fn replay(
    recording: &Recording,
    name: &str,
    kinds: &[&'static Kind],
    device: &Device,
    parameters: &Parameters,
    done: &(dyn Fn() + Sync),
) -> Result<Replay, Failure> {
    let trace = &recording.trace;
    let mut run = Run::new(trace, trace.len(), name, kinds, device, parameters)?;
    run.add(recording.clone(), done)?;
    Ok(Replay {
        rows: run.rows(),
        left_out: run.left_out,
        mismatched_presets: run.mismatched_presets,
        estimates: run.estimates,
    })
}

/// As [`replay`], with scores against the `reference`, if there is one, instead of the true velocity.
///
/// # Errors
/// As [`replay`].
pub(crate) fn replay_against(
    reference: Option<&Reference>,
    recording: &Recording,
    name: &str,
    kinds: &[&'static Kind],
    device: &Device,
    parameters: &Parameters,
    done: &(dyn Fn() + Sync),
) -> Result<Replay, Failure> {
    let mut recording = recording.clone();
    if let Some(reference) = reference {
        reference.to_trace(&mut recording.trace, 0..recording.t.len());
    }
    replay(&recording, name, kinds, device, parameters, done)
}

/// What the scores of a replay are against.
#[derive(Clone, Copy, Debug)]
pub enum Against<'a> {
    /// The column `true_omega`.
    Truth,
    /// The velocity that was computed from the recording itself.
    Reference(&'a Reference),
}

/// A row of the scores with what they are against: an object of the JSON output.
#[derive(Clone, Debug, Serialize)]
pub struct Scored<'a> {
    #[serde(flatten)]
    row: &'a Row,
    /// `truth` or `reference`.
    against: &'static str,
    /// RMS of the reference's standard deviation, rad/s; `None` for the truth.
    reference_sd_rad_s: Option<f64>,
    /// `constant` or `varying`: the steps of `t`.
    period: &'static str,
}

/// Name of the steps of a recording in JSON.
#[must_use]
pub fn period(trace: &Trace) -> &'static str {
    match trace.periods {
        None => "constant",
        Some(_) => "varying",
    }
}

impl Against<'_> {
    /// `rows` of a recording with the columns of `trace`, with what they are against.
    #[must_use]
    pub fn scored<'a>(&self, rows: &'a [Row], trace: &Trace) -> Vec<Scored<'a>> {
        let scored = |row: &'a Row| {
            let (against, reference_sd_rad_s) = match self {
                Self::Truth => ("truth", None),
                Self::Reference(reference) => ("reference", Some(reference.rms_sd(row.rate_hz))),
            };
            Scored {
                row,
                against,
                reference_sd_rad_s,
                period: period(trace),
            }
        };
        rows.iter().map(scored).collect()
    }
}

/// One line on the recording's length and rate, the encoder and the parameters.
#[must_use]
pub fn header(
    (rows, rate_hz): (usize, f64),
    device: &Device,
    device_name: &str,
    parameters: &Parameters,
) -> String {
    format!(
        "{rows} rows at {rate_hz} Hz, {} counts/rev ({device_name}), parameters: {}",
        device.stages.large.counts_per_rev,
        parameters.sources()
    )
}

/// Scores of the force through the coupler.
const COUPLER_SCORES: [&str; 6] = [
    "distance_rad_s",
    "distance_pct",
    "distance_transient_rad_s",
    "distance_transient_pct",
    "outside",
    "force_mn",
];

/// The usual scores in lines of `width` characters; those of the coupler only `with_coupler`.
#[must_use]
pub fn table(rows: &[Row], with_coupler: bool, width: usize) -> String {
    let shown = |field: &&Field<Score>| {
        let known = rows.iter().any(|row| (field.of)(&row.score).is_some());
        field.usual && known && (with_coupler || !COUPLER_SCORES.contains(&field.name))
    };
    let fields: Vec<_> = Score::FIELDS.iter().filter(shown).collect();
    table::details(rows, &fields, width)
}

/// Writes the header of [`csv()`].
///
/// # Errors
/// The errors of `out`.
pub fn csv_header<'a>(out: &mut dyn Write, names: impl Iterator<Item = &'a str>) -> io::Result<()> {
    write!(out, "t")?;
    for name in names {
        write!(out, ",{name}")?;
    }
    writeln!(out)
}

/// Rows of the CSV that one thread formats.
const FORMATTED: usize = 1 << 11;

/// Names of the columns of a reference.
pub const REFERENCE_COLUMNS: [&str; 2] = ["reference_rad_s", "reference_sd_rad_s"];

/// Writes rows of `t`, the `columns` of the estimators, and those of the `reference`, rad/s, as CSV.
///
/// # Errors
/// The errors of `out`.
pub fn csv(
    out: &mut dyn Write,
    t: &[f64],
    columns: &[&[f32]],
    reference: &[&[f64]],
) -> io::Result<()> {
    let chunks = t.par_chunks(FORMATTED).enumerate();
    let texts: Vec<_> = chunks
        .map(|(chunk, t)| {
            let mut text = Vec::new();
            for (k, t) in t.iter().enumerate() {
                write!(text, "{t}")?;
                for column in columns {
                    write!(text, ",{}", column[chunk * FORMATTED + k])?;
                }
                for value in reference {
                    // As many digits as an estimator has: a telescope moves at 7e-5 rad/s.
                    write!(text, ",{}", value[chunk * FORMATTED + k] as f32)?;
                }
                writeln!(text)?;
            }
            io::Result::Ok(text)
        })
        .collect();
    texts.into_iter().try_for_each(|text| out.write_all(&text?))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// More rows than one thread formats.
    #[test]
    fn each_row_of_a_long_csv_has_its_own_values() {
        let rows = 2 * FORMATTED + 3;
        let t: Vec<f64> = (0..rows).map(|k| k as f64).collect();
        let velocity: Vec<f32> = (0..rows).map(|k| k as f32 + 0.5).collect();
        let reference: Vec<f64> = (0..rows).map(|k| -7.25e-9 * k as f64).collect();
        let mut text = Vec::new();
        csv(&mut text, &t, &[&velocity], &[&reference]).unwrap();
        let text = String::from_utf8(text).unwrap();
        assert_eq!(text.lines().count(), rows);
        for (k, line) in text.lines().enumerate().skip(1) {
            let start = format!("{k},{k}.5,");
            let value: f64 = line.strip_prefix(&start).unwrap().parse().unwrap();
            // Half of the last bit of an f32.
            assert!((value / reference[k] - 1.0).abs() < 6e-8, "{line}");
        }
    }

    #[test]
    fn estimator_without_its_column_is_left_out_and_reported() {
        let text = "t,counts_large,true_omega\n0,0,0\n0.001,1,1.5\n0.002,2,1.5\n";
        let recording = Recording::parse(text.as_bytes(), "r").unwrap();
        let kinds: Vec<_> = Kind::all().iter().collect();
        let device = Device::default();
        let replay = replay(
            &recording,
            "r",
            &kinds,
            &device,
            &Parameters::default(),
            &|| (),
        )
        .unwrap();
        assert!(replay.left_out.contains(&("kalman-motor", "current")));
        assert!(replay.estimates.iter().any(|e| e.estimator == "pll"));
        assert!(
            !replay
                .estimates
                .iter()
                .any(|e| e.estimator == "kalman-motor")
        );
        let mut text = Vec::new();
        let first = &replay.estimates[0];
        csv_header(&mut text, [first.estimator].into_iter()).unwrap();
        csv(&mut text, &recording.t, &[&first.velocity], &[]).unwrap();
        let csv = String::from_utf8(text).unwrap();
        assert_eq!(
            csv,
            "t,finite-difference\n0,0\n0.001,1.5339808\n0.002,1.5339808\n"
        );
    }
}
