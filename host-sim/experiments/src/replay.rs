//! Recordings through the estimators.

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
use scoring::contest::{Contest, Contestant, Estimate, Heading, Row};
use scoring::score::{Field, Score, Wanted};
use simulation::device::Device;
use terminal::failure::Failure;

/// What came of a recording.
#[derive(Clone, Debug)]
pub struct Replay {
    /// One an estimator, in the order asked for.
    pub estimates: Vec<Estimate>,
    /// The scores, where the recording has `true_omega`.
    pub rows: Vec<Row>,
    /// Estimators left out, and the column each lacks.
    pub left_out: Vec<(&'static str, &'static str)>,
    /// Parameters that were tuned for another encoder or rate, a line each.
    pub far: Vec<String>,
}

/// Runs `kinds` over a recording called `name`; `done` is called as each ends.
///
/// # Errors
/// [`Failure::Input`] where an estimator cannot be built.
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
    let contest = Contest::new(&able, parameters, &setup, PlantKind::Friction)?;
    let estimate = |contestant: &Contestant| {
        let estimate = contestant.estimate(trace);
        done();
        estimate
    };
    let estimates: Vec<_> = (contest.contestants().par_iter())
        .filter_map(estimate)
        .collect();
    let heading = Heading {
        scenario: name.to_owned(),
        rate_hz: trace.rate_hz,
        plant: PlantKind::Friction,
        seed: 0,
    };
    let rows = contest.rows(&heading, trace, &estimates, interval(device), Wanted::ALL)?;
    let lacking = |kind: &&'static Kind| {
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
        left_out: unable.iter().map(lacking).collect(),
        far: parameters.used_far_away(&able, &setup, PlantKind::Friction),
    })
}

/// What was replayed, with which encoder and parameters, in a line.
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

/// Scores that tell what a hand feels through the coupler.
const FELT: [&str; 6] = [
    "distance_rad_s",
    "distance_pct",
    "distance_transient_rad_s",
    "distance_transient_pct",
    "outside",
    "force_mn",
];

/// The usual scores in lines of `width` characters, those of the coupler only where there is one.
#[must_use]
pub fn table(rows: &[Row], with_coupler: bool, width: usize) -> String {
    let shown = |field: &&Field<Score>| {
        let known = rows.iter().any(|row| (field.of)(&row.score).is_some());
        field.usual && known && (with_coupler || !FELT.contains(&field.name))
    };
    let fields: Vec<_> = Score::FIELDS.iter().filter(shown).collect();
    table::details(rows, &fields, width)
}

/// What there is to say of the board that made the recording: how often the truth was within two of
/// the standard deviations that it claimed, and what it learned against `device`.
#[must_use]
pub fn of_the_board(recording: &Recording, board: &BoardColumns, device: &Device) -> Vec<String> {
    let mut said = Vec::new();
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
        said.extend(share.map(|share| {
            let percent = 100.0 * share;
            format!("the board's own velocity is within two of its sigma_large in {percent:.1} %")
        }));
    }
    if let Some(learned) = &board.learned {
        said.extend(health::lines(learned, device));
    }
    said
}

/// The name a recording goes by: its file's.
#[must_use]
pub fn name(path: &Path) -> String {
    path.file_name()
        .map_or_else(String::new, |name| name.to_string_lossy().into_owned())
}

/// Writes `t` and one column an estimator, rad/s, as CSV.
///
/// # Errors
/// Those of `out`.
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
    fn who_lacks_a_column_is_left_out_by_name() {
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
