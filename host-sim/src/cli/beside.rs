//! What the report of `compare` shows beside the scores: limits, wrong beliefs, a warming coupler.

use catalogue::parameters::PlantKind;
use experiments::compare::{Case, Settings, compare};
use experiments::limit::{self, limit};
use experiments::sensitivity::{self, sensitivity};
use report::CaseReport;
use simulation::scenario::ScenarioName;
use terminal::failure::Failure;

use super::arguments::rates;
use super::compare::{Compare, case_report};

/// Particles of the limit: `host-sim limit` with its 2000 finds 0.2 to 1.0 % less (scenario stochastic,
/// 1 kHz, seeds 1 and 2).
const PARTICLES: usize = 500;

/// What is run beside the cases that were asked for.
#[derive(Default)]
pub(super) struct Beside {
    pub(super) limits: Vec<limit::Row>,
    pub(super) beliefs: Vec<sensitivity::Row>,
    pub(super) warming: Vec<CaseReport>,
}

/// Runs what belongs to a report of everything, at the lowest rate asked for: a report of chosen
/// scenarios has none of it but the limit of those that it is run on.
pub(super) fn beside(
    options: &Compare,
    settings: &Settings,
    cases: &[Case],
) -> Result<Beside, Failure> {
    let rate_hz = rates(&options.rates, &[1e3])
        .into_iter()
        .fold(f64::INFINITY, f64::min);
    let of = |scenario: ScenarioName| Case {
        scenario,
        rate_hz,
        plant: PlantKind::Friction,
        seed: options.seed,
        seconds: options.seconds.unwrap_or(scenario.default_seconds()),
        keep: false,
    };
    if options.frictionless {
        return Ok(Beside::default());
    }
    let seen: Vec<Case> = cases
        .iter()
        .filter(|case| limit::SCENARIOS.contains(&case.scenario) && case.rate_hz == rate_hz)
        .filter(|case| case.plant == PlantKind::Friction)
        .cloned()
        .collect();
    let limits = limit(&seen, settings, PARTICLES, || ())?;
    if !options.scenarios.is_empty() {
        return Ok(Beside {
            limits,
            ..Beside::default()
        });
    }
    let moving = [ScenarioName::Step, ScenarioName::Track].map(of);
    let warming = compare(&[of(ScenarioName::Heating)], settings, || ())?;
    Ok(Beside {
        limits,
        beliefs: sensitivity(&moving, settings, || ())?,
        warming: warming.iter().map(case_report).collect(),
    })
}
