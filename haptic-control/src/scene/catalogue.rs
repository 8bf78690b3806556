//! The list of all scenes: every other list of scenes is made from it.

use estimator_core::Hertz;

use super::{
    Detents, Excite, FreeAir, Hold, Inertia, Off, SpringDamper, Texture, Torque, Viscous, Wall,
};
use crate::design_error::DesignError;
use crate::device::DualStage;
use crate::tuning::{Bounds, Refusal, Tunable};
use crate::units::Radians;

/// Calls the macro `$each` with all scenes, a row a scene: its number in commands, its name, the
/// feature of an image that holds no other scene, and its type.
///
/// ```
/// macro_rules! names {
///     ($($number:literal, $name:literal, $feature:literal, $scene:ident;)+) => {
///         [$($name),+]
///     };
/// }
/// assert_eq!(haptic_control::scenes!(names)[2], "wall");
/// ```
#[macro_export]
macro_rules! scenes {
    ($each:ident) => {
        $each! {
            0, "off", "scene-off", Off;
            1, "free-air", "scene-free-air", FreeAir;
            2, "wall", "scene-wall", Wall;
            3, "spring-damper", "scene-spring-damper", SpringDamper;
            4, "viscous", "scene-viscous", Viscous;
            5, "detents", "scene-detents", Detents;
            6, "texture", "scene-texture", Texture;
            7, "hold", "scene-hold", Hold;
            8, "torque", "scene-torque", Torque;
            9, "inertia", "scene-inertia", Inertia;
            10, "excite", "scene-excite", Excite;
        }
    };
}

macro_rules! any_scene {
    ($($number:literal, $name:literal, $feature:literal, $scene:ident;)+) => {
        /// Any of the scenes, with its parameters.
        #[derive(Clone, Copy, Debug, PartialEq)]
        pub enum AnyScene {
            $(
                #[doc = concat!("See [`", stringify!($scene), "`].")]
                $scene($scene),
            )+
        }

        impl AnyScene {
            /// Names of all scenes, at their numbers.
            pub const NAMES: [&'static str; [$($name),+].len()] = [$($name),+];

            /// Number of the scene in commands.
            #[must_use]
            pub const fn number(&self) -> u8 {
                match self {
                    $(Self::$scene(_) => $number,)+
                }
            }

            /// All scenes with their usual parameters, at their numbers.
            ///
            /// # Errors
            /// As the scenes' own `usual`: a device or a rate that one of them cannot do with.
            pub const fn usual(
                device: &DualStage,
                rate: Hertz,
            ) -> Result<[Self; Self::NAMES.len()], DesignError> {
                Ok([$(
                    match $scene::usual(device, rate) {
                        Ok(scene) => Self::$scene(scene),
                        Err(error) => return Err(error),
                    },
                )+])
            }

            /// Names of its parameters, in the order of their numbers.
            #[must_use]
            pub const fn parameters(&self) -> &'static [&'static str] {
                match self {
                    $(Self::$scene(_) => $scene::PARAMETERS,)+
                }
            }

            /// As [`Tunable::tuned`].
            ///
            /// # Errors
            /// [`Refusal`]: the scene stays as it was.
            pub fn tuned(
                &self,
                parameter: u8,
                value: f32,
                bounds: &Bounds,
            ) -> Result<Self, Refusal> {
                Ok(match self {
                    $(Self::$scene(scene) => {
                        Self::$scene(scene.tuned(parameter, value, bounds)?)
                    })+
                })
            }
        }
    };
}
scenes!(any_scene);

/// The usual parameters of a scene.
macro_rules! usual {
    ($($scene:ident: |$device:ident, $rate:ident| $usual:expr;)+) => {
        $(
            impl $scene {
                /// The scene with its usual parameters, for a device at a control rate.
                ///
                /// # Errors
                /// [`DesignError`], where the scene depends on a device or a rate that it cannot
                /// do with.
                pub const fn usual($device: &DualStage, $rate: Hertz) -> Result<Self, DesignError> {
                    $usual
                }
            }
        )+
    };
}

usual! {
    Off: |_device, _rate| Ok(Self);
    FreeAir: |_device, _rate| Ok(Self);
    Wall: |_device, _rate| Self::new(Radians(0.1), 0.30, 0.0);
    SpringDamper: |_device, _rate| Self::new(Radians(0.0), 0.10, 0.5e-3);
    Viscous: |_device, _rate| Self::new(2e-3);
    Detents: |_device, _rate| Self::new(8e-3, 24);
    Texture: |_device, rate| Self::new(6e-3, Hertz(150.0), rate);
    Hold: |_device, _rate| Self::new(0.20, 1e-3);
    Torque: |_device, _rate| Self::new(0.0);
    Inertia: |device, _rate| {
        let own = device.small.inertia as f32;
        Self::new(-0.4 * own, own)
    };
    Excite: |device, rate| Self::new(device, rate);
}
