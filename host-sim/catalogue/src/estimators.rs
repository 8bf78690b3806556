//! Every estimator by name, with its parameters.

mod build;
mod erased;
mod run;

use std::ops::Deref;

use estimator_catalogue::{ROWS, Row};
use estimator_core::{CoupledMotor, Device, Hertz};

pub use estimator_catalogue::{Parameter, Search};

pub use erased::{Estimator, State};
pub use run::{available, sample};

use crate::parameters::{Parameters, PlantKind};
use terminal::failure::Failure;
use terminal::wording::{decimal, unknown};

/// An estimator that can be built: its row of the catalogue, with its builder.
///
/// The facts of the row are fields of the kind: `kind.name`, `kind.parameters`.
#[derive(Clone, Copy, Debug)]
pub struct Kind {
    row: &'static Row,
    build: build::Build,
}

impl Deref for Kind {
    type Target = Row;

    fn deref(&self) -> &Row {
        self.row
    }
}

/// What every estimator is built for.
#[derive(Clone, Copy, Debug)]
pub struct Setup {
    /// Control rate.
    pub rate: Hertz,
    /// The large motor as the estimators believe it to be.
    pub device: Device,
    /// Its Coulomb friction, N.m.
    pub friction_nm: f64,
    /// Time constant of its amplifier, s.
    pub amplifier_lag_s: f64,
    /// Counts per revolution of the small encoder.
    pub small_counts_per_rev: u32,
}

/// The default device at 1 kHz.
impl Default for Setup {
    fn default() -> Self {
        Self::of(&simulation::device::Device::default(), 1e3)
    }
}

impl Setup {
    /// The constants of a simulated device that its estimators are designed for: those of the large
    /// motor, of its encoder and amplifier, and of the coupler.
    #[must_use]
    pub fn of(device: &simulation::device::Device, rate_hz: f64) -> Self {
        Self {
            rate: Hertz(rate_hz),
            device: Device {
                counts_per_rev: device.large.counts_per_rev,
                inertia: device.large.inertia_kg_m2,
                damping: device.coupler.damping_nms_per_rad,
                torque_constant: device.large.torque_constant_nm_per_a,
            },
            friction_nm: device.large.coulomb_nm,
            amplifier_lag_s: 1.0 / (std::f64::consts::TAU * device.amplifier.bandwidth_hz),
            small_counts_per_rev: device.small.counts_per_rev,
        }
    }

    /// All that the estimators believe of the device.
    #[must_use]
    pub fn stages(&self) -> CoupledMotor {
        CoupledMotor {
            large: self.device,
            coulomb_friction: self.friction_nm,
            amplifier_lag: self.amplifier_lag_s,
            small_counts_per_rev: self.small_counts_per_rev,
        }
    }

    /// The same without friction.
    #[must_use]
    pub fn frictionless(self) -> Self {
        Self {
            friction_nm: 0.0,
            ..self
        }
    }
}

/// Values of a kind's parameters, in the order of [`Kind::parameters`].
pub type Values = Vec<f64>;

impl Kind {
    /// All kinds, in the order in which they are shown.
    #[must_use]
    pub fn all() -> &'static [Self] {
        static ALL: [Kind; ROWS.len()] = {
            let mut all = [Kind {
                row: &ROWS[0],
                build: build::BUILDERS[0],
            }; ROWS.len()];
            let mut i = 0;
            while i < all.len() {
                all[i] = Kind {
                    row: &ROWS[i],
                    build: build::BUILDERS[i],
                };
                i += 1;
            }
            all
        };
        &ALL
    }

    /// The kind called `name`.
    ///
    /// # Errors
    /// [`Failure::Input`] that lists the names there are.
    pub fn named(name: &str) -> Result<&'static Self, Failure> {
        Self::all()
            .iter()
            .find(|kind| kind.name == name)
            .ok_or_else(|| {
                let names = Self::all().iter().map(|kind| kind.name);
                Failure::Input(unknown("estimator", name, names))
            })
    }

    /// Whether its model has an acceleration, as [`Estimator::gives_acceleration`] says of one with
    /// the usual parameters: no parameter changes that.
    #[must_use]
    pub fn gives_acceleration(&self) -> bool {
        let setup = Setup::default();
        let values = Parameters::default().values(self, &setup, PlantKind::Friction);
        self.build(&setup, &values)
            .is_ok_and(|estimator| estimator.gives_acceleration())
    }

    /// Whether it is an observer: it has a disturbance torque, and with it a mechanical model.
    #[must_use]
    pub fn is_observer(&self) -> bool {
        self.parameters.iter().any(Parameter::is_torque)
    }

    /// Whether `tune` has anything to look for.
    #[must_use]
    pub fn is_tunable(&self) -> bool {
        self.parameters
            .iter()
            .any(|p| !matches!(p.search, Search::Fixed(_)))
    }

    /// Index of the parameter called `name`.
    ///
    /// # Errors
    /// [`Failure::Input`] that lists the parameters there are.
    pub fn parameter(&self, name: &str) -> Result<usize, Failure> {
        let found = self.parameters.iter().position(|p| p.name == name);
        found.ok_or_else(|| {
            if self.parameters.is_empty() {
                return Failure::Input(format!(
                    "{} has no parameter '{name}': it has none at all",
                    self.name
                ));
            }
            let names = self.parameters.iter().map(|p| p.name);
            Failure::Input(format!(
                "{} has {}",
                self.name,
                unknown("parameter", name, names)
            ))
        })
    }

    /// The estimator with these parameter values.
    ///
    /// # Errors
    /// [`Failure::Input`] that names the parameter or the reason of a refused design.
    pub fn build(&self, setup: &Setup, values: &Values) -> Result<Estimator, Failure> {
        for (parameter, &value) in self.parameters.iter().zip(values) {
            check(parameter, self.name, value)?;
        }
        (self.build)(setup, values).map_err(|error| {
            Failure::Input(format!("{} at {} Hz: {error}", self.name, setup.rate.0))
        })
    }
}

/// Whether `value` is in the range of a parameter of the estimator `kind`.
///
/// # Errors
/// [`Failure::Input`] that names the parameter and its range.
pub fn check(parameter: &Parameter, kind: &str, value: f64) -> Result<(), Failure> {
    let whole = !parameter.whole || value.fract() == 0.0;
    if (parameter.lowest..=parameter.highest).contains(&value) && whole {
        return Ok(());
    }
    let number = if parameter.whole {
        "a whole number"
    } else {
        "a number"
    };
    Err(Failure::Input(format!(
        "{kind}.{} = {}: must be {number} from {} to {}{}{}",
        parameter.name,
        decimal(value),
        decimal(parameter.lowest),
        decimal(parameter.highest),
        if parameter.unit.is_empty() { "" } else { " " },
        parameter.unit,
    )))
}
