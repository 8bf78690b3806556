//! Compensation of what both motors add to the torque of a scene: friction, and the drag of the large motor.

use core::f64::consts::PI;

use estimator_core::Hertz;
use estimator_core::const_math::exp;

use crate::coulomb::{Coulomb, slow};
use crate::device::DualStage;
use crate::limits::within;
use crate::rst_design::LoopPoles;
use crate::stage::CoupledParts;
use crate::units::{NewtonMetres, RadPerS};

/// Acceleration of the handle when a hand turns it back, rad/s²: that of a swing by 40° to both sides once
/// a second. Below the velocity that it reaches in the delay of the loop, the direction is uncertain.
const REVERSAL: f64 = 28.0;

/// Time after a reversal from which on the whole friction is compensated beside a spring, and the time in which
/// the compensation rises to it, s.
const FRICTION_AFTER: Ramp = Ramp {
    from_s: 4e-3,
    rise_s: 2e-3,
};

/// Part of the friction that is compensated beside a spring right after a reversal.
const REVERSING_PART: f32 = 0.5;

/// Time after a reversal from which on the drag is compensated, and the time in which the compensation rises, s.
const DRAG_AFTER: Ramp = Ramp {
    from_s: 10e-3,
    rise_s: 8e-3,
};

/// Part of the large motor's tracking error that the small motor always compensates, and the part that it
/// compensates more where the drag is compensated.
const TRACKING_PART: f32 = 0.5;
const MORE_TRACKING: f32 = 0.2;

/// A weight that rises from 0 to 1, by the time since a reversal.
#[derive(Clone, Copy)]
struct Ramp {
    from_s: f64,
    rise_s: f64,
}

/// A [`Ramp`] in ticks: the weight is `per_tick age - offset`, from 0 to 1.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Weight {
    per_tick: f32,
    offset: f32,
}

impl Ramp {
    const fn at(self, period_s: f64) -> Weight {
        Weight {
            per_tick: (period_s / self.rise_s) as f32,
            offset: (self.from_s / self.rise_s) as f32,
        }
    }

    const fn end_s(self) -> f64 {
        self.from_s + self.rise_s
    }
}

impl Weight {
    #[inline]
    fn of(self, age: f32) -> f32 {
        within(self.per_tick * age - self.offset, 0.0, 1.0)
    }
}

/// What the controller compensates of the motion of the handle, in a scene that both motors render.
///
/// Each tick, with the estimated velocity ω of the handle, the time t since its sign changed and the delay
/// `τ = 2 / (2π f_t)` of the velocity loop's tracking filter:
/// ```text
/// x ← x + (1 - e^(-T/τ)) (ω - x)
/// u(t) = sat01((t - 10 ms) / 8 ms)       v(t) = sat01((t - 4 ms) / 2 ms)       s(ω) = 1 - sat(ω / 6 rad/s)⁴
/// followed = ω + (ω - x)        beside a spring: ω + u (ω - x)
/// friction = Tc sat(ω / ω_d) (1 + s) / 2        beside a spring: times (1 + v) / 2
/// drag     = u s                tracking = 0.5 + 0.2 u s        sat01(x) = max(0, min(x, 1))
/// ```
/// `followed` is the velocity that the large motor follows, rad/s: `(ω - x) / τ` is the acceleration of the
/// handle, and a large motor that leads by the delay does not lag a steady acceleration. `friction` is the torque
/// of the small motor against its friction Tc, N·m. ω_d is what 28 rad/s² reach in the delay of the
/// loop: 0.031 rad/s at 10 kHz, 0.056 rad/s at 1 kHz. `drag` and `tracking` are the parts of the coupler's torque
/// that the small motor takes as transmitted ([`ContinuousStage::update`](crate::ContinuousStage::update)).
///
/// **Right after a reversal nothing is taken off the drag.** A handle that oscillates with a half period below
/// 10 ms therefore has the whole damping of the coupler, which makes a stiff spring passive. A hand turns back
/// more seldom, so that it feels the drag for some ms only. Beside a spring the same holds for half of the friction.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Compensation {
    /// 1 - e^(-T/τ).
    gain: f32,
    friction: Coulomb,
    /// Part of the friction that is compensated right after a reversal.
    reversing: f32,
    friction_after: Weight,
    drag_after: Weight,
    /// Least weight of the lead of the large motor: 1 for a lead right after a reversal too.
    lead: f32,
    /// Ticks from a reversal until both weights are 1.
    settling: u32,
}

/// State of a [`Compensation`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CompensationState {
    /// x, the velocity of the handle a delay before, rad/s.
    before: f32,
    /// Direction of the latest motion, 1 or -1; 0 before any motion.
    direction: f32,
    /// Ticks until both weights are 1.
    unsettled: u32,
}

/// What a tick compensates.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Compensated {
    /// What the large motor follows.
    pub followed: RadPerS,
    /// Torque of the small motor against its own friction.
    pub friction: NewtonMetres,
    /// Parts of the coupler's torque that the small motor takes as transmitted.
    pub parts: CoupledParts,
}

impl Compensated {
    /// Nothing but this velocity to follow.
    #[must_use]
    pub const fn following(followed: RadPerS) -> Self {
        Self {
            followed,
            friction: NewtonMetres(0.0),
            parts: CoupledParts {
                tracking: 0.0,
                drag: 0.0,
            },
        }
    }
}

impl Compensation {
    /// For the handle of a device that moves freely, with the velocity loop of these poles at a control rate.
    #[must_use]
    pub const fn free(device: &DualStage, rate: Hertz, poles: LoopPoles) -> Self {
        let delay = 2.0 / (2.0 * PI * poles.tracking.0);
        let direction = REVERSAL * (rate.period_s() + poles.estimator_delay_s);
        let period = rate.period_s();
        Self {
            gain: (1.0 - exp(-period / delay)) as f32,
            friction: Coulomb::new(device.small.coulomb_friction, direction),
            reversing: 1.0,
            friction_after: FRICTION_AFTER.at(period),
            drag_after: DRAG_AFTER.at(period),
            lead: 1.0,
            settling: (DRAG_AFTER.end_s() / period) as u32 + 1,
        }
    }

    /// For a handle beside a spring.
    #[must_use]
    pub const fn sprung(device: &DualStage, rate: Hertz, poles: LoopPoles) -> Self {
        Self {
            reversing: REVERSING_PART,
            lead: 0.0,
            ..Self::free(device, rate, poles)
        }
    }

    /// State after a constant velocity of the handle.
    #[must_use]
    pub const fn start(&self, handle: RadPerS) -> CompensationState {
        CompensationState {
            before: handle.0,
            direction: direction(handle),
            unsettled: 0,
        }
    }

    /// One tick, with the estimated velocity of the handle.
    #[must_use]
    // As ContinuousStage::update.
    #[inline(always)]
    pub fn update(&self, state: &mut CompensationState, handle: RadPerS) -> Compensated {
        state.before += self.gain * (handle.0 - state.before);
        // At rest, at the first motion or at a reversal.
        if handle.0 * state.direction <= 0.0 {
            self.turn(state, handle);
        }
        // Most ticks are long after a reversal.
        let weights = if state.unsettled == 0 {
            Weights::SETTLED
        } else {
            self.soon(state)
        };
        let slow = slow(handle);
        let drag = weights.drag * slow;
        Compensated {
            followed: RadPerS(handle.0 + weights.lead * (handle.0 - state.before)),
            friction: NewtonMetres(
                weights.friction * self.friction.at(handle, state.direction, slow),
            ),
            parts: CoupledParts {
                tracking: TRACKING_PART + MORE_TRACKING * drag,
                drag,
            },
        }
    }

    #[cold]
    fn turn(&self, state: &mut CompensationState, handle: RadPerS) {
        let direction = direction(handle);
        if direction * state.direction < 0.0 {
            state.unsettled = self.settling;
        }
        if direction != 0.0 {
            state.direction = direction;
        }
    }

    /// The weights soon after a reversal.
    #[inline]
    fn soon(&self, state: &mut CompensationState) -> Weights {
        let age = self.settling.wrapping_sub(state.unsettled) as f32;
        state.unsettled -= 1;
        let drag = self.drag_after.of(age);
        let whole = self.friction_after.of(age);
        Weights {
            drag,
            lead: self.lead + (1.0 - self.lead) * drag,
            friction: self.reversing + (1.0 - self.reversing) * whole,
        }
    }
}

/// 1 or -1; 0 at rest.
const fn direction(handle: RadPerS) -> f32 {
    if handle.0 > 0.0 {
        1.0
    } else if handle.0 < 0.0 {
        -1.0
    } else {
        0.0
    }
}

/// Weights of drag, lead and friction, from 0 to 1.
struct Weights {
    drag: f32,
    lead: f32,
    friction: f32,
}

impl Weights {
    /// Long after a reversal.
    const SETTLED: Self = Self {
        drag: 1.0,
        lead: 1.0,
        friction: 1.0,
    };
}
