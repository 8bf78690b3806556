//! One motor: its shaft, its amplifier, its friction and its ripple.

use crate::device;
use haptic_control::Motor;
use std::f64::consts::TAU;

/// Saturates a commanded current to the limit; NaN becomes zero.
#[must_use]
pub fn saturate(current_a: f64, limit_a: f64) -> f64 {
    if current_a.is_nan() {
        0.0
    } else {
        current_a.clamp(-limit_a, limit_a)
    }
}

/// State and constants of one motor.
#[derive(Clone, Debug)]
pub(super) struct Axis {
    pub(super) angle: f64,
    pub(super) omega: f64,
    pub(super) current: f64,
    pub(super) command: f64,
    limit: f64,
    torque_constant: f64,
    coulomb: f64,
    pub(super) inertia: f64,
    per_inertia: f64,
    /// Factor by which a difference between current and command decays in a step.
    left: f64,
    /// Mean of this difference over the step, relative to its initial value.
    mean_left: f64,
    ripple: Ripple,
}

/// Torques on one shaft over a step that do not depend on its velocity, N.m.
#[derive(Clone, Copy)]
pub(super) struct Drive {
    pub(super) motor: f64,
    pub(super) coulomb: f64,
}

impl Axis {
    pub(super) fn new(motor: &Motor, ripple: &device::Ripple, lag_s: f64, step_s: f64) -> Self {
        Self {
            angle: 0.0,
            omega: 0.0,
            current: 0.0,
            command: 0.0,
            limit: motor.current_limit,
            torque_constant: motor.torque_constant,
            coulomb: motor.coulomb_friction,
            inertia: motor.inertia,
            per_inertia: 1.0 / motor.inertia,
            left: (-step_s / lag_s).exp(),
            mean_left: -(-step_s / lag_s).exp_m1() * lag_s / step_s,
            ripple: Ripple::new(motor, ripple),
        }
    }

    pub(super) fn command(&mut self, current_a: f64) {
        self.command = saturate(current_a, self.limit);
    }

    /// Advances the amplifier by a step; the shaft's torques are those in the middle of the step.
    #[inline]
    pub(super) fn drive(&mut self, half_step: f64) -> Drive {
        let missing = self.current - self.command;
        let mean = self.command + missing * self.mean_left;
        self.current = self.command + missing * self.left;
        let (friction, torque) = self.ripple.factors(self.angle + half_step * self.omega);
        Drive {
            motor: self.torque_constant * torque * mean,
            coulomb: self.coulomb * friction,
        }
    }

    /// Motor torque at this instant, N.m.
    pub(super) fn torque(&self) -> f64 {
        let (constant, factor) = self.torque_factors();
        constant * factor * self.current
    }

    /// Torque constant, N.m/A, and the factor of its ripple at this angle.
    pub(super) fn torque_factors(&self) -> (f64, f64) {
        let mut ripple = self.ripple;
        (self.torque_constant, ripple.factors(self.angle).1)
    }

    /// Coulomb friction at this angle, N.m.
    pub(super) fn friction(&self) -> f64 {
        let mut ripple = self.ripple;
        self.coulomb * ripple.factors(self.angle).0
    }

    /// Direction that friction opposes: that of the motion, at rest that of the other torques if they
    /// exceed friction, else 0.
    #[inline]
    pub(super) fn direction(&self, push: f64, coulomb: f64) -> f64 {
        if self.omega != 0.0 {
            self.omega.signum()
        } else if push.abs() <= coulomb {
            0.0
        } else {
            push.signum()
        }
    }

    #[inline]
    pub(super) fn acceleration(&self, push: f64, direction: f64, coulomb: f64) -> f64 {
        if direction == 0.0 {
            return 0.0;
        }
        (push - direction * coulomb) * self.per_inertia
    }

    /// Completes a step of the midpoint rule. If friction stopped the shaft inside the step, the shaft
    /// stays there or continues in the other direction. `push` is the torque on the shaft at rest at
    /// the end of the step.
    #[inline]
    pub(super) fn finish(
        &mut self,
        step: f64,
        mid_omega: f64,
        end_omega: f64,
        direction: f64,
        coulomb: f64,
        push: impl FnOnce() -> f64,
    ) {
        if coulomb == 0.0 || end_omega * direction >= 0.0 {
            self.angle += step * mid_omega;
            self.omega = end_omega;
            return;
        }
        let until = step * self.omega / (self.omega - end_omega);
        self.angle += 0.5 * until * self.omega;
        self.omega = 0.0;
        let push = push();
        let onward = self.direction(push, coulomb);
        let left = step - until;
        self.omega = left * self.acceleration(push, onward, coulomb);
        self.angle += 0.5 * left * self.omega;
    }
}

/// Position-dependent factors of friction (one period per revolution) and torque (several periods).
///
/// Sine and cosine are computed at an anchor. Near it a short series has an error of 2e-8 of the
/// ripple, so that most steps need no trigonometric function.
#[derive(Clone, Copy, Debug)]
struct Ripple {
    friction: f64,
    torque: f64,
    per_rev: f64,
    reach: f64,
    anchor: f64,
    once: (f64, f64),
    often: (f64, f64),
}

/// Largest angle of the series, rad of the faster ripple.
const SERIES_REACH: f64 = 0.15;

impl Ripple {
    fn new(motor: &Motor, ripple: &device::Ripple) -> Self {
        let smooth = motor.coulomb_friction * ripple.friction == 0.0 && ripple.torque == 0.0;
        Self {
            friction: ripple.friction,
            torque: ripple.torque,
            per_rev: ripple.per_rev,
            reach: if smooth {
                f64::INFINITY
            } else {
                SERIES_REACH / ripple.per_rev.max(1.0)
            },
            anchor: 0.0,
            once: (0.0, 1.0),
            often: (0.0, 1.0),
        }
    }

    #[inline]
    fn factors(&mut self, angle: f64) -> (f64, f64) {
        if self.reach == f64::INFINITY {
            return (1.0, 1.0);
        }
        let mut from = angle - self.anchor;
        if from.abs() > self.reach {
            self.anchor(angle);
            from = 0.0;
        }
        (
            1.0 + self.friction * series(self.once, from),
            1.0 + self.torque * series(self.often, from * self.per_rev),
        )
    }

    #[cold]
    fn anchor(&mut self, angle: f64) {
        self.anchor = angle;
        self.once = angle.rem_euclid(TAU).sin_cos();
        self.often = (angle * self.per_rev).rem_euclid(TAU).sin_cos();
    }
}

#[inline]
fn series((sin, cos): (f64, f64), x: f64) -> f64 {
    let h = 0.5 * x * x;
    sin * (1.0 - h * (1.0 - h * (1.0 / 6.0))) + cos * x * (1.0 - h * (1.0 / 3.0 - h * (1.0 / 30.0)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use haptic_control::DualStage;

    #[test]
    fn saturation_limits_and_turns_nan_to_zero() {
        assert_eq!(saturate(7.0, 6.0), 6.0);
        assert_eq!(saturate(f64::NEG_INFINITY, 6.0), -6.0);
        assert_eq!(saturate(-0.25, 6.0), -0.25);
        assert_eq!(saturate(f64::NAN, 6.0), 0.0);
    }

    #[test]
    fn series_agrees_with_the_sines() {
        let exact = device::Ripple::default();
        let mut ripple = Ripple::new(&DualStage::DEFAULT.large, &exact);
        let (mut worst_friction, mut worst_torque) = (0.0_f64, 0.0_f64);
        for k in -40_000..40_000 {
            let angle = f64::from(k) * 3.7e-4;
            let (friction, torque) = ripple.factors(angle);
            let sine = 1.0 + exact.friction * angle.sin();
            worst_friction = worst_friction.max((friction - sine).abs());
            let sine = 1.0 + exact.torque * (exact.per_rev * angle).sin();
            worst_torque = worst_torque.max((torque - sine).abs());
        }
        assert!(worst_friction < 1e-12, "{worst_friction:e}");
        assert!(worst_torque < 3e-10, "{worst_torque:e}");
    }
}
