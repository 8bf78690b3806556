//! The noise that an observer is designed for.

use crate::design::DesignError;
use crate::design::const_math::exp;

/// Noise and disturbances that an observer is designed for. SI units.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Uncertainty {
    /// Spectral density of the white torque on the motor shaft, N·m/√Hz; above 0 and below 10^6.
    pub torque_noise: f64,
    /// Standard deviation of the disturbance torque, N·m; above 0 and below 10^6. The disturbance
    /// is a torque that changes slowly and that the model does not explain.
    pub disturbance: f64,
    /// Correlation time of the disturbance torque, s; above 0 and below 10^9.
    pub disturbance_time: f64,
    /// Share of the disturbance that corrects the Coulomb friction, 0 to 1: it changes sign with the
    /// direction of motion, and holds a rotor at rest.
    pub friction_share: f64,
    /// Standard deviation of a boundary's position, counts; 1e-4 to 1e3. For a perfect disc about
    /// 1/16, which covers the rounding of the model.
    pub boundary_noise: f64,
}

impl Uncertainty {
    /// These values, if every one is in its range.
    pub(super) const fn checked(&self) -> Result<&Self, DesignError> {
        if !(self.torque_noise > 0.0 && self.torque_noise < 1e6) {
            return Err(DesignError::TORQUE_NOISE);
        }
        if !(self.disturbance > 0.0 && self.disturbance < 1e6) {
            return Err(DesignError::DISTURBANCE);
        }
        if !(self.disturbance_time > 0.0 && self.disturbance_time < 1e9) {
            return Err(DesignError::DISTURBANCE_TIME);
        }
        if !(self.friction_share >= 0.0 && self.friction_share <= 1.0) {
            return Err(DesignError::FRICTION_SHARE);
        }
        if !(self.boundary_noise >= 1e-4 && self.boundary_noise <= 1e3) {
            return Err(DesignError::BOUNDARY_NOISE);
        }
        Ok(self)
    }
}

/// An [`Uncertainty`] in counts and ticks.
#[derive(Clone, Copy)]
pub(super) struct Noise {
    /// Variance that the white torque adds to the velocity in a tick, (counts/tick)².
    pub(super) white: f64,
    /// Standard deviation of the disturbance, counts/tick².
    pub(super) load: f64,
    /// Variance that a tick adds to the disturbance, (counts/tick²)².
    pub(super) disturbance: f64,
    /// Factor by which the disturbance decays in a tick.
    pub(super) decay: f64,
    /// Standard deviation of a boundary's position, counts.
    pub(super) boundary: f64,
}

impl Noise {
    /// The noise in counts and ticks; `per_torque` is counts/tick² per N·m, `t` the period in s.
    pub(super) const fn new(
        uncertainty: &Uncertainty,
        per_torque: f64,
        t: f64,
    ) -> Result<Self, DesignError> {
        let decay = exp(-(t / uncertainty.disturbance_time).min(700.0));
        let white = per_torque * uncertainty.torque_noise;
        let disturbance = per_torque * uncertainty.disturbance;
        let noise = Self {
            white: white * white / t,
            load: disturbance,
            disturbance: disturbance * disturbance * (1.0 - decay * decay),
            decay,
            boundary: uncertainty.boundary_noise,
        };
        if !(noise.white > 0.0) {
            return Err(DesignError::TORQUE_NOISE);
        }
        if !(noise.disturbance > 0.0) {
            return Err(DesignError::DISTURBANCE);
        }
        Ok(noise)
    }
}
