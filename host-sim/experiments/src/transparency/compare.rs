//! Closed-loop comparison: every scene and rate, with the velocity of each estimator in turn and
//! with that of the reference encoder.

use haptic_control::SceneKind;

use super::run::{Feedback, Prepared};
use super::{Attribution, ClosedLoopRow, Fingertip, Parasitic};
use crate::compare::{Cost, Settings};
use crate::parallel::in_order;
use catalogue::estimators::Kind;
use catalogue::parameters::PlantKind;
use scoring::score::Score;
use simulation::device::Device;
use terminal::failure::Failure;

/// Estimator on the reference encoder, and default estimator of the handle's velocity.
pub const DEFAULT_ESTIMATOR: &str = "kalman-triple-steady";

/// One scene at one rate.
#[derive(Clone, Debug, PartialEq)]
pub struct LoopCase {
    /// Scene. The catalogue names the simulated hand that tries it.
    pub scene: SceneKind,
    /// Control rate, Hz.
    pub rate_hz: f64,
    /// With or without Coulomb friction; the controller's constants agree with it.
    pub plant: PlantKind,
    /// Seed.
    pub seed: u64,
    /// Duration, s.
    pub seconds: f64,
    /// Whether the signals are kept for figures.
    pub keep: bool,
    /// Whether the parasitic force is attributed to its causes.
    pub attribute: bool,
}

/// What all cases have in common.
#[derive(Clone, Debug)]
pub struct LoopSettings {
    /// Device, estimators that close the loop in turn, their parameters, and the velocity scores to
    /// compute.
    pub common: Settings,
    /// Estimator of the handle's velocity, on the small encoder.
    pub handle: &'static Kind,
}

/// One case, scored.
#[derive(Clone, Debug)]
pub struct Outcome {
    /// The case.
    pub case: LoopCase,
    /// Conversion of torque to force at the fingertip.
    pub fingertip: Fingertip,
    /// One run per estimator that closes the loop, then one with the reference encoder. A scene that
    /// does not use the large motor's velocity has a single run, named "any".
    pub runs: Vec<Run>,
    /// The scores of each estimator in the loop that it closes itself, then of each estimator in the
    /// loop that the reference encoder closes.
    pub rows: Vec<ClosedLoopRow>,
    /// Run time.
    pub cost: Cost,
}

/// One run of a case.
#[derive(Clone, Debug)]
pub struct Run {
    /// Estimator that closed the loop, [`REFERENCE`](super::REFERENCE), or "any".
    pub controlled_by: &'static str,
    /// Scores of the parasitic force.
    pub parasitic: Parasitic,
    /// Scores of the velocity that the loop used, if it used one.
    pub velocity: Option<Score>,
    /// Reason for which the monitor stopped the motors, if it did.
    pub stopped: Option<&'static str>,
    /// The parasitic force by cause, if [`LoopCase::attribute`] is set.
    pub attribution: Option<Attribution>,
    /// The signals, if [`LoopCase::keep`] is set.
    pub signals: Option<Signals>,
}

/// Signals of a run for figures, one entry per tick.
#[derive(Clone, Debug, Default)]
pub struct Signals {
    /// Force that the scene computed, at the fingertip, mN.
    pub wanted_mn: Vec<f32>,
    /// Force on the hand, at the fingertip, mN.
    pub felt_mn: Vec<f32>,
    /// Velocity of the handle, rad/s.
    pub handle_rad_s: Vec<f32>,
}

/// The simulated device, with or without Coulomb friction.
#[must_use]
pub fn device(settings: &LoopSettings, plant: PlantKind) -> Device {
    match plant {
        PlantKind::Friction => settings.common.device.clone(),
        PlantKind::Frictionless => settings.common.device.frictionless(),
    }
}

/// Runs all cases in parallel; `done` is called as each ends. The outcomes come in the order of
/// the cases.
///
/// # Errors
/// [`Failure::Input`] of the first case, in order, that could not be run.
pub fn compare(
    cases: &[LoopCase],
    settings: &LoopSettings,
    done: &(dyn Fn() + Sync),
) -> Result<Vec<Outcome>, Failure> {
    let prepared: Vec<_> = (cases.iter())
        .map(|case| Prepared::new(case, settings))
        .collect::<Result<_, _>>()?;
    let jobs: Vec<(&Prepared, Feedback)> = (prepared.iter())
        .flat_map(|p| p.loops().into_iter().map(move |feedback| (p, feedback)))
        .collect();
    let mut ran: Vec<(Run, Vec<ClosedLoopRow>, Cost)> =
        in_order(&jobs, |&(prepared, feedback)| {
            let ran = prepared.run(feedback);
            done();
            ran
        })?;
    let mut outcomes = Vec::with_capacity(cases.len());
    for prepared in &prepared {
        let rest = ran.split_off(prepared.loops().len());
        let mut outcome = Outcome {
            case: prepared.case.clone(),
            fingertip: Fingertip::new(&settings.common.device),
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

/// Number of runs of a case.
#[must_use]
pub fn runs(case: &LoopCase, settings: &LoopSettings) -> usize {
    match case.scene.facts().needs.continuous {
        true => settings.common.estimators.len() + 1,
        false => 1,
    }
}
