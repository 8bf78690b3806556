//! Every estimator by name, with its parameters.

mod build;
mod erased;
mod initialiser;
mod paste;
mod run;

use std::ops::Deref;

use device_files::device::COUNTS_PER_REV;
use device_files::presets::check_value;
use estimator_catalogue::{ROWS, Row};
use estimator_core::Hertz;
use haptic_control::DualStage;

pub use estimator_catalogue::{Parameter, Search};

pub use erased::{Estimator, Reports, State};
pub use run::sample;

use run::available;
use simulation::trace::Trace;

use crate::parameters::{Parameters, PlantKind};
use terminal::failure::Failure;
use terminal::wording::unknown;

/// Name of the estimator whose errors are the 100 % of the scores.
pub const DIFFERENCE: &str = "finite-difference";

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

/// The device and the control rate for which estimators are built.
#[derive(Clone, Copy, Debug)]
pub struct Setup {
    /// Control rate.
    pub rate: Hertz,
    /// The device constants that the estimators assume.
    pub stages: DualStage,
}

/// The default device at 1 kHz.
impl Default for Setup {
    fn default() -> Self {
        Self::of(&simulation::device::Device::default(), 1e3)
    }
}

impl Setup {
    /// The constants of a simulated device.
    #[must_use]
    pub fn of(device: &simulation::device::Device, rate_hz: f64) -> Self {
        Self {
            rate: Hertz(rate_hz),
            stages: device.stages,
        }
    }

    /// The same setup without friction of the large motor.
    #[must_use]
    pub fn frictionless(mut self) -> Self {
        self.stages.large.coulomb_friction = 0.0;
        self
    }
}

/// What a trace lacks for an estimator.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Lack {
    /// A column of a recording.
    Column(&'static str),
    /// A constant period.
    ConstantPeriod,
}

/// Values of a kind's parameters, in the order of its row.
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

    /// Whether the estimator gives an acceleration, as [`Estimator::gives_acceleration`] for the
    /// default parameters. No parameter changes this.
    #[must_use]
    pub fn gives_acceleration(&self) -> bool {
        let setup = Setup::default();
        let values = Parameters::default().values(self, &setup, PlantKind::Friction);
        self.build(&setup, &values)
            .is_ok_and(|estimator| estimator.gives_acceleration())
    }

    /// Reason why the estimator cannot run on `trace`; `None` if it can.
    #[must_use]
    pub fn lack(&self, trace: &Trace) -> Option<Lack> {
        let (needs, has) = (self.needs, available(trace));
        if !needs.within(has) {
            return Some(Lack::Column(match needs {
                needs if needs.current && !has.current => "current",
                needs if needs.coupled && !has.coupled => "counts_small",
                _ => "edge_tick",
            }));
        }
        (trace.periods.is_some() && !self.varying_period).then_some(Lack::ConstantPeriod)
    }

    /// Whether the estimator is an observer, with a disturbance torque and a mechanical model.
    #[must_use]
    pub fn is_observer(&self) -> bool {
        self.parameters.iter().any(Parameter::is_torque)
    }

    /// Whether the estimator has a parameter that `tune` searches.
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
            let remedy = match self.coarser(setup, values) {
                None => String::new(),
                Some(counts) => format!(
                    "; {}, or take another estimator, as imm",
                    fewer_counts(setup, counts)
                ),
            };
            Failure::Input(format!(
                "{} at {} Hz: {error}{remedy}",
                self.name, setup.rate.0
            ))
        })
    }

    /// Why a design of these values, which are within their ranges, is refused; `None` if it is not.
    #[must_use]
    pub fn refusal(&self, setup: &Setup, values: &Values) -> Option<String> {
        let error = (self.build)(setup, values).err()?;
        Some(format!("at {} Hz: {error}", setup.rate.0))
    }

    /// The most counts per revolution, by a power of two fewer than those of the device, with which these values give
    /// an estimator; `None` if none do.
    #[must_use]
    pub fn coarser(&self, setup: &Setup, values: &Values) -> Option<u32> {
        let counts = setup.stages.large.counts_per_rev;
        let fewer = (1..u32::BITS).map(|k| counts >> k);
        let mut fewer = fewer.take_while(|counts| COUNTS_PER_REV.contains(counts));
        fewer.find(|&counts| {
            let mut coarse = *setup;
            coarse.stages.large.counts_per_rev = counts;
            (self.build)(&coarse, values).is_ok()
        })
    }
}

/// What a user does where `counts` per revolution are the most that a design for `setup` admits.
#[must_use]
pub fn fewer_counts(setup: &Setup, counts: u32) -> String {
    format!(
        "with {counts} counts/rev it is possible, for a log by host-sim coarsen --fine-counts-per-rev {} \
         --counts-per-rev {counts} --rate {}",
        setup.stages.large.counts_per_rev, setup.rate.0
    )
}

/// Whether `value` is in the range of a parameter of the estimator `kind`.
///
/// # Errors
/// [`Failure::Input`] that names the parameter and its range.
pub fn check(parameter: &Parameter, kind: &str, value: f64) -> Result<(), Failure> {
    check_value(parameter, kind, value).map_err(Failure::Input)
}
