//! The path of a device of one's own: identify, tune, image, board.

use haptic_control::{DualStage, Fingerprint, Mode, SceneKind, Stop};
use std::ffi::OsString;
use std::fs;
use std::path::{Path, PathBuf};

use estimator_core::{Count, EndFit, Foaw, Hertz, Sample, Scale, VelocityEstimator};
use experiments::closed_loop::Hand;
use simulation::device::Device;
use virtual_board::run::{Outcome, Setup, on_board};

use crate::image::{SETTLED_S, image_for, of_scene};

const COUNTS_PER_REV: u32 = 8000;
const RATE: Hertz = Hertz(10e3);

/// Runs `host-sim` with these words; FILE: stands for the folder of the test.
fn host_sim(words: &str, folder: &Path) {
    let words = format!("host-sim {words}").replace("FILE:", &format!("{}/", folder.display()));
    let words = words.split_whitespace().map(OsString::from);
    host_sim::cli::run(words).unwrap_or_else(|error| panic!("{error}"));
}

/// The large motor's velocity by FOAW, rad/s, at each tick of a run.
fn foaw(run: &Outcome, window: usize, bound: u16) -> Vec<f32> {
    let foaw = Foaw::<128, EndFit>::new(window, bound).unwrap();
    let scale = Scale::new(COUNTS_PER_REV, RATE).unwrap();
    let mut count = Count(u32::from(run.first_counts[0].unwrap()));
    let mut state = foaw.start(&Sample::new(count));
    let ticks = run.ticks.iter().map(|tick| {
        count = count.extended(tick.counts[0].unwrap());
        foaw.update(&mut state, &Sample::new(count))
            .rad_per_s(&scale)
    });
    ticks.collect()
}

/// A device with half as much inertia again and 2000 lines: its owner knows the encoder, identifies
/// the rest from a recording, tunes the estimators, and builds the image from both files.
#[test]
fn image_built_for_identified_and_tuned_files_drives_that_device() {
    let folder = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join("own-device");
    fs::create_dir_all(&folder).unwrap();
    let file = |name: &str| folder.join(name);
    let encoder = format!("[large]\ncounts_per_rev = {COUNTS_PER_REV}\n");
    fs::write(file("mine.toml"), &encoder).unwrap();
    let inertia = 1.5 * DualStage::DEFAULT.large.inertia;
    fs::write(
        file("truth.toml"),
        format!("{encoder}inertia_kg_m2 = {inertia:e}\n"),
    )
    .unwrap();
    let truth = Device::read(&file("truth.toml")).unwrap();

    host_sim(
        "simulate --device FILE:truth.toml --every 10 --out FILE:excite.csv",
        &folder,
    );
    host_sim(
        "identify FILE:excite.csv --device FILE:mine.toml --out FILE:mine.toml",
        &folder,
    );
    host_sim(
        "tune --device FILE:mine.toml --rate 10000 --scenario step --seconds 0.3 --seeds 1 \
         --estimator foaw-end-fit --estimator kalman-triple-steady --out FILE:tuned.toml",
        &folder,
    );
    let mine = Device::read(&file("mine.toml")).unwrap();
    assert_eq!(mine.stages.large.counts_per_rev, COUNTS_PER_REV);
    let off = mine.stages.large.inertia / inertia - 1.0;
    assert!(off.abs() < 0.03, "identified inertia is {off} off");

    let image = image_for(&file("mine.toml"), &file("tuned.toml"));
    let run = on_board(
        &image,
        &Setup {
            device: truth,
            ..of_scene(SceneKind::FreeAir, Hand::Moving, 2.0)
        },
        |_| (),
    )
    .unwrap();
    run.check().unwrap();

    // The image was built for these files, and says so.
    let boot = run.telemetry.boots[0];
    assert_eq!(boot.device, Some(mine.stages.fingerprint()));
    assert_ne!(boot.device, Some(DualStage::DEFAULT.fingerprint()));
    let shipped = tuned::PRESETS_FINGERPRINT;
    assert!(
        boot.presets
            .is_some_and(|presets: Fingerprint| presets != shipped)
    );

    // Its estimator has the tuned window on the identified encoder.
    let tuned = fs::read_to_string(file("tuned.toml")).unwrap();
    let tuned: toml::Table = tuned.parse().unwrap();
    let tuned = &tuned["preset"][0]["estimators"]["foaw-end-fit"];
    let [n, d] = ["n", "d"].map(|name| tuned[name].as_float().unwrap());
    assert_ne!(n, 32.0, "the window of the shipped image tests nothing");
    let velocities = foaw(&run, n as usize, d as u16);
    let settled =
        |frame: &&recordings::telemetry::Frame| f64::from(frame.tick) > SETTLED_S * RATE.0;
    let frames: Vec<_> = run.telemetry.frames.iter().filter(settled).collect();
    assert!(frames.len() > 1500, "{} frames", frames.len());
    let (mut along, mut square) = (0.0, 0.0);
    for frame in &frames {
        let tick = run.tick_index(frame).unwrap();
        assert_eq!(
            frame.velocity_large.to_bits(),
            velocities[tick].to_bits(),
            "{frame:?}"
        );
        let omega = run.ticks[tick].large.omega;
        along += f64::from(frame.velocity_large) * omega;
        square += omega * omega;
    }
    // In radians of this encoder: with the counts of the default device it would be twice as fast.
    let ratio = along / square;
    assert!((ratio - 1.0).abs() < 0.02, "{ratio} of the true velocity");

    // The scene goes on to the end, without a stop.
    let last = run.telemetry.frames.last().unwrap();
    assert_eq!((last.state, last.cause), (Mode::Running, Stop::None));
}
