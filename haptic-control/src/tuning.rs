//! Parameters of scenes: names, quantities, bounds and changes.

use core::ops::RangeInclusive;

use estimator_core::Hertz;

use crate::scene::{Inertia, Scene};

/// Limits of scene parameters on one device at one control rate.
///
/// ```
/// use estimator_core::*;
/// use haptic_control::*;
/// const BOUNDS: Bounds =
///     Bounds { stiffness: 0.6, damping: 5e-3, angle: 6.3, torque: 41e-3, inertia: 5e-6, rate: Hertz(10e3) };
/// let wall = preset!(Wall::new(Radians(0.1), 0.30, 0.0));
/// let softer = wall.tuned(1, 0.20, &BOUNDS);
/// assert_eq!(softer, Ok(preset!(Wall::new(Radians(0.1), 0.20, 0.0))));
/// assert_eq!(wall.tuned(1, 0.61, &BOUNDS), Err(Refusal::OutOfBounds));
/// assert_eq!(wall.tuned(1, f32::NAN, &BOUNDS), Err(Refusal::NotFinite));
/// assert_eq!(wall.tuned(3, 0.20, &BOUNDS), Err(Refusal::Unknown));
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bounds {
    /// Largest stiffness, N·m/rad.
    pub stiffness: f32,
    /// Largest damping, N·m·s/rad.
    pub damping: f32,
    /// Largest angle to either side, rad.
    pub angle: f32,
    /// Largest torque and amplitude, N·m.
    pub torque: f32,
    /// The handle's own inertia, kg·m². A virtual inertia has at most half of its magnitude.
    pub inertia: f32,
    /// Control rate.
    pub rate: Hertz,
}

/// The quantity of a parameter: it determines unit and bounds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Quantity {
    /// Angle, to either side.
    Angle,
    /// Stiffness.
    Stiffness,
    /// Damping.
    Damping,
    /// Torque, to either side.
    Torque,
    /// Amplitude of a torque, or a torque that opposes a motion.
    Amplitude,
    /// Detents in a turn, a whole number.
    DetentsPerTurn,
    /// Frequency of a vibration.
    Frequency,
    /// Inertia that is added to the handle's own; negative if it is subtracted.
    Inertia,
}

impl Quantity {
    /// Name of the SI unit; empty for a number.
    #[must_use]
    pub const fn unit(self) -> &'static str {
        match self {
            Self::Angle => "rad",
            Self::Stiffness => "N·m/rad",
            Self::Damping => "N·m·s/rad",
            Self::Torque | Self::Amplitude => "N·m",
            Self::DetentsPerTurn => "",
            Self::Frequency => "Hz",
            Self::Inertia => "kg·m²",
        }
    }

    /// Smallest and largest value. A scene may refuse a value in this range because of its other
    /// parameters.
    #[must_use]
    pub fn range(self, bounds: &Bounds) -> RangeInclusive<f32> {
        let (least, most) = match self {
            Self::Angle => (-bounds.angle, bounds.angle),
            Self::Stiffness => (0.0, bounds.stiffness),
            Self::Damping => (0.0, bounds.damping),
            Self::Torque => (-bounds.torque, bounds.torque),
            Self::Amplitude => (0.0, bounds.torque),
            Self::DetentsPerTurn => (1.0, 1000.0),
            Self::Frequency => (50.0, 300.0),
            Self::Inertia => {
                let largest = Inertia::LARGEST_PART * bounds.inertia;
                (-largest, largest)
            }
        };
        least..=most
    }
}

impl Quantity {
    /// Whether the value is a finite number in the range.
    ///
    /// # Errors
    /// [`Refusal::NotFinite`] or [`Refusal::OutOfBounds`].
    pub(crate) fn admits(self, value: f32, bounds: &Bounds) -> Result<(), Refusal> {
        if !value.is_finite() {
            Err(Refusal::NotFinite)
        } else if self.range(bounds).contains(&value) {
            Ok(())
        } else {
            Err(Refusal::OutOfBounds)
        }
    }
}

/// A parameter of a scene. Its number is its place among the scene's parameters.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Parameter {
    /// Name on the command line.
    pub name: &'static str,
    /// Quantity.
    pub quantity: Quantity,
}

/// The reason for which a parameter was not set.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Refusal {
    /// The value is not a finite number.
    NotFinite,
    /// The value is outside the bounds within which the device renders the scene safely.
    OutOfBounds,
    /// The scene or the parameter does not exist.
    Unknown,
}

/// A scene whose parameters have numbers.
pub trait Tunable: Scene + Copy {
    /// Parameters, in the order of their numbers.
    const PARAMETERS: &'static [Parameter];

    /// This scene with parameter number `parameter` set to `value`.
    ///
    /// # Errors
    /// [`Refusal`]: the scene stays as it was.
    fn tuned(&self, parameter: u8, value: f32, bounds: &Bounds) -> Result<Self, Refusal> {
        let quantity = Self::quantity(parameter).ok_or(Refusal::Unknown)?;
        quantity.admits(value, bounds)?;
        self.with(parameter, value, bounds)
            .ok_or(Refusal::OutOfBounds)
    }

    /// The value of parameter number `parameter` at this control rate, if the scene has it.
    fn value(&self, parameter: u8, rate: Hertz) -> Option<f32>;

    /// The quantity of parameter number `parameter`. Firmware reads this instead of the parameters,
    /// so that it does not contain their names.
    #[doc(hidden)]
    fn quantity(parameter: u8) -> Option<Quantity>;

    /// This scene with another value of a known parameter, within the range of its quantity;
    /// `None` if the scene refuses the value.
    #[doc(hidden)]
    fn with(&self, parameter: u8, value: f32, bounds: &Bounds) -> Option<Self>;
}

/// Implements [`Tunable`]: a line per parameter with its name, variable, quantity and value, and
/// the scene of these variables.
macro_rules! parameters {
    ($scene:ident) => {
        parameters! { $scene, |scene, bounds, rate| {} => Ok::<Self, ()>(*scene) }
    };
    ($scene:ident, |$this:ident, $bounds:ident, $rate:ident| {
        $($name:literal $variable:ident: $quantity:ident = $get:expr;)*
    } => $build:expr) => {
        impl crate::tuning::Tunable for $scene {
            const PARAMETERS: &'static [crate::tuning::Parameter] = &[$(
                crate::tuning::Parameter {
                    name: $name,
                    quantity: crate::tuning::Quantity::$quantity,
                }
            ),*];

            fn quantity(parameter: u8) -> Option<crate::tuning::Quantity> {
                const QUANTITIES: &[crate::tuning::Quantity] =
                    &[$(crate::tuning::Quantity::$quantity),*];
                QUANTITIES.get(usize::from(parameter)).copied()
            }

            fn value(&self, parameter: u8, $rate: estimator_core::Hertz) -> Option<f32> {
                let $this = self;
                // Not every scene reads them.
                let _ = ($this, $rate);
                let values: &[f32] = &[$($get),*];
                values.get(usize::from(parameter)).copied()
            }

            fn with(
                &self,
                parameter: u8,
                value: f32,
                $bounds: &crate::tuning::Bounds,
            ) -> Option<Self> {
                let ($this, $rate) = (self, $bounds.rate);
                // Not every scene reads all of them.
                let _ = ($this, $rate, value);
                let mut numbers = 0..;
                $(
                    let $variable = match numbers.next() == Some(parameter) {
                        true => value,
                        false => $get,
                    };
                )*
                let _ = (numbers.next(), parameter);
                $build.ok()
            }
        }
    };
}
pub(crate) use parameters;
