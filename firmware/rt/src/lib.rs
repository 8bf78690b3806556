//! All of the firmware's unsafe code, with a SAFETY line for each use.
#![no_std]

mod converter;
mod crystal;
mod debugger;
mod emergency;
mod reset_cause;
mod rtt;
pub mod serial;

pub use converter::convert_channel;
pub use crystal::crystal_is_ready;
pub use debugger::{debugger_interferes, undo_debugger};
pub use emergency::{EmergencyOutputs, outputs_safe, restart};
pub use reset_cause::{store, take};
pub use rtt::{lost, receive, send};
