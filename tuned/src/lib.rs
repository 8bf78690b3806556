//! The tuned parameters of host-sim/presets.toml for the plant with friction, as constants: images
//! take what `host-sim tune` wrote and carry no copy.
//!
//! ```
//! use estimator_core::Hertz;
//!
//! const JERK: f64 = tuned::value("kalman-triple", Hertz(10_000.0), "jerk");
//! assert!(JERK > 0.0);
//! ```
#![no_std]

use estimator_core::{Hertz, Uncertainty};

/// Rate in Hz, estimator, parameter, value.
type Row = (f64, &'static str, &'static str, f64);

static TABLE: &[Row] = include!(concat!(env!("OUT_DIR"), "/table.rs"));

/// The value of an estimator's parameter, tuned at the rate nearest to `rate` by ratio, as host-sim
/// takes it; `None` if the file has no such parameter.
#[must_use]
pub const fn find(estimator: &str, rate: Hertz, parameter: &str) -> Option<f64> {
    let (mut value, mut nearest) = (None, f64::INFINITY);
    let mut rows = TABLE;
    while let [(at, of, name, tuned), rest @ ..] = rows {
        rows = rest;
        let ratio = if *at < rate.0 {
            rate.0 / *at
        } else {
            *at / rate.0
        };
        if same(of, estimator) && same(name, parameter) && ratio < nearest {
            (value, nearest) = (Some(*tuned), ratio);
        }
    }
    value
}

/// The value that [`find`] finds.
///
/// # Panics
/// If the file has no such parameter: in a constant, the build stops.
#[must_use]
pub const fn value(estimator: &str, rate: Hertz, parameter: &str) -> f64 {
    find(estimator, rate, parameter).expect("a parameter in host-sim/presets.toml")
}

/// The uncertainty that an observer is tuned to.
///
/// # Panics
/// As [`value`].
#[must_use]
pub const fn uncertainty(observer: &str, rate: Hertz) -> Uncertainty {
    Uncertainty {
        torque_noise: value(observer, rate, "torque_noise"),
        load: value(observer, rate, "load"),
        load_time: value(observer, rate, "load_time"),
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
