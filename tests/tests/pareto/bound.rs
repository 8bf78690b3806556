//! The bound of every update's instructions, from its machine code, against the most that hostile
//! and simulated traces make of it. `UPDATE_GOLDEN=1` writes the table anew.

use std::path::Path;

use bench_image::{SUBJECTS, Subject};
use estimator_core::{Counts, Sample};
use measured::tables::BOUNDS;
use pareto::board::{Job, on_board};
use pareto::image::{Image, Level};
use pareto::{bound, traces};
use stress::course::Course;

/// Ticks of a hostile stretch, and stretches; the mailbox holds 4096 samples.
const STRETCH: usize = 100;
const STRETCHES: usize = 40;

fn hostile(seed: u64, rate_hz: u32) -> Vec<Sample> {
    let mut course = Course::new(seed, f64::from(rate_hz));
    let mut samples = vec![course.shown().sample()];
    for _ in 0..STRETCHES {
        course.move_on();
        samples.extend((0..STRETCH).map(|_| course.step().sample()));
    }
    samples
}

/// Counts a tick that a window's motion is made faster by, so that best-fit needs 64 bits for its
/// products. Cone and window move with the slope and stay what they are.
const FASTER: i32 = 1000;

fn faster(samples: &[Sample]) -> Vec<Sample> {
    let ticks = samples.iter().zip(0..);
    let moved = ticks.map(|(sample, tick)| Sample {
        count: sample.count + Counts(FASTER * tick),
        ..*sample
    });
    moved.collect()
}

/// The bound and the most seen, at one level; both rates' presets are one.
#[derive(Clone, Copy, Default)]
struct Found {
    bound: u32,
    most: u32,
}

struct Row {
    name: String,
    /// By level, as [`Level::ALL`].
    found: [Found; 2],
}

/// Runs hostile and fast motions; `measured` has the most over the simulated ones.
fn measure(measured: &[pareto::measure::Row]) -> Result<Vec<Row>, String> {
    let simulated = traces::all()?;
    let drawn: Vec<(u32, Vec<Sample>)> = traces::RATES_HZ
        .iter()
        .flat_map(|rate| (1..=3).map(|seed| (*rate, hostile(seed, *rate))))
        .collect();
    let fast: Vec<Vec<Sample>> = simulated
        .iter()
        .map(|ground| faster(&ground.samples))
        .collect();

    let ours = || {
        SUBJECTS
            .iter()
            .enumerate()
            .filter(|(_, one)| !one.is_peer() && bound::is_derivable(one.name))
    };
    let mut jobs = Vec::new();
    for (
        subject,
        Subject {
            rate_hz, window, ..
        },
    ) in ours()
    {
        let suits = |rate: &u32| *rate_hz == 0 || rate_hz == rate;
        let suited = drawn.iter().filter(|(rate, _)| suits(rate));
        let suited = suited.map(|(_, samples)| &samples[..]);
        let fast = fast
            .iter()
            .filter(|_| *window > 0)
            .map(|samples| &samples[..]);
        jobs.extend(suited.chain(fast).map(|samples| Job {
            subject,
            samples,
            follow: 0,
        }));
    }
    let mut rows: Vec<Row> = Vec::new();
    for (at, level) in Level::ALL.into_iter().enumerate() {
        let image = Image::build(level)?;
        let ran = on_board(&image, &jobs)?;
        for (index, subject) in ours() {
            let bound = bound::of(&image, subject)?;
            let own = jobs
                .iter()
                .zip(&ran)
                .filter(|(job, _)| job.subject == index);
            let most = own.flat_map(|(_, ran)| ran.instructions.iter().copied());
            let most = most.max().ok_or("nothing ran")?;
            let name = subject.to_string();
            let simulated = measured.iter().find(|row| row.name == name);
            let simulated = simulated.ok_or("an estimator without a measured row")?;
            let most = most.max(simulated.cost[at].most);
            if !rows.iter().any(|row| row.name == name) {
                let found = [Found::default(); 2];
                rows.push(Row {
                    name: name.clone(),
                    found,
                });
            }
            let row = rows.iter_mut().find(|row| row.name == name);
            let found = &mut row.ok_or("has a row")?.found[at];
            *found = Found {
                bound: found.bound.max(bound),
                most: found.most.max(most),
            };
        }
    }
    Ok(rows)
}

fn cells(rows: &[Row]) -> Vec<Vec<String>> {
    let row = |Row { name, found }: &Row| {
        let figures = found.iter().flat_map(|found| [found.bound, found.most]);
        let figures = figures.map(|figure| figure.to_string());
        std::iter::once(name.clone()).chain(figures).collect()
    };
    rows.iter().map(row).collect()
}

/// The bound `a + b n` that docs/theory/foaw.md states for windows of n intervals holds at either
/// level and is at most 10 instructions above the larger one.
fn as_told_of_windows(rows: &[Row]) {
    let theory = Path::new(env!("CARGO_MANIFEST_DIR")).join("../docs/theory/foaw.md");
    let theory = std::fs::read_to_string(theory).unwrap();
    for (name, n, [a, b]) in [
        ("foaw-end-fit, n = 15", 15, [76, 19]),
        // Beyond 16 intervals the search goes by stretches.
        ("foaw-end-fit, n = 64", 64, [112, 20]),
        // Up to 17 intervals 32 bits hold every product.
        ("foaw-best-fit, n = 15", 15, [136, 38]),
        ("foaw-best-fit, n = 64", 64, [181, 66]),
    ] {
        assert!(theory.contains(&format!("{a} + {b} n")), "{a} + {b} n");
        let row = rows.iter().find(|row| row.name == name).unwrap();
        let bound = row.found.map(|found| found.bound).into_iter().max();
        let (bound, told) = (bound.unwrap(), a + b * n);
        assert!(
            bound <= told && bound + 10 >= told,
            "{name}: {bound} instructions, told {told}"
        );
    }
}

#[test]
fn measured_instructions_are_below_the_bounds() {
    let rows = measure(&crate::rows()).unwrap();
    let all = rows
        .iter()
        .flat_map(|row| row.found.map(|found| (&row.name, found)));
    for (name, Found { bound, most }) in all {
        assert!(most <= bound, "{name}: {most} instructions, bound {bound}");
        // The bound takes every turn of a window for its dearest: one that moves both bounds.
        let slack = if name.contains("n = ") { 1.35 } else { 1.25 };
        assert!(
            f64::from(bound) <= slack * f64::from(most),
            "{name}: bound {bound}, and never more than {most} seen"
        );
    }

    as_told_of_windows(&rows);

    let same = |_: &str, then: f64, now: f64| (then - now).abs() <= (0.1 * then).max(3.0);
    let checked = BOUNDS.check(&[], &cells(&rows), same);
    checked.unwrap_or_else(|error| panic!("{error}"));
}
