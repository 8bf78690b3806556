//! `host-sim simulate`.

use std::path::PathBuf;

use clap::{Args, ValueEnum};

use experiments::closed_loop::Hand;
use experiments::simulated::Run;
use recordings::arguments::DeviceFile;
use simulation::simulate::RATES_HZ;
use terminal::failure::Failure;
use terminal::output::{note, write_whole};

use super::page::working;
use super::rates::loop_rate_help;

/// Load on the handle in a scene.
#[derive(Clone, Copy, Debug, ValueEnum)]
enum Holder {
    /// A trembling hand holds the handle still.
    Still,
    /// A clamp blocks the handle.
    Clamp,
    /// The handle is free.
    #[value(alias = "free")]
    Nobody,
    /// A hand moves the handle.
    Moving,
}

/// Help text of `--rate`.
fn rate_help() -> String {
    format!(
        "{}; of scene excite from 1000 Hz on, of a scenario from {} Hz on",
        loop_rate_help(),
        RATES_HZ.0
    )
}

#[derive(Debug, Args)]
pub(super) struct Simulate {
    /// Scene to simulate in closed loop: excite, or one of compare --closed-loop [default: excite]
    #[arg(long, value_name = "NAME", conflicts_with = "scenario")]
    scene: Option<String>,
    /// Scenario to simulate in open loop instead of a scene, see host-sim scenarios
    #[arg(long, value_name = "NAME")]
    scenario: Option<String>,
    /// Load on the handle in a scene
    #[arg(long, value_enum, default_value = "still", conflicts_with = "scenario")]
    hand: Holder,
    #[arg(long, value_name = "HZ", default_value_t = 10_000.0, help = rate_help())]
    rate: f64,
    /// Write only every N-th tick of a scene, 1 to 1000, as telemetry does
    #[arg(long, value_name = "N", default_value_t = 1, conflicts_with = "scenario",
        value_parser = clap::value_parser!(u32).range(1..=1000))]
    every: u32,
    /// Duration, s [default: 16; scenarios: 10, heating 60]
    #[arg(long, value_name = "S")]
    seconds: Option<f64>,
    /// Seed of all random numbers
    #[arg(long, value_name = "N", default_value_t = 1)]
    seed: u64,
    #[command(flatten)]
    device: DeviceFile,
    /// Write the recording to FILE; - is standard output
    #[arg(long, value_name = "FILE.csv")]
    out: PathBuf,
}

pub(super) fn run(options: &Simulate) -> Result<(), Failure> {
    let run = Run {
        device: options.device.load_to_simulate()?,
        rate_hz: options.rate,
        seconds: options.seconds,
        seed: options.seed,
    };
    let hand = match options.hand {
        Holder::Still => Hand::Still,
        Holder::Clamp => Hand::Clamp,
        Holder::Nobody => Hand::Gone(0.0),
        Holder::Moving => Hand::Moving,
    };
    let bar = working("simulating");
    let recording = match &options.scenario {
        Some(name) => run.scenario(name),
        None => run.scene(options.scene.as_deref(), hand, options.every as usize),
    };
    bar.finish_and_clear();
    let recording = recording?;
    for line in &recording.notes {
        note(format_args!("note: {line}"));
    }
    write_whole(&options.out, &recording.to_csv())
}
