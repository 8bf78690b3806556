//! Tests of the controllers that know more than a board, whose force bounds that of others.

use experiments::closed_loop::{Conditions, Dac, Exact, Loop, Oracle, TickState};
use haptic_control::SceneKind;
use simulation::plant::Grip;

use crate::loops::on_default;

const SEED: u64 = 1;
const SECONDS: f64 = 4.0;
/// Ticks that are not judged: the handle starts without the torque of the scene.
const SKIP_S: f64 = 0.1;

fn with(scene: SceneKind, rate_hz: f64) -> Loop {
    Loop {
        seed: SEED,
        ..on_default(scene, rate_hz, ["kalman-triple"; 2])
    }
}

fn ticks(run: &Loop) -> usize {
    (SECONDS * run.rate_hz) as usize
}

fn conditions(oracle: Option<Oracle>) -> Conditions<'static> {
    Conditions {
        dac: Some(Dac::board().unwrap()),
        exact: Exact::Both,
        oracle,
        ..Conditions::default()
    }
}

/// Ticks of a run with an oracle that are judged.
fn judged(run: &Loop, oracle: Oracle) -> Vec<TickState> {
    let mut all = Vec::new();
    let observe = |now: &TickState| all.push(*now);
    run.run_under(ticks(run), conditions(Some(oracle)), observe)
        .unwrap();
    assert!(all.iter().all(|now| now.stopped.is_none()));
    // 600 A/s and 1.5 A, up to the rounding to f32.
    let slope = 600.0 / run.rate_hz + 1e-6;
    for pair in all.windows(2) {
        let [before, now] = [&pair[0], &pair[1]].map(|now| now.commanded.1);
        assert!((now - before).abs() <= slope && now.abs() <= 1.5);
    }
    all.split_off((SKIP_S * run.rate_hz) as usize)
}

fn parasitic(now: &TickState) -> f64 {
    now.felt - f64::from(now.action.torque.0)
}

fn rms(signal: impl ExactSizeIterator<Item = f64>) -> f64 {
    let n = signal.len() as f64;
    (signal.map(|x| x * x).sum::<f64>() / n).sqrt()
}

/// Torque of a step of the small motor's DAC: 27.5 mN.m/A times 1.5 A / 2047.
const DAC_STEP: f64 = 27.5e-3 * 1.5 / 2047.0;

/// Scenes whose wanted torque does not depend on the acceleration.
const BOUNDED: [SceneKind; 5] = [
    SceneKind::FreeAir,
    SceneKind::Wall,
    SceneKind::SpringDamper,
    SceneKind::Viscous,
    SceneKind::Texture,
];

/// The hand accelerates by a during a tick, which the oracle does not know. The handle is a mass on the
/// dampings of hand and coupler:
/// ```text
/// J w' = b_h (a t - w) - b w     w(T) = b_h a / (b_h + b) (T - τ (1 - e^(-T/τ)))     τ = J / (b_h + b)
/// torque = b_h (w(T) - a T) - k_h a T² / 2
/// ```
/// No controller that does not know a changes this part of the torque. The position of the handle is
/// neglected, which is 2 % of the torque, and so are the large motor and a reversal inside the tick.
#[test]
fn force_without_the_future_is_what_the_hand_changes_in_a_tick() {
    for rate_hz in [1e3, 1e4] {
        let run = with(SceneKind::FreeAir, rate_hz);
        let (t, hand, stages) = (1.0 / rate_hz, run.device.hand, run.device.stages);
        let (b_h, b) = (hand.damping_nms_per_rad, stages.damping);
        let tau = stages.small.inertia / (b_h + b);
        let omega = b_h / (b_h + b) * (t - tau * (1.0 - (-t / tau).exp()));
        let per_acceleration = b_h * (omega - t) - 0.5 * hand.stiffness_nm_per_rad * t * t;
        let grips = run.hand.grips(t, SEED, ticks(&run));
        let accelerations: Vec<f64> = grips
            .iter()
            .map(|grip| match grip {
                Grip::Hand(motion) => (motion.at(t).omega - motion.at(0.0).omega) / t,
                _ => panic!("a hand"),
            })
            .collect();
        let accelerations = &accelerations[(SKIP_S * rate_hz) as usize..];
        let bound = (per_acceleration * rms(accelerations.iter().copied())).abs();
        let found = rms(judged(&run, Oracle::Present).iter().map(parasitic));
        assert!(
            (found / bound - 1.0).abs() < 0.05,
            "{rate_hz} Hz: {found} N.m, {bound} N.m derived"
        );
    }
}

/// What the oracle leaves beside what the hand changes: the rounding of its current, which after a tick has
/// changed the velocity by at most `step T / (2 J)` and the torque of hand and scene with it.
#[test]
fn oracle_reaches_the_torque_that_it_expects_up_to_a_step_of_the_dac() {
    // In a texture at 10 kHz the slope of the current is limited in a tenth of the ticks.
    let smooth = BOUNDED.iter().filter(|scene| **scene != SceneKind::Texture);
    for rate_hz in [1e3, 1e4] {
        for &scene in smooth.clone() {
            let run = with(scene, rate_hz);
            let t = 1.0 / rate_hz;
            // The viscous field adds 2 mN.m.s/rad to the hand's 3.
            let per_omega = 5e-3;
            let most = per_omega * 0.5 * DAC_STEP * t / run.device.stages.small.inertia;
            for oracle in [Oracle::Present, Oracle::NextTick] {
                let ticks = judged(&run, oracle);
                let expected = ticks.iter().map(|now| now.expected.unwrap());
                let beyond = expected.filter(|torque| torque.abs() > most).count();
                // The slope of the current is limited where friction reverses.
                assert!(
                    beyond * 20 < ticks.len(),
                    "{scene}, {rate_hz} Hz: {beyond} of {}",
                    ticks.len()
                );
            }
        }
    }
}

#[test]
fn oracle_that_knows_the_next_tick_expects_what_comes() {
    for scene in BOUNDED {
        let ticks = judged(&with(scene, 1e3), Oracle::NextTick);
        for pair in ticks.windows(2) {
            let (expected, came) = (pair[0].expected.unwrap(), parasitic(&pair[1]));
            // The torque of the scene is an f32 of at most 0.1 N.m.
            assert!((expected - came).abs() < 1e-8, "{scene}: {expected} {came}");
        }
    }
}

#[test]
fn oracle_that_leaves_the_inertia_leaves_the_inertia() {
    for scene in BOUNDED {
        let run = with(scene, 1e4);
        let ticks = judged(&run, Oracle::InertiaLeft);
        let left = ticks.iter().map(|now| parasitic(now) - now.torques.inertia);
        // Half a step of the current, and as much for what the hand changes.
        let small = left.filter(|torque| torque.abs() < DAC_STEP).count();
        // The rest is reversals, where the slope of the current is limited.
        assert!(
            small * 10 > 9 * ticks.len(),
            "{scene}: {small} of {}",
            ticks.len()
        );
    }
}

#[test]
fn exact_velocities_and_acceleration_are_those_of_the_plant() {
    let run = with(SceneKind::Inertia, 1e3);
    let added = -0.4 * run.device.stages.small.inertia;
    let mut largest = 0.0_f64;
    run.run_under(ticks(&run), conditions(None), |now| {
        // f32 of velocities up to 100 rad/s.
        let large = f64::from(now.action.large_velocity.0) - now.large.omega;
        let handle = f64::from(now.action.handle_velocity.0) - now.handle.omega;
        assert!(
            large.abs() < 2e-5 && handle.abs() < 2e-5,
            "{large} {handle}"
        );
        // The wanted torque is -M α, the inertia's torque -J α.
        let wanted = added / run.device.stages.small.inertia * now.torques.inertia;
        let torque = f64::from(now.action.torque.0);
        assert!(
            (torque - wanted).abs() <= 1e-6 * wanted.abs(),
            "{torque} {wanted}"
        );
        largest = largest.max(wanted.abs());
    })
    .unwrap();
    assert!(largest > 1e-5, "{largest}");
}
