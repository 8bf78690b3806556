//! What the hand feels: the device in closed loop, scored by the force that should not be there.
//!
//! Every estimator closes the loop on its own ([`compare`](mod@compare)); a torque of many sines
//! into a clamped handle says how fast torque is rendered ([`sweep()`]); the designed velocity loop
//! has its margins ([`design`]). Velocities are scored as everywhere else ([`score`](scoring::score)).

pub mod compare;
pub mod design;
mod parasitic;
mod row;
mod run;
pub mod sweep;
pub mod table;

pub use compare::{Case, Outcome, Run, Settings, Signals, compare};
pub use design::Design;
pub use parasitic::{Fingertip, Parasitic};
pub use row::FeltRow;
pub use sweep::{Response, Swept, bandwidth_hz, sweep};

/// Who closes the loop where that is the reference encoder, as in the paper.
pub const REFERENCE: &str = "reference";
