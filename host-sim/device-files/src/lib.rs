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

/// `value` with `digits` significant digits, at least one.
#[must_use]
pub fn to_digits(value: f64, digits: usize) -> f64 {
    let text = format!("{value:.0$e}", digits.saturating_sub(1));
    text.parse().unwrap_or(value)
}

/// `value` with six significant digits, for a number that is not measured.
#[must_use]
pub fn six_digits(value: f64) -> f64 {
    to_digits(value, 6)
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
        let values = [5.99889999999868, 2.0 / 11_600.0, 2000.0, f64::INFINITY];
        let shown = values.map(super::six_digits);
        assert_eq!(shown, [5.9989, 0.000172414, 2000.0, f64::INFINITY]);
        // 12.345678900000001
        assert_eq!(super::six_digits(1e3 * 0.012_345_678_9), 12.3457);
    }

    #[test]
    fn digits_are_significant_ones() {
        for (value, digits, rounded) in [
            (123.456, 3, 123.0),
            (-0.001_264, 2, -0.0013),
            (9.96, 2, 10.0),
            (9.96, 0, 10.0),
            (0.0, 3, 0.0),
        ] {
            assert_eq!(super::to_digits(value, digits), rounded, "{value} {digits}");
        }
        assert!(super::to_digits(f64::NAN, 3).is_nan());
    }
}
