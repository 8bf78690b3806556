//! A varied device that is no device: what is left of its deviations.

use super::{NOMINAL, Variation};
use device_files::six_digits;
use simulation::device::Device;

/// A number of a [`Variation`].
type Field = fn(&mut Variation) -> &mut f64;

/// The numbers that make a device, with their names in the rows. The inertias come after the dampings and the
/// hand, which decide how small they may be.
const FIELDS: [(&str, Field); 12] = [
    ("damping", |v| &mut v.damping),
    ("hand", |v| &mut v.hand),
    ("large_inertia", |v| &mut v.large_inertia),
    ("small_inertia", |v| &mut v.small_inertia),
    ("large_constant", |v| &mut v.large_constant),
    ("small_constant", |v| &mut v.small_constant),
    ("large_friction", |v| &mut v.large_friction),
    ("small_friction", |v| &mut v.small_friction),
    ("amplifier", |v| &mut v.amplifier),
    ("disc_phase", |v| &mut v.disc_phase),
    ("disc_line", |v| &mut v.disc_line),
    ("disc_random", |v| &mut v.disc_random),
];

/// Parts of a deviation: what [`Variation::within`] leaves of it is a whole number of them.
const PARTS: u32 = 1024;

impl Variation {
    /// The deviation of a device within the limits of [`Device::validate`]. Of a deviation that passes them,
    /// as much is left as they allow; one that does not is unchanged.
    #[must_use]
    pub fn within(self, nominal: &Device) -> Self {
        let is_valid = |variation: &Self| variation.of(nominal).validate().is_ok();
        if is_valid(&self) {
            return self;
        }
        let (mut whole, mut none) = (self, NOMINAL);
        let mut limited = self;
        for (_, field) in FIELDS {
            *field(&mut limited) = *field(&mut none);
        }
        let mut take = |field: Field, parts: u32| {
            let from = *field(&mut none);
            let mut next = limited;
            *field(&mut next) =
                from + (*field(&mut whole) - from) * f64::from(parts) / f64::from(PARTS);
            let is_valid = is_valid(&next);
            if is_valid {
                limited = next;
            }
            is_valid
        };
        let left = FIELDS.map(|(_, field)| (field, take(field, PARTS)));
        for (field, _) in left.into_iter().filter(|(_, is_whole)| !is_whole) {
            if take(field, PARTS) {
                continue;
            }
            let (mut most, mut too_many) = (0, PARTS);
            while too_many - most > 1 {
                let parts = most.midpoint(too_many);
                if take(field, parts) {
                    most = parts;
                } else {
                    too_many = parts;
                }
            }
        }
        limited
    }

    /// The numbers in which `limited` differs, for example `disc_random 0.0199805 in place of 0.02`.
    #[must_use]
    pub fn changes(mut self, mut limited: Self) -> String {
        let changed = FIELDS.into_iter().filter_map(|(name, field)| {
            let (whole, left) = (*field(&mut self), *field(&mut limited));
            (whole != left).then(|| {
                format!(
                    "{name} {} in place of {}",
                    six_digits(left),
                    six_digits(whole)
                )
            })
        });
        changed.collect::<Vec<_>>().join(", ")
    }
}

#[cfg(test)]
mod tests {
    use super::super::Subject;
    use super::*;
    use crate::robust::corners::corners;

    #[test]
    fn deviation_is_limited_to_what_a_device_can_be() {
        let device = |text: &str| Device::from_toml_str(text).unwrap();
        let default = Device::default();
        let all = || corners().into_iter().map(|(_, variation)| variation);
        for variation in all() {
            assert_eq!(variation.within(&default), variation);
        }
        for text in [
            "disc.phase_counts = 0.12",
            "disc.phase_counts = 0.44",
            "small.inertia_kg_m2 = 1.67e-6",
            "hand.damping_nms_per_rad = 0.009",
            "hand.stiffness_nm_per_rad = 200\nhand.damping_nms_per_rad = 0.02",
            "large.inertia_kg_m2 = 1e-9\ncoupler.damping_nms_per_rad = 1e-5",
            "large.inertia_kg_m2 = 0.09",
            "small.torque_constant_nm_per_a = 10",
            "amplifier.bandwidth_hz = 1.5",
            "large.coulomb_nm = 9",
        ] {
            let nominal = device(text);
            for variation in all() {
                let limited = variation.within(&nominal);
                assert_eq!(limited.of(&nominal).validate(), Ok(()), "{text}");
                assert_eq!(limited.within(&nominal), limited, "{text}");
            }
        }
        // 0.12 and the 0.31 of phase and line leave just less than 0.02 below 0.45.
        let limited = corner("disc").within(&device("disc.phase_counts = 0.12"));
        assert_eq!((limited.disc_phase, limited.disc_line), (0.06, 0.25));
        let part = 0.02 / 1024.0;
        assert!(limited.disc_random < 0.02 && limited.disc_random > 0.02 - 1.5 * part);
        // (b + 4 * 9 mN.m.s/rad) / J reaches the rate of 1e4 of the longest step.
        let nominal = device("hand.damping_nms_per_rad = 0.009");
        let limited = corner("agile-stiff").within(&nominal);
        assert_eq!(limited.hand, 4.0);
        let smallest = (nominal.stages.damping + 0.036) / 1e4 / nominal.stages.small.inertia;
        let above = limited.small_inertia - smallest;
        assert!((0.0..0.3 / 1024.0).contains(&above), "{limited:?}");
        assert_eq!(
            corner("agile-stiff").changes(limited),
            format!(
                "small_inertia {} in place of 0.7",
                six_digits(limited.small_inertia)
            )
        );
    }

    fn corner(name: &str) -> Variation {
        let Ok(Subject::Corner(i)) = name.parse() else {
            panic!("{name}");
        };
        corners()[i].1
    }
}
