//! Parameters of scenes, changed while they run: one at a time, within bounds.

use estimator_core::Hertz;

use crate::scene::{
    Detents, Excite, FreeAir, Hold, Inertia, Off, Scene, SpringDamper, Texture, Torque, Viscous,
    Wall,
};
use crate::units::Radians;

/// What parameters may be; a scene is built for them anew or not at all.
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
    /// The handle's own inertia, kg·m², half of which may be added or taken away.
    pub inertia: f32,
    /// Control rate.
    pub rate: Hertz,
}

/// Why a parameter was not set.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Refusal {
    /// The value is no finite number.
    NotFinite,
    /// The value is outside what the device renders safely.
    OutOfBounds,
    /// There is no such scene or parameter.
    Unknown,
}

/// A scene whose parameters have numbers.
pub trait Tunable: Scene + Copy {
    /// Names of the parameters, in the order of their numbers.
    const PARAMETERS: &'static [&'static str];

    /// This scene with parameter number `parameter` set to `value`.
    ///
    /// # Errors
    /// [`Refusal`]: the scene stays as it was.
    fn tuned(&self, parameter: u8, value: f32, bounds: &Bounds) -> Result<Self, Refusal> {
        if usize::from(parameter) >= Self::PARAMETERS.len() {
            Err(Refusal::Unknown)
        } else if !value.is_finite() {
            Err(Refusal::NotFinite)
        } else {
            self.set(parameter, value, bounds)
                .ok_or(Refusal::OutOfBounds)
        }
    }

    /// The same for a known parameter and a finite value; `None` out of bounds.
    #[doc(hidden)]
    fn set(&self, parameter: u8, value: f32, bounds: &Bounds) -> Option<Self>;
}

/// `value`, if it is at least zero and at most `largest`.
fn gain(value: f32, largest: f32) -> Option<f32> {
    (value >= 0.0 && value <= largest).then_some(value)
}

/// `value`, if it is at most `largest` to either side.
fn signed(value: f32, largest: f32) -> Option<f32> {
    (value >= -largest && value <= largest).then_some(value)
}

impl Tunable for Off {
    const PARAMETERS: &'static [&'static str] = &[];

    fn set(&self, _: u8, _: f32, _: &Bounds) -> Option<Self> {
        None
    }
}

impl Tunable for FreeAir {
    const PARAMETERS: &'static [&'static str] = &[];

    fn set(&self, _: u8, _: f32, _: &Bounds) -> Option<Self> {
        None
    }
}

impl Tunable for Wall {
    const PARAMETERS: &'static [&'static str] = &["position", "stiffness", "damping"];

    fn set(&self, parameter: u8, value: f32, bounds: &Bounds) -> Option<Self> {
        let (mut position, [mut stiffness, mut damping]) = self.parameters();
        match parameter {
            0 => position = Radians(signed(value, bounds.angle)?),
            1 => stiffness = gain(value, bounds.stiffness)?,
            _ => damping = gain(value, bounds.damping)?,
        }
        Self::new(position, stiffness, damping).ok()
    }
}

impl Tunable for SpringDamper {
    const PARAMETERS: &'static [&'static str] = &["centre", "stiffness", "damping"];

    fn set(&self, parameter: u8, value: f32, bounds: &Bounds) -> Option<Self> {
        let (mut centre, [mut stiffness, mut damping]) = self.parameters();
        match parameter {
            0 => centre = Radians(signed(value, bounds.angle)?),
            1 => stiffness = gain(value, bounds.stiffness)?,
            _ => damping = gain(value, bounds.damping)?,
        }
        Self::new(centre, stiffness, damping).ok()
    }
}

impl Tunable for Viscous {
    const PARAMETERS: &'static [&'static str] = &["damping"];

    fn set(&self, _: u8, value: f32, bounds: &Bounds) -> Option<Self> {
        Self::new(gain(value, bounds.damping)?).ok()
    }
}

impl Tunable for Detents {
    const PARAMETERS: &'static [&'static str] = &["amplitude", "per-turn"];

    fn set(&self, parameter: u8, value: f32, bounds: &Bounds) -> Option<Self> {
        let (mut amplitude, mut per_rev) = self.parameters();
        match parameter {
            0 => amplitude = gain(value, bounds.torque)?,
            _ => per_rev = gain(value, f32::from(u16::MAX))?,
        }
        // The slope at a detent is a stiffness like any other.
        gain(amplitude * per_rev, bounds.stiffness)?;
        let whole = per_rev as u16;
        (f32::from(whole) == per_rev).then_some(())?;
        Self::new(amplitude, whole).ok()
    }
}

impl Tunable for Texture {
    const PARAMETERS: &'static [&'static str] = &["amplitude", "frequency"];

    fn set(&self, parameter: u8, value: f32, bounds: &Bounds) -> Option<Self> {
        match parameter {
            0 => Some(self.with_amplitude(gain(value, bounds.torque)?)),
            _ => Self::new(self.amplitude(), Hertz(f64::from(value)), bounds.rate).ok(),
        }
    }
}

impl Tunable for Hold {
    const PARAMETERS: &'static [&'static str] = &["stiffness", "damping"];

    fn set(&self, parameter: u8, value: f32, bounds: &Bounds) -> Option<Self> {
        let [mut stiffness, mut damping] = self.parameters();
        match parameter {
            0 => stiffness = gain(value, bounds.stiffness)?,
            _ => damping = gain(value, bounds.damping)?,
        }
        Self::new(stiffness, damping).ok()
    }
}

impl Tunable for Torque {
    const PARAMETERS: &'static [&'static str] = &["torque"];

    fn set(&self, _: u8, value: f32, bounds: &Bounds) -> Option<Self> {
        Self::new(signed(value, bounds.torque)?).ok()
    }
}

impl Tunable for Excite {
    const PARAMETERS: &'static [&'static str] = &[];

    fn set(&self, _: u8, _: f32, _: &Bounds) -> Option<Self> {
        None
    }
}

impl Tunable for Inertia {
    const PARAMETERS: &'static [&'static str] = &["inertia"];

    fn set(&self, _: u8, value: f32, bounds: &Bounds) -> Option<Self> {
        Self::new(value, bounds.inertia).ok()
    }
}
