//! Self-contained HTML pages of the experiments: figures, tables and their explanation.
//!
//! The functions turn results into text; they neither simulate nor read or write files. A figure
//! without data is left out.

use experiments::compare::Damping;
use experiments::limit;
use experiments::sensitivity as sensitivity_rows;
use scoring::score::Score;
use simulation::device::Device;

mod bars;
mod canvas;
mod causes;
mod closed_loop;
mod cost;
mod curve;
mod damping;
#[cfg(test)]
mod demo;
mod distances;
mod feel;
mod grid;
mod identify;
pub mod measured;
mod over_time;
mod overview;
mod page;
mod palette;
mod plot;
mod quantisation;
mod real;
mod recommend;
mod recording;
mod robust;
mod score_tables;
mod section;
mod sections;
mod sensitivity;
mod spectra;
mod style;
mod tables;
mod text;
mod velocity;
mod verdict;
pub mod version;
mod windows;
mod zwidth;

pub use sensitivity::sensitivity;

pub use feel::feel;

pub use identify::identify;

pub use zwidth::zwidth;

pub use real::real;

pub use recommend::recommend;

pub use page::Printout;

pub use closed_loop::ClosedLoop;

pub use robust::robust;

pub use recording::{RecordingView, recording};

/// Content of the page of a comparison.
#[derive(Clone, Debug, Default)]
pub struct ReportInput {
    /// The command line that produced the page.
    pub command: String,
    /// Name of the device: its file, or that it is the default one.
    pub device_name: String,
    /// The device that was simulated.
    pub device: Device,
    /// Remarks printed below the heading, plain text, one paragraph each.
    pub notes: Vec<String>,
    /// One entry for each scenario, rate, plant and seed; the tables have the same order.
    pub cases: Vec<CaseReport>,
    /// Errors of the particle filter.
    pub limits: Vec<limit::LimitRow>,
    /// Errors of estimators whose model has one wrong constant.
    pub parameter_errors: Vec<sensitivity_rows::SensitivityRow>,
    /// Runs of scenario `heating`, shown by their damping alone.
    pub heating: Vec<CaseReport>,
    /// Results of the closed loop, if it was run.
    pub closed_loop: ClosedLoop,
}

/// Results of one scenario at one rate on one plant.
#[derive(Clone, Debug, Default)]
pub struct CaseReport {
    /// Name of the scenario.
    pub scenario: String,
    /// Sample rate, Hz.
    pub rate_hz: f64,
    /// Whether the plant has Coulomb friction.
    pub friction: bool,
    /// Seed of the random numbers.
    pub seed: u64,
    /// One row for each estimator, in the order of the tables.
    pub rows: Vec<EstimatorRow>,
    /// The signals, if figures show this case: encoder quantisation, step response, permanent
    /// regime and spectrum.
    pub traces: Option<Traces>,
    /// True and identified damping, if the coupler heats up.
    pub damping: Option<Damping>,
}

/// The scores of one estimator in one case.
#[derive(Clone, Debug, Default)]
pub struct EstimatorRow {
    /// Name of the estimator.
    pub estimator: String,
    /// Its scores.
    pub score: Score,
    /// Instructions per update on the board, if they were measured.
    pub instructions: Option<f64>,
}

/// The signals of one case.
#[derive(Clone, Debug, Default)]
pub struct Traces {
    /// Sample rate, Hz.
    pub rate_hz: f64,
    /// True velocity, rad/s.
    pub truth: Vec<f64>,
    /// Name and velocity (rad/s) of each estimator, with as many samples as the truth.
    pub estimates: Vec<(String, Vec<f32>)>,
}

impl Traces {
    /// Time since the first sample, s.
    fn time(&self, sample: usize) -> f64 {
        sample as f64 / self.rate_hz
    }
}

/// The page of a comparison as HTML that loads no other file.
///
/// # Errors
/// If signals differ in length or have no rate, or a figure cannot be drawn.
pub fn html(report: &ReportInput) -> Result<String, String> {
    for case in &report.cases {
        let Some(traces) = &case.traces else { continue };
        let what = format!("traces of {} at {} Hz", case.scenario, case.rate_hz);
        if !(traces.rate_hz > 0.0 && traces.rate_hz.is_finite()) {
            return Err(format!("{what}: sample rate {}", traces.rate_hz));
        }
        if traces.truth.iter().any(|w| !w.is_finite()) {
            return Err(format!("{what}: the truth is not finite"));
        }
        for (name, estimate) in &traces.estimates {
            if estimate.len() != traces.truth.len() {
                let (has, needs) = (estimate.len(), traces.truth.len());
                return Err(format!("{what}: {name} has {has} samples, not {needs}"));
            }
        }
    }
    overview::page(report)
}

/// The figures of a page in order, each an SVG document.
pub fn figures(page: &str) -> impl Iterator<Item = &str> {
    page.split("<figure>")
        .skip(1)
        .filter_map(|rest| rest.split("</figure>").next())
}

#[cfg(test)]
mod tests;
