//! Identification against the truth of simulated devices. Tuned on seeds from 1000 on, scored here
//! on others.

use std::fmt::Write as _;

use experiments::closed_loop::{Hand, Loop, usual};
use experiments::identify::{Identification, Known, Quantity, identify};
use haptic_control::SceneKind;
use rand_xoshiro::Xoshiro256PlusPlus;
use rand_xoshiro::rand_core::{Rng, SeedableRng};
use recordings::recording::Recording;
use simulation::device::Device;

use crate::loops;

/// A device whose constants are up to 30 % (friction, amplifier 50 %) off, on a real disc.
pub(super) fn device(seed: u64) -> Device {
    let mut random = Xoshiro256PlusPlus::seed_from_u64(seed);
    let mut factor = |spread: f64| {
        let unit = (random.next_u64() >> 11) as f64 * 0.5_f64.powi(53);
        1.0 + spread * (2.0 * unit - 1.0)
    };
    let mut device = Device::default();
    device.stages.large.inertia *= factor(0.3);
    device.stages.large.torque_constant *= factor(0.1);
    device.stages.large.coulomb_friction *= factor(0.5);
    device.stages.small.inertia *= factor(0.3);
    device.stages.small.torque_constant *= factor(0.2);
    device.stages.small.coulomb_friction *= factor(0.5);
    device.stages.damping *= factor(0.15);
    device.stages.amplifier_bandwidth.0 *= factor(0.5);
    device.disc.phase_counts = 0.06;
    device.disc.line_counts = 0.25;
    device.disc.random_counts = 0.02;
    device
}

/// The excitation of that device at 10 kHz, all rows or each `every`-th.
pub(super) fn record(device: &Device, hand: Hand, seed: u64, every: usize) -> Recording {
    let scene = usual(SceneKind::Excite, &device.stages, 10e3).unwrap();
    let run = Loop {
        hand,
        seed,
        ..loops::on(device, scene, 10e3, ["kalman-triple-steady"; 2])
    };
    run.record(165_000, every).unwrap()
}

pub(super) fn torque_constant(device: &Device) -> Known {
    Known::TorqueConstant(device.stages.large.torque_constant)
}

/// Against a device file that says something else.
fn found(recordings: Vec<Recording>, known: Known) -> Result<Identification, String> {
    found_against(&Device::default(), recordings, known)
}

pub(super) fn found_against(
    file: &Device,
    recordings: Vec<Recording>,
    known: Known,
) -> Result<Identification, String> {
    let named: Vec<_> = recordings
        .into_iter()
        .map(|r| ("r.csv".to_owned(), r))
        .collect();
    identify(&named, &[], file, known, false).map_err(|failure| failure.to_string())
}

pub(super) fn truth(device: &Device, key: &str) -> f64 {
    match key {
        "large.inertia_kg_m2" => device.stages.large.inertia,
        "large.torque_constant_nm_per_a" => device.stages.large.torque_constant,
        "large.coulomb_nm" => device.stages.large.coulomb_friction,
        "small.inertia_kg_m2" => device.stages.small.inertia,
        "small.torque_constant_nm_per_a" => device.stages.small.torque_constant,
        "small.coulomb_nm" => device.stages.small.coulomb_friction,
        "coupler.damping_nms_per_rad" => device.stages.damping,
        "amplifier.bandwidth_hz" => device.stages.amplifier_bandwidth.0,
        _ => panic!("{key}"),
    }
}

/// Relative errors of the identified values, and the number of values inside their intervals.
#[derive(Default)]
struct Tally {
    told: Vec<&'static str>,
    worst: f64,
    inside: usize,
    /// Sum of the squares of the errors over half the intervals.
    squares: f64,
}

impl Tally {
    fn add(&mut self, device: &Device, found: &Identification) {
        for quantity in found.quantities.iter().filter(|q| q.rejected.is_none()) {
            let truth = truth(device, quantity.key);
            let error = (quantity.estimate.value - truth).abs();
            assert!(error < 0.03 * truth, "{quantity:?} is {truth}");
            self.told.push(quantity.key);
            self.worst = self.worst.max(error / truth);
            self.inside += usize::from(error <= quantity.estimate.half);
            self.squares += (error / quantity.estimate.half).powi(2);
        }
    }

    /// For docs/theory/identification.md: `cargo test --release -p experiments --test experiments identify --
    /// --nocapture`.
    fn print(&self, what: &str) {
        println!(
            "{what}: {} values, the worst {:.2} % off, {} inside their intervals, of which errors are {:.2} (RMS)",
            self.told.len(),
            100.0 * self.worst,
            self.inside,
            self.part_of_intervals()
        );
    }

    fn times(&self, key: &str) -> usize {
        self.told.iter().filter(|told| **told == key).count()
    }

    /// RMS of the errors over half the intervals: 0.5 for normal errors and intervals of 95 %.
    fn part_of_intervals(&self) -> f64 {
        (self.squares / self.told.len() as f64).sqrt()
    }

    /// Few enough outside, and no intervals that are several times too wide.
    fn is_as_sure_as_it_says(&self) {
        let part = self.inside as f64 / self.told.len() as f64;
        assert!(part > 0.85, "{part} of {} inside", self.told.len());
        let errors = self.part_of_intervals();
        assert!(
            (0.25..1.0).contains(&errors),
            "errors of {errors} of the intervals"
        );
    }
}

/// The series in the lag of the torque is cut off: with a long lag every value is biased.
#[test]
fn long_delay_of_the_torque_is_refused_and_a_short_one_is_exact() {
    for (bandwidth_hz, is_refused) in [(20.0, true), (40.0, true), (80.0, true), (100.0, false)] {
        let mut device = Device::default();
        device.stages.amplifier_bandwidth.0 = bandwidth_hz;
        let recording = record(&device, Hand::Still, 1, 1);
        match found(vec![recording], torque_constant(&device)) {
            Err(said) => assert!(
                is_refused && said.contains("above 1.8 ms (an amplifier below 88 Hz)"),
                "{bandwidth_hz} Hz: {said}"
            ),
            Ok(found) => {
                assert!(!is_refused, "{bandwidth_hz} Hz");
                let mut tally = Tally::default();
                tally.add(&device, &found);
                assert!(tally.worst < 0.005, "{bandwidth_hz} Hz: {}", tally.worst);
            }
        }
    }
}

#[test]
fn recording_with_a_held_handle_identifies_large_motor_coupler_and_amplifier() {
    let mut tally = Tally::default();
    for seed in 1..=16 {
        let device = device(seed);
        let recording = record(&device, Hand::Still, seed, 1);
        tally.add(
            &device,
            &found(vec![recording], torque_constant(&device)).unwrap(),
        );
    }
    for key in [
        "large.inertia_kg_m2",
        "large.coulomb_nm",
        "coupler.damping_nms_per_rad",
    ] {
        assert_eq!(tally.times(key), 16, "{key}");
    }
    assert!(tally.times("amplifier.bandwidth_hz") >= 8);
    assert_eq!(tally.times("small.inertia_kg_m2"), 0);
    tally.print("held");
    tally.is_as_sure_as_it_says();
}

#[test]
fn frames_of_1_khz_identify_all_except_the_amplifier_at_every_phase() {
    let mut tally = Tally::default();
    for seed in 1..=8 {
        let device = device(seed);
        let all = record(&device, Hand::Still, seed, 1);
        let frames = every_tenth(&all, seed as usize);
        tally.add(
            &device,
            &found(vec![frames], torque_constant(&device)).unwrap(),
        );
    }
    tally.print("frames");
    assert_eq!(tally.told.len(), 3 * 8);
    assert_eq!(tally.times("amplifier.bandwidth_hz"), 0);
    assert!(tally.worst < 0.002, "{}", tally.worst);
}

/// The frames of a telemetry that began at this tick: currents change between them.
fn every_tenth(all: &Recording, first: usize) -> Recording {
    let mut frames = all.clone();
    let rows = || (first..all.trace.len()).step_by(10);
    frames.t = rows().map(|k| all.t[k]).collect();
    frames.trace.rate_hz = all.trace.rate_hz / 10.0;
    frames.trace.counts_large = rows().map(|k| all.trace.counts_large[k]).collect();
    let small = all.trace.counts_small.as_ref().unwrap();
    frames.trace.counts_small = Some(rows().map(|k| small[k]).collect());
    let current = all.trace.current.as_ref().unwrap();
    frames.trace.current = Some(rows().map(|k| current[k]).collect());
    frames.current_small = None;
    frames
}

#[test]
fn recordings_with_held_and_free_handle_identify_the_handle() {
    let mut tally = Tally::default();
    for seed in 1..=12 {
        let device = device(seed);
        let held = record(&device, Hand::Clamp, seed, 1);
        let free = record(&device, Hand::Gone(0.0), seed + 100, 1);
        let found = found(vec![held, free], torque_constant(&device)).unwrap();
        tally.add(&device, &found);
    }
    tally.print("free");
    // A light or slippery handle ends its recording early, and too little is left to tell.
    for key in ["small.inertia_kg_m2", "small.torque_constant_nm_per_a"] {
        println!("free: {key} told {} times of 12", tally.times(key));
        assert!(tally.times(key) >= 6, "{key}");
    }
    // Friction varies over a turn, and a free handle makes none.
    assert_eq!(tally.times("small.coulomb_nm"), 0);
    tally.is_as_sure_as_it_says();
}

#[test]
fn ratios_do_not_depend_on_the_known_constant() {
    let device = device(3);
    let recording = record(&device, Hand::Clamp, 3, 10);
    let with = |known| {
        let found = found(vec![recording.clone()], known).unwrap();
        let told = found.quantities.into_iter();
        let told = told.filter(|quantity| quantity.rejected.is_none());
        told.map(|quantity| (quantity.key, quantity.estimate.value))
            .collect::<Vec<_>>()
    };
    for known in [
        Known::Inertia(device.stages.large.inertia),
        Known::Damping(device.stages.damping),
        torque_constant(&device),
    ] {
        let told = with(known);
        assert_eq!(told.len(), 3, "{told:?}");
        for (key, value) in told {
            let truth = truth(&device, key);
            assert!(
                (value / truth - 1.0).abs() < 0.01,
                "{known}: {key} {value} {truth}"
            );
        }
    }
    let [single, double] = [1.0, 2.0].map(|factor| with(Known::Inertia(factor * 1e-5)));
    for (one, two) in single.iter().zip(&double) {
        assert!((two.1 / one.1 - 2.0).abs() < 1e-9);
    }
}

/// Rows with the current that flows as the measured one, and commands of which the amplifier gives only a part.
#[test]
fn measured_current_identifies_the_torque_constant_although_the_amplifier_has_another_gain() {
    const GAIN: f64 = 0.9;
    let device = device(5);
    let all = record(&device, Hand::Still, 5, 1);
    let flowing = all.trace.current.as_ref().unwrap();
    let small = all.trace.counts_small.as_ref().unwrap();
    let mut text = "t,counts_large,counts_small,current,current_measured\n".to_owned();
    for (k, t) in all.t.iter().enumerate() {
        let (large, small) = (all.trace.counts_large[k], small[k]);
        let command = flowing[k] / GAIN;
        let measured = k.checked_sub(1).map(|before| flowing[before].to_string());
        let measured = measured.unwrap_or_default();
        writeln!(text, "{t},{large},{small},{command},{measured}").unwrap();
    }
    let torque_constant = |text: &str| {
        let recording = Recording::parse(text.as_bytes(), "r.csv").unwrap();
        let known = Known::Inertia(device.stages.large.inertia);
        let found = found(vec![recording], known).unwrap();
        let is_it = |quantity: &&Quantity| quantity.key == "large.torque_constant_nm_per_a";
        let quantity = found.quantities.iter().find(is_it).unwrap();
        assert_eq!(quantity.rejected, None);
        quantity.estimate.value / device.stages.large.torque_constant
    };
    // The bound of the other tests; the commands alone are wrong by the gain.
    assert!((torque_constant(&text) - 1.0).abs() < 0.03);
    let commands = text.replace("current_measured", "ignored");
    assert!((torque_constant(&commands) / GAIN - 1.0).abs() < 0.03);
}

#[test]
fn insufficient_recording_is_refused_with_a_remedy() {
    let device = Device::default();
    let known = torque_constant(&device);
    let good = record(&device, Hand::Clamp, 1, 10);
    let refused = |change: &dyn Fn(&mut Recording)| {
        let mut recording = good.clone();
        change(&mut recording);
        let error = found(vec![recording], known).unwrap_err();
        assert!(
            error.starts_with("r.csv: ") && !error.contains('\n'),
            "{error}"
        );
        error
    };
    let error = refused(&|r| r.trace.current = None);
    assert!(error.contains("no column current"), "{error}");
    let error = refused(&|r| r.trace.counts_small = None);
    assert!(
        error.contains("no column counts_small") && error.contains("16 %"),
        "{error}"
    );
    let error = refused(&|r| r.trace.current.as_mut().unwrap().fill(0.0));
    assert!(error.contains("current is zero"), "{error}");
    let error = refused(&|r| {
        let current = r.trace.current.as_mut().unwrap();
        current.iter_mut().for_each(|i| *i = -*i);
    });
    assert!(error.contains("backward"), "{error}");
    let error = refused(&|r| r.trace.counts_large.fill(7));
    assert!(error.contains("does not move"), "{error}");
    // Currents of something else: shuffled in time by a second.
    let error = refused(&|r| r.trace.current.as_mut().unwrap().rotate_right(1000));
    assert!(
        error.contains("unexplained") || error.contains("no constant is identified"),
        "{error}"
    );
    // A clock that stumbles all the time.
    let error = refused(&|r| (0..r.t.len()).for_each(|k| r.t[k] += 3e-4 * (k % 20 / 19) as f64));
    assert!(error.contains("turns one way"), "{error}");
}

#[test]
fn motion_without_steps_is_not_enough_for_the_inertia() {
    // Two seconds at one current: where it settles tells one ratio at most.
    let device = Device::default();
    let mut recording = record(&device, Hand::Clamp, 1, 10);
    let speed = 40.0;
    for (k, count) in recording.trace.counts_large.iter_mut().enumerate() {
        *count = (speed * k as f64 * 1e-3 / std::f64::consts::TAU * 4096.0) as u32;
    }
    recording.trace.current.as_mut().unwrap().fill(0.9);
    let error = found(vec![recording], torque_constant(&device)).unwrap_err();
    assert!(
        error.contains("no constant is identified") || error.contains("unexplained"),
        "{error}"
    );
}
