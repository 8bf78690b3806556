use estimator_core::Skip;

use super::environment::is_gain;
use super::{Handle, Scene};
use crate::design_error::DesignError;
use crate::need::Wanted;
use crate::tuning::parameters;
use crate::units::{NewtonMetres, RadPerS, Radians};

/// Coulomb friction: a constant torque T against the motion, with a linear transition of slope B
/// around zero velocity, `torque = -max(-T, min(B ω, T))`.
///
/// T in N·m, B in N·m·s/rad, both at least zero. The transition ends at the velocity `T / B`. Below
/// it the scene is a [`Viscous`](super::Viscous) field of damping B, so B has the bound of a
/// damping. There is no stiction: a constant torque below T moves the handle at its ratio to B.
///
/// ```
/// use haptic_control::{Friction, Handle, RadPerS, Radians, Scene};
/// let friction = Friction::new(4e-3, 2e-3)?;
/// let torque = |omega| {
///     let handle = Handle { angle: Radians(0.0), velocity: RadPerS(omega), acceleration: () };
///     friction.torque(&mut (), &handle).0
/// };
/// assert_eq!((torque(1.0), torque(10.0), torque(-10.0)), (-2e-3, -4e-3, 4e-3));
/// # Ok::<(), haptic_control::DesignError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Friction {
    torque: f32,
    damping: f32,
}

impl Friction {
    /// A friction of at most `torque`, with this damping around zero velocity.
    ///
    /// # Errors
    /// [`DesignError::Scene`] unless both are finite and at least zero.
    pub const fn new(torque: f32, damping: f32) -> Result<Self, DesignError> {
        if is_gain(torque) && is_gain(damping) {
            Ok(Self { torque, damping })
        } else {
            Err(DesignError::Scene)
        }
    }
}

parameters! { Friction, |friction, bounds, rate| {
    "torque" torque: Amplitude = friction.torque;
    "damping" damping: Damping = friction.damping;
} => Self::new(torque, damping) }

impl Scene for Friction {
    type Velocity = Wanted;
    type Acceleration = Skip;
    type Continuous = Wanted;
    type Transient = Wanted;
    type State = ();
    const FREE: bool = true;

    fn start(&self, _: Radians) {}

    fn torque(&self, (): &mut (), handle: &Handle<RadPerS>) -> NewtonMetres {
        let viscous = self.damping * handle.velocity.0;
        let friction = if viscous > self.torque {
            self.torque
        } else if viscous < -self.torque {
            -self.torque
        } else {
            viscous
        };
        NewtonMetres(-friction)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn torque(scene: &Friction, omega: f32) -> f64 {
        let handle = Handle {
            angle: Radians(0.7),
            velocity: RadPerS(omega),
            acceleration: (),
        };
        f64::from(scene.torque(&mut (), &handle).0)
    }

    /// The references, in f64, are Coulomb's law beyond the transition and a damper inside it.
    #[test]
    fn torque_is_coulomb_friction_beyond_the_transition_and_viscous_inside() {
        for (most, damping) in [(4e-3, 3e-3), (8e-3, 0.5e-3), (1e-3, 5e-3)] {
            let scene = Friction::new(most, damping).unwrap();
            let transition = f64::from(most) / f64::from(damping);
            for k in -400..=400_i16 {
                let omega = f32::from(k) * 0.0625;
                let speed = f64::from(omega).abs();
                let wanted = if speed < transition {
                    -f64::from(damping) * f64::from(omega)
                } else {
                    -f64::from(most) * f64::from(omega).signum()
                };
                let error = (torque(&scene, omega) - wanted).abs();
                assert!(error <= 1e-6 * f64::from(most), "{omega}: {error}");
            }
        }
    }

    /// The scene is passive: its power is negative at every velocity. The magnitude of its power is
    /// at most that of its damping.
    #[test]
    fn friction_dissipates_power_with_a_slope_of_at_most_the_damping() {
        let scene = Friction::new(4e-3, 3e-3).unwrap();
        for k in -4000..4000_i16 {
            let [omega, next] = [k, k + 1].map(|k| f32::from(k) * 1e-3);
            assert!(torque(&scene, omega) * f64::from(omega) <= 0.0, "{omega}");
            let slope = (torque(&scene, next) - torque(&scene, omega)) / f64::from(next - omega);
            assert!((-3.001e-3..=0.0).contains(&slope), "{omega}: {slope}");
        }
    }

    #[test]
    fn zero_friction_or_zero_damping_gives_zero_torque() {
        for (most, damping) in [(0.0, 3e-3), (4e-3, 0.0)] {
            let scene = Friction::new(most, damping).unwrap();
            for omega in [-1e6, -1.0, 0.0, 1.0, 1e6] {
                assert_eq!(torque(&scene, omega), 0.0, "{omega}");
            }
        }
    }

    #[test]
    fn parameters_that_are_not_finite_or_negative_are_refused() {
        for bad in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY, -1e-9] {
            assert_eq!(Friction::new(bad, 1e-3), Err(DesignError::Scene));
            assert_eq!(Friction::new(1e-3, bad), Err(DesignError::Scene));
        }
    }
}
