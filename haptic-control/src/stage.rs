//! The two stages that make torque on the handle.

use estimator_core::Amps;

use crate::coulomb::{Coulomb, LARGEST_CONSTANT};
use crate::device::DualStage;
use crate::limits::{CurrentLimits, CurrentScale, at_most};
use crate::monitor::LARGE_OVERSPEED;
use crate::rst::{Rst, RstState};
use crate::rst_design::RstDesign;
use crate::units::{NewtonMetres, RadPerS};

/// The continuous stage: the large motor behind the coupler (fig. 3 of the paper).
///
/// The torque on the handle is `b (ω_L - ω_S)`. A commanded torque therefore is a commanded
/// velocity `ω_L = ω_S + torque / b`, which an [`Rst`] compensator tracks; ω_S is the velocity
/// [`Followed`]. The commanded velocity
/// is limited to 85 % of the speed at which [`Monitor::new`](crate::Monitor::new) stops the large
/// motor; the transient stage renders the missing torque. Two terms are fed forward: Coulomb
/// friction in the direction of the commanded velocity, and the pull of the coupler on the large
/// motor, `-b ω_S`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ContinuousStage {
    rst: Rst,
    limits: CurrentLimits,
    rad_per_s_per_nm: f32,
    nm_per_rad_per_s: f32,
    /// Current fed forward per velocity of the handle, A per rad/s.
    damping: f32,
    /// Current fed forward for friction, A.
    friction: f32,
    /// Inverse of the velocity over which the friction is faded in, 1 / (rad/s).
    per_fade: f32,
    /// Torque that is compensated per measured slip, N·m per rad/s.
    measured: f32,
    /// 1 - m, the gain of each half of the tracking filter.
    tracking_gain: f32,
}

/// The motion of the handle that the large motor follows.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Followed {
    /// Velocity that it follows where no torque is commanded.
    pub velocity: RadPerS,
    /// Inverse of the velocity over which its friction is faded in, 1 / (rad/s).
    pub(crate) per_fade: f32,
}

/// State of a [`ContinuousStage`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ContinuousState {
    rst: RstState,
    current: Amps,
    /// Largest current.
    largest: Amps,
    /// The commanded torque, limited by the largest velocity of the large motor, N·m.
    asked: f32,
    /// Both halves of the tracking filter, for `asked`.
    expected: [f32; 2],
}

impl ContinuousState {
    /// Largest current, A.
    pub(crate) const fn largest_current(&self) -> f32 {
        self.largest.get()
    }
}

/// Largest commanded velocity of the large motor, rad/s. The rest up to the monitor's limit is for
/// overshoot on a device whose parameters differ from the description.
const LARGEST_WANTED: f32 = (0.85 * LARGE_OVERSPEED) as f32;

/// Commanded velocity of the large motor below which the friction that is fed forward is reduced,
/// because its direction is uncertain, in a scene with a spring, rad/s.
const FADE: f64 = 0.5;

/// Velocity of the handle below which the friction that is fed forward is reduced in a scene with a spring,
/// rad/s. It is lower than that of the large motor was chosen for: the handle's encoder is finer.
const HANDLE_FADE: f64 = 0.12;

/// Part of the small motor's friction that is fed forward in a scene with a spring. The rest damps the
/// spring: with all of it, the largest passive stiffness without damping would be smaller by a seventh.
const FRICTION_PART: f64 = 0.8;

/// Least damping of the coupler with which the transient stage is passive, as a factor of the value in
/// the description.
const LEAST_DAMPING: f64 = 0.6;

/// Part of the measured slip's torque that the small motor compensates. A larger part would drive
/// the handle, if the small motor is stronger and the coupler weaker than in the description.
const MEASURED_PART: f64 = LEAST_DAMPING / LARGEST_CONSTANT;
const EXPECTED_PART: f32 = (1.0 - MEASURED_PART) as f32;

impl ContinuousStage {
    /// The stage of a device, with its designed loop; a tick may change the current by `slew` A.
    #[must_use]
    pub const fn new(device: &DualStage, design: &RstDesign, slew: f32) -> Self {
        Self {
            rst: Rst::new(design),
            limits: CurrentLimits {
                largest: Amps::new(device.large.current_limit as f32),
                slew,
            },
            rad_per_s_per_nm: (1.0 / device.damping) as f32,
            nm_per_rad_per_s: device.damping as f32,
            damping: (-device.damping / device.large.torque_constant) as f32,
            friction: (device.large.coulomb_friction / device.large.torque_constant) as f32,
            per_fade: (1.0 / FADE) as f32,
            measured: (MEASURED_PART * device.damping) as f32,
            tracking_gain: (1.0 - design.tracking_pole) as f32,
        }
    }

    /// State with no current and the limits of the device, the large motor at a velocity.
    #[must_use]
    pub const fn start(&self, large: RadPerS) -> ContinuousState {
        ContinuousState {
            rst: self.rst.start(large),
            current: Amps::ZERO,
            largest: self.limits.largest,
            asked: 0.0,
            expected: [0.0; 2],
        }
    }

    /// Starts again with no current. The scale of the limit stays.
    pub fn restart(&self, state: &mut ContinuousState, large: RadPerS) {
        *state = ContinuousState {
            largest: state.largest,
            ..self.start(large)
        };
    }

    /// Scales the limit of the current, from the next tick on.
    pub fn scale(&self, state: &mut ContinuousState, scale: CurrentScale) {
        state.largest = Amps::new(scale.large(self.limits.largest.get()));
    }

    /// The motion that the large motor follows in a scene with a spring: that of the handle.
    #[inline]
    #[must_use]
    pub const fn follow(&self, handle: RadPerS) -> Followed {
        Followed {
            velocity: handle,
            per_fade: self.per_fade,
        }
    }

    /// One tick: the large motor's current for a commanded torque.
    #[must_use]
    #[inline]
    pub fn update(
        &self,
        state: &mut ContinuousState,
        torque: NewtonMetres,
        large: RadPerS,
        handle: RadPerS,
        followed: Followed,
    ) -> Amps {
        let wanted = followed.velocity.0 + torque.0 * self.rad_per_s_per_nm;
        // NaN is not within.
        let (limited, asked) = if wanted.abs() <= LARGEST_WANTED {
            (wanted, torque.0)
        } else {
            self.limited(wanted, followed)
        };
        state.asked = asked;
        let looped = self.rst.update(&mut state.rst, RadPerS(limited), large);
        let direction = at_most(state.rst.filtered().0 * followed.per_fade, 1.0);
        let forward = self.friction * direction + self.damping * handle.0;
        let wanted = looped + forward;
        let limits = CurrentLimits {
            largest: state.largest,
            ..self.limits
        };
        let before = state.current;
        state.current = limits.unlimited(wanted, before).unwrap_or_else(|| {
            let current = limits.limited(wanted, before);
            if current.get() != wanted {
                state.rst.limited(current.get() - forward);
            }
            current
        });
        state.current
    }

    /// The limited velocity for a velocity above the largest, and the torque that is commanded by it.
    #[cold]
    #[inline(never)]
    fn limited(&self, wanted: f32, followed: Followed) -> (f32, f32) {
        let limited = at_most(wanted, LARGEST_WANTED);
        let asked = (limited - followed.velocity.0) * self.nm_per_rad_per_s;
        (limited, asked)
    }

    /// One tick, after [`Self::update`]: the torque that the coupler is assumed to transmit.
    ///
    /// It is the average of the torque of the measured slip and of the commanded torque after the
    /// tracking filter F and the limit of the velocity, `b slip / 2 + F torque / 2`. Both are equal
    /// once the large motor follows. Only half of an uncommanded slip torque is compensated, which
    /// keeps the loop passive.
    #[must_use]
    pub fn coupled(&self, state: &mut ContinuousState, slip: RadPerS) -> NewtonMetres {
        let [lag, expected] = &mut state.expected;
        *lag += self.tracking_gain * (state.asked - *lag);
        *expected += self.tracking_gain * (*lag - *expected);
        NewtonMetres(EXPECTED_PART * *expected + self.measured * slip.0)
    }
}

/// The transient stage: the small motor on the handle.
///
/// With a continuous stage it renders the torque that the coupler is assumed not to transmit,
/// without delay (see [`ContinuousStage::coupled`]). Alone it renders the whole torque. Its own
/// Coulomb friction is fed forward in the direction of the handle's velocity, if that is estimated:
/// [`TransientStage::friction_correction`] or [`Anticipated::friction`](crate::Anticipated::friction).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TransientStage {
    limits: CurrentLimits,
    amps_per_nm: f32,
    friction: Coulomb,
}

/// State of a [`TransientStage`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TransientState {
    current: Amps,
    /// Largest current.
    largest: Amps,
}

impl TransientState {
    /// Largest current, A.
    pub(crate) const fn largest_current(&self) -> f32 {
        self.largest.get()
    }
}

impl TransientStage {
    /// The stage of a device; a tick may change the current by `slew` A.
    #[must_use]
    pub const fn new(device: &DualStage, slew: f32) -> Self {
        Self {
            limits: CurrentLimits {
                largest: Amps::new(device.small.current_limit as f32),
                slew,
            },
            amps_per_nm: (1.0 / device.small.torque_constant) as f32,
            friction: Coulomb::new(device.small.coulomb_friction, FRICTION_PART, HANDLE_FADE),
        }
    }

    /// State with no current and the limits of the device.
    #[must_use]
    pub const fn start(&self) -> TransientState {
        TransientState {
            current: Amps::ZERO,
            largest: self.limits.largest,
        }
    }

    /// Starts again with no current. The scale of the limit stays.
    pub fn restart(&self, state: &mut TransientState) {
        state.current = Amps::ZERO;
    }

    /// Scales the limit of the current, from the next tick on.
    pub fn scale(&self, state: &mut TransientState, scale: CurrentScale) {
        state.largest = Amps::new(scale.small(self.limits.largest.get()));
    }

    /// Torque that is fed forward against the small motor's friction at this velocity of the handle, in a
    /// scene without [anticipation](crate::Anticipation): four fifths of the friction from 0.12 rad/s on,
    /// half of it from 6 rad/s on.
    #[inline]
    #[must_use]
    pub fn friction_correction(&self, handle: RadPerS) -> NewtonMetres {
        self.friction.at(handle)
    }

    /// One tick: the small motor's current for a torque, that against its friction included.
    #[must_use]
    pub fn update(&self, state: &mut TransientState, torque: NewtonMetres) -> Amps {
        let wanted = torque.0 * self.amps_per_nm;
        let limits = CurrentLimits {
            largest: state.largest,
            ..self.limits
        };
        state.current = limits.applied(wanted, state.current);
        state.current
    }
}
