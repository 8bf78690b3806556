//! Faults of the large encoder in closed loop: the monitor ends them, scene by scene.

use catalogue::estimators::Kind;
use catalogue::parameters::Parameters;
use experiments::closed_loop::{
    EncoderFault, Faulty, FeedbackEncoder, Hand, Loop, estimator, usual,
};
use haptic_control::{LoopPoles, SceneKind, SimulatedHand, Stop};
use simulation::device::Device;

const FAULT_S: f64 = 0.5;

fn closed(scene: SceneKind, rate_hz: f64, seed: u64) -> Loop {
    let device = Device::default();
    let kind = Kind::named("kalman-triple-steady").unwrap();
    let on =
        |counts: u32| estimator(kind, &device, counts, rate_hz, &Parameters::default()).unwrap();
    Loop {
        large: on(device.stages.large.counts_per_rev),
        handle: on(device.stages.small.counts_per_rev),
        scene: usual(scene, &device.stages, rate_hz).unwrap(),
        assumed: device.stages,
        device,
        hand: match scene.facts().hand {
            SimulatedHand::WallPress => Hand::Pushing,
            _ => Hand::Moving,
        },
        rate_hz,
        seed,
        encoder: FeedbackEncoder::Own,
        poles: LoopPoles::DEFAULT,
        late_ticks: 0,
        offsets_a: [0.0; 2],
    }
}

struct Ended {
    /// Time from the fault to the stop, s, and why.
    stop: Option<(f64, Stop)>,
    /// Largest difference from what a healthy device makes the hand feel, N.m.
    spurious_nm: f64,
}

fn with(run: &Loop, fault: EncoderFault, seconds: f64) -> Ended {
    let ticks = (seconds * run.rate_hz) as usize;
    let from = (FAULT_S * run.rate_hz) as usize;
    let mut healthy = Vec::with_capacity(ticks);
    run.run(ticks, |now| healthy.push(now.felt)).unwrap();
    let mut ended = Ended {
        stop: None,
        spurious_nm: 0.0,
    };
    let mut k = 0;
    run.run_with(ticks, Some((from, Faulty::Large(fault))), |now| {
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
        let ended = with(&closed(scene, rate_hz, seed), fault, 1.5);
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
            let causes = [Stop::Stall, Stop::RunawayDirection];
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
    for scene in with_large_motor() {
        let (stop_s, spurious_nm) =
            worst(scene, 2e3, EncoderFault::Swapped, &[Stop::RunawayDirection]);
        println!("{scene}: {stop_s} s, {spurious_nm} N.m");
        assert!(stop_s < 0.2, "{scene}: {stop_s} s");
        // The estimate turns round at once, and with it half of what the coupler brings.
        let most = if springs(scene) { 0.04 } else { 0.012 };
        assert!(spurious_nm < most, "{scene}: {spurious_nm} N.m");
    }
}
