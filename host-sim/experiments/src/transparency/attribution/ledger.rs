//! The terms of the parasitic torque at each tick.

use estimator_core::Hertz;
use haptic_control::{
    Compensated, Compensation, CompensationState, ContinuousState, DualStage, LoopPoles,
    NewtonMetres, RadPerS, Rig, SceneKind,
};
use simulation::device::Device;
use simulation::plant::{Grip, Plant};

use super::{CAUSES, Cause};
use crate::closed_loop::TickState;

/// Bookkeeping of one closed-loop run without late ticks. It repeats the arithmetic of the large motor's
/// stage, whose state a controller keeps to itself, and follows the linear model of the velocity loop.
pub struct Ledger {
    rig: Rig,
    /// Whether the large motor renders the scene.
    continuous: bool,
    compensation: Compensation,
    /// Torque constant of the small motor, N.m/A.
    torque_constant: f64,
    /// Damping b of the coupler, N.m.s/rad.
    damping: f64,
    stage: ContinuousState,
    compensated: CompensationState,
    error: ErrorLoop,
    /// Torques that the estimation errors of the large motor and of the handle added to what the small
    /// motor was asked for at the tick before, N.m. They act at this tick.
    acting: [f64; 2],
}

/// Response of the velocity loop to the estimation error alone: the regulator without reference, and
/// the large motor without friction and ripple, whose handle is clamped. The limits of current and
/// slope apply to the difference.
struct ErrorLoop {
    stage: ContinuousState,
    motor: Plant,
    /// Steps of the motor in a tick.
    steps: u32,
}

impl ErrorLoop {
    /// Velocity at this tick, rad/s. Then the loop moves on by one tick with this estimation error.
    fn advance(&mut self, rig: &Rig, error: f64) -> f64 {
        let omega = self.motor.large().omega;
        let seen = RadPerS((error + omega) as f32);
        let still = RadPerS(0.0);
        let (stage, none) = (&rig.continuous, Compensated::following(still));
        let driven = stage.update(&mut self.stage, NewtonMetres(0.0), seen, still, &none);
        self.motor.command(f64::from(driven.current.get()), 0.0);
        for _ in 0..self.steps {
            self.motor.step(&Grip::Clamped, 0.0, 0.0);
        }
        omega
    }
}

/// Longest step of the error loop, over the time constant J/b of the large motor with the coupler. The midpoint
/// rule of the plant is off by 0.1 % of a change then, and unstable from 2 on.
const LONGEST_STEP: f64 = 0.1;

impl Ledger {
    /// The bookkeeping of `scene` on `device`, with a controller for `assumed`.
    ///
    /// # Errors
    /// One line where the loop cannot be designed.
    pub fn new(
        device: &Device,
        assumed: &DualStage,
        scene: SceneKind,
        rate_hz: f64,
        poles: LoopPoles,
    ) -> Result<Self, String> {
        let rig = Rig::new(assumed, Hertz(rate_hz), poles)
            .map_err(|error| format!("control at {rate_hz} Hz: {error}"))?;
        let needs = scene.facts().needs;
        let start = || rig.continuous.start(RadPerS(0.0));
        let compensation = if needs.free { rig.free } else { rig.sprung };
        let mut smooth = device.frictionless();
        smooth.large_ripple.torque = 0.0;
        let stages = &device.stages;
        let constants = stages.damping / stages.large.inertia / rate_hz;
        let steps = (constants / LONGEST_STEP).ceil().max(1.0);
        Ok(Self {
            continuous: needs.continuous,
            torque_constant: device.stages.small.torque_constant,
            damping: device.stages.damping,
            stage: start(),
            compensated: compensation.start(RadPerS(0.0)),
            compensation,
            error: ErrorLoop {
                stage: start(),
                motor: Plant::new(&smooth, 1.0 / rate_hz / steps),
                steps: steps as u32,
            },
            acting: [0.0; 2],
            rig,
        })
    }

    /// The terms of this tick in the order of [`Cause::ALL`], N.m. Ticks come in order.
    pub fn terms(&mut self, now: &TickState) -> [f64; CAUSES] {
        let (action, torques) = (&now.action, &now.torques);
        let error_large = f64::from(action.large_velocity.0) - now.large.omega;
        let error_handle = f64::from(action.handle_velocity.0) - now.handle.omega;
        // Torques that the errors of this tick's velocities add to what the small motor is asked for.
        let mut asked_by_error = [0.0; 2];
        let (mut coupled, mut caused) = (0.0, 0.0);
        let (mut fed, mut exact) = (0.0, 0.0);
        if self.continuous {
            let (large, handle) = (action.large_velocity, action.handle_velocity);
            let (ahead, friction) = self.compensated(handle, now.handle.omega);
            (fed, exact) = (f64::from(ahead.friction.0), friction);
            let stage = &self.rig.continuous;
            let driven = stage.update(&mut self.stage, action.torque, large, handle, &ahead);
            coupled = f64::from(driven.coupled.0);
            let measured =
                [ahead.parts.tracking, ahead.parts.drag].map(|part| self.damping * f64::from(part));
            caused = (self.damping - measured[0]) * self.error.advance(&self.rig, error_large);
            asked_by_error = [-measured[0] * error_large, measured[1] * error_handle];
        }
        let slip = torques.coupler - coupled - caused - asked_by_error[0] - asked_by_error[1];

        asked_by_error[1] += fed - exact;
        let asked = f64::from(action.torque.0) - coupled + fed;
        let [before, from_now] = now
            .small_amplifier
            .map(|current| self.torque_constant * current);
        let commanded = self.torque_constant * now.commanded.1;
        let acting = std::mem::replace(&mut self.acting, asked_by_error);
        // The command without the errors, of the tick before less that of this tick.
        let sampling =
            (before - acting[0] - acting[1]) - (from_now - asked_by_error[0] - asked_by_error[1]);
        let of = |cause| match cause {
            Cause::Inertia => torques.inertia,
            Cause::Friction => torques.friction + exact,
            Cause::Ripple => torques.ripple,
            Cause::Slip => slip,
            Cause::Estimate => caused + acting[0],
            Cause::HandleEstimate => acting[1],
            Cause::Amplifier => torques.motor - before,
            Cause::Sampling => sampling,
            Cause::Dac => from_now - commanded,
            Cause::Limits => commanded - asked,
        };
        Cause::ALL.map(of)
    }

    /// What the controller compensates, and the torque against the friction of the small motor with the true
    /// velocity of the handle, N.m.
    fn compensated(&mut self, handle: RadPerS, omega: f64) -> (Compensated, f64) {
        // With the time since the reversal that the controller knows.
        let exact = self
            .compensation
            .update(&mut { self.compensated }, RadPerS(omega as f32));
        let ahead = self.compensation.update(&mut self.compensated, handle);
        (ahead, f64::from(exact.friction.0))
    }
}
