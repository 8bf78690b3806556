//! The two stages that make torque on the handle.

use estimator_core::Amps;

use crate::device::DualStage;
use crate::limits::{CurrentLimits, within};
use crate::rst::{Rst, RstState};
use crate::rst_design::RstDesign;
use crate::units::{NewtonMetres, RadPerS};

/// The continuous stage: the large motor behind the coupler (fig. 3 of the paper).
///
/// Torque on the handle is `b (ω_L - ω_S)`, so a wanted torque is a wanted velocity
/// `ω_L = ω_S + torque / b`, which an [`Rst`] compensator follows. Fed forward: Coulomb friction
/// in the direction of the wanted velocity, and the coupler's pull on the large motor, `-b ω_S`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ContinuousStage {
    rst: Rst,
    limits: CurrentLimits,
    rad_per_s_per_nm: f32,
    /// Fed forward for the handle's velocity, A per rad/s.
    damping: f32,
    /// Fed forward for friction, A.
    friction: f32,
    /// Velocity over which the friction is faded in, 1 / (rad/s).
    per_fade: f32,
}

/// State of a [`ContinuousStage`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ContinuousState {
    rst: RstState,
    current: f32,
}

/// Velocity below which the direction of the large motor's wanted motion is not trusted to feed
/// friction forward, rad/s.
const FADE: f64 = 0.5;

/// The same for the handle, whose velocity is measured finer.
const HANDLE_FADE: f64 = 0.12;

/// Part of the small motor's friction that is fed forward. With all of it, a torque constant 20 %
/// above the believed one would drive a handle that nobody holds.
const FRICTION_PART: f64 = 0.8;

impl ContinuousStage {
    /// The stage of a device, with its designed loop; a tick may change the current by `slew` A.
    #[must_use]
    pub const fn new(device: &DualStage, design: &RstDesign, slew: f32) -> Self {
        Self {
            rst: Rst::new(design),
            limits: CurrentLimits {
                largest: device.large.current_limit as f32,
                slew,
            },
            rad_per_s_per_nm: (1.0 / device.damping) as f32,
            damping: (-device.damping / device.large.torque_constant) as f32,
            friction: (device.large.coulomb / device.large.torque_constant) as f32,
            per_fade: (1.0 / FADE) as f32,
        }
    }

    /// Largest current, A.
    pub(crate) const fn largest_current(&self) -> f32 {
        self.limits.largest
    }

    /// State with no current, the large motor at a velocity.
    #[must_use]
    pub const fn start(&self, large: RadPerS) -> ContinuousState {
        ContinuousState {
            rst: self.rst.start(large),
            current: 0.0,
        }
    }

    /// One tick: the large motor's current for a wanted torque.
    #[must_use]
    pub fn update(
        &self,
        state: &mut ContinuousState,
        torque: NewtonMetres,
        large: RadPerS,
        handle: RadPerS,
    ) -> Amps {
        let wanted = RadPerS(handle.0 + torque.0 * self.rad_per_s_per_nm);
        let looped = self.rst.update(&mut state.rst, wanted, large);
        let direction = within(state.rst.filtered().0 * self.per_fade, -1.0, 1.0);
        let forward = self.friction * direction + self.damping * handle.0;
        let wanted = looped + forward;
        state.current = self.limits.applied(wanted, state.current);
        if state.current != wanted {
            state.rst.limited(state.current - forward);
        }
        Amps::new(state.current)
    }
}

/// The transient stage: the small motor on the handle.
///
/// With a continuous stage it gets the torque that the coupler does not deliver, at once:
/// `Kt i = torque - b (ω_L - ω_S)`. Alone it gets the whole torque. Four fifths of its own Coulomb
/// friction are fed forward in the direction of the handle's velocity, where that is known.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TransientStage {
    limits: CurrentLimits,
    amps_per_nm: f32,
    nm_per_rad_per_s: f32,
    friction: NewtonMetres,
    per_fade: f32,
}

/// State of a [`TransientStage`]: the current of the last tick.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct TransientState {
    current: f32,
}

impl TransientStage {
    /// The stage of a device; a tick may change the current by `slew` A.
    #[must_use]
    pub const fn new(device: &DualStage, slew: f32) -> Self {
        Self {
            limits: CurrentLimits {
                largest: device.small.current_limit as f32,
                slew,
            },
            amps_per_nm: (1.0 / device.small.torque_constant) as f32,
            nm_per_rad_per_s: device.damping as f32,
            friction: NewtonMetres((FRICTION_PART * device.small.coulomb) as f32),
            per_fade: (1.0 / HANDLE_FADE) as f32,
        }
    }

    /// Largest current, A.
    pub(crate) const fn largest_current(&self) -> f32 {
        self.limits.largest
    }

    /// Torque that a slip velocity puts on the handle.
    #[must_use]
    pub fn coupled(&self, slip: RadPerS) -> NewtonMetres {
        NewtonMetres(self.nm_per_rad_per_s * slip.0)
    }

    /// One tick: the small motor's current for the torque that is missing.
    #[must_use]
    pub fn update(
        &self,
        state: &mut TransientState,
        missing: NewtonMetres,
        handle: RadPerS,
    ) -> Amps {
        let friction = self.friction.0 * within(handle.0 * self.per_fade, -1.0, 1.0);
        let wanted = (missing.0 + friction) * self.amps_per_nm;
        state.current = self.limits.applied(wanted, state.current);
        Amps::new(state.current)
    }
}
