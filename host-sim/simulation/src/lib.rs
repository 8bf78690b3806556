//! The dual-stage device in f64: the plant, its encoders, the scenarios that move it, and the trace
//! of samples as a control board reads them.
//!
//! The trace also has the true velocity, which only scores read.

pub use device_files::device;

pub mod encoder;
pub mod plant;
pub mod scenario;
pub mod simulate;
pub mod trace;
