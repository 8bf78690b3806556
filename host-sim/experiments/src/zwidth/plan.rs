//! The loops of one command: every combination of rate, encoder and estimator.

use serde::{Deserialize, Serialize};
use shards::Experiment;

use super::{BOUNDS_A_CASE, Boundary, LoopSetup, Settings, boundaries};
use crate::closed_loop::{check_handle, check_stamps, loop_ticks};
use catalogue::estimators::Kind;
use terminal::failure::Failure;

/// Estimator of the handle's velocity beside an estimator that needs the current.
pub const HANDLE: &str = "kalman-triple";

/// All inputs of the boundaries of several loops. A job is one loop.
#[derive(Clone, Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Plan {
    /// Estimators of the large motor's velocity, by name.
    pub estimators: Vec<String>,
    /// Estimator of the handle's velocity; `None` for that of the large motor, or [`HANDLE`] if that
    /// one needs the current.
    pub handle: Option<String>,
    /// Whether each rate and encoder also has a loop with the true velocities of both motors.
    pub exact: bool,
    /// Control rates, Hz.
    pub rates_hz: Vec<f64>,
    /// Numbers of lines of the large encoder.
    pub lines: Vec<u32>,
    /// Settings that all loops share.
    pub settings: Settings,
    /// Name of the device in reports.
    pub device_name: String,
}

impl Experiment for Plan {
    const COMMAND: &'static str = "host-sim zwidth";
    const STEPS_A_JOB: usize = BOUNDS_A_CASE;
    type Job = LoopSetup;
    type Row = Boundary;

    /// The loops in the order of the table.
    fn jobs(&self) -> Result<Vec<LoopSetup>, Failure> {
        let kinds = self.estimators.iter().map(|name| Kind::named(name));
        let kinds: Vec<_> = kinds.collect::<Result<_, _>>()?;
        check_stamps(kinds.iter().copied())?;
        let handle = self.handle.as_deref().map(Kind::named).transpose()?;
        handle.map_or(Ok(()), |kind| check_handle("--handle-estimator", kind))?;
        let triple = Kind::named(HANDLE)?;
        let mut cases = Vec::new();
        for &rate_hz in &self.rates_hz {
            loop_ticks(rate_hz, 1.0)?;
            for &lines in &self.lines {
                cases.extend(kinds.iter().map(|&large| LoopSetup {
                    large,
                    handle: handle.unwrap_or(if large.needs.current { triple } else { large }),
                    rate_hz,
                    lines,
                    exact: false,
                }));
                // The estimators of this loop do not run.
                cases.extend(self.exact.then_some(LoopSetup {
                    large: triple,
                    handle: triple,
                    rate_hz,
                    lines,
                    exact: true,
                }));
            }
        }
        Ok(cases)
    }

    fn rows(&self, jobs: &[LoopSetup], done: &(dyn Fn() + Sync)) -> Result<Vec<Boundary>, Failure> {
        boundaries(jobs, &self.settings, done)
    }
}
