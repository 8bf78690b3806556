//! What the hand feels: the parasitic force of each scene and estimator by cause, and with each cause
//! switched off in turn.
//!
//! The bookkeeping of [`attribution`](crate::transparency::attribution) says how much force each cause has
//! in a run. Switching off says how the force changes if the cause goes: the controller then reacts to
//! another motion. A device without a cause is described to the controller as it is. All runs of a case
//! have the same seed.

pub mod rows;
pub mod table;
mod without;

use haptic_control::{LoopPoles, SceneKind};

pub use without::Without;

use crate::closed_loop::{Conditions, Dac, Exact, FeedbackEncoder, Loop, estimator, usual};
use crate::parallel::in_order;
use crate::transparency::attribution::CAUSES;
use crate::transparency::{Attribution, Fingertip, Ledger, Parasitic};
use catalogue::estimators::Kind;
use catalogue::parameters::Parameters;
use device_files::six_digits;
use scoring::score::SKIP_S;
use scoring::spectrum::SEGMENT_S;
use simulation::device::Device;
use simulation::simulate;
use terminal::failure::Failure;

/// What all cases have in common.
#[derive(Clone, Debug)]
pub struct Settings {
    /// Device with every cause.
    pub device: Device,
    /// Parameters of the estimators.
    pub parameters: Parameters,
    /// Estimator of the handle's velocity.
    pub handle: &'static Kind,
    /// Seed.
    pub seed: u64,
    /// Duration of each run, s.
    pub seconds: f64,
    /// What is switched off in turn.
    pub without: Vec<Without>,
}

impl Settings {
    /// What cannot be switched off, because no device of the simulation is left without it, and why; `None`
    /// where all can.
    #[must_use]
    pub fn left_out(&self) -> Option<String> {
        let refused = |without: &Without| {
            let mut device = without.of(&self.device);
            // A tenth as it is written.
            let inertia = &mut device.stages.small.inertia;
            *inertia = six_digits(*inertia);
            let reason = device.validate().err()?;
            Some((without.name(), reason))
        };
        let refused: Vec<_> = self.without.iter().filter_map(refused).collect();
        let (_, reason) = refused.first()?;
        let names: Vec<_> = refused
            .iter()
            .map(|(name, _)| format!("\"{name}\""))
            .collect();
        Some(format!(
            "this device cannot be simulated without {}, which have no scores: {reason}",
            names.join(", ")
        ))
    }
}

/// One scene with one estimator at one rate.
#[derive(Clone, Copy, Debug)]
pub struct Case {
    /// Scene, tried by the hand that the catalogue names.
    pub scene: SceneKind,
    /// Control rate, Hz.
    pub rate_hz: f64,
    /// Estimator of the large motor's velocity; `None` for a scene that does not use it.
    pub estimator: Option<&'static Kind>,
}

impl Case {
    /// Name of the estimator; "any" without one.
    #[must_use]
    pub fn estimator_name(&self) -> &'static str {
        self.estimator.map_or("any", |kind| kind.name)
    }
}

/// Results of one case.
#[derive(Clone, Debug)]
pub struct Felt {
    /// The case.
    pub case: Case,
    /// Scores of the parasitic force with every cause.
    pub parasitic: Parasitic,
    /// The parasitic force by cause; `None` if it is not finite.
    pub attribution: Option<Attribution>,
    /// Scores of the parasitic force without a cause, in the order of [`Settings::without`].
    pub without: Vec<(Without, Parasitic)>,
}

/// Why the scores from 50 to 500 Hz are missing; `None` where there are some, or no scores at all.
#[must_use]
pub fn without_spectrum(all: &[Felt]) -> Option<String> {
    let is_short = |felt: &Felt| {
        let found = felt.attribution.as_ref();
        found.is_some_and(|found| found.tactile_mn.is_none())
    };
    all.iter().any(is_short).then(|| {
        format!(
            "the columns from 50 to 500 Hz need --seconds {} or more: a spectrum takes {SEGMENT_S} s after the first \
             {SKIP_S} s",
            SKIP_S + SEGMENT_S
        )
    })
}

/// A case, and what is switched off in it.
type Job<'a> = (&'a Case, Option<Without>);

/// Runs all cases in parallel; `done` is called after each of the [`runs`].
///
/// # Errors
/// [`Failure::Input`] of the first run, in order, that is not possible.
pub fn feel(
    cases: &[Case],
    settings: &Settings,
    done: &(dyn Fn() + Sync),
) -> Result<Vec<Felt>, Failure> {
    let (distinct, places) = distinct(cases, settings);
    let ran: Vec<(Parasitic, Option<Attribution>)> = in_order(&distinct, |(case, without)| {
        let ran = run(case, *without, settings);
        done();
        ran
    })?;
    let ran: Vec<_> = places.into_iter().map(|place| &ran[place]).collect();
    let felt = (cases.iter()).zip(ran.chunks(1 + settings.without.len()));
    Ok(felt
        .map(|(case, runs)| Felt {
            case: *case,
            parasitic: runs[0].0,
            attribution: runs[0].1.clone(),
            without: (settings.without.iter().copied())
                .zip(runs[1..].iter().map(|(parasitic, _)| *parasitic))
                .collect(),
        })
        .collect())
}

/// Number of runs of [`feel`].
#[must_use]
pub fn runs(cases: &[Case], settings: &Settings) -> usize {
    distinct(cases, settings).0.len()
}

/// The jobs without those that are the same run as an earlier one, and the place of each job among them:
/// case by case, first with every cause.
fn distinct<'a>(cases: &'a [Case], settings: &Settings) -> (Vec<Job<'a>>, Vec<usize>) {
    let jobs = cases.iter().flat_map(|case| {
        let without = settings.without.iter().map(move |what| (case, Some(*what)));
        std::iter::once((case, None)).chain(without)
    });
    let mut distinct: Vec<Job> = Vec::new();
    let places = jobs.map(|job| {
        let same = distinct.iter().position(|other| is_same_run(&job, other));
        same.unwrap_or_else(|| {
            distinct.push(job);
            distinct.len() - 1
        })
    });
    let places = places.collect();
    (distinct, places)
}

/// Whether both jobs have the true velocity in the same loop: no estimator of the large motor runs in it.
fn is_same_run((a, without): &Job, (b, other): &Job) -> bool {
    let has_truth = without.is_some_and(|without| without.exact() != Exact::Neither);
    has_truth && without == other && (a.scene, a.rate_hz) == (b.scene, b.rate_hz)
}

/// Runs a case without a cause, if one is given, and attributes the force of a run with every cause. A run
/// that is not possible has no scores.
fn run(
    case: &Case,
    without: Option<Without>,
    settings: &Settings,
) -> Result<(Parasitic, Option<Attribution>), Failure> {
    let rate_hz = case.rate_hz;
    let device = match without {
        Some(without) => without.of(&settings.device),
        None => settings.device.clone(),
    };
    let is_possible =
        |without: Without| without.is_possible_in(case.scene) && device.validate().is_ok();
    if without.is_some_and(|without| !is_possible(without)) {
        return Ok((Parasitic::default(), None));
    }
    let removes = |remove: fn(&Without) -> bool| without.as_ref().is_some_and(remove);
    let conditions = Conditions {
        fault: None,
        dac: match removes(Without::removes_dac) {
            true => None,
            false => Some(Dac::board()?),
        },
        exact: without.map_or(Exact::Neither, Without::exact),
        oracle: without.and_then(Without::oracle),
        grips: None,
    };
    let on = |kind, counts| estimator(kind, &device, counts, rate_hz, &settings.parameters);
    let assumed = device.stages;
    let run = Loop {
        large: on(
            case.estimator.unwrap_or(settings.handle),
            assumed.large.counts_per_rev,
        )?,
        handle: on(settings.handle, assumed.small.counts_per_rev)?,
        scene: scene(case, &settings.device)?,
        hand: case.scene.facts().hand.into(),
        device,
        assumed,
        rate_hz,
        seed: settings.seed,
        encoder: FeedbackEncoder::Own,
        poles: LoopPoles::DEFAULT,
        late_ticks: 0,
        offsets_a: [0.0; 2],
    };
    let ticks = simulate::ticks(rate_hz, settings.seconds)?;
    let fingertip = Fingertip::new(&run.device);
    let mn = fingertip.mn_per_nm;
    let mut ledger = match without {
        None => Some(Ledger::new(
            &run.device,
            &run.assumed,
            case.scene,
            rate_hz,
            run.poles,
        )?),
        Some(_) => None,
    };
    let mut terms: [Vec<f64>; CAUSES] = Default::default();
    let mut parasitic = Vec::with_capacity(ticks);
    run.run_under(ticks, conditions, |now| {
        parasitic.push(mn * (now.felt - f64::from(now.action.torque.0)));
        if let Some(ledger) = &mut ledger {
            for (term, torque) in terms.iter_mut().zip(ledger.terms(now)) {
                term.push(mn * torque);
            }
        }
    })?;
    let attribution = ledger.and_then(|_| Attribution::of(&terms, rate_hz));
    Ok((Parasitic::of(&parasitic, rate_hz, &fingertip), attribution))
}

/// The scene as it is for the device with every cause, so that every run has the same task.
fn scene(case: &Case, device: &Device) -> Result<haptic_control::AnyScene, String> {
    usual(case.scene, &device.stages, case.rate_hz)
}

#[cfg(test)]
mod tests;
