//! Open-loop comparison: scores of every estimator for each scenario, rate and plant.

use std::time::{Duration, Instant};

use crate::parallel::in_order;
use catalogue::estimators::{Kind, Setup};
use catalogue::parameters::{Parameters, PlantKind};
use scoring::evaluation::{Estimate, Evaluation, Heading, Row};
use scoring::score::{HapticInterval, Wanted};
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
    /// Whether the outcome has the signals, for figures.
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

/// Scores of one case.
#[derive(Clone, Debug)]
pub struct Outcome {
    /// The case.
    pub case: Case,
    /// One row per estimator.
    pub rows: Vec<Row>,
    /// The signals, if [`Case::keep`] is set.
    pub signals: Option<(Trace, Vec<Estimate>)>,
    /// True and estimated damping, in scenario heating.
    pub damping: Option<Damping>,
    /// Whether the large motor moves by a count.
    pub moves: bool,
    /// Run time.
    pub cost: Cost,
}

/// Damping b over a run, N.m.s/rad: true values and estimates, one each [`Damping::STEP_S`].
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Damping {
    /// True damping of the coupler.
    pub truth: Vec<f64>,
    /// Estimated damping by estimator.
    pub learned: Vec<(&'static str, Vec<f64>)>,
}

impl Damping {
    /// Time from one value to the next, s.
    pub const STEP_S: f64 = 0.1;

    fn of(evaluation: &Evaluation, trace: &Trace, estimates: &[Estimate]) -> Option<Self> {
        let every = (Self::STEP_S * trace.rate_hz).round().max(1.0) as usize;
        let thinned = |values: &[f64]| values.iter().copied().step_by(every).collect();
        let learned = evaluation.candidates().iter().filter_map(|candidate| {
            let damping = evaluation.learned_damping(candidate, trace, estimates)?;
            Some((candidate.kind.name, thinned(&damping)))
        });
        Some(Self {
            truth: thinned(trace.true_damping.as_ref()?),
            learned: learned.collect(),
        })
    }
}

/// Run time of a case on one thread.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Cost {
    /// Steps of the plant.
    pub plant_steps: u64,
    /// Time for plant, encoders and scenario.
    pub simulation: Duration,
    /// Time for all estimators.
    pub estimation: Duration,
    /// Time for all scores.
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

/// The device constants that the estimators of a case use; without friction if the plant has none.
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
pub fn interval(device: &Device) -> HapticInterval {
    HapticInterval::new(
        device.interval.weber,
        device.interval.threshold_n,
        device.handle.diameter_m,
        device.stages.damping,
    )
}

/// Runs all cases in parallel and calls `done` after each. The outcomes have the order of the
/// cases.
///
/// # Errors
/// [`Failure::Input`] of the first case, in order, that cannot be run.
pub fn compare(
    cases: &[Case],
    settings: &Settings,
    done: &(dyn Fn() + Sync),
) -> Result<Vec<Outcome>, Failure> {
    in_order(cases, |case| {
        let outcome = run(case, settings);
        done();
        outcome
    })
}

fn run(case: &Case, settings: &Settings) -> Result<Outcome, Failure> {
    let Settings {
        device,
        estimators,
        parameters,
        wanted,
    } = settings;
    let evaluation = Evaluation::new(estimators, parameters, &setup_of(case, device), case.plant)?;
    let begin = Instant::now();
    let trace = trace(case, device, estimators)?;
    let simulated = Instant::now();
    let estimates = evaluation.estimates(&trace);
    let estimated = Instant::now();
    let heading = Heading {
        scenario: case.scenario.as_str().to_owned(),
        rate_hz: case.rate_hz,
        plant: case.plant,
        seed: case.seed,
    };
    let rows = evaluation.rows(&heading, &trace, &estimates, interval(device), *wanted)?;
    let heats = case.scenario.role() == Role::Warming;
    Ok(Outcome {
        case: case.clone(),
        rows,
        damping: heats
            .then(|| Damping::of(&evaluation, &trace, &estimates))
            .flatten(),
        moves: trace.counts_large.windows(2).any(|pair| pair[0] != pair[1]),
        cost: Cost {
            plant_steps: plant_steps(case.rate_hz, case.seconds)?,
            simulation: simulated - begin,
            estimation: estimated - simulated,
            scoring: estimated.elapsed(),
        },
        signals: case.keep.then_some((trace, estimates)),
    })
}

/// Simulates a case with only the columns that the estimators read.
///
/// # Errors
/// [`Failure::Input`] if rate or duration are out of range.
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

#[cfg(test)]
pub(crate) mod tests {
    use super::*;

    /// Estimators with their presets on the default device, without plots.
    pub(crate) fn settings(names: &[&str]) -> Settings {
        Settings {
            device: Device::default(),
            estimators: names.iter().map(|it| Kind::named(it).unwrap()).collect(),
            parameters: Parameters::default(),
            wanted: Wanted::NONE,
        }
    }

    /// A second of a scenario at 1 kHz.
    pub(crate) fn case(scenario: ScenarioName, plant: PlantKind) -> Case {
        Case {
            scenario,
            rate_hz: 1000.0,
            plant,
            seed: 1,
            seconds: 1.0,
            keep: false,
        }
    }

    #[test]
    fn estimators_know_whether_the_plant_has_friction() {
        let device = Device::default();
        let own = device.stages.large.coulomb_friction;
        let assumed = |scenario, plant| {
            let setup = setup_of(&case(scenario, plant), &device);
            setup.stages.large.coulomb_friction
        };
        assert_eq!(assumed(ScenarioName::Step, PlantKind::Friction), own);
        assert_eq!(assumed(ScenarioName::Step, PlantKind::Frictionless), 0.0);
        // The plant of this scenario is linear, whatever the device.
        assert_eq!(assumed(ScenarioName::Stochastic, PlantKind::Friction), 0.0);
    }

    #[test]
    fn damping_has_a_value_each_tenth_of_a_second() {
        let settings = settings(&["adaptive"]);
        let case = case(ScenarioName::Heating, PlantKind::Friction);
        let outcomes = compare(&[case], &settings, &|| ()).unwrap();
        let damping = outcomes[0].damping.as_ref().unwrap();
        assert_eq!(damping.truth.len(), 10);
        assert_eq!(damping.learned[0].0, "adaptive");
        assert_eq!(damping.learned[0].1.len(), 10);
        // It falls from that of the device on.
        assert!((damping.truth[0] / settings.device.stages.damping - 1.0).abs() < 1e-3);
        assert!(damping.truth.is_sorted_by(|a, b| a > b), "{damping:?}");
    }
}
