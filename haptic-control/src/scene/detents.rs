use estimator_core::Skip;

use super::environment::is_gain;
use super::sine::sine;
use super::{Handle, Scene};
use crate::design_error::DesignError;
use crate::need::Wanted;
use crate::tuning::{Bounds, parameters};
use crate::units::{NewtonMetres, Radians};

/// Detents: `torque = -A sin(n θ)`, with n rest positions a turn.
///
/// The scene reads the handle's position alone and the small motor alone renders it, so the
/// controller has no velocity estimator. A in N·m, at least zero; n from 1 to 1000.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Detents {
    amplitude: f32,
    /// Half periods of the sine per radian.
    half_periods_per_rad: f32,
}

impl Detents {
    /// `per_rev` detents a turn with this amplitude, N·m.
    ///
    /// # Errors
    /// [`DesignError::Scene`] if a parameter is out of its range.
    pub const fn new(amplitude: f32, per_rev: u16) -> Result<Self, DesignError> {
        if is_gain(amplitude) && per_rev >= 1 && per_rev <= 1000 {
            Ok(Self {
                amplitude,
                half_periods_per_rad: per_rev as f32 / core::f32::consts::PI,
            })
        } else {
            Err(DesignError::Scene)
        }
    }

    /// Number of detents a turn.
    const fn per_rev(&self) -> f32 {
        (self.half_periods_per_rad * core::f32::consts::PI + 0.5) as u16 as f32
    }

    /// `per_rev` detents a turn, a whole number, whose slope at rest is within the bound of a
    /// stiffness.
    fn tuned(amplitude: f32, per_rev: f32, bounds: &Bounds) -> Result<Self, DesignError> {
        let whole = per_rev as u16;
        if f32::from(whole) == per_rev && amplitude * per_rev <= bounds.stiffness {
            Self::new(amplitude, whole)
        } else {
            Err(DesignError::Scene)
        }
    }
}

parameters! { Detents, |detents, bounds, rate| {
    "amplitude" amplitude: Amplitude = detents.amplitude;
    "per-turn" per_rev: DetentsPerTurn = detents.per_rev();
} => Self::tuned(amplitude, per_rev, bounds) }

impl Scene for Detents {
    type Velocity = Skip;
    type Acceleration = Skip;
    type Continuous = Skip;
    type Transient = Wanted;
    type State = ();

    fn start(&self, _: Radians) {}

    fn torque(&self, (): &mut (), handle: &Handle<()>) -> NewtonMetres {
        let half_periods = handle.angle.0 * self.half_periods_per_rad;
        // Into [-1, 1] by whole periods; the cast saturates, far beyond any handle's turns.
        let nearest = if half_periods < 0.0 {
            half_periods - 1.0
        } else {
            half_periods + 1.0
        };
        let phase = half_periods - 2.0 * (nearest * 0.5) as i32 as f32;
        NewtonMetres(-self.amplitude * sine(phase))
    }
    fn vibration(&self) -> NewtonMetres {
        NewtonMetres(self.amplitude)
    }
}
