//! Findings on one estimator.

use serde::{Deserialize, Serialize};

/// Largest error by rounding while a filter settles after a start in motion, rad/s: a thirtieth of the
/// haptic tolerance at rest.
const START_BOUND_RAD_S: f64 = 1e-2;

/// Number of faults that are reported in words; further ones are only counted.
const FAULTS_TOLD: usize = 5;

/// Bounds of an estimator.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Bounds {
    /// Largest error by rounding of a velocity inside the haptic range, rad/s; infinite if rounding
    /// can change a decision.
    pub deviation_rad_s: f64,
    /// Longest time until the output is at rest, ticks.
    pub settles_ticks: u32,
}

/// Findings of a run.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub struct Findings {
    /// Name and parameters.
    pub estimator: String,
    /// Control rate, Hz.
    pub rate_hz: f64,
    /// Ticks run.
    pub ticks: u64,
    /// Wraps of the 32-bit count.
    pub wraps: u64,
    /// Largest |f32 - f64| while no velocity since the last rest was above 20 rad/s, rad/s.
    #[serde(with = "shards::exact")]
    pub deviation_rad_s: f64,
    /// Largest |f32 - f64| within the first ticks after a start in motion at up to 20 rad/s, rad/s,
    /// while the covariance decreases from its prior with a loss of digits.
    #[serde(with = "shards::exact")]
    pub start_deviation_rad_s: f64,
    /// Largest |f32 - f64| over the largest velocity since the last rest, from a count a tick on.
    #[serde(with = "shards::exact")]
    pub relative_deviation: f64,
    /// Longest time until the output stayed at rest, ticks.
    pub recovery_ticks: u32,
    /// Longest time of the twin, ticks.
    pub twin_recovery_ticks: u32,
    /// Number of windows compared with their definition.
    pub windows_compared: u64,
    /// The first faults, in words.
    pub faults: Vec<String>,
    /// Number of faults.
    pub fault_count: u64,
    /// Bounds of the estimator.
    #[serde(skip)]
    pub bounds: Bounds,
}

impl Findings {
    /// Whether all checks passed.
    #[must_use]
    pub fn passed(&self) -> bool {
        self.fault_count == 0
            && self.recovery_ticks <= self.bounds.settles_ticks
            && (self.bounds.deviation_rad_s.is_infinite() || self.is_its_twin())
    }

    /// Whether it is close to its twin, as one is that decides nothing by its last bit.
    fn is_its_twin(&self) -> bool {
        self.deviation_rad_s <= self.bounds.deviation_rad_s
            && self.start_deviation_rad_s <= START_BOUND_RAD_S
            && self.recovery_ticks <= self.twin_bound()
    }

    /// The twin's recovery with a tenth and two ticks more.
    const fn twin_bound(&self) -> u32 {
        self.twin_recovery_ticks + self.twin_recovery_ticks / 10 + 2
    }

    pub(crate) fn fault(&mut self, said: impl FnOnce() -> String) {
        self.fault_count += 1;
        if self.faults.len() < FAULTS_TOLD {
            self.faults.push(said());
        }
    }

    /// Adds the findings on the same estimator from another course.
    pub(crate) fn join(&mut self, other: Self) {
        self.ticks += other.ticks;
        self.wraps += other.wraps;
        self.windows_compared += other.windows_compared;
        self.deviation_rad_s = self.deviation_rad_s.max(other.deviation_rad_s);
        self.start_deviation_rad_s = self.start_deviation_rad_s.max(other.start_deviation_rad_s);
        self.relative_deviation = self.relative_deviation.max(other.relative_deviation);
        self.recovery_ticks = self.recovery_ticks.max(other.recovery_ticks);
        self.twin_recovery_ticks = self.twin_recovery_ticks.max(other.twin_recovery_ticks);
        self.faults.extend(other.faults);
        self.faults.truncate(FAULTS_TOLD);
        self.fault_count += other.fault_count;
    }
}
