//! Devices at the limits of the tolerances.

use super::variation::{
    AMPLIFIER, CONSTANT, DAMPING, DISC, FRICTION, GONE_RAD_S, HAND, INERTIA, NOMINAL, Variation,
    ZERO,
};

/// Names and devices: one value at a limit at a time, then the worst combinations.
///
/// *agile* has the largest acceleration per current, *sluggish* the smallest, *thin* the weakest
/// coupler.
#[must_use]
pub fn corners() -> Vec<(&'static str, Variation)> {
    let with = |mut base: Variation, change: fn(&mut Variation)| {
        change(&mut base);
        base
    };
    let n = NOMINAL;
    let disc = with(n, |v| {
        (v.disc_phase, v.disc_line, v.disc_random) = DISC;
    });
    let agile = with(disc, |v| {
        (v.large_inertia, v.small_inertia) = (INERTIA.0, INERTIA.0);
        (v.large_constant, v.small_constant) = (CONSTANT.1, CONSTANT.1);
        (v.large_friction, v.small_friction) = (FRICTION.0, FRICTION.0);
        (v.amplifier, v.late_ticks) = (AMPLIFIER.0, 1);
    });
    let sluggish = with(agile, |v| {
        (v.large_inertia, v.small_inertia) = (INERTIA.1, INERTIA.1);
        (v.large_constant, v.small_constant) = (CONSTANT.0, CONSTANT.0);
        (v.large_friction, v.small_friction) = (FRICTION.1, FRICTION.1);
    });
    let thin = |base| with(base, |v| v.damping = DAMPING.0);
    let stiff = |base| with(base, |v| v.hand = HAND.1);
    let gone = |base| with(base, |v| v.gone_rad_s = Some(GONE_RAD_S.1));
    vec![
        ("nominal", n),
        ("damping-low", thin(n)),
        (
            "large-inertia-low",
            with(n, |v| v.large_inertia = INERTIA.0),
        ),
        (
            "large-inertia-high",
            with(n, |v| v.large_inertia = INERTIA.1),
        ),
        (
            "small-inertia-low",
            with(n, |v| v.small_inertia = INERTIA.0),
        ),
        (
            "small-inertia-high",
            with(n, |v| v.small_inertia = INERTIA.1),
        ),
        (
            "large-constant-low",
            with(n, |v| v.large_constant = CONSTANT.0),
        ),
        (
            "large-constant-high",
            with(n, |v| v.large_constant = CONSTANT.1),
        ),
        (
            "small-constant-low",
            with(n, |v| v.small_constant = CONSTANT.0),
        ),
        (
            "small-constant-high",
            with(n, |v| v.small_constant = CONSTANT.1),
        ),
        (
            "large-friction-low",
            with(n, |v| v.large_friction = FRICTION.0),
        ),
        (
            "large-friction-high",
            with(n, |v| v.large_friction = FRICTION.1),
        ),
        (
            "small-friction-low",
            with(n, |v| v.small_friction = FRICTION.0),
        ),
        (
            "small-friction-high",
            with(n, |v| v.small_friction = FRICTION.1),
        ),
        ("amplifier-slow", with(n, |v| v.amplifier = AMPLIFIER.0)),
        ("tick-late", with(n, |v| v.late_ticks = 1)),
        (
            "zeros-high",
            with(n, |v| (v.large_zero, v.small_zero) = (ZERO.1, ZERO.1)),
        ),
        (
            "zeros-opposite",
            with(n, |v| (v.large_zero, v.small_zero) = (ZERO.1, ZERO.0)),
        ),
        ("hand-stiff", stiff(n)),
        ("hand-gone", gone(n)),
        ("disc", disc),
        ("agile", agile),
        ("agile-stiff", stiff(agile)),
        ("agile-gone", gone(agile)),
        ("agile-thin", thin(agile)),
        ("agile-thin-gone", gone(thin(agile))),
        ("sluggish", sluggish),
        ("sluggish-thin-stiff", stiff(thin(sluggish))),
        ("sluggish-thin-gone", gone(thin(sluggish))),
    ]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::robust::variation::Subject;
    use simulation::device::Device;

    /// The device that a name says: one value at a limit of its range.
    #[test]
    fn corner_of_one_value_has_it_at_its_limit() {
        type Value = fn(&mut Variation) -> &mut f64;
        let ranges: [(&str, Value, f64, f64); 6] = [
            ("large-inertia", |v| &mut v.large_inertia, 0.7, 1.3),
            ("small-inertia", |v| &mut v.small_inertia, 0.7, 1.3),
            ("large-constant", |v| &mut v.large_constant, 0.8, 1.2),
            ("small-constant", |v| &mut v.small_constant, 0.8, 1.2),
            ("large-friction", |v| &mut v.large_friction, 0.6, 1.5),
            ("small-friction", |v| &mut v.small_friction, 0.6, 1.5),
        ];
        let both = ranges.iter().flat_map(|&(name, value, low, high)| {
            [
                (format!("{name}-low"), value, low),
                (format!("{name}-high"), value, high),
            ]
        });
        let one: [(&str, Value, f64); 3] = [
            ("damping-low", |v| &mut v.damping, 0.6),
            ("amplifier-slow", |v| &mut v.amplifier, 0.5),
            ("hand-stiff", |v| &mut v.hand, 4.0),
        ];
        let one = one.map(|(name, value, limit)| (name.to_owned(), value, limit));
        for (name, value, limit) in both.chain(one) {
            let mut expected = NOMINAL;
            *value(&mut expected) = limit;
            assert_eq!(named(&name), expected, "{name}");
        }
        assert_eq!(named("hand-gone").gone_rad_s, Some(3.0));
        assert_eq!(named("tick-late").late_ticks, 1);
        let disc = named("disc");
        assert_eq!(
            (disc.disc_phase, disc.disc_line, disc.disc_random),
            (0.06, 0.25, 0.02)
        );
    }

    /// The largest and the smallest acceleration per current, of both motors.
    #[test]
    fn worst_combinations_have_the_ratios_of_their_names() {
        let ratios = |v: &Variation| {
            [
                v.large_constant / v.large_inertia,
                v.small_constant / v.small_inertia,
            ]
        };
        let frictions = |v: &Variation| [v.large_friction, v.small_friction];
        for (name, ratio, friction) in [("agile", 1.2 / 0.7, 0.6), ("sluggish", 0.8 / 1.3, 1.5)] {
            let of_name = corners()
                .into_iter()
                .filter(|(known, _)| known.starts_with(name));
            for (known, corner) in of_name {
                assert_eq!(ratios(&corner), [ratio; 2], "{known}");
                assert_eq!(frictions(&corner), [friction; 2], "{known}");
                assert_eq!((corner.amplifier, corner.late_ticks), (0.5, 1), "{known}");
                let has = |part| known.contains(part);
                assert_eq!(
                    corner.damping,
                    if has("thin") { 0.6 } else { 1.0 },
                    "{known}"
                );
                assert_eq!(corner.hand, if has("stiff") { 4.0 } else { 1.0 }, "{known}");
                assert_eq!(corner.gone_rad_s.is_some(), has("gone"), "{known}");
            }
        }
    }

    fn named(name: &str) -> Variation {
        let found = corners().into_iter().find(|(known, _)| *known == name);
        found.unwrap_or_else(|| panic!("no {name}")).1
    }

    #[test]
    fn corners_reach_every_limit_and_are_valid_devices() {
        let corners = corners();
        assert_eq!(corners[0], ("nominal", NOMINAL));
        for (i, (name, variation)) in corners.iter().enumerate() {
            assert_eq!(name.parse(), Ok(Subject::Corner(i)));
            assert_eq!(Subject::Corner(i).to_string(), *name);
            variation.of(&Device::default()).validate().unwrap();
        }
        assert!("42".parse() == Ok(Subject::Drawn(42)));
        assert!("corner".parse::<Subject>().is_err());
        assert!(corners.iter().any(|(_, v)| v.damping == 0.6));
        assert!(corners.iter().any(|(_, v)| v.hand == 4.0));
        // 15 steps of 6 A / 2047 and of 1.5 A / 2047.
        let zeros = corners
            .iter()
            .map(|(_, v)| v.offsets_a(&Device::default().stages));
        let largest = zeros.fold([0.0_f64; 2], |a, b| [a[0].max(b[0]), a[1].max(b[1])]);
        assert!((largest[0] - 0.043_97).abs() < 1e-5 && (largest[1] - 0.010_99).abs() < 1e-5);
    }
}
