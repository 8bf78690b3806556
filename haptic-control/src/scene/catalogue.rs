//! Types made from the catalogue of scenes.

use estimator_core::Hertz;

use super::*;
use crate::design_error::DesignError;
use crate::device::DualStage;
use crate::need::Need;
use crate::scenes;
use crate::tick::HandleNeed;
use crate::tuning::{Bounds, Parameter, Refusal, Tunable};
use crate::units::{NewtonMetres, Radians};

/// Purpose of a scene.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Role {
    /// Renders a virtual environment. Comparisons and robustness runs try every environment.
    Environment,
    /// Renders a torque that commands set.
    SetPoint,
    /// Commands currents open loop, to identify the device.
    Excitation,
}

/// The simulated hand that tries a scene.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SimulatedHand {
    /// Moves the handle to and fro.
    FreeMotion,
    /// Moves the handle into the angle of the wall and back.
    WallPress,
    /// Holds the handle at one angle, apart from tremor.
    HoldStill,
}

/// Parts of the controller that a scene needs, as its types say.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Needs {
    /// The scene reads the handle's velocity.
    pub velocity: bool,
    /// The scene reads the handle's acceleration.
    pub acceleration: bool,
    /// The large motor renders the scene's torque.
    pub continuous: bool,
    /// The small motor renders the scene's torque.
    pub transient: bool,
    /// The handle moves freely: the scene has no spring, and the controller compensates more.
    pub free: bool,
    /// The handle's velocity is estimated: for the scene, for the slip of the coupler, or because
    /// the scene reads the acceleration.
    pub handle_estimator: bool,
}

impl Needs {
    const fn of<S: Scene>() -> Self {
        Self {
            velocity: S::Velocity::WANTED,
            acceleration: S::Acceleration::WANTED,
            continuous: S::Continuous::WANTED,
            transient: S::Transient::WANTED,
            free: S::FREE,
            handle_estimator: HandleNeed::<S>::WANTED,
        }
    }
}

/// A row of the catalogue of scenes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SceneFacts {
    /// Number in commands and telemetry.
    pub number: u8,
    /// Name on the command line and in tables.
    pub name: &'static str,
    /// Description of the scene, in one line.
    pub summary: &'static str,
    /// The torque on the handle, as a formula.
    pub torque: &'static str,
    /// Purpose of the scene.
    pub role: Role,
    /// The simulated hand that tries the scene.
    pub hand: SimulatedHand,
    /// Parts of the controller that the scene needs.
    pub needs: Needs,
    /// Parameters, in the order of their numbers.
    pub parameters: &'static [Parameter],
}

macro_rules! scene_types {
    ($(
        $number:literal, $name:literal, $scene:ident, {
            summary: $summary:literal,
            torque: $torque:literal,
            role: $role:ident,
            hand: $hand:ident,
            usual: |$device:ident, $rate:ident| $usual:expr
        };
    )+) => {
        /// The kind of a scene: an entry of the catalogue, without values of parameters.
        ///
        /// ```
        /// use haptic_control::SceneKind;
        /// let wall = SceneKind::named("wall").unwrap();
        /// assert_eq!((wall, wall.number()), (SceneKind::Wall, 2));
        /// assert!(wall.facts().needs.velocity);
        /// ```
        #[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
        #[repr(u8)]
        pub enum SceneKind {
            $(
                #[doc = concat!("See [`", stringify!($scene), "`](crate::", stringify!($scene), ").")]
                $scene = $number,
            )+
        }

        impl SceneKind {
            /// All scenes, each at its number.
            pub const ALL: [Self; [$($name),+].len()] = [$(Self::$scene),+];

            /// The scene's row of the catalogue.
            #[must_use]
            pub const fn facts(self) -> &'static SceneFacts {
                match self {
                    $(Self::$scene => {
                        const FACTS: SceneFacts = SceneFacts {
                            number: $number,
                            name: $name,
                            summary: $summary,
                            torque: $torque,
                            role: Role::$role,
                            hand: SimulatedHand::$hand,
                            needs: Needs::of::<$scene>(),
                            parameters: $scene::PARAMETERS,
                        };
                        &FACTS
                    })+
                }
            }

            /// The scene with its usual parameters, for a device at a control rate.
            ///
            /// # Errors
            /// [`DesignError`] if the scene cannot be rendered by this device or at this rate.
            pub const fn usual(
                self,
                device: &DualStage,
                rate: Hertz,
            ) -> Result<AnyScene, DesignError> {
                Ok(match self {
                    $(Self::$scene => match $scene::usual(device, rate) {
                        Ok(scene) => AnyScene::$scene(scene),
                        Err(error) => return Err(error),
                    },)+
                })
            }
        }

        /// A scene of the catalogue, with values of its parameters.
        #[derive(Clone, Copy, Debug, PartialEq)]
        pub enum AnyScene {
            $(
                #[doc = concat!("See [`", stringify!($scene), "`](crate::", stringify!($scene), ").")]
                $scene($scene),
            )+
        }

        impl AnyScene {
            /// The scene without its parameters.
            #[must_use]
            pub const fn kind(&self) -> SceneKind {
                match self {
                    $(Self::$scene(_) => SceneKind::$scene,)+
                }
            }

            /// The value of a parameter, see [`Tunable::value`].
            #[must_use]
            pub fn value(&self, parameter: u8, rate: Hertz) -> Option<f32> {
                match self {
                    $(Self::$scene(scene) => scene.value(parameter, rate),)+
                }
            }

            /// The scene with one parameter changed, see [`Tunable::tuned`].
            ///
            /// # Errors
            /// [`Refusal`]: the scene stays as it was.
            pub fn tuned(
                &self,
                parameter: u8,
                value: f32,
                bounds: &Bounds,
            ) -> Result<Self, Refusal> {
                let quantity = match self {
                    $(Self::$scene(_) => $scene::quantity(parameter),)+
                };
                quantity.ok_or(Refusal::Unknown)?.admits(value, bounds)?;
                let tuned = match self {
                    $(Self::$scene(scene) => {
                        scene.with(parameter, value, bounds).map(Self::$scene)
                    })+
                };
                tuned.ok_or(Refusal::OutOfBounds)
            }

            /// Amplitude of the scene's own vibration, see [`Scene::vibration`].
            #[must_use]
            pub fn vibration(&self) -> NewtonMetres {
                match self {
                    $(Self::$scene(scene) => scene.vibration(),)+
                }
            }
        }

        $(
            impl From<$scene> for AnyScene {
                fn from(scene: $scene) -> Self {
                    Self::$scene(scene)
                }
            }

            impl $scene {
                /// The scene with its usual parameters, for a device at a control rate.
                ///
                /// # Errors
                /// [`DesignError`] if the scene cannot be rendered by this device or at this rate.
                pub const fn usual($device: &DualStage, $rate: Hertz) -> Result<Self, DesignError> {
                    $usual
                }
            }
        )+
    };
}
scenes!(scene_types);

impl SceneKind {
    /// Number of the scene in commands and telemetry.
    #[must_use]
    pub const fn number(self) -> u8 {
        self as u8
    }

    /// Name of the scene.
    #[must_use]
    pub const fn name(self) -> &'static str {
        self.facts().name
    }

    /// Whether the scene's currents follow the encoders: with an encoder or a current of the wrong sign
    /// the feedback is positive.
    #[must_use]
    pub const fn is_closed_loop(self) -> bool {
        let needs = self.facts().needs;
        needs.continuous || needs.transient
    }

    /// The virtual environments, in the order of their numbers.
    pub fn environments() -> impl Iterator<Item = Self> + Clone {
        Self::ALL
            .into_iter()
            .filter(|kind| kind.facts().role == Role::Environment)
    }

    /// The scene of this name.
    #[must_use]
    pub fn named(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|kind| kind.name() == name)
    }

    /// Number of the scene's parameter of this name.
    #[must_use]
    pub fn parameter(self, name: &str) -> Option<u8> {
        let parameters = self.facts().parameters;
        let number = parameters.iter().position(|known| known.name == name)?;
        u8::try_from(number).ok()
    }
}

impl core::fmt::Display for SceneKind {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.pad(self.name())
    }
}

impl AnyScene {
    /// All scenes with their usual parameters, each at its number.
    ///
    /// # Errors
    /// As [`SceneKind::usual`].
    pub const fn usual(
        device: &DualStage,
        rate: Hertz,
    ) -> Result<[Self; SceneKind::ALL.len()], DesignError> {
        let mut all = [Self::Off(Off); SceneKind::ALL.len()];
        let mut i = 0;
        while i < all.len() {
            all[i] = match SceneKind::ALL[i].usual(device, rate) {
                Ok(scene) => scene,
                Err(error) => return Err(error),
            };
            i += 1;
        }
        Ok(all)
    }
}
