//! Values that are set one after the other, each checked beside those before it.

use drivers::link::Hello;
use firmware_app::scene::BOUNDS;
use firmware_app::scene::all::Parameters;
use haptic_control::SceneKind;
use terminal::failure::Failure;
use tuned::DEVICE_FINGERPRINT;

use super::{Tuning, explained};
use crate::refusal::OUT_OF_BOUNDS;

/// The values of a board's parameters, as far as they are known.
pub struct Known(Parameters);

impl Known {
    /// The values after a reset.
    #[must_use]
    pub fn usual() -> Self {
        Self(Parameters::default())
    }

    /// The values of a scene of a board that may have been tuned before: the smallest ones, beside which no
    /// other value is refused that the board takes.
    pub(crate) fn least(scene: SceneKind) -> Self {
        let mut known = Self::usual();
        for (number, parameter) in (0..).zip(scene.facts().parameters) {
            let range = parameter.quantity.range(&BOUNDS);
            let least = 0.0_f32.clamp(*range.start(), *range.end());
            // What the scene refuses stays as after a reset.
            let _ = known.0.set(scene.number(), number, least);
        }
        known
    }

    /// Sets a value. An image for another device has other bounds, and checks values beside others itself.
    ///
    /// # Errors
    /// [`Failure::Input`] with the bounds, also those that a scene has for several parameters together.
    pub fn set(&mut self, tuning: &Tuning, hello: &Hello) -> Result<(), Failure> {
        tuning.check(hello)?;
        if hello.device != DEVICE_FINGERPRINT.0 {
            return Ok(());
        }
        let set = self
            .0
            .set(tuning.scene.number(), tuning.number, tuning.value);
        set.map(drop).map_err(|_| {
            let reason = explained(OUT_OF_BOUNDS, Some(tuning.scene));
            Failure::Input(format!("{tuning}: {reason}"))
        })
    }
}

#[cfg(test)]
mod tests {
    use super::super::tests::hello;
    use super::*;

    fn set(mut known: Known, values: &[(&str, f32)]) -> Result<(), String> {
        for (name, value) in values {
            let tuning = Tuning::new(SceneKind::Detents, name, *value).unwrap();
            let set = known.set(&tuning, &hello(&[]));
            set.map_err(|error| error.to_string())?;
        }
        Ok(())
    }

    #[test]
    fn product_of_amplitude_and_number_is_bounded() {
        let said = |tuning: &str| {
            let end =
                "the value is out of bounds; amplitude times per-turn is at most 0.35 N·m/rad";
            Err(format!("{tuning}: {end}"))
        };
        let (strong, many) = (("amplitude", 0.04), ("per-turn", 1000.0));
        // 24 detents of 0.008 N·m.
        let usual = Known::usual;
        assert_eq!(set(usual(), &[strong]), said("detents amplitude 0.04 N·m"));
        assert_eq!(set(usual(), &[many]), said("detents per-turn 1000"));
        assert_eq!(set(usual(), &[("per-turn", 8.0), strong]), Ok(()));
        let least = || Known::least(SceneKind::Detents);
        assert_eq!(set(least(), &[strong]), Ok(()));
        assert_eq!(set(least(), &[many]), Ok(()));
        let both = set(least(), &[strong, many]);
        assert_eq!(both, said("detents per-turn 1000"));
        let both = set(least(), &[many, strong]);
        assert_eq!(both, said("detents amplitude 0.04 N·m"));
    }

    #[test]
    fn product_of_another_device_is_left_to_its_board() {
        let mut hello = hello(&[]);
        hello.device ^= 1;
        let strong = Tuning::new(SceneKind::Detents, "amplitude", 0.04).unwrap();
        assert_eq!(Known::usual().set(&strong, &hello), Ok(()));
    }

    #[test]
    fn every_parameter_has_a_least_value_that_its_scene_takes() {
        for scene in SceneKind::ALL {
            let mut parameters = Parameters::default();
            for (number, parameter) in (0..).zip(scene.facts().parameters) {
                let range = parameter.quantity.range(&BOUNDS);
                let least = 0.0_f32.clamp(*range.start(), *range.end());
                let set = parameters.set(scene.number(), number, least);
                assert!(set.is_ok(), "{scene} {}", parameter.name);
            }
        }
    }
}
