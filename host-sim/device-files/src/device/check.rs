//! Allowed values of a device, and the error messages of a device file.

use haptic_control::Motor;

use super::range::Range;
use super::{COUNTS_PER_REV, Device, Ripple, counts_per_rev_rule};

fn check_counts(key: &str, counts: u32) -> Result<(), String> {
    if COUNTS_PER_REV.contains(&counts) {
        return Ok(());
    }
    let rule = counts_per_rev_rule(Some(counts.into()));
    Err(format!("{key} = {counts}: must be {rule}"))
}

fn check_motor(name: &str, motor: &Motor, ripple: &Ripple) -> Result<(), String> {
    for (key, value, unit, range) in [
        (
            "inertia_kg_m2",
            motor.inertia,
            "kg.m2",
            Range::Usually(1e-9, 0.1, "g.cm2", -7),
        ),
        (
            "torque_constant_nm_per_a",
            motor.torque_constant,
            "N.m/A",
            Range::Usually(1e-5, 10.0, "mN.m/A", -3),
        ),
        (
            "coulomb_nm",
            motor.coulomb_friction,
            "N.m",
            Range::Within(0.0, 10.0),
        ),
        ("coulomb_ripple", ripple.friction, "", Range::Share),
        ("torque_ripple", ripple.torque, "", Range::Share),
        (
            "ripple_per_rev",
            ripple.per_rev,
            "periods a revolution",
            Range::Within(0.01, 1e4),
        ),
        (
            "current_limit_a",
            motor.current_limit,
            "A",
            Range::Within(1e-3, 1e3),
        ),
        (
            "continuous_current_a",
            motor.continuous_current,
            "A",
            Range::Within(1e-3, 1e3),
        ),
        (
            "winding_time_constant_s",
            motor.winding_time_constant,
            "s",
            Range::Usually(1e-3, 1e3, "ms", -3),
        ),
    ] {
        range.check(&format!("{name}.{key}"), value, unit)?;
    }
    check_counts(&format!("{name}.counts_per_rev"), motor.counts_per_rev)
}

pub(super) fn check_values(device: &Device) -> Result<(), String> {
    check_motor("large", &device.stages.large, &device.large_ripple)?;
    check_motor("small", &device.stages.small, &device.small_ripple)?;
    for (key, value, unit, range) in [
        (
            "coupler.damping_nms_per_rad",
            device.stages.damping,
            "N.m.s/rad",
            Range::Within(1e-9, 10.0),
        ),
        (
            "coupler.fall_at_60_s",
            device.fall_at_60_s,
            "",
            Range::Share,
        ),
        (
            "amplifier.bandwidth_hz",
            device.stages.amplifier_bandwidth.0,
            "Hz",
            Range::Within(1.0, 1e6),
        ),
        (
            "hand.stiffness_nm_per_rad",
            device.hand.stiffness_nm_per_rad,
            "N.m/rad",
            Range::Within(0.0, 1e6),
        ),
        (
            "hand.damping_nms_per_rad",
            device.hand.damping_nms_per_rad,
            "N.m.s/rad",
            Range::Within(0.0, 1e3),
        ),
        (
            "handle.diameter_m",
            device.handle.diameter_m,
            "m",
            Range::Usually(1e-3, 1.0, "mm", -3),
        ),
        (
            "interval.threshold_n",
            device.interval.threshold_n,
            "N",
            Range::Within(0.0, 1e3),
        ),
        ("interval.weber", device.interval.weber, "", Range::Share),
        (
            "disc.phase_counts",
            device.disc.phase_counts,
            "counts",
            Range::Within(0.0, 1.0),
        ),
        (
            "disc.line_counts",
            device.disc.line_counts,
            "counts",
            Range::Within(0.0, 1.0),
        ),
        (
            "disc.random_counts",
            device.disc.random_counts,
            "counts",
            Range::Within(0.0, 1.0),
        ),
    ] {
        range.check(key, value, unit)?;
    }
    let disc = device.disc.phase_counts + device.disc.line_counts + device.disc.random_counts;
    if disc >= 0.45 {
        return Err(format!(
            "disc: phase_counts + line_counts + random_counts = {disc}: must be below 0.45 counts"
        ));
    }
    check_counts("reference.counts_per_rev", device.reference.counts_per_rev)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn refused(text: &str) -> String {
        let error = Device::from_toml_str(text).expect_err(text);
        assert!(!error.contains('\n'), "one line: {error}");
        error
    }

    #[test]
    fn device_is_unchanged_after_writing_and_reading() {
        let mut device = Device::default();
        device.stages.small.inertia = 61.25e-7;
        device.disc.phase_counts = 0.1;
        device.reference.counts_per_rev = 8000;
        let text = toml::to_string(&device).unwrap();
        assert_eq!(Device::from_toml_str(&text).unwrap(), device);
    }

    #[test]
    fn missing_keys_keep_the_default_of_their_motor() {
        assert_eq!(Device::from_toml_str("").unwrap(), Device::default());
        let device = Device::from_toml_str("[small]\ncoulomb_nm = 1").unwrap();
        let mut expected = Device::default();
        expected.stages.small.coulomb_friction = 1.0;
        assert_eq!(device, expected);
    }

    #[test]
    fn unknown_key_is_reported_with_its_line_and_the_known_keys() {
        let error = refused("[[larg]]\ninertia_kg_m2 = 1e-5");
        assert!(error.contains("unknown field `larg`"), "{error}");
        let error = refused("[large]\n\ninertia = 1e-5\n");
        assert!(error.starts_with("line 3, inertia: "), "{error}");
        assert!(error.contains("inertia_kg_m2"), "{error}");
        let error = refused("[coupler]\nb = 1");
        assert!(error.starts_with("line 2, b: "), "{error}");
        let error = refused("[laarge]\ncoulomb_nm = 1e-5\n");
        assert!(error.starts_with("line 1, [laarge]: "), "{error}");
    }

    #[test]
    fn wrong_type_is_reported_with_its_line() {
        let error = refused("[hand]\nstiffness_nm_per_rad = 'firm'");
        assert!(
            error.starts_with("line 2, stiffness_nm_per_rad: "),
            "{error}"
        );
        assert!(error.ends_with("expected a number"), "{error}");
        let error = refused("[large]\ncoulomb_nm = 0,004");
        assert!(error.starts_with("line 2, coulomb_nm: "), "{error}");
        let error = refused("[large]\ncounts_per_rev = -4");
        assert!(error.starts_with("line 2, counts_per_rev: "), "{error}");
    }

    #[test]
    fn impossible_values_are_refused_by_name() {
        for (text, expected) in [
            (
                "large.inertia_kg_m2 = -1",
                "large.inertia_kg_m2 = -1: must be above 0 kg.m2",
            ),
            (
                "large.counts_per_rev = 0",
                "large.counts_per_rev = 0: must be from 16 to 4000000 counts per revolution; a line of a \
                 quadrature encoder is four counts",
            ),
            (
                "small.counts_per_rev = 15",
                "small.counts_per_rev = 15: must be from 16 to 4000000 counts per revolution; a line of a \
                 quadrature encoder is four counts",
            ),
            (
                "reference.counts_per_rev = 4000001",
                "reference.counts_per_rev = 4000001: must be from 16 to 4000000 counts per revolution; of a finer \
                 encoder, divide the counts and this number by a power of two",
            ),
            (
                "coupler.damping_nms_per_rad = nan",
                "coupler.damping_nms_per_rad = NaN: must be a finite number",
            ),
            (
                "hand.stiffness_nm_per_rad = inf",
                "hand.stiffness_nm_per_rad = inf: must be a finite number",
            ),
            (
                "large.inertia_kg_m2 = 115",
                "large.inertia_kg_m2 = 115: must be at most 0.1 kg.m2; did you mean 115e-7, which is \
                 115 g.cm2?",
            ),
            (
                "small.torque_constant_nm_per_a = 27.5",
                "small.torque_constant_nm_per_a = 27.5: must be at most 10 N.m/A; did you mean 27.5e-3, \
                 which is 27.5 mN.m/A?",
            ),
            (
                "handle.diameter_m = 70",
                "handle.diameter_m = 70: must be at most 1 m; did you mean 70e-3, which is 70 mm?",
            ),
            (
                "small.current_limit_a = 0",
                "small.current_limit_a = 0: must be above 0 A",
            ),
            (
                "large.continuous_current_a = -1",
                "large.continuous_current_a = -1: must be above 0 A",
            ),
            (
                "small.winding_time_constant_s = 14000",
                "small.winding_time_constant_s = 14000: must be at most 1000 s; did you mean 14000e-3, \
                 which is 14000 ms?",
            ),
            (
                "large.coulomb_ripple = 1.0",
                "large.coulomb_ripple = 1: must be at least 0 and below 1",
            ),
            (
                "small.coulomb_nm = -1e-3",
                "small.coulomb_nm = -0.001: must be 0 N.m or more",
            ),
            (
                "disc = { phase_counts = 0.25, random_counts = 0.25 }",
                "disc: phase_counts + line_counts + random_counts = 0.5: must be below 0.45 counts",
            ),
        ] {
            assert_eq!(refused(text), format!("line 1, {expected}"));
        }
    }

    #[test]
    fn value_out_of_range_is_reported_with_its_line() {
        for text in [
            "\n# a comment\n[large]\ncounts_per_rev = 4096\ninertia_kg_m2 = -1\n",
            "[small]\n\n[large]\n\n inertia_kg_m2\t= -1",
            "\n\n\n\nlarge = { torque_ripple = 0.1, inertia_kg_m2 = -1 }",
            "\n\n\n\nlarge.inertia_kg_m2 = -1\n",
        ] {
            let error = refused(text);
            assert_eq!(
                error, "line 5, large.inertia_kg_m2 = -1: must be above 0 kg.m2",
                "{text}"
            );
        }
    }

    /// Values with which simulations hang or designs fail, or which give
    /// results that are no numbers.
    #[test]
    fn finite_values_that_no_device_has_are_refused_by_name() {
        for (text, rule) in [
            ("large.current_limit_a = 1e20", "at most 1000 A"),
            ("small.current_limit_a = 1e300", "at most 1000 A"),
            ("small.coulomb_nm = 1e20", "at most 10 N.m"),
            ("large.coulomb_nm = 1e300", "at most 10 N.m"),
            (
                "small.ripple_per_rev = 1e300",
                "at most 10000 periods a revolution",
            ),
            (
                "large.torque_constant_nm_per_a = 1e-300",
                "at least 1e-5 N.m/A",
            ),
            ("large.inertia_kg_m2 = 1e-300", "at least 1e-9 kg.m2"),
            ("large.continuous_current_a = 1e-300", "at least 0.001 A"),
            ("small.winding_time_constant_s = 1e-300", "at least 0.001 s"),
            (
                "coupler.damping_nms_per_rad = 1e-20",
                "at least 1e-9 N.m.s/rad",
            ),
            ("amplifier.bandwidth_hz = 1e20", "at most 1000000 Hz"),
            ("amplifier.bandwidth_hz = 1e-20", "at least 1 Hz"),
            ("handle.diameter_m = 1e-300", "at least 0.001 m"),
            ("interval.threshold_n = 1e300", "at most 1000 N"),
        ] {
            assert_eq!(refused(text), format!("line 1, {text}: must be {rule}"));
        }
    }

    #[test]
    fn errors_of_a_disc_add_up() {
        let mut device = Device::default();
        device.disc.phase_counts = 0.2;
        device.disc.line_counts = 0.1;
        device.disc.random_counts = 0.14;
        assert_eq!(check_values(&device), Ok(()));
        device.disc.random_counts = 0.16;
        let error = check_values(&device).unwrap_err();
        assert!(error.contains("must be below 0.45 counts"), "{error}");
    }

    #[test]
    fn frictionless_removes_only_the_coulomb_friction_of_both_motors() {
        let device = Device::default();
        let mut expected = device.clone();
        expected.stages.large.coulomb_friction = 0.0;
        expected.stages.small.coulomb_friction = 0.0;
        expected.large_ripple.friction = 0.0;
        expected.small_ripple.friction = 0.0;
        assert_eq!(device.frictionless(), expected);
        assert_ne!(expected, device);
    }

    #[test]
    fn counts_are_stated_by_the_key_of_the_large_motor() {
        for (text, states) in [
            ("[large]\ncounts_per_rev = 4096", true),
            ("large.counts_per_rev = 4096", true),
            ("[large]\ncoulomb_nm = 0", false),
            ("[small]\ncounts_per_rev = 4096", false),
            ("", false),
        ] {
            assert_eq!(Device::states_counts(text), states, "{text}");
        }
    }
}
