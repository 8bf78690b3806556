//! Tests of the closed loop and its scores.

use catalogue::estimators::Kind;
use catalogue::parameters::{Parameters, PlantKind};
use experiments::closed_loop::{Conditions, Hand, Loop, Press, usual};
use experiments::compare::Settings;
use experiments::transparency::{
    Fingertip, LoopCase, LoopSettings, Parasitic, bandwidth_hz, compare, sweep,
};
use haptic_control::{AnyScene, Inertia, SceneKind};
use scoring::score::Wanted;
use simulation::device::Device;
use simulation::plant::Grip;
use std::f64::consts::TAU;

use crate::loops;

fn settings(names: &[&str]) -> LoopSettings {
    LoopSettings {
        common: Settings {
            device: Device::default(),
            estimators: names
                .iter()
                .map(|name| Kind::named(name).unwrap())
                .collect(),
            parameters: Parameters::default(),
            wanted: Wanted::ALL,
        },
        handle: Kind::named("kalman-triple-steady").unwrap(),
    }
}

/// A run of `scene` with the steady Kalman filter for both velocities.
fn with_kalman(scene: AnyScene, device: &Device, hand: Hand, rate_hz: f64) -> Loop {
    Loop {
        hand,
        ..loops::on(device, scene, rate_hz, ["kalman-triple-steady"; 2])
    }
}

#[test]
fn known_grips_are_those_of_the_hand() {
    let device = Device::default();
    let scene = usual(SceneKind::Wall, &device.stages, 1000.0).unwrap();
    let felt = |hand, grips: Option<&[Grip]>| {
        let mut felt = Vec::new();
        let conditions = Conditions {
            grips,
            ..Conditions::default()
        };
        let run = with_kalman(scene, &device, hand, 1000.0);
        run.run_under(300, conditions, |now| felt.push(now.felt.to_bits()))
            .unwrap();
        felt
    };
    for hand in [Hand::Pushing, Hand::Tracking, Hand::Clamp] {
        let grips = hand.grips(1e-3, 1, 300);
        assert_eq!(felt(hand, Some(&grips)), felt(hand, None), "{hand:?}");
        // Too few grips are not used.
        assert_eq!(
            felt(hand, Some(&grips[..200])),
            felt(hand, None),
            "{hand:?}"
        );
    }
    let other = Hand::Pushing.grips(1e-3, 2, 300);
    assert_ne!(felt(Hand::Pushing, Some(&other)), felt(Hand::Pushing, None));
}

#[test]
fn parasitic_force_is_felt_minus_wanted_force() {
    let case = LoopCase {
        scene: SceneKind::Wall,
        rate_hz: 1000.0,
        plant: PlantKind::Friction,
        seed: 3,
        seconds: 1.5,
        keep: true,
        attribute: false,
    };
    let outcomes = compare(&[case], &settings(&["pll"]), &|| ()).unwrap();
    let fingertip = Fingertip::new(&Device::default());
    for run in &outcomes[0].runs {
        let signals = run.signals.as_ref().unwrap();
        let pushed = signals.wanted_mn.iter().copied().fold(0.0, f32::min);
        assert!(pushed < -300.0, "the hand is in the wall: {pushed} mN");
        let forces = signals.felt_mn.iter().zip(&signals.wanted_mn);
        let parasitic: Vec<f64> = forces
            .map(|(felt, wanted)| f64::from(felt - wanted))
            .collect();
        let again = Parasitic::of(&parasitic, 1000.0, &fingertip);
        let rms = |score: &Parasitic| score.parasitic_mn_rms.unwrap();
        assert!((rms(&again) / rms(&run.parasitic) - 1.0).abs() < 1e-3);
        assert!(rms(&again) < 30.0, "felt is what was wanted, nearly");
    }
}

#[test]
fn scene_off_has_no_current_and_only_scenes_with_a_loop_use_the_large_velocity() {
    let (device, rate_hz) = (Device::default(), 1000.0);
    for scene in SceneKind::environments() {
        let scene_parameters = usual(scene, &device.stages, rate_hz).unwrap();
        let run = with_kalman(scene_parameters, &device, Hand::Moving, rate_hz);
        let (mut driven, mut known, mut counted) = (false, false, false);
        run.run(500, |moment| {
            let currents = moment.action.currents;
            driven |= currents.large.get() != 0.0 || currents.small.get() != 0.0;
            known |= moment.action.large_velocity.0 != 0.0;
            counted |= moment.own_count != moment.sample.count;
        })
        .unwrap();
        assert_eq!(driven, scene != SceneKind::Off, "{scene}");
        assert_eq!(known, scene.facts().needs.continuous, "{scene}");
        assert!(!counted, "the loop sees the device's own encoder");
    }
}

#[test]
fn a_hard_press_does_not_stop_a_scene() {
    let (device, rate_hz) = (Device::default(), 1000.0);
    // 0.5 N.m/rad: 10 N at 35 mm on a handle that stays where it is, and twice as far.
    for angle in [0.7, 1.4] {
        for scene in SceneKind::environments() {
            let hand = Hand::Pressing(Press {
                angle: 0.1 + angle,
                moving_s: 0.4,
                rest_s: 0.3,
            });
            let scene_parameters = usual(scene, &device.stages, rate_hz).unwrap();
            let run = with_kalman(scene_parameters, &device, hand, rate_hz);
            let mut stopped = None;
            run.run(1300, |moment| stopped = moment.stopped).unwrap();
            assert_eq!(stopped, None, "{scene}, {angle} rad");
        }
    }
}

#[test]
fn torque_is_rendered_flat_up_to_the_amplifiers() {
    let swept = sweep(
        &settings(&["finite-difference"]),
        10e3,
        PlantKind::Frictionless,
    )
    .unwrap();
    let (name, responses) = &swept.runs[1];
    assert_eq!((*name, responses[0].hz), ("reference", 2.0));
    for response in responses {
        assert!(
            (0.0..=1.0 + 1e-9).contains(&response.coherence),
            "{response:?}"
        );
        if response.hz < 10.0 {
            assert!((response.gain - 1.0).abs() < 0.03, "{response:?}");
            assert!(response.phase_deg.abs() < 3.0, "{response:?}");
        }
    }
    // An amplifier of 2 kHz, a tick of delay in the large motor's part, half a tick of holding.
    let bandwidth = bandwidth_hz(responses).unwrap();
    assert!((1400.0..2100.0).contains(&bandwidth), "{bandwidth}");
    let (_, difference) = &swept.runs[0];
    let least = |of: &[experiments::transparency::Response]| {
        of.iter().map(|r| r.coherence).fold(1.0, f64::min)
    };
    assert!(least(difference) < least(responses));
}

/// The inertia that a hand feels: felt torque against the handle's acceleration, least squares,
/// over the whole motion and with both through the same four poles at 1 Hz.
fn felt_inertia(scene: impl Into<AnyScene>, device: &Device) -> [f64; 2] {
    let rate_hz = 10e3;
    let run = with_kalman(scene.into(), device, Hand::Moving, rate_hz);
    let slow = |poles: &mut [f64; 4], input: f64| {
        poles.iter_mut().fold(input, |input, pole| {
            *pole += TAU / rate_hz * (input - *pole);
            *pole
        })
    };
    let mut poles = [[0.0; 4]; 2];
    let (mut products, mut squares) = ([0.0; 2], [0.0; 2]);
    run.run(100_000, |now| {
        // The handle moves at the start, which the estimator does not know.
        if now.t < 0.5 {
            return;
        }
        let (felt, acceleration) = (now.felt, now.handle_acceleration);
        let slowly = (slow(&mut poles[0], felt), slow(&mut poles[1], acceleration));
        for (at, (felt, acceleration)) in [(felt, acceleration), slowly].into_iter().enumerate() {
            products[at] -= felt * acceleration;
            squares[at] += acceleration * acceleration;
        }
    })
    .unwrap();
    let own = device.stages.small.inertia;
    [0, 1].map(|at| products[at] / squares[at] / own)
}

/// An inertia as a part of the handle's own.
fn inertia(part: f32, device: &Device) -> Inertia {
    let own = device.stages.small.inertia as f32;
    Inertia::new(part * own, own).unwrap()
}

#[test]
fn virtual_inertia_adds_to_that_of_the_handle() {
    // The compensation of drag and friction, which beside a spring is least right after a reversal, may take
    // inertia off and must not add any.
    let device = Device::default();
    let plain = felt_inertia(inertia(0.0, &device), &device)[0];
    assert!((0.0..1.1).contains(&plain), "{plain}");
    // In slow motion the lag of the estimate is none, and without friction torques add up, but for the drag, which
    // is compensated by the time since a reversal.
    let device = device.frictionless();
    let [lighter, plain, heavier] =
        [-0.4, 0.0, 0.4].map(|part| felt_inertia(inertia(part, &device), &device)[1]);
    for added in [heavier - plain, plain - lighter] {
        assert!((added - 0.4).abs() < 0.01, "{lighter}, {plain}, {heavier}");
    }
}
