//! What can be said on the command line.

use std::path::{Path, PathBuf};

use clap::{Args, Parser, Subcommand};

use catalogue::estimators::Kind;
use catalogue::parameters::Parameters;
use simulation::device::Device;
use simulation::scenario::ScenarioName;
use terminal::failure::Failure;

/// Velocity estimation for a dual-stage haptic device, simulated and scored.
///
/// Without a command: compare, with everything at its default.
#[derive(Debug, Parser)]
#[command(name = "host-sim", version = report::version::VERSION)]
pub(super) struct Arguments {
    #[command(subcommand)]
    pub(super) command: Option<Command>,
}

#[derive(Debug, Subcommand)]
pub(super) enum Command {
    /// Simulate the device, run the estimators on it, print scores and write a report
    Compare(super::compare::Compare),
    /// Run a recording through the estimators
    Replay(super::replay::Replay),
    /// Turn the firmware's telemetry into a recording
    Record(super::record::Record),
    /// Draw a recording
    Plot(super::plot::Plot),
    /// Fit the device to recordings of an excitation and write it as a device file
    Identify(super::identify::Identify),
    /// Simulate a scene or a scenario and write it as a recording
    Simulate(super::simulate::Simulate),
    /// Search the estimators' parameters on tuning seeds and write them to a file
    Tune(super::tune::Tune),
    /// Run estimators that believe in wrong constants of the device, and say what it costs them
    Sensitivity(super::sensitivity::Sensitivity),
    /// Say how well velocity can be known at all, by a particle filter with the true model
    Limit(super::limit::Limit),
    /// Find the stiffest wall and the strongest damping that stay passive and free of limit cycles
    Zwidth(super::zwidth::Zwidth),
    /// Close the loop on devices that differ from what the controller believes, and judge each run
    Robust(super::robust::Robust),
    /// Join the shards of a robust run
    Merge(super::robust::Merge),
    /// List the estimators and their parameters
    Estimators,
    /// List the scenarios
    Scenarios,
    /// Print the device as TOML: the default one, or a checked file with all its values
    Device(DeviceFile),
}

#[derive(Clone, Debug, Default, Args)]
pub(super) struct DeviceFile {
    /// Device file; what it leaves out keeps its default [see host-sim device]
    #[arg(long, value_name = "FILE.toml")]
    device: Option<PathBuf>,
}

#[derive(Clone, Debug, Default, Args)]
pub(super) struct ParameterOptions {
    /// Parameters tuned by host-sim tune, over the shipped ones
    #[arg(long, value_name = "FILE.toml")]
    presets: Option<PathBuf>,
    /// Set a parameter, over everything else; repeatable
    #[arg(long = "set", value_name = "NAME.PARAM=VALUE")]
    set: Vec<String>,
}

impl DeviceFile {
    /// The file's text, or none.
    pub(super) fn text(&self) -> Result<String, Failure> {
        let Some(path) = &self.device else {
            return Ok(String::new());
        };
        std::fs::read_to_string(path)
            .map_err(|error| Failure::Input(format!("{}: cannot read: {error}", path.display())))
    }

    /// The device of the file, or the default one.
    pub(super) fn load(&self) -> Result<Device, Failure> {
        let name = self.device.as_deref().unwrap_or(Path::new(""));
        Device::from_toml_str(&self.text()?)
            .map_err(|error| Failure::Input(format!("{}: {error}", name.display())))
    }

    /// Whether there is a file.
    pub(super) fn is_given(&self) -> bool {
        self.device.is_some()
    }

    /// What the device goes by.
    pub(super) fn name(&self) -> String {
        self.device
            .as_deref()
            .map_or_else(|| "default device".to_owned(), experiments::replay::name)
    }
}

impl ParameterOptions {
    /// Shipped presets, the file over them, the values set by name over both.
    pub(super) fn load(&self) -> Result<Parameters, Failure> {
        let mut parameters = Parameters::default();
        if let Some(path) = &self.presets {
            parameters.layer(catalogue::parameters::read(path)?);
        }
        for text in &self.set {
            parameters.set(text)?;
        }
        Ok(parameters)
    }
}

/// The estimators by these names, once each; all where there is no name.
pub(super) fn kinds(names: &[String]) -> Result<Vec<&'static Kind>, Failure> {
    if names.is_empty() {
        return Ok(Kind::all().iter().collect());
    }
    let mut kinds: Vec<&'static Kind> = Vec::new();
    for name in names {
        let kind = Kind::named(name)?;
        if !kinds.iter().any(|known| known.name == kind.name) {
            kinds.push(kind);
        }
    }
    Ok(kinds)
}

/// The scenarios by these names, once each; `default` where there is no name.
pub(super) fn scenarios(
    names: &[String],
    default: &[ScenarioName],
) -> Result<Vec<ScenarioName>, Failure> {
    if names.is_empty() {
        return Ok(default.to_vec());
    }
    let mut scenarios = Vec::new();
    for name in names {
        let scenario = name.parse()?;
        if !scenarios.contains(&scenario) {
            scenarios.push(scenario);
        }
    }
    Ok(scenarios)
}

/// These rates, once each; `default` where there is none.
pub(super) fn rates(given: &[f64], default: &[f64]) -> Vec<f64> {
    let mut rates = Vec::new();
    for &rate in if given.is_empty() { default } else { given } {
        if !rates.contains(&rate) {
            rates.push(rate);
        }
    }
    rates
}
