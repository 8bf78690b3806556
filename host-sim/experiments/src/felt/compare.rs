//! Scenes × rates, the loop closed by every estimator in turn and by the reference encoder.

use rayon::prelude::*;

use haptic_control::SceneKind;

use super::run::{By, Prepared};
use super::{FeltRow, Fingertip, Parasitic};
use crate::compare::Cost;
use catalogue::estimators::Kind;
use catalogue::parameters::{Parameters, PlantKind};
use scoring::score::{Score, Wanted};
use simulation::device::Device;
use terminal::failure::Failure;

/// Estimator of the large motor's velocity on the reference encoder, and of the handle's unless
/// told otherwise.
pub const USUAL: &str = "kalman-triple-steady";

/// One scene at one rate.
#[derive(Clone, Debug, PartialEq)]
pub struct Case {
    /// Scene. The catalogue names the simulated hand that tries it.
    pub scene: SceneKind,
    /// Control rate, Hz.
    pub rate_hz: f64,
    /// With or without Coulomb friction; the controller knows which.
    pub plant: PlantKind,
    /// Seed.
    pub seed: u64,
    /// Duration, s.
    pub seconds: f64,
    /// Whether the signals are kept for figures.
    pub keep: bool,
}

/// What all cases have in common.
#[derive(Clone, Debug)]
pub struct Settings {
    /// The device.
    pub device: Device,
    /// Estimators that close the loop, each in turn.
    pub estimators: Vec<&'static Kind>,
    /// Estimator of the handle's velocity, on the small encoder.
    pub handle: &'static Kind,
    /// Parameters of all of them.
    pub parameters: Parameters,
    /// Which velocity scores to compute.
    pub wanted: Wanted,
}

/// One case, scored.
#[derive(Clone, Debug)]
pub struct Outcome {
    /// What was run.
    pub case: Case,
    /// What torque is worth at the device's fingertip.
    pub fingertip: Fingertip,
    /// One for each estimator in the loop and one for the reference, in this order; one alone,
    /// called "any", where the scene does not ask for the large motor's velocity.
    pub runs: Vec<Run>,
    /// The scores: each estimator closing the loop itself, then each watching the run that the
    /// reference closed.
    pub rows: Vec<FeltRow>,
    /// Where the time went.
    pub cost: Cost,
}

/// One run of a case.
#[derive(Clone, Debug)]
pub struct Run {
    /// Who closed the loop.
    pub controlled_by: &'static str,
    /// What the hand felt.
    pub parasitic: Parasitic,
    /// Scores of the velocity that the loop used, where it used one.
    pub velocity: Option<Score>,
    /// Why the monitor stopped the motors, if it did.
    pub stopped: Option<&'static str>,
    /// The signals, where [`Case::keep`] asked for them.
    pub signals: Option<Signals>,
}

/// What figures show of a run, one entry a tick.
#[derive(Clone, Debug, Default)]
pub struct Signals {
    /// Force that the scene wanted at the fingertip, mN.
    pub wanted_mn: Vec<f32>,
    /// Force that the hand felt there, mN.
    pub felt_mn: Vec<f32>,
    /// Velocity of the handle, rad/s.
    pub handle_rad_s: Vec<f32>,
}

/// The plant's device, with or without its friction.
#[must_use]
pub fn device(settings: &Settings, plant: PlantKind) -> Device {
    match plant {
        PlantKind::Friction => settings.device.clone(),
        PlantKind::Frictionless => settings.device.frictionless(),
    }
}

/// Runs all cases in parallel; `done` is called as each ends. The outcomes come in the order of
/// the cases.
///
/// # Errors
/// [`Failure::Input`] of the first case, in order, that could not be run.
pub fn compare(
    cases: &[Case],
    settings: &Settings,
    done: impl Fn() + Sync,
) -> Result<Vec<Outcome>, Failure> {
    let prepared: Vec<_> = (cases.iter())
        .map(|case| Prepared::new(case, settings))
        .collect::<Result<_, _>>()?;
    let jobs: Vec<(&Prepared, By)> = (prepared.iter())
        .flat_map(|p| p.closers().into_iter().map(move |by| (p, by)))
        .collect();
    let mut ran: Vec<(Run, Vec<FeltRow>, Cost)> = jobs
        .par_iter()
        .map(|&(prepared, by)| {
            let ran = prepared.run(by);
            done();
            ran
        })
        .collect::<Result<_, _>>()?;
    let mut outcomes = Vec::with_capacity(cases.len());
    for prepared in &prepared {
        let rest = ran.split_off(prepared.closers().len());
        let mut outcome = Outcome {
            case: prepared.case.clone(),
            fingertip: Fingertip::new(&settings.device),
            runs: Vec::new(),
            rows: Vec::new(),
            cost: Cost::default(),
        };
        for (run, rows, cost) in std::mem::replace(&mut ran, rest) {
            outcome.runs.push(run);
            outcome.rows.extend(rows);
            outcome.cost = [outcome.cost, cost].into_iter().sum();
        }
        outcomes.push(outcome);
    }
    Ok(outcomes)
}

/// How many runs a case takes.
#[must_use]
pub fn runs(case: &Case, settings: &Settings) -> usize {
    match case.scene.facts().needs.continuous {
        true => settings.estimators.len() + 1,
        false => 1,
    }
}
