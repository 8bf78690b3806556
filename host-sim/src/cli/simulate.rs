//! `host-sim simulate`.

use std::path::PathBuf;

use clap::{Args, ValueEnum};
use haptic_control::{LoopPoles, SceneKind};

use catalogue::estimators::Kind;
use catalogue::parameters::Parameters;
use experiments::closed_loop::{FeedbackEncoder, Hand, Loop, estimator, named, usual};
use recordings::arguments::DeviceFile;
use recordings::recording::Recording;
use simulation::scenario::ScenarioName;
use simulation::simulate::{simulate, ticks};
use simulation::trace::Columns;
use terminal::failure::Failure;
use terminal::output::write_whole;

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
    /// Control rate, 100 to 100000 Hz
    #[arg(
        long,
        value_name = "HZ",
        default_value_t = 10_000.0,
        allow_negative_numbers = true
    )]
    rate: f64,
    /// Write only every N-th tick of a scene, 1 to 1000, as telemetry does
    #[arg(long, value_name = "N", default_value_t = 1, conflicts_with = "scenario",
        value_parser = clap::value_parser!(u32).range(1..=1000))]
    every: u32,
    /// Duration, s [default: 16; scenarios: 10, heating 60]
    #[arg(long, value_name = "S", allow_negative_numbers = true)]
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

/// Default duration of a scene, s: a little longer than the excitation.
const EXCITE_S: f64 = 16.0;

pub(super) fn run(options: &Simulate) -> Result<(), Failure> {
    let recording = match &options.scenario {
        Some(name) => of_scenario(options, name.parse()?)?,
        None => of_scene(options)?,
    };
    write_whole(&options.out, &recording.to_csv())
}

fn of_scenario(options: &Simulate, name: ScenarioName) -> Result<Recording, Failure> {
    let device = options.device.load()?;
    let seconds = options.seconds.unwrap_or_else(|| name.default_seconds());
    let columns = Columns {
        counts_small: true,
        edges: true,
    };
    let trace = simulate(&device, name, options.rate, options.seed, seconds, columns)?;
    Ok(Recording {
        t: (0..trace.len()).map(|k| k as f64 / options.rate).collect(),
        trace,
        current_small: None,
        uneven_steps: 0,
        notes: Vec::new(),
    })
}

fn of_scene(options: &Simulate) -> Result<Recording, Failure> {
    let device = options.device.load()?;
    let scene = match options.scene.as_deref() {
        None => SceneKind::Excite,
        // Scenes that need commands of the host are not offered.
        Some(name) => named(
            name,
            [SceneKind::Excite]
                .into_iter()
                .chain(SceneKind::environments()),
        )?,
    };
    let ticks = ticks(options.rate, options.seconds.unwrap_or(EXCITE_S))?;
    let parameters = Parameters::default();
    let estimator = |counts_per_rev| {
        let kind = Kind::named("kalman-triple-steady")?;
        estimator(kind, &device, counts_per_rev, options.rate, &parameters)
    };
    let assumed = device.stages;
    let run = Loop {
        assumed,
        scene: usual(scene, &assumed, options.rate)?,
        hand: match options.hand {
            Holder::Still => Hand::Still,
            Holder::Clamp => Hand::Clamp,
            Holder::Nobody => Hand::Gone(0.0),
            Holder::Moving => Hand::Moving,
        },
        rate_hz: options.rate,
        seed: options.seed,
        large: estimator(device.stages.large.counts_per_rev)?,
        handle: estimator(device.stages.small.counts_per_rev)?,
        encoder: FeedbackEncoder::Own,
        poles: LoopPoles::DEFAULT,
        late_ticks: 0,
        offsets_a: [0.0; 2],
        device,
    };
    Ok(run.record(ticks, options.every as usize)?)
}
