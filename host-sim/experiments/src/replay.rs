//! Replay of recordings through the estimators.

use std::io::{self, Write};
use std::path::Path;

use rayon::prelude::*;

use crate::compare::interval;
use crate::table;
use catalogue::estimators::Setup;
use catalogue::estimators::{Kind, available};
use catalogue::parameters::{Parameters, PlantKind};
use recordings::health;
use recordings::recording::{BoardColumns, Recording};
use scoring::evaluation::{Candidate, Estimate, Evaluation, Heading, Row};
use scoring::score::{Field, Score, Wanted};
use simulation::device::Device;
use terminal::failure::Failure;

/// Results of a replay.
#[derive(Clone, Debug)]
pub struct Replay {
    /// One estimate per estimator, in the requested order.
    pub estimates: Vec<Estimate>,
    /// The scores, empty without column `true_omega`.
    pub rows: Vec<Row>,
    /// Estimators left out, each with the missing column.
    pub left_out: Vec<(&'static str, &'static str)>,
    /// One line per estimator whose parameters were tuned for another encoder or rate.
    pub mismatched_presets: Vec<String>,
}

/// Runs the estimators `kinds` on a recording called `name` and calls `done` after each.
///
/// # Errors
/// [`Failure::Input`] if an estimator cannot be built.
pub fn replay(
    recording: &Recording,
    name: &str,
    kinds: &[&'static Kind],
    device: &Device,
    parameters: &Parameters,
    done: impl Fn() + Sync,
) -> Result<Replay, Failure> {
    let trace = &recording.trace;
    let (able, unable): (Vec<_>, Vec<_>) = kinds
        .iter()
        .partition(|kind| kind.needs.within(available(trace)));
    let setup = Setup::of(device, trace.rate_hz);
    let evaluation = Evaluation::new(&able, parameters, &setup, PlantKind::Friction)?;
    let estimate = |candidate: &Candidate| {
        let estimate = candidate.estimate(trace);
        done();
        estimate
    };
    let estimates: Vec<_> = (evaluation.candidates().par_iter())
        .filter_map(estimate)
        .collect();
    let heading = Heading {
        scenario: name.to_owned(),
        rate_hz: trace.rate_hz,
        plant: PlantKind::Friction,
        seed: 0,
    };
    let rows = evaluation.rows(&heading, trace, &estimates, interval(device), Wanted::ALL)?;
    let missing = |kind: &&'static Kind| {
        let has = available(trace);
        let column = match kind.needs {
            needs if needs.current && !has.current => "current",
            needs if needs.coupled && !has.coupled => "counts_small",
            _ => "edge_tick",
        };
        (kind.name, column)
    };
    Ok(Replay {
        estimates,
        rows,
        left_out: unable.iter().map(missing).collect(),
        mismatched_presets: parameters.used_far_away(&able, &setup, PlantKind::Friction),
    })
}

/// One line on the recording's length and rate, the encoder and the parameters.
#[must_use]
pub fn header(
    recording: &Recording,
    device: &Device,
    device_name: &str,
    parameters: &Parameters,
) -> String {
    format!(
        "{} rows at {} Hz, {} counts/rev ({device_name}), parameters: {}",
        recording.t.len(),
        recording.trace.rate_hz,
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

/// Summary of the board's own estimates in a recording, one line each: the share of samples whose
/// error is within two of its standard deviations, and its estimated parameters relative to `device`.
#[must_use]
pub fn board_summary(recording: &Recording, board: &BoardColumns, device: &Device) -> Vec<String> {
    let mut lines = Vec::new();
    let trace = &recording.trace;
    if let (Some(omega), Some(velocity), Some(sigma)) = (
        &trace.true_omega,
        board.column("velocity_large"),
        board.column("sigma_large"),
    ) {
        let own = Estimate {
            estimator: "board",
            velocity: velocity.iter().map(|v| *v as f32).collect(),
            deviation: Some(sigma.iter().map(|s| *s as f32).collect()),
        };
        let share = own.within_2_sigma(omega, trace.rate_hz);
        lines.extend(share.map(|share| {
            let percent = 100.0 * share;
            format!(
                "the error of the board's velocity_large is within two sigma_large in {percent:.1} % \
                 of the samples"
            )
        }));
    }
    if let Some(learned) = &board.learned {
        lines.extend(health::lines(learned, device));
    }
    lines
}

/// Name of a recording: that of its file.
#[must_use]
pub fn name(path: &Path) -> String {
    path.file_name()
        .map_or_else(String::new, |name| name.to_string_lossy().into_owned())
}

/// Writes `t` and one column per estimator, rad/s, as CSV.
///
/// # Errors
/// The errors of `out`.
pub fn csv(out: &mut dyn Write, t: &[f64], estimates: &[Estimate]) -> io::Result<()> {
    write!(out, "t")?;
    for estimate in estimates {
        write!(out, ",{}", estimate.estimator)?;
    }
    writeln!(out)?;
    for (k, t) in t.iter().enumerate() {
        write!(out, "{t}")?;
        for estimate in estimates {
            write!(out, ",{}", estimate.velocity[k])?;
        }
        writeln!(out)?;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

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
            || (),
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
        csv(&mut text, &recording.t, &replay.estimates[..1]).unwrap();
        let csv = String::from_utf8(text).unwrap();
        assert_eq!(
            csv,
            "t,finite-difference\n0,0\n0.001,1.5339808\n0.002,1.5339808\n"
        );
    }
}
