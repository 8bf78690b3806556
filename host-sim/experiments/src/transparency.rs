//! Transparency of the device in closed loop: the parasitic force on the hand.
//!
//! [`compare`](mod@compare) runs each scene with every estimator in the loop. [`attribution`] divides
//! the parasitic force among its causes. [`sweep()`] measures
//! the frequency response of the rendered torque with a multisine on a clamped handle. [`design`]
//! has the margins of the designed velocity loop. Velocities have the scores of
//! [`score`](scoring::score).

pub mod attribution;
pub mod compare;
pub mod design;
mod parasitic;
mod row;
mod run;
pub mod sweep;
pub mod table;

pub use attribution::{Attribution, Cause, Ledger, Part};
pub use compare::{LoopCase, LoopSettings, Outcome, Run, Signals, compare};
pub use design::Design;
pub use parasitic::{Fingertip, Parasitic};
pub use row::ClosedLoopRow;
pub use sweep::{Response, Swept, bandwidth_hz, sweep};

/// Name of the runs whose loop is closed by the reference encoder, as in the paper.
pub const REFERENCE: &str = "reference";
