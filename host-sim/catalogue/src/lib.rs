//! Every estimator by name: its parameters with units and ranges, its tuned presets, and the device
//! constants that it is designed for.

pub mod constant_error;
pub mod estimators;
pub mod parameters;
