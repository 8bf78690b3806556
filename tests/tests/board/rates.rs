//! Images of other control rates.

use std::f64::consts::TAU;
use std::sync::OnceLock;

use estimator_core::{Hertz, Model, SteadyKalman, SteadyKalmanTriple};
use experiments::closed_loop::{Hand, Press};
use firmware_app::config::DEVICE;
use firmware_app::large::NAMES;
use haptic_control::{LoopPoles, Mode, Rig, SceneKind, Stop, Switchboard};
use virtual_board::fault::Fault;
use virtual_board::image::Image;
use virtual_board::run::{ControlTick, Outcome, Setup};

use crate::image::{SETTLED_S, end, image_at, of_scene, run_checked};
use crate::mirror::{mirrored_by, same_frames};

/// Control rates, Hz: the lowest one, the default, one that every image may have, and the highest.
const RATES: [u32; 4] = [1000, 10_000, 20_000, 40_000];

/// The image with a steady-state Kalman filter at each rate.
fn images() -> &'static [(u32, Image)] {
    static IMAGES: OnceLock<Vec<(u32, Image)>> = OnceLock::new();
    IMAGES.get_or_init(|| {
        let image = |rate| (rate, image_at(rate, "large-kalman").unwrap());
        RATES.map(image).into()
    })
}

fn period_ns(rate_hz: u32) -> u64 {
    1_000_000_000 / u64::from(rate_hz)
}

/// The filter of `motor` as it is tuned for a rate.
fn filter(motor: &str, counts_per_rev: u32, rate: Hertz) -> SteadyKalmanTriple {
    let jerk = tuned::image(motor, NAMES[1], rate, "jerk");
    let model = Model::triple_integrator(counts_per_rev, rate, jerk).unwrap();
    SteadyKalman::new(&model).unwrap()
}

/// RMS error of the reported velocity of the large motor, rad/s, while the loop is closed.
fn error(run: &Outcome) -> f64 {
    let squares = run.telemetry.frames.iter().filter_map(|frame| {
        let tick = run.tick(frame)?;
        let error = f64::from(frame.velocity_large) - tick.large.omega;
        (tick.at_ns as f64 * 1e-9 >= SETTLED_S).then_some(error * error)
    });
    let squares: Vec<f64> = squares.collect();
    (squares.iter().sum::<f64>() / squares.len() as f64).sqrt()
}

#[test]
fn every_rate_agrees_with_the_host_bit_for_bit_and_misses_no_tick() {
    let mut errors = Vec::new();
    for (rate_hz, image) in images() {
        let run = run_checked(image, &of_scene(SceneKind::FreeAir, Hand::Moving, 3.0));
        assert_eq!(run.rate_hz(), f64::from(*rate_hz));
        assert_eq!(run.telemetry.malformed, [""; 0], "{rate_hz} Hz");
        assert_eq!(end(&run), (Mode::Running, Stop::None), "{rate_hz} Hz");
        // A frame per millisecond, from the first tick on.
        assert!(run.telemetry.frames.len() > 2980, "{rate_hz} Hz");
        for (k, frame) in run.telemetry.frames.iter().enumerate() {
            let tick = k as u32 * (rate_hz / 1000);
            assert_eq!((frame.seq as usize, frame.tick), (k, tick), "{rate_hz} Hz");
            assert_eq!((frame.overruns, frame.drops), (0, 0), "{rate_hz} Hz");
        }
        // The start ends after the first tick is due. Each later one comes on time, but for an instruction of
        // the lowest priority that cannot be interrupted.
        let (first, ticks) = run.ticks.split_first().expect("ticks");
        assert!(ticks[0].at_ns - first.at_ns <= period_ns(*rate_hz));
        let since_due =
            |(k, tick): (usize, &ControlTick)| tick.at_ns - period_ns(*rate_hz) * k as u64;
        let due = ticks.iter().enumerate().map(since_due).min();
        for (k, tick) in ticks.iter().enumerate() {
            let late = since_due((k, tick)) - due.expect("ticks");
            assert!(late < 500, "{rate_hz} Hz: tick {k} is {late} ns late");
        }
        let rate = Hertz(f64::from(*rate_hz));
        let rig = Rig::new(&DEVICE, rate, LoopPoles::DEFAULT).unwrap();
        let large = filter("large", DEVICE.large.counts_per_rev, rate);
        let handle = filter("handle", DEVICE.small.counts_per_rev, rate);
        let switchboard = Switchboard::new(large, handle, rig, rate);
        let moving = same_frames(&run, &mirrored_by(&switchboard, &run));
        assert!(moving > 2000, "{rate_hz} Hz: {moving} moving frames");
        errors.push(error(&run));
    }
    println!("{RATES:?} Hz: {errors:?} rad/s");
    // A finite difference at 1 kHz has the difference of two roundings of a count in 1 ms.
    let count = TAU / f64::from(DEVICE.large.counts_per_rev);
    let finite_difference = 1e3 * count / 6_f64.sqrt();
    let better = |error: &f64| *error < 0.8 * finite_difference;
    assert!(errors.iter().all(better), "{errors:?} {finite_difference}");
}

/// A run of 0.1 s beyond a fault at 0.4 s.
fn faulty(image: &Image, fault: Fault) -> Outcome {
    run_checked(
        image,
        &Setup {
            faults: vec![(SETTLED_S, fault)],
            ..of_scene(SceneKind::FreeAir, Hand::Moving, SETTLED_S + 0.1)
        },
    )
}

#[test]
fn faults_are_found_in_time_at_every_rate() {
    for (rate_hz, image) in images() {
        let period_s = period_ns(*rate_hz) as f64 * 1e-9;
        // The tick that reads the line stops; 20 us are its own time and the lockstep's step.
        let ready = faulty(image, Fault::AmplifierFault);
        let off_s = ready.off_after(SETTLED_S).expect("it is switched off");
        assert_eq!(end(&ready), (Mode::Safe, Stop::AmplifierFault));
        assert!(
            off_s <= period_s + 20e-6,
            "{rate_hz} Hz: off after {off_s} s"
        );
        // The enables lapse 16 periods after the last control task.
        let hung = faulty(image, Fault::HungControl);
        let off_s = hung.off_after(SETTLED_S).expect("it is switched off");
        let periods = off_s / period_s;
        assert!((14.9..17.0).contains(&periods), "{rate_hz} Hz: {off_s} s");
        // Tasks of 1.2 periods, one after another, until one tick in five is missed too often.
        let long = faulty(image, Fault::LongTasks);
        assert_eq!(end(&long), (Mode::Safe, Stop::TickOverrun), "{rate_hz} Hz");
        let since = long
            .ticks
            .iter()
            .skip_while(|tick| (tick.at_ns as f64) < SETTLED_S * 1e9);
        let starts: Vec<_> = since
            .map(|tick| tick.at_ns as f64 * 1e-9 / period_s)
            .collect();
        for pair in starts[1..6].windows(2) {
            let periods = pair[1] - pair[0];
            assert!((periods - 1.2).abs() < 0.05, "{rate_hz} Hz: {periods}");
        }
        let halt = faulty(image, Fault::Halt(5));
        assert_eq!(end(&halt), (Mode::Safe, Stop::TickOverrun), "{rate_hz} Hz");
    }
}

/// Below 10 kHz a tick does what other rates divide among ten.
#[test]
fn monitor_windings_and_balance_stop_the_device_at_the_lowest_rate() {
    let (_, image) = &images()[0];
    let turned = |angle| {
        Hand::Pressing(Press {
            angle,
            moving_s: 0.5,
            rest_s: 4.0,
        })
    };
    let swapped = vec![(SETTLED_S, Fault::SmallSwapped)];
    let runs = [
        (
            of_scene(SceneKind::Off, turned(12.0), 0.5),
            Stop::HandleOverspeed,
        ),
        (of_scene(SceneKind::Hold, turned(1.5), 3.5), Stop::Overload),
        (
            Setup {
                faults: swapped,
                ..of_scene(SceneKind::FreeAir, Hand::Moving, SETTLED_S + 1.0)
            },
            Stop::TorqueBalance,
        ),
    ];
    let ends = runs
        .each_ref()
        .map(|(setup, _)| end(&run_checked(image, setup)));
    assert_eq!(ends, runs.map(|(_, cause)| (Mode::Safe, cause)));
}

#[test]
fn image_whose_control_task_is_too_long_is_not_built() {
    // Each costs seconds of a build if it is not refused.
    assert!(image_at(40_000, "large-kalman,handle-imm").is_err());
    // 84 MHz are no multiple of it.
    assert!(image_at(9000, "large-kalman").is_err());
    assert!(image_at(500, "large-kalman").is_err());
    assert!(image_at(42_000, "large-kalman").is_err());
}
