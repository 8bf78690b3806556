//! Tests of the currents of a run.

use super::*;
use haptic_control::SceneKind;

/// A run of a scene on a device without friction and ripple, whose amplifiers have these wrong zeros.
fn with_zeros(scene: SceneKind, hand: Hand, offsets_a: [f64; 2]) -> Loop {
    let mut device = Device::default().frictionless();
    (device.large_ripple.torque, device.small_ripple.torque) = (0.0, 0.0);
    let (assumed, rate_hz) = (device.stages, 2000.0);
    let kind = Kind::named("kalman-triple-steady").unwrap();
    let on = |motor: haptic_control::Motor| {
        let parameters = Parameters::default();
        estimator(kind, &device, motor.counts_per_rev, rate_hz, &parameters).unwrap()
    };
    Loop {
        large: on(assumed.large),
        handle: on(assumed.small),
        scene: usual(scene, &assumed, rate_hz).unwrap(),
        device,
        assumed,
        hand,
        rate_hz,
        seed: 1,
        encoder: FeedbackEncoder::Own,
        poles: LoopPoles::DEFAULT,
        late_ticks: 0,
        offsets_a,
    }
}

/// `J w' = Kt i - b w` of the large motor, and `Kt i + b w` on the clamped handle.
#[test]
fn each_wrong_zero_is_a_current_of_its_motor() {
    let offsets = [0.02, -0.05];
    let run = with_zeros(SceneKind::Off, Hand::Clamp, offsets);
    let DualStage {
        large,
        small,
        damping,
        ..
    } = run.assumed;
    let last = large.torque_constant * offsets[0] / damping;
    run.run(1000, |now| {
        assert_eq!(now.stopped, None);
        // The amplifiers have followed.
        if now.t > 0.01 {
            let omega = last * (1.0 - (-damping / large.inertia * now.t).exp());
            assert!(
                (now.large.omega - omega).abs() < 0.02 * last,
                "{now:?} {omega}"
            );
            let felt = small.torque_constant * offsets[1] + damping * now.large.omega;
            assert!((now.felt - felt).abs() < 1e-6, "{now:?} {felt}");
        }
    })
    .unwrap();
}

#[test]
fn disabled_amplifier_has_no_current_whatever_its_zero() {
    let run = with_zeros(SceneKind::FreeAir, Hand::Moving, [0.0, 0.1]);
    let conditions = Conditions {
        fault: Some((200, Faulty::Large(EncoderFault::Swapped))),
        ..Conditions::default()
    };
    let mut stopped = 0;
    run.run_under(1000, conditions, |now| {
        let [_, from_now] = now.small_amplifier;
        match now.stopped {
            None => assert_eq!(from_now, now.commanded.1 + 0.1),
            Some(_) => assert_eq!(from_now, 0.0),
        }
        stopped += usize::from(now.stopped.is_some());
    })
    .unwrap();
    assert!((1..800).contains(&stopped), "{stopped}");
}

/// The amplifiers get each command a number of ticks after its computation, and nothing before the first one.
#[test]
fn late_command_is_that_of_so_many_ticks_before() {
    for late_ticks in [0, 1, 3] {
        let run = Loop {
            late_ticks,
            ..with_zeros(SceneKind::FreeAir, Hand::Moving, [0.0; 2])
        };
        let (mut commanded, mut applied) = (vec![0.0; late_ticks], Vec::new());
        run.run(300, |now| {
            commanded.push(now.commanded.1);
            applied.push(now.small_amplifier[1]);
        })
        .unwrap();
        assert_eq!(applied, commanded[..300], "{late_ticks} ticks");
        assert!(commanded.windows(2).any(|pair| pair[0] != pair[1]));
    }
}
