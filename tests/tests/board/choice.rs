//! The large motor's estimator, exchanged by command while the board runs.

use std::sync::OnceLock;

use drivers::NO_ESTIMATOR;
use estimator_core::{Confidence as _, VelocityEstimator as _};
use experiments::closed_loop::Hand;
use firmware_app::large;
use firmware_app::scene::RIG;
use haptic_control::{Mode, SceneKind, Stop};
use recordings::telemetry::Frame;
use virtual_board::command::Command;
use virtual_board::run::{ControlTick, Outcome, Setup};

use crate::image::{of_scene, run, run_image};
use crate::mirror::{mirrored, same_bits};

/// When the filter takes over and when the window does again, s.
const CHANGES_S: [f64; 2] = [2.0, 3.5];
/// Ticks that a change takes, and of these the fade.
const CHANGE: usize = 400;
const FADE: f32 = 200.0;

fn changing(scene: SceneKind, hand: Hand) -> Setup {
    let mut setup = of_scene(scene, hand, 5.0);
    let changes = CHANGES_S.into_iter().zip([1, 0]);
    setup
        .commands
        .extend(changes.map(|(at, number)| (at, Command::Estimator(number))));
    setup
}

/// Free air in a moving hand and a wall in a pushing one, changed twice.
fn runs() -> &'static [Outcome; 2] {
    static RUNS: OnceLock<[Outcome; 2]> = OnceLock::new();
    RUNS.get_or_init(|| {
        [
            (SceneKind::FreeAir, Hand::Moving),
            (SceneKind::Wall, Hand::Pushing),
        ]
        .map(|(scene, hand)| run(&changing(scene, hand)))
    })
}

#[test]
fn telemetry_has_the_number_of_the_active_estimator() {
    for run in runs() {
        let told: Vec<_> = run.telemetry.frames.iter().collect();
        let mut told: Vec<_> = told.iter().map(|frame| frame.estimator.unwrap()).collect();
        let taking_over = told
            .iter()
            .filter(|number| **number == NO_ESTIMATOR)
            .count();
        told.dedup();
        // No estimator is active before the scene starts (100 ms until arming, 20 ms of settling)
        // and during a handover (40 ms each).
        assert_eq!(told, [NO_ESTIMATOR, 0, NO_ESTIMATOR, 1, NO_ESTIMATOR, 0]);
        assert!(
            (120 + 78..=125 + 82).contains(&taking_over),
            "{taking_over}"
        );
        let last = run.telemetry.frames.last().unwrap();
        assert_eq!((last.state, last.cause), (Mode::Running, Stop::None));
        assert_eq!((last.overruns, last.drops), (0, 0));
        // While both run the task takes longer; less than a quarter of its period, at
        // one cycle an instruction.
        let change = |tick: &&ControlTick| {
            CHANGES_S.iter().any(|at| {
                let since = tick.at_ns as f64 * 1e-9 - at;
                (0.0..0.05).contains(&since)
            })
        };
        let during = run
            .ticks
            .iter()
            .filter(change)
            .map(|tick| tick.instructions);
        let most = during.max().unwrap();
        println!("at most {most} instructions during a change");
        assert!(most > 1300 && most < 4200, "{most} instructions");
    }
}

/// Telemetry agrees with the host bit for bit. At every tick of a change the step of the velocity
/// is bounded by the steps of both estimators and the fade.
#[test]
fn change_of_estimator_causes_no_step_of_the_velocity() {
    for run in runs() {
        let host = mirrored(run);
        same_bits(run, &host);
        let records: Vec<_> = host.iter().map(|(_, record)| record).collect();
        let number = |k: usize| records[k].estimation.number;
        let mut changes = 0;
        let (mut window, mut filter) = (
            large::WINDOW.start(&records[0].sample),
            large::FILTER.start(&records[0].sample),
        );
        let mut last = [0.0_f32; 3];
        for (k, record) in records.iter().enumerate().skip(1) {
            let sample = &record.sample;
            let velocity = |v: estimator_core::CountsPerTick| v.rad_per_s(&RIG.large_scale);
            let now = [
                record.action.large_velocity.0,
                velocity(large::WINDOW.update(&mut window, sample)),
                velocity(large::FILTER.update(&mut filter, sample)),
            ];
            let moved = [0, 1, 2].map(|n: usize| (now[n] - last[n]).abs());
            let apart = (now[1] - now[2]).abs().max((last[1] - last[2]).abs());
            let allowed = match (number(k - 1), number(k)) {
                (None, None) | (None, Some(_)) => moved[1].max(moved[2]) + apart / FADE,
                (Some(0), _) => moved[1],
                _ => moved[2],
            };
            // Before both windows are full and the filter has settled they are not the image's.
            if k > 10_000 {
                assert!(
                    moved[0] <= 1.0001 * allowed + 1e-4,
                    "{k}: {moved:?} {apart}"
                );
            }
            match (number(k - 1), number(k)) {
                (Some(0), None) => filter = large::FILTER.start(sample),
                (Some(1), None) => window = large::WINDOW.start(sample),
                _ => {}
            }
            changes += usize::from(number(k).is_none() && number(k - 1).is_some());
            last = now;
        }
        assert_eq!(changes, 2);
    }
}

/// Largest change of the force at the fingertip within a millisecond of `range`, mN.
fn jump_mn(run: &Outcome, range: std::ops::Range<usize>) -> f64 {
    let diameter_m = 0.07;
    let felt = |k: usize| run.ticks[k].felt;
    let changes = range.map(|k| (felt(k + 10) - felt(k)).abs());
    changes.fold(0.0, f64::max) * 2e3 / diameter_m
}

/// A fingertip feels 10 mN. A pushing hand shakes on the wall by more than that each millisecond,
/// so what counts is what a change adds to what was there before.
#[test]
fn change_of_estimator_causes_no_noticeable_force() {
    for run in runs() {
        for at in CHANGES_S {
            let first = (at * 1e4) as usize;
            let during = jump_mn(run, first..first + CHANGE + 200);
            let before = jump_mn(run, first - CHANGE - 200..first - 10);
            println!("{at} s: {during:.2} mN within 1 ms, before {before:.2} mN");
            assert!(
                during < before + 5.0,
                "{at} s: {during} mN, before {before} mN"
            );
            assert!(
                during > 0.2 * before,
                "{at} s: {during} mN, before {before} mN"
            );
        }
    }
}

/// Nearly all velocities are within two of the reported standard deviations, and these are small
/// enough to be informative.
#[test]
fn standard_deviation_in_telemetry_is_valid() {
    let [air, _] = runs();
    let frames = |number: u8| {
        let inside = move |frame: &&Frame| frame.tick > 10_000 && frame.estimator == Some(number);
        air.telemetry.frames.iter().filter(inside)
    };
    for number in [0, 1] {
        let error =
            |frame: &Frame| f64::from(frame.velocity_large) - air.tick(frame).unwrap().large.omega;
        let sigma = |frame: &Frame| f64::from(frame.sigma_large.unwrap());
        let n = frames(number).count() as f64;
        let within = frames(number).filter(|f| error(f).abs() <= 2.0 * sigma(f));
        let within = within.count() as f64 / n;
        let rms = |of: &dyn Fn(&Frame) -> f64| {
            (frames(number).map(|f| of(f).powi(2)).sum::<f64>() / n).sqrt()
        };
        let ratio = rms(&sigma) / rms(&error);
        println!("{number}: {within:.3} within 2 sigma, sigma {ratio:.2} of the error, {n} frames");
        assert!(
            n > 900.0 && within > 0.9 && ratio < 4.0,
            "{number}: {within} {ratio}"
        );
    }
    // The very numbers: a full window of 32 and the steady filter.
    let first = |number| frames(number).next().unwrap().sigma_large.unwrap();
    let filter = large::FILTER.variance(&large::FILTER.start(&estimator_core::Sample::default()));
    assert_eq!(first(1), filter.std_dev().rad_per_s(&RIG.large_scale));
}

#[test]
fn unknown_estimator_is_refused() {
    let mut setup = of_scene(SceneKind::FreeAir, Hand::Moving, 1.0);
    setup.commands.push((0.5, Command::Estimator(2)));
    let refused = |run: &Outcome| {
        let mut log = run.telemetry.log.iter();
        log.any(|line| line == "refused not-finite=0 out-of-bounds=0 unknown=1 unverified=0")
    };
    let two = run(&setup);
    assert!(refused(&two), "{:?}", two.telemetry.log);
    // An image of one has nothing to choose.
    setup.commands.pop();
    setup.commands.push((0.5, Command::Estimator(0)));
    let one = run_image("large-foaw", &setup);
    assert!(refused(&one), "{:?}", one.telemetry.log);
    for run in [&one, &two] {
        assert_eq!(run.telemetry.frames.last().unwrap().estimator, Some(0));
    }
}

/// A choice lasts: over a change of scene that needs no estimator, and over disarm.
#[test]
fn selected_estimator_persists() {
    let air = Command::Scene(SceneKind::FreeAir);
    let run = run(&Setup {
        commands: vec![
            (0.05, air),
            (0.1, Command::Arm),
            (0.3, Command::Estimator(1)),
            (0.5, Command::Scene(SceneKind::Off)),
            (0.6, air),
            (0.8, Command::Disarm),
            (0.9, Command::Arm),
            (0.95, air),
        ],
        seconds: 1.2,
        ..Setup::default()
    });
    let at = |t: f64| {
        let tick = (t * 1e4) as u32;
        let frame = run.telemetry.frames.iter().find(|frame| frame.tick >= tick);
        frame.unwrap().estimator
    };
    assert_eq!(at(0.29), Some(0));
    assert_eq!(at(0.55), Some(NO_ESTIMATOR));
    // At once: there was nothing to fade from.
    assert_eq!(at(0.61), Some(1));
    assert_eq!(at(1.15), Some(1));
}
