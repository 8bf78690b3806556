//! What was found of one estimator.

use serde::{Deserialize, Serialize};

/// What rounding may add while a filter that started in motion settles, rad/s: a thirtieth of
/// the haptic tolerance at rest.
const START_BOUND_RAD_S: f64 = 1e-2;

/// More faults than this are counted and not told.
const FAULTS_TOLD: usize = 5;

/// What may be asked of an estimator.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Bounds {
    /// What rounding may add to a velocity inside the haptic range, rad/s; infinite where it may
    /// turn a decision.
    pub deviation_rad_s: f64,
    /// Longest time to come to rest, ticks.
    pub settles_ticks: u32,
}

/// What was found.
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
    pub deviation_rad_s: f64,
    /// Largest |f32 - f64| within the first ticks after a start in motion, rad/s, at up to
    /// 20 rad/s: a covariance comes down from its prior, and cancels digits as it does.
    pub start_deviation_rad_s: f64,
    /// Largest |f32 - f64| over the largest velocity since the last rest, from a count a tick on.
    pub relative_deviation: f64,
    /// Longest rest until the output stayed at rest, ticks.
    pub recovery_ticks: u32,
    /// How long the twin took at most.
    pub twin_recovery_ticks: u32,
    /// Windows that were compared with their definition.
    pub windows_compared: u64,
    /// What went wrong.
    pub faults: Vec<String>,
    /// How often.
    pub fault_count: u64,
    /// What it is held against.
    #[serde(skip)]
    pub bounds: Bounds,
}

impl Findings {
    /// Whether everything held.
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

    /// Takes in what was found of the same estimator on another course.
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
