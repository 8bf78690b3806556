//! The two files that describe a device: the device file, which `host-sim identify` writes, and the
//! presets file, which `host-sim tune` writes.
//!
//! The simulation, the virtual board and the build of a flash image read them with the same code.

pub mod constants;
pub mod device;
pub mod presets;
mod read;

pub use read::text;

/// A number with as few digits as necessary, with an exponent instead of many zeros.
#[must_use]
pub fn decimal(x: f64) -> String {
    if x == 0.0 || (1e-4..1e10).contains(&x.abs()) {
        return format!("{x}");
    }
    format!("{x:e}")
}

#[cfg(test)]
mod tests {
    #[test]
    fn exponent_replaces_many_zeros() {
        let shown = [1e-300, 0.0, -0.5, 1e6, 1e12, f64::NAN].map(super::decimal);
        assert_eq!(shown, ["1e-300", "0", "-0.5", "1000000", "1e12", "NaN"]);
    }
}
