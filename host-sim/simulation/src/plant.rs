//! The dual-stage device in f64.
//!
//! ```text
//! J_L dw_L/dt = Kt_L i_L - b (w_L - w_S) - friction_L(w_L)
//! J_S dw_S/dt = Kt_S i_S + b (w_L - w_S) - friction_S(w_S) + hand torque
//! ```
//! The coupler's torque is proportional to slip velocity. Each amplifier is a first-order lag, solved
//! exactly over the step; the shafts are integrated with the midpoint rule (second order). Coulomb
//! friction stops a shaft inside the step and holds it at exactly zero velocity as long as the other
//! torques are smaller.

mod axis;
mod hand;

pub use axis::saturate;
pub use hand::{Grip, HandMotion, Pose};

use crate::device::{Device, LONGEST_STEP_S};
use axis::Axis;

/// Number of steps of at most [`LONGEST_STEP_S`] that divide a tick of `period_s` exactly.
#[must_use]
pub fn steps_per_tick(period_s: f64) -> u32 {
    // The subtrahend compensates rounding: a period of 1e-3 has 100 steps.
    (period_s / LONGEST_STEP_S - 1e-9).ceil().max(1.0) as u32
}

/// Torques on the shaft of the handle at one instant, N.m, each positive where it pushes the hand in
/// the positive direction. Their sum is [`felt`](Self::felt) up to rounding.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct HandleTorques {
    /// Torque of the small motor without its ripple, `Kt_S i_S`.
    pub motor: f64,
    /// Torque ripple of the small motor.
    pub ripple: f64,
    /// Torque of the coupler, `b (w_L - w_S)`.
    pub coupler: f64,
    /// Coulomb friction of the small motor, `-friction_S`. At rest it balances the other torques, up
    /// to its limit.
    pub friction: f64,
    /// Inertia of the handle, `-J_S dw_S/dt`.
    pub inertia: f64,
    /// Torque of the handle on the hand, [`Plant::handle_torque`].
    pub felt: f64,
}

/// State of the device and the constants of one step.
///
/// ```
/// use simulation::device::Device;
/// use simulation::plant::{Grip, Plant};
/// let mut plant = Plant::new(&Device::default().frictionless(), 10e-6);
/// plant.command(0.5, 0.0);
/// for _ in 0..30_000 {
///     plant.step(&Grip::Clamped, 0.0, 0.0);
/// }
/// let settled: f64 = 46.8e-3 * 0.5 / 0.96e-3; // Kt i / b, rad/s; torque ripple is 1.5 %
/// assert!((plant.large().omega / settled - 1.0).abs() < 0.015);
/// ```
#[derive(Clone, Debug)]
pub struct Plant {
    large: Axis,
    small: Axis,
    damping: f64,
    hand_stiffness: f64,
    hand_damping: f64,
    step: f64,
}

impl Plant {
    /// The device at rest at angle zero, without current; `step_s` is fixed, s.
    #[must_use]
    pub fn new(device: &Device, step_s: f64) -> Self {
        let lag = device.stages.amplifier_lag();
        Self {
            large: Axis::new(&device.stages.large, &device.large_ripple, lag, step_s),
            small: Axis::new(&device.stages.small, &device.small_ripple, lag, step_s),
            damping: device.stages.damping,
            hand_stiffness: device.hand.stiffness_nm_per_rad,
            hand_damping: device.hand.damping_nms_per_rad,
            step: step_s,
        }
    }

    /// Sets angle and velocity of both shafts.
    pub fn place(&mut self, large: Pose, small: Pose) {
        for (axis, pose) in [(&mut self.large, large), (&mut self.small, small)] {
            axis.angle = pose.angle;
            axis.omega = pose.omega;
        }
    }

    /// Commands both currents, A; each saturates at its limit.
    pub fn command(&mut self, large_a: f64, small_a: f64) {
        self.large.command(large_a);
        self.small.command(small_a);
    }

    /// Both commands after saturation, large then small, A.
    #[must_use]
    pub fn commands(&self) -> (f64, f64) {
        (self.large.command, self.small.command)
    }

    /// Both currents, large then small, A.
    #[must_use]
    pub fn currents(&self) -> (f64, f64) {
        (self.large.current, self.small.current)
    }

    /// Changes the coupler's damping b, N.m.s/rad.
    pub(crate) fn set_damping(&mut self, damping: f64) {
        self.damping = damping;
    }

    /// Large motor's angle and velocity.
    #[must_use]
    pub fn large(&self) -> Pose {
        pose(&self.large)
    }

    /// Small motor's (and the handle's) angle and velocity.
    #[must_use]
    pub fn small(&self) -> Pose {
        pose(&self.small)
    }

    /// Kinetic energy of both shafts, J.
    #[must_use]
    pub fn kinetic_energy(&self) -> f64 {
        let of = |axis: &Axis| 0.5 * axis.inertia * axis.omega * axis.omega;
        of(&self.large) + of(&self.small)
    }

    /// Coulomb friction of the small motor at its present angle, N.m.
    #[must_use]
    pub fn small_friction(&self) -> f64 {
        self.small.friction()
    }

    fn hand_torque(&self, intended: Pose, small: Pose) -> f64 {
        self.hand_stiffness * (intended.angle - small.angle)
            + self.hand_damping * (intended.omega - small.omega)
    }

    /// Torque of the handle on the hand, N.m, `t` seconds after the tick.
    ///
    /// It is `Kt_S i_S + b slip - J_S dw_S/dt - friction_S`, which by the second equation of motion is
    /// the negative torque of the hand. A clamp is assumed to carry no friction torque.
    #[must_use]
    pub fn handle_torque(&self, grip: &Grip, t: f64) -> f64 {
        match grip {
            Grip::Clamped => {
                self.small.torque() + self.damping * (self.large.omega - self.small.omega)
            }
            Grip::Free => 0.0,
            Grip::Hand(motion) => -self.hand_torque(motion.at(t), self.small()),
        }
    }

    /// Torques on the shaft of the handle, `t` seconds after the tick. The acceleration is that of the
    /// second equation of motion at this instant. A clamp has neither friction nor acceleration.
    #[must_use]
    pub fn handle_torques(&self, grip: &Grip, t: f64) -> HandleTorques {
        let felt = self.handle_torque(grip, t);
        let (constant, factor) = self.small.torque_factors();
        let motor = constant * self.small.current;
        let ripple = motor * (factor - 1.0);
        let coupler = self.damping * (self.large.omega - self.small.omega);
        let (friction, inertia) = match grip {
            Grip::Clamped => (0.0, 0.0),
            Grip::Free | Grip::Hand(_) => {
                let push = motor + ripple + coupler - felt;
                let coulomb = self.small.friction();
                match self.small.direction(push, coulomb) {
                    0.0 => (-push, 0.0),
                    direction => (-direction * coulomb, direction * coulomb - push),
                }
            }
        };
        HandleTorques {
            motor,
            ripple,
            coupler,
            friction,
            inertia,
            felt,
        }
    }

    /// One step that begins `t` s after the tick; `disturbance_nm` acts on the large shaft.
    #[inline]
    pub fn step(&mut self, grip: &Grip, t: f64, disturbance_nm: f64) {
        match grip {
            Grip::Clamped => self.step_clamped(disturbance_nm),
            Grip::Free => self.step_both(disturbance_nm, |_, _, _| 0.0),
            Grip::Hand(motion) => {
                let (stiffness, damping) = (self.hand_stiffness, self.hand_damping);
                self.step_both(disturbance_nm, |since, angle, omega| {
                    let intended = motion.at(t + since);
                    stiffness * (intended.angle - angle) + damping * (intended.omega - omega)
                });
            }
        }
    }

    #[inline]
    fn step_clamped(&mut self, disturbance: f64) {
        let half = 0.5 * self.step;
        self.small.drive(half);
        self.small.omega = 0.0;
        let drive = self.large.drive(half);
        let other = drive.motor + disturbance;
        let damping = self.damping;
        let push = |omega: f64| other - damping * omega;

        let start = self.large.omega;
        let direction = self.large.direction(push(start), drive.coulomb);
        let first = self
            .large
            .acceleration(push(start), direction, drive.coulomb);
        let middle = start + half * first;
        let second = self
            .large
            .acceleration(push(middle), direction, drive.coulomb);
        let end = start + self.step * second;
        self.large
            .finish(self.step, middle, end, direction, drive.coulomb, || other);
    }

    /// `hand(since, angle, omega)` is the torque of the hand on the handle, `since` seconds after the
    /// beginning of the step.
    #[inline]
    fn step_both(&mut self, disturbance: f64, hand: impl Fn(f64, f64, f64) -> f64) {
        let (step, half, damping) = (self.step, 0.5 * self.step, self.damping);
        let drive_large = self.large.drive(half);
        let drive_small = self.small.drive(half);
        let (hold_large, hold_small) = (drive_large.coulomb, drive_small.coulomb);
        let push_large =
            |large: f64, small: f64| drive_large.motor + disturbance - damping * (large - small);
        let push_small = |since: f64, angle: f64, large: f64, small: f64| {
            drive_small.motor + damping * (large - small) + hand(since, angle, small)
        };

        let (large, small, angle) = (self.large.omega, self.small.omega, self.small.angle);
        let on_large = push_large(large, small);
        let on_small = push_small(0.0, angle, large, small);
        let way_large = self.large.direction(on_large, hold_large);
        let way_small = self.small.direction(on_small, hold_small);
        let mid_large = large + half * self.large.acceleration(on_large, way_large, hold_large);
        let mid_small = small + half * self.small.acceleration(on_small, way_small, hold_small);

        let on_large = push_large(mid_large, mid_small);
        let on_small = push_small(half, angle + half * small, mid_large, mid_small);
        let end_large = large + step * self.large.acceleration(on_large, way_large, hold_large);
        let end_small = small + step * self.small.acceleration(on_small, way_small, hold_small);

        self.large
            .finish(step, mid_large, end_large, way_large, hold_large, || {
                push_large(0.0, end_small)
            });
        let end_large = self.large.omega;
        self.small
            .finish(step, mid_small, end_small, way_small, hold_small, || {
                push_small(step, angle, end_large, 0.0)
            });
    }
}

fn pose(axis: &Axis) -> Pose {
    Pose {
        angle: axis.angle,
        omega: axis.omega,
    }
}
