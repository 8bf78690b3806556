//! Sensitivity of the estimators to errors in the device's constants.
//!
//! Each run of the plant is estimated several times, each time by estimators with one wrong
//! constant: see [`ConstantError`]. Plant, loop and the finite difference as reference stay
//! unchanged.

mod plan;
pub mod table;

use serde::{Deserialize, Serialize};

use crate::compare::{Case, Settings, interval, setup_of, trace};
use crate::parallel::in_order;
use catalogue::constant_error::ConstantError;
use catalogue::estimators::{DIFFERENCE, Kind};
use scoring::score::{Truth, Wanted};
use terminal::failure::Failure;

pub use plan::Plan;

/// Errors of a constant, as fractions of its largest error. The correct constants are run too.
pub const PARTS: [f64; 4] = [-1.0, -0.5, 0.5, 1.0];

/// Error of one estimator with one wrong constant, or none, in one run.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct SensitivityRow {
    /// Estimator.
    pub estimator: &'static str,
    /// Scenario.
    pub scenario: &'static str,
    /// Control rate, Hz.
    pub rate_hz: f64,
    /// Seed.
    pub seed: u64,
    /// The wrong constant; `null` if all are correct.
    pub constant: Option<&'static str>,
    /// Relative error of the constant.
    pub error: f64,
    /// RMS error of the velocity, rad/s.
    pub rms_rad_s: f64,
    /// RMS error in % of that of finite difference on the same samples.
    pub rms_pct: f64,
    /// Share of the samples outside the haptic interval, 0 to 1.
    pub outside: f64,
}

/// Errors of one estimator with one wrong constant, or none, in a case.
#[derive(Clone, Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Cell {
    estimator: String,
    /// Index of the wrong constant and its error in [`ConstantError::at`] of [`PARTS`].
    constant_error: Option<usize>,
    #[serde(with = "shards::exact")]
    rms_rad_s: f64,
    #[serde(with = "shards::exact")]
    rms_pct: f64,
    #[serde(with = "shards::exact")]
    outside: f64,
}

/// Runs all cases in parallel and calls `done` after each.
///
/// # Errors
/// [`Failure::Input`] of the first case, in order, that cannot be run.
pub fn sensitivity(
    cases: &[Case],
    settings: &Settings,
    done: &(dyn Fn() + Sync),
) -> Result<Vec<SensitivityRow>, Failure> {
    rows(cases, &cells(cases, settings, done)?)
}

/// The cells of each case.
fn cells(
    cases: &[Case],
    settings: &Settings,
    done: &(dyn Fn() + Sync),
) -> Result<Vec<Vec<Cell>>, Failure> {
    in_order(cases, |case| {
        let cells = run(case, settings);
        done();
        cells
    })
}

/// The rows of all cases, in their order.
///
/// # Errors
/// [`Failure::Input`] on a cell of an unknown estimator or constant.
pub fn rows(cases: &[Case], cells: &[Vec<Cell>]) -> Result<Vec<SensitivityRow>, Failure> {
    let constant_errors = ConstantError::at(&PARTS);
    let row = |case: &Case, cell: &Cell| {
        let constant_error = match cell.constant_error {
            None => None,
            Some(index) => {
                let known = constant_errors.get(index);
                Some(
                    known
                        .ok_or_else(|| Failure::Input(format!("no error of a constant {index}")))?,
                )
            }
        };
        Ok(SensitivityRow {
            estimator: Kind::named(&cell.estimator)?.name,
            scenario: case.scenario.as_str(),
            rate_hz: case.rate_hz,
            seed: case.seed,
            constant: constant_error.map(|constant_error| constant_error.constant.as_str()),
            error: constant_error.map_or(0.0, |constant_error| constant_error.error),
            rms_rad_s: cell.rms_rad_s,
            rms_pct: cell.rms_pct,
            outside: cell.outside,
        })
    };
    let cases = cases.iter().zip(cells);
    let rows = cases.flat_map(|(case, cells)| cells.iter().map(move |cell| row(case, cell)));
    rows.collect()
}

fn run(case: &Case, settings: &Settings) -> Result<Vec<Cell>, Failure> {
    let trace = trace(case, &settings.device, &settings.estimators)?;
    let wanted = Wanted {
        rms: true,
        outside: true,
        ..Wanted::NONE
    };
    let omega = trace.true_omega.as_deref().unwrap_or_default();
    let truth = Truth::new(omega, case.rate_hz, interval(&settings.device), wanted)
        .map_err(|error| Failure::Input(format!("{}: {error}", case.scenario)))?;
    let setup = setup_of(case, &settings.device);
    let score = |kind: &Kind, constant_error: Option<&ConstantError>| {
        // The tuned parameters stay unchanged.
        let values = settings.parameters.values(kind, &setup, case.plant);
        let assumed = constant_error.map_or(setup, |constant_error| constant_error.of(&setup));
        let estimator = kind.build(&assumed, &values)?;
        let score = truth.score(&estimator.run(&trace));
        let missing = || Failure::Input(format!("{}: no score", kind.name));
        Ok::<_, Failure>((
            score.rms_rad_s.ok_or_else(missing)?,
            score.outside.ok_or_else(missing)?,
        ))
    };
    let (reference, _) = score(Kind::named(DIFFERENCE)?, None)?;
    let constant_errors = ConstantError::at(&PARTS);
    let wrong = constant_errors.iter().enumerate();
    let assumed: Vec<_> = std::iter::once(None).chain(wrong.map(Some)).collect();
    let mut cells = Vec::new();
    for kind in &settings.estimators {
        if kind.lack(&trace).is_some() {
            continue;
        }
        for constant_error in &assumed {
            let (rms_rad_s, outside) = score(kind, constant_error.map(|(_, error)| error))?;
            cells.push(Cell {
                estimator: kind.name.to_owned(),
                constant_error: constant_error.map(|(index, _)| index),
                rms_rad_s,
                rms_pct: 100.0 * rms_rad_s / reference,
                outside,
            });
        }
    }
    Ok(cells)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::compare::tests::{case, settings};
    use catalogue::parameters::PlantKind;
    use simulation::scenario::ScenarioName;

    #[test]
    fn percentages_are_of_the_finite_difference_and_a_model_feels_its_constants() {
        let names = ["finite-difference", "observer"];
        let settings = settings(&names);
        let case = Case {
            seconds: 0.5,
            ..case(ScenarioName::Step, PlantKind::Friction)
        };
        let rows = sensitivity(&[case], &settings, &|| ()).unwrap();
        let of = |name| -> Vec<_> {
            let rows = rows.iter().filter(|row| row.estimator == name);
            rows.collect()
        };
        let [difference, observer] = names.map(of);
        assert_eq!(difference.len(), 1 + ConstantError::at(&PARTS).len());
        assert!(difference.iter().all(|row| row.rms_pct == 100.0));
        let reference = difference[0].rms_rad_s;
        let right = observer[0];
        assert_eq!((right.constant, right.error), (None, 0.0));
        for row in &observer[1..] {
            assert!((row.rms_pct * reference / row.rms_rad_s - 100.0).abs() < 1e-9);
            assert_ne!(row.rms_rad_s, right.rms_rad_s, "{row:?}");
        }
    }
}
