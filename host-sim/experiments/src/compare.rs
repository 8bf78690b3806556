//! The main job: scenarios × rates × plants, every estimator on each, scored.

use std::time::{Duration, Instant};

use rayon::prelude::*;

use catalogue::estimators::{Kind, Setup};
use catalogue::parameters::{Parameters, PlantKind};
use scoring::contest::{Contest, Estimate, Heading, Row};
use scoring::score::{Interval, Wanted};
use simulation::device::Device;
use simulation::scenario::{Role, ScenarioName};
use simulation::simulate::{plant_steps, simulate};
use simulation::trace::{Columns, Trace};
use terminal::failure::Failure;

/// One run of the plant.
#[derive(Clone, Debug, PartialEq)]
pub struct Case {
    /// Scenario.
    pub scenario: ScenarioName,
    /// Control rate, Hz.
    pub rate_hz: f64,
    /// With or without Coulomb friction.
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
    /// Estimators, in the order of the tables.
    pub estimators: Vec<&'static Kind>,
    /// Their parameters.
    pub parameters: Parameters,
    /// Which scores to compute.
    pub wanted: Wanted,
}

/// One case, scored.
#[derive(Clone, Debug)]
pub struct Outcome {
    /// What was run.
    pub case: Case,
    /// One row an estimator.
    pub rows: Vec<Row>,
    /// The signals, where [`Case::keep`] asked for them.
    pub signals: Option<(Trace, Vec<Estimate>)>,
    /// Damping, true and learned, in scenario heating.
    pub damping: Option<Damping>,
    /// Where the time went.
    pub cost: Cost,
}

/// Damping b over a run, N.m.s/rad, true and as estimators learned it, each [`Damping::STEP_S`].
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Damping {
    /// The coupler's.
    pub truth: Vec<f64>,
    /// By estimator.
    pub learned: Vec<(&'static str, Vec<f64>)>,
}

impl Damping {
    /// Time from one value to the next, s.
    pub const STEP_S: f64 = 0.1;

    fn of(contest: &Contest, trace: &Trace) -> Option<Self> {
        let every = (Self::STEP_S * trace.rate_hz).round().max(1.0) as usize;
        let thinned = |values: &[f64]| values.iter().copied().step_by(every).collect();
        let learned = contest.contestants().iter().filter_map(|contestant| {
            let damping = contest.learned_damping(contestant, trace)?;
            Some((contestant.kind.name, thinned(&damping)))
        });
        Some(Self {
            truth: thinned(trace.true_damping.as_ref()?),
            learned: learned.collect(),
        })
    }
}

/// Where the time of a case went, on its one thread.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Cost {
    /// Steps of the plant.
    pub plant_steps: u64,
    /// Simulation of plant, encoders and scenario.
    pub simulation: Duration,
    /// All estimators.
    pub estimation: Duration,
    /// All scores.
    pub scoring: Duration,
}

impl std::iter::Sum for Cost {
    fn sum<I: Iterator<Item = Self>>(costs: I) -> Self {
        costs.fold(Self::default(), |a, b| Self {
            plant_steps: a.plant_steps + b.plant_steps,
            simulation: a.simulation + b.simulation,
            estimation: a.estimation + b.estimation,
            scoring: a.scoring + b.scoring,
        })
    }
}

/// The device of a case as estimators see it: of a plant without friction, they know that.
#[must_use]
pub fn setup_of(case: &Case, device: &Device) -> Setup {
    let setup = Setup::of(device, case.rate_hz);
    if case.plant == PlantKind::Frictionless || case.scenario.linear_plant() {
        setup.frictionless()
    } else {
        setup
    }
}

/// The haptic interval of a device.
#[must_use]
pub fn interval(device: &Device) -> Interval {
    Interval::new(
        device.interval.weber,
        device.interval.threshold_n,
        device.handle.diameter_m,
        device.stages.damping,
    )
}

/// Runs all cases in parallel; `done` is called as each ends. The outcomes come in the order of
/// the cases, whatever the order they ended in.
///
/// # Errors
/// [`Failure::Input`] of the first case, in order, that could not be run.
pub fn compare(
    cases: &[Case],
    settings: &Settings,
    done: impl Fn() + Sync,
) -> Result<Vec<Outcome>, Failure> {
    cases
        .par_iter()
        .map(|case| {
            let outcome = run(case, settings);
            done();
            outcome
        })
        .collect()
}

fn run(case: &Case, settings: &Settings) -> Result<Outcome, Failure> {
    let Settings {
        device,
        estimators,
        parameters,
        wanted,
    } = settings;
    let contest = Contest::new(estimators, parameters, &setup_of(case, device), case.plant)?;
    let begin = Instant::now();
    let trace = trace(case, device, estimators)?;
    let simulated = Instant::now();
    let estimates = contest.estimates(&trace);
    let estimated = Instant::now();
    let heading = Heading {
        scenario: case.scenario.as_str().to_owned(),
        rate_hz: case.rate_hz,
        plant: case.plant,
        seed: case.seed,
    };
    let rows = contest.rows(&heading, &trace, &estimates, interval(device), *wanted)?;
    let heats = case.scenario.role() == Role::Warming;
    Ok(Outcome {
        case: case.clone(),
        rows,
        damping: heats.then(|| Damping::of(&contest, &trace)).flatten(),
        cost: Cost {
            plant_steps: plant_steps(case.rate_hz, case.seconds)?,
            simulation: simulated - begin,
            estimation: estimated - simulated,
            scoring: estimated.elapsed(),
        },
        signals: case.keep.then_some((trace, estimates)),
    })
}

/// Simulates a case, with no column but those that the estimators read.
///
/// # Errors
/// [`Failure::Input`] where rate or duration are out of range.
pub fn trace(case: &Case, device: &Device, estimators: &[&Kind]) -> Result<Trace, Failure> {
    let columns = Columns {
        counts_small: estimators.iter().any(|kind| kind.needs.coupled),
        edges: estimators.iter().any(|kind| kind.needs.edge),
    };
    let frictionless;
    let device = match case.plant {
        PlantKind::Friction => device,
        PlantKind::Frictionless => {
            frictionless = device.frictionless();
            &frictionless
        }
    };
    Ok(simulate(
        device,
        case.scenario,
        case.rate_hz,
        case.seed,
        case.seconds,
        columns,
    )?)
}
