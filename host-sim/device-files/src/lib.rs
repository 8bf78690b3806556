//! The two files that describe a device: the device file, which `host-sim identify` writes, and the
//! presets file, which `host-sim tune` writes.
//!
//! The simulation, the virtual board and the build of a flash image read them with the same code.

pub mod constants;
pub mod device;
pub mod presets;
mod read;

pub use read::{text, utf8};

/// A number with as few digits as necessary, with an exponent instead of many zeros.
#[must_use]
pub fn decimal(x: f64) -> String {
    if x == 0.0 || (1e-4..1e10).contains(&x.abs()) {
        return format!("{x}");
    }
    format!("{x:e}")
}

/// `value` with six significant digits, for a number that is not measured.
#[must_use]
pub fn digits(value: f64) -> f64 {
    format!("{value:.5e}").parse().unwrap_or(value)
}

#[cfg(test)]
mod tests {
    #[test]
    fn exponent_replaces_many_zeros() {
        let shown = [1e-300, 0.0, -0.5, 1e6, 1e12, f64::NAN].map(super::decimal);
        assert_eq!(shown, ["1e-300", "0", "-0.5", "1000000", "1e12", "NaN"]);
    }

    #[test]
    fn residue_of_a_computation_is_not_shown() {
        let shown = [5.99889999999868, 2.0 / 11_600.0, 2000.0, f64::INFINITY].map(super::digits);
        assert_eq!(shown, [5.9989, 0.000172414, 2000.0, f64::INFINITY]);
    }
}
