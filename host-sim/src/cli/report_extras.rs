//! Further experiments of the report of `compare`: lower bounds of the error, errors of the
//! device's constants, a warming coupler.

use catalogue::parameters::PlantKind;
use experiments::compare::{Case, Settings, compare};
use experiments::limit::{self, limit};
use experiments::sensitivity::{self, sensitivity};
use report::CaseReport;
use simulation::scenario::ScenarioName;
use terminal::failure::Failure;

use super::arguments::distinct;
use super::compare::{Compare, case_report};
use super::rates::USUAL_HZ;

/// Number of particles for the lower bound. With the 2000 particles of `host-sim limit` the bound
/// is 0.2 to 1.0 % lower (scenario stochastic, 1 kHz, seeds 1 and 2).
const PARTICLES: usize = 500;

/// Results that the report shows in addition to the requested cases.
#[derive(Default)]
pub(super) struct ReportExtras {
    pub(super) limits: Vec<limit::LimitRow>,
    pub(super) constant_errors: Vec<sensitivity::SensitivityRow>,
    pub(super) warming: Vec<CaseReport>,
}

/// Runs the further experiments at the lowest requested rate. If scenarios were named, only the
/// lower bounds are computed.
pub(super) fn report_extras(
    options: &Compare,
    settings: &Settings,
    cases: &[Case],
) -> Result<ReportExtras, Failure> {
    let rate_hz = distinct(&options.rates, &USUAL_HZ)
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
        return Ok(ReportExtras::default());
    }
    let bounded: Vec<Case> = cases
        .iter()
        .filter(|case| limit::SCENARIOS.contains(&case.scenario) && case.rate_hz == rate_hz)
        .filter(|case| case.plant == PlantKind::Friction)
        .cloned()
        .collect();
    let limits = limit(&bounded, settings, PARTICLES, &|| ())?;
    if !options.scenarios.is_empty() {
        return Ok(ReportExtras {
            limits,
            ..ReportExtras::default()
        });
    }
    let moving = [ScenarioName::Step, ScenarioName::Track].map(of);
    let warming = compare(&[of(ScenarioName::Heating)], settings, &|| ())?;
    Ok(ReportExtras {
        limits,
        constant_errors: sensitivity(&moving, settings, &|| ())?,
        warming: warming.iter().map(case_report).collect(),
    })
}
