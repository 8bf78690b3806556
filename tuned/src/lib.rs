//! The device and the tuned parameters that images are built for, as constants: images take what
//! `host-sim identify` and `host-sim tune` wrote and carry no copy.
//!
//! `DEVICE=mine.toml PRESETS=tuned.toml cargo firmware` builds for other files than the shipped ones.
//!
//! ```
//! use estimator_core::Hertz;
//!
//! const JERK: f64 = tuned::value("kalman-triple", Hertz(10_000.0), "jerk");
//! assert!(JERK > 0.0);
//! ```
#![no_std]

use estimator_catalogue::{Parameter, ROWS};
use estimator_core::{Hertz, Uncertainty};
use haptic_control::{DualStage, Fingerprint, Motor};

/// Values of one presets file.
struct Layer {
    /// Motor, estimator, parameter, value.
    image: &'static [(&'static str, &'static str, &'static str, f64)],
    /// Rate in Hz, ratio of the device's counts per revolution to the tuned ones, estimator, parameter,
    /// value.
    tuned: &'static [(f64, f64, &'static str, &'static str, f64)],
}

include!(concat!(env!("OUT_DIR"), "/constants.rs"));

/// Hash of the device that images are built for.
pub const DEVICE_FINGERPRINT: Fingerprint = DEVICE.fingerprint();
/// Hash of the tuned parameters.
pub const PRESETS_FINGERPRINT: Fingerprint = PRESETS;

impl Layer {
    /// The value tuned at the rate nearest to `rate` by ratio, among the rates at which `estimator`
    /// is tuned, scaled to `rate` and to the encoder of the device.
    const fn tuned(&self, estimator: &str, rate: Hertz, parameter: &str) -> Option<f64> {
        let (mut value, mut nearest) = (None, f64::INFINITY);
        let mut rows = self.tuned;
        while let [(at, counts, of, name, tuned), rest @ ..] = rows {
            rows = rest;
            if !same(of, estimator) {
                continue;
            }
            let ratio = if *at < rate.0 {
                rate.0 / *at
            } else {
                *at / rate.0
            };
            if ratio < nearest {
                (value, nearest) = (None, ratio);
            }
            if ratio == nearest && same(name, parameter) {
                let scaled = parameter_of(estimator, parameter);
                value = Some(scaled.scaled(*tuned, *counts, rate.0 / *at));
            }
        }
        value
    }

    const fn image(&self, motor: &str, estimator: &str, parameter: &str) -> Option<f64> {
        let mut rows = self.image;
        while let [(moved, of, name, value), rest @ ..] = rows {
            if same(moved, motor) && same(of, estimator) && same(name, parameter) {
                return Some(*value);
            }
            rows = rest;
        }
        None
    }
}

/// The row of a parameter.
const fn parameter_of(estimator: &str, parameter: &str) -> &'static Parameter {
    let mut rows = ROWS;
    while let [row, rest @ ..] = rows {
        let mut parameters = if same(row.name, estimator) {
            row.parameters
        } else {
            &[]
        };
        while let [found, rest @ ..] = parameters {
            if same(found.name, parameter) {
                return found;
            }
            parameters = rest;
        }
        rows = rest;
    }
    panic!("a parameter of the catalogue")
}

/// The value of an estimator's parameter, tuned at the rate nearest to `rate` by ratio and scaled to
/// `rate` and to the encoder of the device, as host-sim takes it; `None` if no file has such a parameter.
#[must_use]
pub const fn find(estimator: &str, rate: Hertz, parameter: &str) -> Option<f64> {
    let mut layers = LAYERS;
    while let [layer, rest @ ..] = layers {
        let value = layer.tuned(estimator, rate, parameter);
        if value.is_some() {
            return value;
        }
        layers = rest;
    }
    None
}

/// The value that [`find`] finds.
///
/// # Panics
/// If no file has such a parameter: in a constant, the build stops.
#[must_use]
pub const fn value(estimator: &str, rate: Hertz, parameter: &str) -> f64 {
    find(estimator, rate, parameter).expect("a parameter in host-sim/presets.toml")
}

/// The value of a parameter of a design that is measured with a window of `capacity` intervals: the
/// window `n` is as long, the noise bound `d` is one count, and every other parameter is tuned.
///
/// # Panics
/// As [`value`].
#[must_use]
pub const fn value_for(estimator: &str, rate: Hertz, capacity: usize, parameter: &str) -> f64 {
    match parameter.as_bytes() {
        b"n" => capacity as f64,
        b"d" => 1.0,
        _ => value(estimator, rate, parameter),
    }
}

/// The value of a parameter in the control loop of an image: the `[image]` section's for that motor,
/// `large` or `handle`; for the large motor else the tuned value. The file that PRESETS names comes
/// before the shipped one.
///
/// # Panics
/// If no file has such a value: in a constant, the build stops.
#[must_use]
pub const fn image(motor: &str, estimator: &str, rate: Hertz, parameter: &str) -> f64 {
    let mut layers = LAYERS;
    while let [layer, rest @ ..] = layers {
        if let Some(value) = layer.image(motor, estimator, parameter) {
            return value;
        }
        if same(motor, "large")
            && let Some(value) = layer.tuned(estimator, rate, parameter)
        {
            return value;
        }
        layers = rest;
    }
    panic!("a parameter in the section [image] of host-sim/presets.toml")
}

/// The uncertainty that an observer is tuned to.
///
/// # Panics
/// As [`value`].
#[must_use]
pub const fn uncertainty(observer: &str, rate: Hertz) -> Uncertainty {
    Uncertainty {
        torque_noise: value(observer, rate, "torque_noise"),
        disturbance: value(observer, rate, "load"),
        disturbance_time: value(observer, rate, "load_time"),
        friction_share: value(observer, rate, "friction_share"),
        boundary_noise: value(observer, rate, "boundary_noise"),
    }
}

const fn same(a: &str, b: &str) -> bool {
    let (mut a, mut b) = (a.as_bytes(), b.as_bytes());
    while let ([x, a_rest @ ..], [y, b_rest @ ..]) = (a, b) {
        if *x != *y {
            return false;
        }
        (a, b) = (a_rest, b_rest);
    }
    a.is_empty() && b.is_empty()
}
