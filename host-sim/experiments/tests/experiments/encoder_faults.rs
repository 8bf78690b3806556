//! Faults of the encoders in closed loop: monitor and balance end them, scene by scene.

use experiments::closed_loop::{Conditions, EncoderFault, Faulty, Hand, Loop, Press};
use experiments::robust::corners::corners;
use haptic_control::{SceneKind, SimulatedHand, Stop};

use crate::loops::on_default;

const FAULT_S: f64 = 0.5;

fn closed(scene: SceneKind, rate_hz: f64, seed: u64) -> Loop {
    Loop {
        hand: match scene.facts().hand {
            SimulatedHand::WallPress => Hand::Pushing,
            _ => Hand::Moving,
        },
        seed,
        ..on_default(scene, rate_hz, ["kalman-triple-steady"; 2])
    }
}

struct Ended {
    /// Time from the fault to the stop, s, and why.
    stop: Option<(f64, Stop)>,
    /// Largest difference from what a healthy device makes the hand feel, N.m.
    spurious_nm: f64,
}

fn with(run: &Loop, fault: Faulty, seconds: f64) -> Ended {
    let ticks = (seconds * run.rate_hz) as usize;
    let from = (FAULT_S * run.rate_hz) as usize;
    let mut healthy = Vec::with_capacity(ticks);
    run.run(ticks, |now| healthy.push(now.felt)).unwrap();
    let mut ended = Ended {
        stop: None,
        spurious_nm: 0.0,
    };
    let mut k = 0;
    let conditions = Conditions {
        fault: Some((from, fault)),
        ..Conditions::default()
    };
    run.run_under(ticks, conditions, |now| {
        if ended.stop.is_none() {
            ended.spurious_nm = ended.spurious_nm.max((now.felt - healthy[k]).abs());
            ended.stop = now.stopped.map(|cause| (now.t - FAULT_S, cause));
        }
        k += 1;
    })
    .unwrap();
    ended
}

/// Largest time until the stop and largest spurious torque over seeds, and whether each cause was
/// one of `causes`.
fn worst(scene: SceneKind, rate_hz: f64, fault: EncoderFault, causes: &[Stop]) -> (f64, f64) {
    let mut worst = (0.0_f64, 0.0_f64);
    for seed in 1..=6 {
        let ended = with(&closed(scene, rate_hz, seed), Faulty::Large(fault), 1.5);
        let (stop_s, cause) = ended
            .stop
            .unwrap_or_else(|| panic!("{scene}, {fault:?}, {seed}"));
        assert!(
            causes.contains(&cause),
            "{scene}, {fault:?}, {seed}: {cause:?}"
        );
        worst = (worst.0.max(stop_s), worst.1.max(ended.spurious_nm));
    }
    worst
}

fn with_large_motor() -> impl Iterator<Item = SceneKind> {
    SceneKind::environments().filter(|scene| scene.facts().needs.continuous)
}

/// Whether the hand presses against a spring, whose torque may vanish.
fn springs(scene: SceneKind) -> bool {
    scene.parameter("stiffness").is_some()
}

#[test]
fn stuck_encoder_is_stopped_before_the_limits_are_exceeded() {
    for scene in with_large_motor() {
        for fault in [
            EncoderFault::StuckA,
            EncoderFault::StuckB,
            EncoderFault::StuckBoth,
        ] {
            let causes = [Stop::Stall, Stop::RunawayDirection, Stop::TorqueBalance];
            let (stop_s, spurious_nm) = worst(scene, 2e3, fault, &causes);
            println!("{scene}, {fault:?}: {stop_s} s, {spurious_nm} N.m");
            // Where nothing moves nothing is wrong yet; free air and a weak field need a motion.
            assert!(stop_s < 0.8, "{scene}, {fault:?}: {stop_s} s");
            let most = if springs(scene) { 0.15 } else { 0.0175 };
            assert!(spurious_nm < most, "{scene}, {fault:?}: {spurious_nm} N.m");
        }
    }
}

#[test]
fn exchanged_phases_are_stopped_at_the_first_motion() {
    let causes = [Stop::RunawayDirection, Stop::TorqueBalance];
    for scene in with_large_motor() {
        let (stop_s, spurious_nm) = worst(scene, 2e3, EncoderFault::Swapped, &causes);
        println!("{scene}: {stop_s} s, {spurious_nm} N.m");
        assert!(stop_s < 0.2, "{scene}: {stop_s} s");
        // The estimate turns round at once, and with it half of what the coupler brings.
        let most = if springs(scene) { 0.04 } else { 0.012 };
        assert!(spurious_nm < most, "{scene}: {spurious_nm} N.m");
    }
}

/// A press with 10 N into the wall and back.
fn pressing(run: Loop) -> Loop {
    let torque = 10.0 * 0.5 * run.device.handle.diameter_m;
    let stiffness = 0.3;
    let compliance = torque / stiffness + torque / run.device.hand.stiffness_nm_per_rad;
    Loop {
        hand: Hand::Pressing(Press {
            angle: 0.1 + compliance,
            moving_s: 0.8,
            rest_s: 0.3,
        }),
        ..run
    }
}

#[test]
fn handle_that_counts_backwards_is_stopped_where_the_large_motor_turns() {
    let swapped = Faulty::Small(EncoderFault::Swapped);
    for scene in [SceneKind::Wall, SceneKind::SpringDamper, SceneKind::Hold] {
        for seed in 1..=6 {
            let run = pressing(closed(scene, 10e3, seed));
            let (stop_s, cause) = with(&run, swapped, 1.0)
                .stop
                .unwrap_or_else(|| panic!("{scene}"));
            println!("{scene}, {seed}: {stop_s} s");
            assert_eq!(cause, Stop::TorqueBalance, "{scene}, {seed}");
            // Three windows of 20 ms, and a tick.
            assert!(stop_s < 0.061, "{scene}, {seed}: {stop_s} s");
        }
    }
    // A hand in free air moves faster than 2 rad/s at times.
    for seed in 1..=6 {
        let run = closed(SceneKind::FreeAir, 10e3, seed);
        let (stop_s, cause) = with(&run, swapped, 2.5).stop.expect("free air");
        println!("free air, {seed}: {stop_s} s");
        assert_eq!(cause, Stop::TorqueBalance, "{seed}");
    }
}

#[test]
fn healthy_devices_at_the_ends_of_the_tolerances_are_balanced() {
    for scene in SceneKind::environments() {
        for (i, (name, variation)) in corners().into_iter().enumerate() {
            let run = closed(scene, 2e3, i as u64 + 1);
            let nominal = run.device.clone();
            let varied = Loop {
                device: variation.of(&nominal),
                late_ticks: variation.late_ticks,
                offsets_a: variation.offsets_a(&nominal.stages),
                ..run
            };
            let swinging = Loop {
                hand: Hand::Moving,
                ..varied.clone()
            };
            for run in [pressing(varied), swinging] {
                let mut stopped = None;
                let ticks = (2.0 * run.rate_hz) as usize;
                run.run(ticks, |now| stopped = now.stopped).unwrap();
                assert_ne!(stopped, Some(Stop::TorqueBalance), "{scene}, {name}");
            }
        }
    }
}

/// What the balance has learned from many windows stays true: stops, reversals and minutes of them.
#[test]
fn healthy_devices_stay_balanced_for_minutes() {
    let seconds = |run: &Loop, seconds: f64| {
        let ticks = (seconds * run.rate_hz) as usize;
        let mut stopped = None;
        run.run(ticks, |now| {
            stopped = stopped.or(now.stopped.map(|cause| (now.t, cause)));
        })
        .unwrap();
        stopped
    };
    let tracking = |scene, seed| Loop {
        hand: Hand::Tracking,
        ..closed(scene, 10e3, seed)
    };
    for scene in with_large_motor() {
        for seed in 11..=13 {
            let stopped = seconds(&tracking(scene, seed), 60.0);
            assert_eq!(stopped, None, "{scene}, {seed}");
        }
        for (i, (name, variation)) in corners().into_iter().enumerate() {
            let run = tracking(scene, i as u64 + 21);
            let nominal = run.device.clone();
            let varied = Loop {
                device: variation.of(&nominal),
                late_ticks: variation.late_ticks,
                offsets_a: variation.offsets_a(&nominal.stages),
                ..run
            };
            let stopped = seconds(&varied, 6.0).map(|(_, cause)| cause);
            assert_ne!(stopped, Some(Stop::TorqueBalance), "{scene}, {name}");
        }
    }
}
