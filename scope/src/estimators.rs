//! The estimators of the catalogue on the samples of a board, sample by sample.

use catalogue::estimators::{Kind, Setup, State};
use catalogue::parameters::{Parameters, PlantKind};
use estimator_core::{Amps, Count, Sample, Scale, VelocityEstimator as _};
use scoring::evaluation::Evaluation;
use simulation::device::Device;
use terminal::failure::Failure;

/// The estimators that need no stamped edges, with their states.
pub(crate) struct Estimators {
    evaluation: Evaluation,
    scale: Scale,
    states: Vec<State>,
    /// Current that was commanded at the sample before, A.
    current: Option<f32>,
}

/// What the estimators read at a telemetry frame.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Reading {
    pub(crate) counts_large: u32,
    pub(crate) counts_small: u32,
    /// Current of the large motor that is commanded from this sample on, A.
    pub(crate) current: f32,
}

impl Estimators {
    /// The kinds of estimators that run.
    pub(crate) fn kinds() -> Vec<&'static Kind> {
        Kind::all().iter().filter(|kind| !kind.needs.edge).collect()
    }

    /// Their names.
    pub(crate) fn names() -> Vec<&'static str> {
        Self::kinds().iter().map(|kind| kind.name).collect()
    }

    /// The estimators for a device, with `rate_hz` samples a second.
    ///
    /// # Errors
    /// [`Failure::Input`] if one cannot be built.
    pub(crate) fn new(device: &Device, rate_hz: f64) -> Result<Self, Failure> {
        let setup = Setup::of(device, rate_hz);
        let failed = |error: estimator_core::DesignError| Failure::Input(error.to_string());
        Ok(Self {
            evaluation: Evaluation::new(
                &Self::kinds(),
                &Parameters::default(),
                &setup,
                PlantKind::Friction,
            )?,
            scale: Scale::new(setup.stages.large.counts_per_rev, setup.rate).map_err(failed)?,
            states: Vec::new(),
            current: None,
        })
    }

    /// Starts all estimators again at the next sample, as a replay does at its first row.
    pub(crate) fn restart(&mut self) {
        self.states.clear();
        self.current = None;
    }

    /// The velocity of each estimator at the next sample, rad/s: zero at the first one.
    pub(crate) fn next(&mut self, reading: &Reading) -> Vec<f64> {
        let mut sample =
            Sample::new(Count(reading.counts_large)).with_coupled(Count(reading.counts_small));
        if let Some(before) = self.current.replace(reading.current) {
            sample = sample.with_current(Amps::new(before));
        }
        let candidates = self.evaluation.candidates();
        if self.states.is_empty() {
            let started = candidates
                .iter()
                .map(|each| each.estimator().start(&sample));
            self.states = started.collect();
            return vec![0.0; candidates.len()];
        }
        let each = candidates.iter().zip(&mut self.states);
        let velocity = |(candidate, state): (&scoring::evaluation::Candidate, &mut State)| {
            let velocity = candidate.estimator().update(state, &sample);
            f64::from(velocity.rad_per_s(&self.scale))
        };
        each.map(velocity).collect()
    }
}
