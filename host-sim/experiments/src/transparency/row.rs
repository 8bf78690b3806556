//! One row of closed-loop scores.

use serde::Serialize;

use super::Parasitic;
use scoring::evaluation::Row;

/// The scores of one estimator in one closed-loop run: an object of the JSON output, a row of the
/// CSV.
///
/// The velocity scores are those of [`Row::estimator`] on the device's own large encoder during
/// this run, in % of finite difference on the same counts. If the estimator closes the loop, its
/// scored velocities are those that the loop used.
#[derive(Clone, Debug, Serialize)]
pub struct ClosedLoopRow {
    /// The velocity scores; `scenario` is the scene's name.
    #[serde(flatten)]
    pub row: Row,
    /// Source of the loop's velocity: the estimator's name, or [`REFERENCE`](super::REFERENCE).
    pub controlled_by: &'static str,
    /// Estimator of the handle's velocity.
    pub handle_estimator: &'static str,
    /// Scores of the parasitic force.
    #[serde(flatten)]
    pub parasitic: Parasitic,
    /// Reason for which the monitor stopped the motors, if it did.
    pub stopped: Option<&'static str>,
}
