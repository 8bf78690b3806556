//! Scenes: the torque they want, and the parameters that they take.

use estimator_core::{Count, Hertz, Sample, preset};
use haptic_control::{
    Controller, DesignError, Detents, FreeAir, Handle, HandleFor, Hold, Inertia, Off, RadPerS,
    RadPerS2, Radians, Scene, SceneKind, Senses, SpringDamper, Texture, Torque, Viscous, Wall,
};

use crate::bench::{HANDLE, LARGE, RATE, RIG, motion};

const OFF: Off = Off;
const FREE_AIR: FreeAir = FreeAir;
const WALL: Wall = preset!(Wall::new(Radians(0.1), 0.3, 1e-3));
const SPRING: SpringDamper = preset!(SpringDamper::new(Radians(0.0), 0.1, 1e-3));
const VISCOUS: Viscous = preset!(Viscous::new(2e-3));
const DETENTS: Detents = preset!(Detents::new(8e-3, 24));
const TEXTURE: Texture = preset!(Texture::new(6e-3, Hertz(200.0), RATE));
const HOLD: Hold = preset!(Hold::new(0.2, 1e-3));

/// Torque on the handle at rest, `counts` from its start.
fn torque_at(
    scene: impl Scene<Acceleration: Senses<estimator_core::SteadyKalmanTriple>>,
    counts: i32,
) -> f32 {
    let controller = Controller::new(scene, LARGE, HANDLE, &RIG);
    let start = Sample::default();
    let mut state = controller.start(&start);
    let there = start.with_coupled(Count(counts as u32));
    let mut torque = 0.0;
    for _ in 0..20_000 {
        torque = controller.step(&mut state, &there).torque.0;
    }
    torque
}

/// 1000 counts of the small encoder.
const ANGLE: f32 = 0.314_159_27;

#[test]
fn torques_at_rest_agree_with_the_formulas() {
    let near =
        |torque: f32, wanted: f32| assert!((torque - wanted).abs() < 1e-6, "{torque} {wanted}");
    for sign in [1, -1] {
        let angle = sign as f32 * ANGLE;
        near(torque_at(OFF, 1000 * sign), 0.0);
        near(torque_at(FREE_AIR, 1000 * sign), 0.0);
        near(torque_at(VISCOUS, 1000 * sign), 0.0);
        near(torque_at(SPRING, 1000 * sign), -0.1 * angle);
        near(torque_at(HOLD, 1000 * sign), -0.2 * angle);
    }
    near(torque_at(WALL, 1000), -0.3 * (ANGLE - 0.1));
    near(torque_at(WALL, 318), 0.0);
    near(torque_at(WALL, -5000), 0.0);
}

#[test]
fn a_wall_never_pulls() {
    let controller = Controller::new(WALL, LARGE, HANDLE, &RIG);
    let mut state = controller.start(&motion(0));
    let mut deepest = 0.0_f32;
    for k in 1..16_000 {
        let torque = controller.step(&mut state, &motion(k)).torque.0;
        assert!(torque <= 0.0, "{k}: {torque}");
        deepest = deepest.min(torque);
    }
    assert!(deepest < -0.1, "it was pushed: {deepest}");
}

#[test]
fn detents_are_evenly_spaced_over_a_turn() {
    // 24 a turn of 20000 counts: 833.3 counts from one rest to the next.
    for turn in [-3.0, 0.0, 2.0, 40.0] {
        let at = |part: f64| {
            let counts = (20_000.0 * (turn + part / 24.0)).round() as i32;
            f64::from(torque_at(DETENTS, counts))
        };
        for detent in 0..24 {
            let detent = f64::from(detent);
            assert!(at(detent).abs() < 5e-5, "{turn} {detent}: {}", at(detent));
            // It pushes back to the rest from either side, most in the middle between.
            assert!((at(detent + 0.25) + 8e-3).abs() < 5e-5, "{turn} {detent}");
            assert!((at(detent - 0.25) - 8e-3).abs() < 5e-5, "{turn} {detent}");
        }
    }
}

#[test]
fn texture_has_its_frequency_and_amplitude() {
    let controller = Controller::new(TEXTURE, LARGE, HANDLE, &RIG);
    let sample = Sample::default();
    let mut state = controller.start(&sample);
    let torques: Vec<_> = (0..10_000)
        .map(|_| controller.step(&mut state, &sample).torque.0)
        .collect();
    let rises = torques
        .windows(2)
        .filter(|w| w[0] <= 0.0 && w[1] > 0.0)
        .count();
    assert!((199..=201).contains(&rises), "{rises} periods in a second");
    let largest = torques.iter().fold(0.0_f32, |a, t| a.max(t.abs()));
    // The samples nearest the peak are 3.6 degrees from it.
    assert!((largest - 6e-3 * 0.998).abs() < 1e-5, "{largest}");
}

fn near(value: f32, wanted: f64) {
    assert!((f64::from(value) - wanted).abs() < 1e-6, "{value} {wanted}");
}

/// The torque of a scene without a state, for a handle as it says.
fn of<S: Scene<State = ()>>(scene: &S, handle: &HandleFor<S>) -> f32 {
    scene.start(Radians(0.0));
    scene.torque(&mut (), handle).0
}

#[test]
fn torques_agree_with_the_formulas() {
    let (angle, velocity) = (Radians(0.3), RadPerS(-4.0));
    let moving = Handle {
        angle,
        velocity,
        acceleration: (),
    };
    near(of(&VISCOUS, &moving), 2e-3 * 4.0);
    near(of(&WALL, &moving), -0.3 * 0.2 + 1e-3 * 4.0);
    let spring = SpringDamper::new(Radians(-0.2), 0.1, 1e-3).unwrap();
    near(of(&spring, &moving), -0.1 * 0.5 + 1e-3 * 4.0);
    near(
        HOLD.torque(&mut Radians(0.5), &moving).0,
        0.2 * 0.2 + 1e-3 * 4.0,
    );
    let still = Handle {
        angle,
        velocity: (),
        acceleration: (),
    };
    near(of(&OFF, &still), 0.0);
    near(of(&FREE_AIR, &still), 0.0);
    near(of(&Torque::new(-0.03).unwrap(), &still), -0.03);
    for (inertia, acceleration) in [(2e-6, 3000.0), (-1.5e-6, 3000.0), (2.5e-6, -7000.0)] {
        let scene = Inertia::new(inertia, 5e-6).unwrap();
        let accelerating = Handle {
            angle,
            velocity: (),
            acceleration: RadPerS2(acceleration),
        };
        let wanted = -f64::from(inertia) * f64::from(acceleration);
        assert!((f64::from(of(&scene, &accelerating)) / wanted - 1.0).abs() < 1e-6);
    }
}

#[test]
fn wall_has_no_torque_before_its_position() {
    let at = |angle, velocity| {
        let handle = Handle {
            angle: Radians(angle),
            velocity: RadPerS(velocity),
            acceleration: (),
        };
        of(&WALL, &handle)
    };
    for velocity in [-100.0, 0.0, 100.0] {
        assert_eq!(
            [0.1, 0.099, -3.0].map(|angle| at(angle, velocity)),
            [0.0; 3]
        );
    }
    near(at(0.1 + 1e-3, 5.0), -0.3e-3 - 5e-3);
    // Left so fast that its damper would pull.
    assert_eq!(at(0.2, -100.0), 0.0);
}

#[test]
fn texture_is_a_sine_from_the_first_tick() {
    for (frequency, rate) in [(50.0, 1e3), (150.0, 10e3), (300.0, 100e3)] {
        let texture = Texture::new(6e-3, Hertz(frequency), Hertz(rate)).unwrap();
        let mut phase = texture.start(Radians(0.3));
        assert_eq!(phase, 0);
        let handle = Handle {
            angle: Radians(0.0),
            velocity: (),
            acceleration: (),
        };
        for k in 1..20_000 {
            let turn = f64::from(k) * frequency / rate;
            let wanted = 6e-3 * (std::f64::consts::TAU * turn).sin();
            let torque = f64::from(texture.torque(&mut phase, &handle).0);
            // The sine's bound, and the phase's rounding.
            let error = (torque - wanted).abs();
            assert!(error < 6e-3 * 0.0012, "{frequency} {k}: {torque} {wanted}");
        }
    }
}

/// All but the set-point of a torque and the excitation, which commands its currents itself.
#[test]
fn environments_are_the_scenes_that_render_by_themselves() {
    let others = [SceneKind::Torque, SceneKind::Excite];
    let all = SceneKind::ALL.into_iter();
    assert!(SceneKind::environments().eq(all.filter(|kind| !others.contains(kind))));
}

#[test]
fn parameters_are_accepted_at_the_limits_and_refused_beyond() {
    let scene = DesignError::Scene;
    let gains = [f32::NAN, f32::INFINITY, -1e-9, f32::NEG_INFINITY];
    for bad in gains {
        assert_eq!(Wall::new(Radians(0.0), bad, 0.0), Err(scene));
        assert_eq!(Wall::new(Radians(0.0), 0.0, bad), Err(scene));
        assert_eq!(SpringDamper::new(Radians(0.0), bad, 0.0), Err(scene));
        assert_eq!(SpringDamper::new(Radians(0.0), 0.0, bad), Err(scene));
        assert_eq!(Viscous::new(bad), Err(scene));
        assert_eq!(Hold::new(bad, 0.0), Err(scene));
        assert_eq!(Hold::new(0.0, bad), Err(scene));
        assert_eq!(Detents::new(bad, 24), Err(scene));
        assert_eq!(Texture::new(bad, Hertz(100.0), RATE), Err(scene));
    }
    for bad in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY] {
        assert_eq!(Wall::new(Radians(bad), 0.3, 0.0), Err(scene));
        assert_eq!(SpringDamper::new(Radians(bad), 0.3, 0.0), Err(scene));
        assert_eq!(Torque::new(bad), Err(scene));
        assert_eq!(Inertia::new(bad, 5e-6), Err(scene));
        assert_eq!(Inertia::new(0.0, bad), Err(scene));
    }
    assert!(Wall::new(Radians(-1e3), 0.0, 0.0).is_ok());
    assert!(SpringDamper::new(Radians(-1e3), 0.0, 0.0).is_ok());
    assert!(Viscous::new(0.0).is_ok() && Hold::new(0.0, 0.0).is_ok());
    assert!(Torque::new(-1e3).is_ok());

    assert_eq!(Detents::new(1e-3, 0), Err(scene));
    assert_eq!(Detents::new(1e-3, 1001), Err(scene));
    assert!(Detents::new(0.0, 1).is_ok() && Detents::new(0.0, 1000).is_ok());

    let texture = |frequency, rate| Texture::new(1e-3, Hertz(frequency), Hertz(rate));
    for (frequency, rate) in [
        (49.9, 10e3),
        (300.1, 10e3),
        (200.1, 400.0),
        (f64::NAN, 10e3),
    ] {
        assert_eq!(texture(frequency, rate), Err(scene), "{frequency} {rate}");
    }
    assert_eq!(texture(100.0, 100.1e3), Err(scene));
    assert_eq!(texture(100.0, f64::NAN), Err(scene));
    for (frequency, rate) in [(50.0, 10e3), (300.0, 10e3), (200.0, 400.0), (100.0, 100e3)] {
        assert!(texture(frequency, rate).is_ok(), "{frequency} {rate}");
    }

    // Half of the handle's own inertia, added or taken away.
    for sign in [1.0, -1.0] {
        assert!(Inertia::new(sign * 2.0, 4.0).is_ok());
        assert_eq!(Inertia::new(sign * 2.001, 4.0), Err(scene));
    }
    assert_eq!(Inertia::new(0.0, 0.0), Err(scene));
    assert_eq!(Inertia::new(0.0, -1.0), Err(scene));
}
