//! Error by f32 on signals of a device: every scenario of the simulated device.

use catalogue::estimators::sample;
use serde::{Deserialize, Serialize};
use simulation::device::Device;
use simulation::scenario::{Role, ScenarioName};
use simulation::simulate::simulate;
use simulation::trace::Columns;

use crate::course::Shown;
use crate::tested::TestedEstimator;

/// Length of each scenario, s.
const SECONDS: f64 = 10.0;

/// Start that is skipped, s; the deviation after a start is measured separately.
const SETTLED_S: f64 = 0.5;

/// Inputs of the estimators, and the true velocity at each, rad/s.
#[derive(Clone, Debug)]
pub struct Scenario {
    shown: Vec<Shown>,
    truth: Vec<f64>,
}

/// The signals of every scenario at one rate.
///
/// # Panics
/// If the default device cannot be simulated at the rate.
#[must_use]
pub fn at(rate_hz: f64, seed: u64) -> Vec<Scenario> {
    let everything = estimator_core::Signals {
        current: true,
        coupled: true,
        edge: true,
    };
    let columns = Columns {
        counts_small: true,
        edges: true,
    };
    let device = Device::default();
    // A scenario of the role Special is for one question.
    let pooled = |scenario: &ScenarioName| scenario.role() != Role::Special;
    let scenarios = ScenarioName::ALL.into_iter().filter(pooled);
    let traces = scenarios.map(|scenario| {
        let trace = simulate(&device, scenario, rate_hz, seed, SECONDS, columns);
        let trace = trace.expect("the default device is possible");
        let samples = (0..trace.len()).map(|k| sample(everything, &trace, k));
        Scenario {
            shown: samples.map(|sample| Shown::of(&sample)).collect(),
            truth: trace.true_omega.expect("simulated"),
        }
    });
    traces.collect()
}

/// Difference of f32 and f64 over all signals.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub struct Difference {
    /// Name and parameters.
    pub estimator: String,
    /// Control rate, Hz.
    pub rate_hz: f64,
    /// Largest |f32 - f64|, rad/s.
    #[serde(with = "shards::exact")]
    pub largest_rad_s: f64,
    /// RMS of f32 - f64, rad/s.
    #[serde(with = "shards::exact")]
    pub rms_rad_s: f64,
    /// RMS error in f32 and in f64 against the truth, rad/s.
    #[serde(with = "shards::exact::two")]
    pub error_rad_s: [f64; 2],
}

impl Difference {
    /// Relative increase of the error by f32; negative if the error happens to be smaller.
    #[must_use]
    pub fn added_error(&self) -> f64 {
        let [narrow, wide] = self.error_rad_s;
        narrow / wide - 1.0
    }
}

/// Runs `tested` over all signals in both precisions.
#[must_use]
pub fn difference(tested: &TestedEstimator, scenarios: &[Scenario]) -> Difference {
    let mut found = Difference {
        estimator: tested.name.clone(),
        rate_hz: tested.rate_hz,
        ..Difference::default()
    };
    let settled = (SETTLED_S * tested.rate_hz) as usize;
    let mut ticks = 0.0;
    for Scenario { shown, truth } in scenarios {
        let mut pair = tested.pair();
        pair.start(&shown[0]);
        for (tick, (shown, truth)) in shown.iter().zip(truth).enumerate().skip(1) {
            let (narrow, wide) = pair.update(shown);
            if tick < settled {
                continue;
            }
            let both = [f64::from(narrow), wide].map(|v| v * tested.rad_per_count());
            let apart = (both[0] - both[1]).abs();
            found.largest_rad_s = found.largest_rad_s.max(apart);
            found.rms_rad_s += apart * apart;
            for (sum, velocity) in found.error_rad_s.iter_mut().zip(both) {
                *sum += (velocity - truth).powi(2);
            }
            ticks += 1.0;
        }
    }
    found.rms_rad_s = (found.rms_rad_s / ticks).sqrt();
    found.error_rad_s = found.error_rad_s.map(|sum| (sum / ticks).sqrt());
    found
}
