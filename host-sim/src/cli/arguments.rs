//! What can be said on the command line.

use std::path::{Path, PathBuf};

use clap::{Args, Parser, Subcommand};

use crate::device::Device;
use crate::estimators::Kind;
use crate::failure::Failure;
use crate::parameters::{Parameters, Presets};
use crate::robust::shard::Part;
use crate::robust::variation::Subject;
use crate::scenario::ScenarioName;

/// Velocity estimation for a dual-stage haptic device, simulated and scored.
///
/// Without a command: compare, with everything at its default.
#[derive(Debug, Parser)]
#[command(name = "host-sim", version)]
pub(super) struct Arguments {
    #[command(subcommand)]
    pub(super) command: Option<Command>,
}

#[derive(Debug, Subcommand)]
pub(super) enum Command {
    /// Simulate the device, run the estimators on it, print scores and write a report
    Compare(Compare),
    /// Run a recording through the estimators
    Replay(Replay),
    /// Turn the firmware's telemetry into a recording
    Record(super::record::Record),
    /// Draw a recording
    Plot(super::plot::Plot),
    /// Fit the device to recordings of an excitation and write it as a device file
    Identify(super::identify::Identify),
    /// Simulate a scene or a scenario and write it as a recording
    Simulate(super::simulate::Simulate),
    /// Search the estimators' parameters on tuning seeds and write them to a file
    Tune(Tune),
    /// Run estimators that believe in wrong constants of the device, and say what it costs them
    Sensitivity(super::sensitivity::Sensitivity),
    /// Say how well velocity can be known at all, by a particle filter with the true model
    Limit(super::limit::Limit),
    /// Find the stiffest wall and the strongest damping that stay passive and free of limit cycles
    Zwidth(Zwidth),
    /// Close the loop on devices that differ from what the controller believes, and judge each run
    Robust(Robust),
    /// Join the shards of a robust run
    Merge(Merge),
    /// List the estimators and their parameters
    Estimators,
    /// List the scenarios
    Scenarios,
    /// Print the device as TOML: the default one, or a checked file with all its values
    Device(DeviceFile),
}

#[derive(Debug, Args)]
pub(super) struct Compare {
    /// Close the loop: each estimator in turn, then the reference encoder, drives the motors in
    /// the scenes; scored is the force that the hand feels and should not
    #[arg(long)]
    pub(super) closed_loop: bool,
    /// Scenario to run; repeatable [default: all but heating; see host-sim scenarios]. With
    /// --closed-loop a scene [default: all: off, free-air, wall, spring-damper, viscous, detents,
    /// texture, hold, inertia]
    #[arg(long = "scenario", visible_alias = "scene", value_name = "NAME")]
    pub(super) scenarios: Vec<String>,
    /// Estimator of the handle's velocity, with --closed-loop [default: kalman-triple-steady]
    #[arg(long, value_name = "NAME", requires = "closed_loop")]
    pub(super) handle_estimator: Option<String>,
    /// Control rate, 100 to 100000 Hz; repeatable [default: 1000 and 11600]
    #[arg(long = "rate", value_name = "HZ", allow_negative_numbers = true)]
    pub(super) rates: Vec<f64>,
    /// Estimator to run; repeatable [default: all; see host-sim estimators]
    #[arg(long = "estimator", value_name = "NAME")]
    pub(super) estimators: Vec<String>,
    /// Seed of everything random; seeds from 2^32 on are those that tune uses
    #[arg(long, value_name = "N", default_value_t = 1)]
    pub(super) seed: u64,
    /// Duration of each run, s [default: 10, heating 60]
    #[arg(long, value_name = "S", allow_negative_numbers = true)]
    pub(super) seconds: Option<f64>,
    /// Take the plant without Coulomb friction
    #[arg(long)]
    pub(super) frictionless: bool,
    #[command(flatten)]
    pub(super) device: DeviceFile,
    #[command(flatten)]
    pub(super) parameters: ParameterOptions,
    /// Score to compute, named as in the JSON; repeatable [default: all]
    #[arg(long = "score", value_name = "NAME")]
    pub(super) scores: Vec<String>,
    /// Folder for the report: index.html, its figures as SVG, scores.csv, scores.json [default:
    /// target/report; with --json - none]
    #[arg(long, value_name = "DIR")]
    pub(super) out: Option<PathBuf>,
    /// Write no report: no plot is drawn, and the plant without friction is not run beside
    #[arg(long, conflicts_with = "out")]
    pub(super) no_report: bool,
    /// Write the scores as JSON to FILE, or with - to standard output and nothing else there
    #[arg(long, value_name = "FILE")]
    pub(super) json: Option<PathBuf>,
    /// Say on standard error where the time went
    #[arg(long)]
    pub(super) timing: bool,
}

#[derive(Debug, Args)]
pub(super) struct Replay {
    /// Recording: CSV with columns t (s) and counts_large, optionally counts_small, current (A),
    /// edge_tick (84 MHz), edge_bound, true_omega (rad/s); others are ignored
    #[arg(value_name = "TRACE.csv")]
    pub(super) trace: PathBuf,
    /// Estimator to run; repeatable [default: all that the columns suffice for]
    #[arg(long = "estimator", value_name = "NAME")]
    pub(super) estimators: Vec<String>,
    #[command(flatten)]
    pub(super) device: DeviceFile,
    #[command(flatten)]
    pub(super) parameters: ParameterOptions,
    /// Write t and a column for each estimator (rad/s) to FILE [default: standard output]
    #[arg(long, value_name = "FILE.csv")]
    pub(super) out: Option<PathBuf>,
    /// Write the scores against true_omega as JSON to FILE, or with - to standard output
    #[arg(long, value_name = "FILE")]
    pub(super) json: Option<PathBuf>,
}

#[derive(Debug, Args)]
pub(super) struct Tune {
    /// Take the mean over right and wrong beliefs in the device, as sensitivity tries them
    #[arg(long)]
    pub(super) doubting: bool,
    /// Scenario to tune on; repeatable [default: step, permanent, track]
    #[arg(long = "scenario", value_name = "NAME")]
    pub(super) scenarios: Vec<String>,
    /// Control rate, Hz; repeatable [default: 1000, 10000 and 11600]
    #[arg(long = "rate", value_name = "HZ", allow_negative_numbers = true)]
    pub(super) rates: Vec<f64>,
    /// Estimator to tune; repeatable [default: all that have parameters]
    #[arg(long = "estimator", value_name = "NAME")]
    pub(super) estimators: Vec<String>,
    /// How many tuning seeds, from 2^32 on
    #[arg(long, value_name = "N", default_value_t = 3, value_parser = clap::value_parser!(u64).range(1..=1000))]
    pub(super) seeds: u64,
    /// Duration of each run, s
    #[arg(
        long,
        value_name = "S",
        default_value_t = 10.0,
        allow_negative_numbers = true
    )]
    pub(super) seconds: f64,
    /// Tune on the plant without Coulomb friction only [default: on both]
    #[arg(long)]
    pub(super) frictionless: bool,
    #[command(flatten)]
    pub(super) device: DeviceFile,
    /// File to write; compare and replay take it as --presets
    #[arg(long, value_name = "FILE.toml", default_value = "target/presets.toml")]
    pub(super) out: PathBuf,
}

#[derive(Debug, Args)]
pub(super) struct Robust {
    /// Scene to run; repeatable [default: all]
    #[arg(long = "scene", value_name = "NAME")]
    pub(super) scenes: Vec<String>,
    /// Control rate, Hz
    #[arg(
        long,
        value_name = "HZ",
        default_value_t = 10e3,
        allow_negative_numbers = true
    )]
    pub(super) rate: f64,
    /// Estimator of both velocities
    #[arg(long, value_name = "NAME", default_value = "kalman-triple-steady")]
    pub(super) estimator: String,
    /// How many devices are drawn for each scene, beside the corners
    #[arg(long, value_name = "N", default_value_t = 1000, value_parser = clap::value_parser!(u64).range(0..=10_000_000))]
    pub(super) devices: u64,
    /// Seed of everything random
    #[arg(long, value_name = "N", default_value_t = 1)]
    pub(super) seed: u64,
    /// Duration of each run, s
    #[arg(
        long,
        value_name = "S",
        default_value_t = 2.0,
        allow_negative_numbers = true
    )]
    pub(super) seconds: f64,
    #[command(flatten)]
    pub(super) device: DeviceFile,
    #[command(flatten)]
    pub(super) parameters: ParameterOptions,
    /// Run one device of each scene alone: its index, or a corner's name
    #[arg(long, value_name = "INDEX", conflicts_with = "shard")]
    pub(super) only: Option<Subject>,
    /// Run part K of N, and write a file for host-sim merge instead of the report
    #[arg(long, value_name = "K/N", conflicts_with = "json")]
    pub(super) shard: Option<Part>,
    /// Folder for index.html, summary.svg, robust.csv, robust.json, or for the shard's file
    /// [default: target/robust; with --json - or --only none]
    #[arg(long, value_name = "DIR")]
    pub(super) out: Option<PathBuf>,
    /// Write the rows as JSON to FILE, or with - to standard output and nothing else there
    #[arg(long, value_name = "FILE")]
    pub(super) json: Option<PathBuf>,
}

#[derive(Debug, Args)]
pub(super) struct Merge {
    /// Files that host-sim robust --shard wrote, all of one run, in any order
    #[arg(value_name = "SHARD", required = true)]
    pub(super) shards: Vec<PathBuf>,
    /// Folder for what the run would have written in one piece [default: target/robust]
    #[arg(long, value_name = "DIR")]
    pub(super) out: Option<PathBuf>,
    /// Write the rows as JSON to FILE, or with - to standard output and nothing else there
    #[arg(long, value_name = "FILE")]
    pub(super) json: Option<PathBuf>,
}

#[derive(Debug, Args)]
pub(super) struct Zwidth {
    /// Estimator of the large motor's velocity; repeatable [default: all but the steady ones]
    #[arg(long = "estimator", value_name = "NAME")]
    pub(super) estimators: Vec<String>,
    /// Estimator of the handle's velocity [default: the large motor's, or kalman-triple where that
    /// one reads the current]
    #[arg(long, value_name = "NAME")]
    pub(super) handle: Option<String>,
    /// Control rate, Hz; repeatable [default: 1000, 10000 and 11600]
    #[arg(long = "rate", value_name = "HZ", allow_negative_numbers = true)]
    pub(super) rates: Vec<f64>,
    /// Lines of the large encoder; repeatable [default: 256, 1024 and 5000]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=1_000_000))]
    pub(super) lines: Vec<u32>,
    /// Seed of the encoders' phases and the disc
    #[arg(long, value_name = "N", default_value_t = 1)]
    pub(super) seed: u64,
    #[command(flatten)]
    pub(super) device: DeviceFile,
    #[command(flatten)]
    pub(super) parameters: ParameterOptions,
    /// Folder for index.html, its figures as SVG, zwidth.csv, zwidth.json [default: target/zwidth;
    /// with --json - none]
    #[arg(long, value_name = "DIR")]
    pub(super) out: Option<PathBuf>,
    /// Write the bounds as JSON to FILE, or with - to standard output and nothing else there
    #[arg(long, value_name = "FILE")]
    pub(super) json: Option<PathBuf>,
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

impl Default for Compare {
    fn default() -> Self {
        Self {
            closed_loop: false,
            scenarios: Vec::new(),
            handle_estimator: None,
            rates: Vec::new(),
            estimators: Vec::new(),
            seed: 1,
            seconds: None,
            frictionless: false,
            device: DeviceFile::default(),
            parameters: ParameterOptions::default(),
            scores: Vec::new(),
            out: None,
            no_report: false,
            json: None,
            timing: false,
        }
    }
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

    /// What the device goes by.
    pub(super) fn name(&self) -> String {
        self.device
            .as_deref()
            .map_or_else(|| "default device".to_owned(), crate::replay::name)
    }
}

impl ParameterOptions {
    /// Shipped presets, the file over them, the values set by name over both.
    pub(super) fn load(&self) -> Result<Parameters, Failure> {
        let mut parameters = Parameters::default();
        if let Some(path) = &self.presets {
            parameters.layer(Presets::read(path)?);
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

/// Whether `path` stands for standard output.
pub(super) fn is_stdout(path: &Path) -> bool {
    path.as_os_str() == "-"
}
