//! The dual-stage device in f64: the plant, its encoders, the scenarios that move it, and the trace
//! of samples that a control board would see.
//!
//! The true position and velocity are in the trace too. Only scores read them.

pub use device_files::device;

pub mod encoder;
pub mod plant;
pub mod scenario;
pub mod simulate;
pub mod trace;
