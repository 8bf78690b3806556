//! What the correction of an observer is designed from.

use super::adaptation::Fixed;
use super::count_update::CountUpdate;
use super::gain_table::GainTable;
use super::inputs::{AmplifierCurrent, CoupledEncoder};
use super::motion::Motion;
use super::quantised_update::QuantisedUpdate;
use super::uncertainty::{Noise, Uncertainty};
use super::{CountObserver, Observer, QuantisedObserver};
use crate::design::DesignError;
use crate::design::const_math::{exp, phi1, phi2};
use crate::models::CoupledMotor;
use crate::models::linear::counts_per_rad;
use crate::units::Hertz;

/// Time over which the direction of motion is averaged to separate friction from the rest of the
/// disturbance, s: an innovation is the result of the motion since the last few.
const DIRECTION_TIME: f64 = 8e-3;

/// A motor with its inputs, and what its correction is designed from.
pub(super) struct Plan {
    motor: Observer<AmplifierCurrent, CoupledEncoder, (), Fixed>,
    /// b T / J.
    beta: f64,
    noise: Noise,
}

impl Plan {
    pub(super) const fn new(
        device: &CoupledMotor,
        rate: Hertz,
        uncertainty: &Uncertainty,
    ) -> Result<Self, DesignError> {
        let device = match device.checked(rate) {
            Ok(device) => device,
            Err(error) => return Err(error),
        };
        let uncertainty = match uncertainty.checked() {
            Ok(uncertainty) => uncertainty,
            Err(error) => return Err(error),
        };
        let motor = device.motor;
        let t = rate.period_s();
        let beta = motor.damping * t / motor.inertia;
        // Counts/tick² per N·m.
        let per_torque = counts_per_rad(motor.counts_per_rev) * t * t / motor.inertia;
        let noise = match Noise::new(uncertainty, per_torque, t) {
            Ok(noise) => noise,
            Err(error) => return Err(error),
        };
        let friction = per_torque * device.coulomb_friction;
        let share = if friction > 0.0 {
            uncertainty.friction_share
        } else {
            0.0
        };
        let ratio = motor.counts_per_rev as f64 / device.coupled_counts_per_rev as f64;
        let motor = Observer {
            motion: Motion {
                phi0: exp(-beta) as f32,
                phi1: phi1(beta) as f32,
                phi2: phi2(beta) as f32,
                coupling: beta as f32,
                friction: friction as f32,
            },
            current: AmplifierCurrent::new(
                per_torque * motor.torque_constant,
                device.amplifier_lag / t,
            ),
            slip: CoupledEncoder {
                ratio: ratio as f32,
            },
            correction: (),
            adaptation: Fixed,
            disturbance_decay: noise.decay as f32,
            direction_pole: exp(-(t / DIRECTION_TIME).min(700.0)) as f32,
            friction_share: share as f32,
        };
        Ok(Self { motor, beta, noise })
    }

    /// Standard deviation of the disturbance, counts/tick².
    pub(super) const fn load(&self) -> f32 {
        self.noise.load as f32
    }

    /// This motor with the correction that counts alone give.
    pub(super) const fn counts(&self) -> Result<CountObserver, DesignError> {
        match GainTable::new(self.beta, &self.noise) {
            Ok(table) => Ok(self.motor.corrected_by(CountUpdate { table })),
            Err(error) => Err(error),
        }
    }

    /// This motor with the truncated-Gaussian correction.
    pub(super) const fn quantised(&self) -> Result<QuantisedObserver, DesignError> {
        match QuantisedUpdate::new(self.beta, &self.noise) {
            Ok(correction) => Ok(self.motor.corrected_by(correction)),
            Err(error) => Err(error),
        }
    }
}

impl<C: Copy, S: Copy, M: Copy, L: Copy> Observer<C, S, M, L> {
    /// The observer of this motor with other parts.
    pub(super) const fn with_parts<D: Copy, T: Copy, N: Copy, K: Copy>(
        self,
        current: D,
        slip: T,
        correction: N,
        adaptation: K,
    ) -> Observer<D, T, N, K> {
        Observer {
            motion: self.motion,
            current,
            slip,
            correction,
            adaptation,
            disturbance_decay: self.disturbance_decay,
            direction_pole: self.direction_pole,
            friction_share: self.friction_share,
        }
    }

    /// The observer of this motor with `correction`.
    const fn corrected_by<N: Copy>(self, correction: N) -> Observer<C, S, N, L> {
        self.with_parts(self.current, self.slip, correction, self.adaptation)
    }
}
