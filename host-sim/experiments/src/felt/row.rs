//! One line of the closed loop's scores.

use serde::Serialize;

use super::Parasitic;
use scoring::contest::Row;

/// An object of the JSON output, a row of the CSV.
///
/// The velocity scores are those of [`Row::estimator`] on the device's own large encoder during
/// this run, in % of finite difference on the same counts. Where the estimator closes the loop
/// itself, they are of the velocities that the loop used.
#[derive(Clone, Debug, Serialize)]
pub struct FeltRow {
    /// The velocity scores; `scenario` is the scene's name.
    #[serde(flatten)]
    pub row: Row,
    /// Who closes the loop: the estimator itself, or [`REFERENCE`](super::REFERENCE).
    pub controlled_by: &'static str,
    /// Estimator of the handle's velocity.
    pub handle_estimator: &'static str,
    /// What the hand felt of it.
    #[serde(flatten)]
    pub parasitic: Parasitic,
    /// Why the monitor stopped the motors, if it did.
    pub stopped: Option<&'static str>,
}
