//! What `limpid_NAME_design` has in common.

use core::mem::MaybeUninit;

use estimator_catalogue::{Parameter, Row};
use estimator_core::{CoupledMotor, DesignError, MotorModel};

/// What an estimator is designed for. An estimator without a model of the device reads `counts_per_rev`
/// and `rate_hz` alone; one without edges does not read `edge_clock_hz`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct limpid_setup_t {
    /// Counts per revolution of the encoder, four per line.
    pub counts_per_rev: u32,
    /// Counts per revolution of the coupled shaft's encoder.
    pub coupled_counts_per_rev: u32,
    /// Control rate, Hz.
    pub rate_hz: f64,
    /// Rate of the clock that stamps edges, Hz.
    pub edge_clock_hz: f64,
    /// Inertia of rotor and load, kg m^2.
    pub inertia: f64,
    /// Viscous damping, N m s/rad: that of the coupling.
    pub damping: f64,
    /// Torque constant, N m/A.
    pub torque_constant: f64,
    /// Coulomb friction, N m.
    pub coulomb_friction: f64,
    /// Time constant of the amplifier, s.
    pub amplifier_lag: f64,
}

impl limpid_setup_t {
    pub(crate) const fn motor(&self) -> CoupledMotor {
        CoupledMotor {
            motor: MotorModel {
                counts_per_rev: self.counts_per_rev,
                inertia: self.inertia,
                damping: self.damping,
                torque_constant: self.torque_constant,
            },
            coulomb_friction: self.coulomb_friction,
            amplifier_lag: self.amplifier_lag,
            coupled_counts_per_rev: self.coupled_counts_per_rev,
        }
    }
}

/// Status of a parameter outside the range that its row gives: see `limpid_status_text`.
const OUT_OF_RANGE: i32 = 1;

/// Status of the first error of [`DesignError::ALL`].
const FIRST_ERROR: i32 = 2;

impl limpid_setup_t {
    /// Whether encoder and rate can scale a velocity, also where the design does not read them.
    fn checked(&self) -> Result<(), DesignError> {
        match self.rate_hz > 0.0 && self.rate_hz.is_finite() {
            false => Err(DesignError::RATE),
            true if self.counts_per_rev == 0 => Err(DesignError::COUNTS_PER_REV),
            true => Ok(()),
        }
    }
}

/// Writes the design if every parameter is in its range and the design is possible for `setup`. Otherwise
/// `into` is not written.
pub(crate) fn write<E>(
    into: &mut MaybeUninit<E>,
    setup: &limpid_setup_t,
    row: &Row,
    values: &[f64],
    design: impl FnOnce() -> Result<E, DesignError>,
) -> i32 {
    let accepted = |(parameter, value): (&Parameter, &f64)| parameter.accepts(*value);
    if !row.parameters.iter().zip(values).all(accepted) {
        return OUT_OF_RANGE;
    }
    // An error of the design says more of a rate.
    match design().and_then(|design| setup.checked().map(|()| design)) {
        Ok(design) => {
            into.write(design);
            0
        }
        Err(error) => {
            let position = DesignError::ALL.iter().position(|one| *one == error);
            FIRST_ERROR + position.map_or(i32::MAX - FIRST_ERROR, |k| k as i32)
        }
    }
}
