//! Constructors of observers, which compute their gains at compile time.

use super::Observer;
use super::adaptation::Fixed;
use super::adaptive::Adaptive;
use super::count_update::CountUpdate;
use super::edge_update::EdgeUpdate;
use super::gain::Gain;
use super::gain_table::GainTable;
use super::inputs::{AmplifierCurrent, CoupledEncoder, HeldShaft, NoCurrent};
use super::motion::Motion;
use super::quantised_update::QuantisedUpdate;
use super::uncertainty::{Noise, Uncertainty};
use crate::design::DesignError;
use crate::design::const_math::{exp, phi1, phi2};
use crate::models::{CoupledMotor, MotorModel};
use crate::units::Hertz;

/// Time over which the direction of motion is averaged to separate friction from the rest of the
/// disturbance, s: an innovation is the result of the motion since the last few.
const DIRECTION_TIME: f64 = 8e-3;

/// A motor with its inputs, and what its correction is designed from.
struct Plan {
    motor: Observer<AmplifierCurrent, CoupledEncoder, (), Fixed>,
    /// b T / J.
    beta: f64,
    noise: Noise,
}

impl Plan {
    const fn new(
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
        let per_torque =
            motor.counts_per_rev as f64 / (2.0 * core::f64::consts::PI) * t * t / motor.inertia;
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

    /// The observer of this motor with `correction`.
    const fn corrected_by<M: Copy>(
        self,
        correction: M,
    ) -> Observer<AmplifierCurrent, CoupledEncoder, M, Fixed> {
        let motor = self.motor;
        motor.with_parts(motor.current, motor.slip, correction, motor.adaptation)
    }
}

impl Observer<AmplifierCurrent, CoupledEncoder, CountUpdate, Fixed> {
    /// An observer of counts, current and coupled shaft, for a device without edge time stamps.
    ///
    /// # Errors
    /// The constant of [`DesignError`] for the rate, for the constant of `device` or for the value of
    /// `uncertainty` that is out of its range; [`DesignError::NOT_CONVERGED`] and
    /// [`DesignError::NOT_STABLE`] for any row of the gain table.
    pub const fn new(
        device: &CoupledMotor,
        rate: Hertz,
        uncertainty: &Uncertainty,
    ) -> Result<Self, DesignError> {
        let plan = match Plan::new(device, rate, uncertainty) {
            Ok(plan) => plan,
            Err(error) => return Err(error),
        };
        match GainTable::new(plan.beta, &plan.noise) {
            Ok(table) => Ok(plan.corrected_by(CountUpdate { table })),
            Err(error) => Err(error),
        }
    }

    /// The gain of a correction that comes `ticks` ticks after the last.
    #[must_use]
    pub fn gain(&self, ticks: usize) -> Gain {
        *self.correction.table.gain(ticks as f32)
    }
}

impl Observer<AmplifierCurrent, CoupledEncoder, QuantisedUpdate, Fixed> {
    /// An observer of counts, current and coupled shaft that also uses a count while the prediction
    /// agrees with it: see [`QuantisedUpdate`].
    ///
    /// # Errors
    /// The errors of [`Observer::new`]; [`DesignError::TORQUE_NOISE_FOR_QUANTISED`] if the white
    /// torque alone spreads the velocity in a tick by less than 1e-9 or more than 512 counts/tick.
    pub const fn quantised(
        device: &CoupledMotor,
        rate: Hertz,
        uncertainty: &Uncertainty,
    ) -> Result<Self, DesignError> {
        let plan = match Plan::new(device, rate, uncertainty) {
            Ok(plan) => plan,
            Err(error) => return Err(error),
        };
        match QuantisedUpdate::new(plan.beta, &plan.noise) {
            Ok(correction) => Ok(plan.corrected_by(correction)),
            Err(error) => Err(error),
        }
    }
}

impl<C: Copy, S: Copy, M: Copy, L: Copy> Observer<C, S, M, L> {
    /// The observer of this motor with other parts.
    const fn with_parts<D: Copy, T: Copy, N: Copy, K: Copy>(
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
}

impl<M: Copy, L: Copy> Observer<AmplifierCurrent, CoupledEncoder, M, L> {
    /// This observer for a device without an encoder on the coupled shaft: the coupled shaft is
    /// assumed to be at rest.
    #[must_use]
    pub const fn held(self) -> Observer<AmplifierCurrent, HeldShaft, M, L> {
        self.with_parts(self.current, HeldShaft, self.correction, self.adaptation)
    }
}

impl Observer<NoCurrent, HeldShaft, EdgeUpdate, Fixed> {
    /// An observer of edges alone, stamped by a clock of frequency `clock`, for a device that
    /// measures neither current nor coupled shaft.
    ///
    /// Without the current, damping and friction cannot be predicted. They become part of the
    /// disturbance, which must be large for that. Counts alone correct too rarely for this; use
    /// [`KalmanTriple`](crate::KalmanTriple) with them.
    ///
    /// # Errors
    /// The errors of [`Observer::new`] and [`Observer::with_edges`].
    pub const fn blind(
        device: &CoupledMotor,
        rate: Hertz,
        clock: Hertz,
        uncertainty: &Uncertainty,
    ) -> Result<Self, DesignError> {
        let unknown = CoupledMotor {
            motor: MotorModel {
                damping: 0.0,
                ..device.motor
            },
            coulomb_friction: 0.0,
            ..*device
        };
        let known = match Observer::new(&unknown, rate, uncertainty) {
            Ok(known) => known,
            Err(error) => return Err(error),
        };
        match EdgeUpdate::new(clock, rate, known.correction) {
            Ok(edges) => {
                // No friction of the model could wrongly hold the rotor inside its interval.
                let edges = EdgeUpdate {
                    unstamped: 0.0,
                    ..edges
                };
                Ok(known.with_parts(NoCurrent, HeldShaft, edges, Fixed))
            }
            Err(error) => Err(error),
        }
    }
}

impl<C: Copy, S: Copy, L: Copy> Observer<C, S, CountUpdate, L> {
    /// This observer with edge time stamps by a clock of frequency `clock`. `rate` is the rate that
    /// the observer was designed for.
    ///
    /// # Errors
    /// [`DesignError::RATE`], [`DesignError::CLOCK`].
    pub const fn with_edges(
        self,
        clock: Hertz,
        rate: Hertz,
    ) -> Result<Observer<C, S, EdgeUpdate, L>, DesignError> {
        match EdgeUpdate::new(clock, rate, self.correction) {
            Ok(edges) => Ok(self.with_parts(self.current, self.slip, edges, self.adaptation)),
            Err(error) => Err(error),
        }
    }
}

impl<C: Copy, S: Copy, M: Copy> Observer<C, S, M, Fixed> {
    /// This observer with adaptation of damping, friction and torque constant per inertia.
    ///
    /// `rate` is the rate that the observer was designed for. `counts_per_rev` converts the velocity
    /// below which the parameters stay, 0.5 rad/s.
    ///
    /// # Errors
    /// [`DesignError::RATE`], [`DesignError::COUNTS_PER_REV`].
    pub const fn adaptive(
        self,
        counts_per_rev: u32,
        rate: Hertz,
    ) -> Result<Observer<C, S, M, Adaptive>, DesignError> {
        let adaptation = match Adaptive::new(counts_per_rev, rate) {
            Ok(adaptation) => adaptation,
            Err(error) => return Err(error),
        };
        Ok(self.with_parts(self.current, self.slip, self.correction, adaptation))
    }
}
