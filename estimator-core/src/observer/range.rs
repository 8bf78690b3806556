//! Range of the parameter errors that an observer learns.

use super::motion::Motion;
use crate::design::const_math::limited;
use crate::memory::memory;
use crate::sealed::Sealed;

/// Range of the parameter errors that [`Adaptive`](super::Adaptive) learns: [`Narrow`] or [`Wide`].
///
/// This trait is sealed: only types of this crate implement it.
pub trait Range: Copy + Sealed {
    /// Standard deviations of the parameter errors before the first update.
    const PRIOR: [f32; 3];
    /// Whether the errors can be so large that the motion by the model is unlike that of the device.
    /// The sensitivities then include the error of the damping, a rotor that only the model stops is
    /// taken as moving, a count that an edge was expected to change is an innovation too, and large
    /// innovations are believed less.
    const LARGE: bool;

    /// The friction of which the error of the friction is a part, counts/tick².
    fn friction(&self, motion: &Motion) -> f32;

    /// The error of a parameter, limited to its range.
    fn limited(&self, parameter: usize, error: f32) -> f32;
}

/// Range of constants that are known within about half of their values: ±60 % for damping and torque
/// constant, ±90 % for friction. The standard deviations start at 35, 60 and 35 %.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[repr(C)]
pub struct Narrow;

memory!(Narrow {});

/// Largest errors of damping, friction and torque constant in the range [`Narrow`].
const LARGEST: [f32; 3] = [0.6, 0.9, 0.6];

impl Sealed for Narrow {}

impl Range for Narrow {
    const PRIOR: [f32; 3] = [0.35, 0.6, 0.35];
    const LARGE: bool = false;

    #[inline(always)]
    fn friction(&self, motion: &Motion) -> f32 {
        motion.friction
    }

    #[inline(always)]
    fn limited(&self, parameter: usize, error: f32) -> f32 {
        limited(error, LARGEST[parameter])
    }
}

/// Range of constants that can be wrong by a factor of ten, and a torque constant whose sign can be
/// wrong.
///
/// The damping is from 0.05 to 21 times that of the model, the friction from 0 to 21 times, the torque
/// constant from -19 to 21 times. The friction is learned in parts of the larger of the model's friction
/// and the standard deviation of the disturbance: a model without friction learns one. The damping is
/// further limited to `φ0 / (1 - φ0)` times that of the model, and not below 1.6 times: under a damping
/// that is constant over a tick a larger one would turn the motion round. The standard deviations start
/// at 1.
///
/// A damping or a torque constant of zero in the model is not learned.
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(C)]
pub struct Wide {
    /// Friction of which the error is a part, counts/tick².
    friction: f32,
    least: [f32; 3],
    most: [f32; 3],
}

memory!(Wide {
    friction,
    least,
    most
});

/// Least damping in the range [`Wide`], in parts of that of the model: without any damping and friction
/// nothing would end the motion of a rotor inside its quantisation interval.
const LEAST_DAMPING: f32 = 0.05;

/// Largest error in the range [`Wide`].
const MOST: f32 = 20.0;

impl Wide {
    /// The range for a motor with a disturbance of standard deviation `load`, counts/tick².
    pub(super) const fn new(motion: &Motion, load: f32) -> Self {
        let friction = if motion.friction > load {
            motion.friction
        } else {
            load
        };
        let none = if friction > 0.0 {
            -motion.friction / friction
        } else {
            0.0
        };
        let monotone = motion.phi0 / (1.0 - motion.phi0);
        let damping = if monotone > MOST {
            MOST
        } else if monotone > LARGEST[0] {
            monotone
        } else {
            LARGEST[0]
        };
        Self {
            friction,
            least: [LEAST_DAMPING - 1.0, none, -MOST],
            most: [damping, MOST, MOST],
        }
    }
}

impl Sealed for Wide {}

impl Range for Wide {
    const PRIOR: [f32; 3] = [1.0; 3];
    const LARGE: bool = true;

    #[inline(always)]
    fn friction(&self, _: &Motion) -> f32 {
        self.friction
    }

    #[inline(always)]
    fn limited(&self, parameter: usize, error: f32) -> f32 {
        let (least, most) = (self.least[parameter], self.most[parameter]);
        if error > most {
            most
        } else if error < least {
            least
        } else {
            error
        }
    }
}
