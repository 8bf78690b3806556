//! The two stages that make torque on the handle.

use estimator_core::Amps;

use crate::compensation::Compensated;
use crate::device::DualStage;
use crate::limits::{CurrentLimits, CurrentScale, at_most, seldom_more};
use crate::monitor::LARGE_OVERSPEED;
use crate::rst::{Rst, RstState};
use crate::rst_design::RstDesign;
use crate::units::{NewtonMetres, RadPerS};

/// The continuous stage: the large motor behind the coupler (fig. 3 of the paper).
///
/// The torque on the handle is `b (ω_L - ω_S)`. A commanded torque therefore is a commanded
/// velocity `ω_L = ω_S + torque / b`, which an [`Rst`] compensator tracks; for ω_S it takes
/// [`Compensated::followed`](crate::Compensated::followed). The commanded velocity
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
    /// 1 - m, the gain of each half of the tracking filter.
    tracking_gain: f32,
}

/// Parts of the coupler's torque beside the commanded one that the small motor takes as transmitted, and so
/// compensates, from 0 to 1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CoupledParts {
    /// Of the torque by the tracking error of the large motor.
    pub tracking: f32,
    /// Of the drag: the torque by the lag of the large motor behind the handle.
    pub drag: f32,
}

/// Result of a tick of a [`ContinuousStage`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Driven {
    /// Current of the large motor.
    pub current: Amps,
    /// Torque that the coupler is assumed to transmit to the handle.
    pub coupled: NewtonMetres,
}

/// State of a [`ContinuousStage`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ContinuousState {
    rst: RstState,
    current: Amps,
    /// Largest current.
    largest: Amps,
    /// Both halves of the tracking filter, for the slip of the commanded torque, rad/s.
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

/// Inverse of the commanded velocity of the large motor below which the friction that is fed forward is
/// reduced, because its direction is uncertain, 1 / (rad/s).
const PER_FADE: f32 = 1.0 / 0.15;

/// Lag of the large motor behind the handle whose drag is compensated at most, rad/s. It bounds the torque that
/// the compensation adds to a handle which oscillates slowly, on a device with a weaker coupler or a stronger small
/// motor than in the description. A hand that turns back at 28 rad/s² makes the motor lag by 0.15 rad/s.
const LARGEST_LAG: f32 = 0.5;

/// The limited velocity for a velocity above the largest, and the slip that is commanded by it.
#[cold]
#[inline(never)]
fn limited(wanted: f32, followed: RadPerS) -> (f32, f32) {
    let limited = at_most(wanted, LARGEST_WANTED);
    (limited, limited - followed.0)
}

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

    /// One tick for a commanded torque and the velocities of the large motor and of the handle.
    ///
    /// ```text
    /// c = F τ + p_t b (ω_L - ω_f) + p_d sat(b (ω_f - ω_S) - F τ, b 0.5 rad/s)
    /// ```
    /// is the torque that the coupler is assumed to transmit. τ is the commanded torque and ω_f the commanded velocity,
    /// both after the tracking filter F and the limit of the velocity. The three terms are the commanded torque, that of
    /// the tracking error, and the drag: once the large motor follows the handle, the latter are zero. p_t and p_d are
    /// the compensated [`CoupledParts`].
    #[must_use]
    // A call of its own costs a tick 20 instructions.
    #[inline(always)]
    pub fn update(
        &self,
        state: &mut ContinuousState,
        torque: NewtonMetres,
        large: RadPerS,
        handle: RadPerS,
        compensated: &Compensated,
    ) -> Driven {
        let slip = torque.0 * self.rad_per_s_per_nm;
        let wanted = compensated.followed.0 + slip;
        // NaN is not within.
        let (limited, asked) = if wanted.abs() <= LARGEST_WANTED {
            (wanted, slip)
        } else {
            limited(wanted, compensated.followed)
        };
        let looped = self.rst.update(&mut state.rst, RadPerS(limited), large);
        let commanded = state.rst.filtered().0;
        let direction = at_most(commanded * PER_FADE, 1.0);
        let forward = self.friction * direction + self.damping * handle.0;
        let wanted = looped + forward;
        let limits = CurrentLimits {
            largest: state.largest,
            ..self.limits
        };
        let before = state.current;
        let current = limits.unlimited(wanted, before).unwrap_or_else(|| {
            let current = limits.limited(wanted, before);
            if current.get() != wanted {
                state.rst.limited(current.get() - forward);
            }
            current
        });
        state.current = current;

        let [lag, expected] = &mut state.expected;
        *lag += self.tracking_gain * (asked - *lag);
        *expected += self.tracking_gain * (*lag - *expected);
        let error = large.0 - commanded;
        let drag = seldom_more(commanded - handle.0 - *expected, LARGEST_LAG);
        let CoupledParts {
            tracking,
            drag: part,
        } = compensated.parts;
        let slip = *expected + tracking * error + part * drag;
        let coupled = NewtonMetres(self.nm_per_rad_per_s * slip);
        Driven { current, coupled }
    }
}

/// The transient stage: the small motor on the handle.
///
/// With a continuous stage it renders the torque that the coupler is assumed not to transmit,
/// without delay (see [`ContinuousStage::update`]). Alone it renders the whole torque. Its own
/// Coulomb friction is fed forward in the direction of the handle's velocity, if that is estimated:
/// [`Compensated::friction`](crate::Compensated::friction).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TransientStage {
    limits: CurrentLimits,
    amps_per_nm: f32,
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
