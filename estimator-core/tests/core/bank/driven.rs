//! Banks that are driven by a known acceleration: what they learn, and what a wrong one costs.

use estimator_core::{
    AccelerationEstimator, Amps, Confidence, Counts, CoupledMotor, Hertz, Imm, ImmAdaptive,
    ImmAdaptiveEdge, ImmEdge, ImmMotor, ImmMotorEdge, LearnedCurrentState, MotorModel,
    ObserverDesign, Sample, VelocityEstimator,
};

use super::{CLOCK, Random, Seen};
use crate::UNSURE;

const RATE: Hertz = Hertz(1000.0);

/// Parts of a tick in which the motion is integrated.
const PARTS: usize = 16;

/// A motor with friction, driven by a current that changes every 20 ms, and a slow hand.
struct Drive {
    /// Acceleration per ampere, counts/s².
    gain: f64,
    /// Deceleration by friction, counts/s².
    friction: f64,
    /// Ticks by which the torque is late.
    delay: usize,
}

/// The motion, its current included: 10 s at 1 kHz.
fn driven(drive: &Drive) -> Seen {
    let ticks = 10_000;
    let mut random = Random(3);
    let mut currents = vec![0.0; ticks];
    for chunk in currents.chunks_mut(20) {
        chunk.fill(random.next());
    }
    let step = 1.0 / (RATE.0 * PARTS as f64);
    let (mut x, mut v) = (0.3, 0.0);
    let mut places = vec![x];
    for tick in 1..ticks {
        let current = currents[tick.saturating_sub(drive.delay).max(1)];
        for part in 0..PARTS {
            let t = (tick * PARTS + part) as f64 * step;
            let hand = 4000.0 * (2.0 * t).sin() - 0.3 * v - 2.0 * x;
            let free = v + step * (drive.gain * current + hand);
            let brake = step * drive.friction;
            let next = if free.abs() > brake {
                free - brake.copysign(free)
            } else {
                0.0
            };
            x += 0.5 * step * (v + next);
            v = next;
            places.push(x);
        }
    }
    let mut seen = Seen::new(RATE.0, ticks, 0.0, &|t| {
        let at = t * RATE.0 * PARTS as f64;
        let i = (at as usize).min(places.len() - 2);
        places[i] + (places[i + 1] - places[i]) * (at - i as f64)
    });
    for (sample, current) in seen.samples.iter_mut().zip(&currents) {
        *sample = sample.with_current(Amps::new(*current as f32));
    }
    seen
}

/// The state of the input after the whole motion.
fn learned(seen: &Seen) -> LearnedCurrentState {
    let bank = ImmMotor::learning(RATE).expect("valid");
    let mut state = bank.start(&seen.samples[0]);
    for sample in &seen.samples[1..] {
        bank.update(&mut state, sample);
    }
    *state.input()
}

#[test]
fn gain_and_friction_are_learned_for_either_sign_and_a_late_torque() {
    let per_tick = RATE.0 * RATE.0;
    for (gain, friction, delay) in [
        (60_000.0, 5_000.0, 0),
        (-60_000.0, 5_000.0, 0),
        (60_000.0, 0.0, 3),
        (20_000.0, 2_000.0, 5),
    ] {
        let found = learned(&driven(&Drive {
            gain,
            friction,
            delay,
        }));
        let error = f64::from(found.gain()) * per_tick / gain - 1.0;
        assert!(error.abs() < 0.15, "{gain} {delay}: {error}");
        // Friction cannot be told well from the hand, nor at all where the torque is late.
        let off = f64::from(found.friction()) * per_tick - friction;
        assert!(
            delay > 0 || off.abs() < 0.4 * friction,
            "{gain} {friction}: {off}"
        );
    }
}

#[test]
fn a_count_that_jumps_is_not_learned_as_an_effect_of_the_current() {
    let seen = driven(&Drive {
        gain: 60_000.0,
        friction: 0.0,
        delay: 0,
    });
    let bank = ImmMotor::learning(RATE).expect("valid");
    for jump in [32_768i32, -32_768, i32::MIN, i32::MAX, 3_000_000] {
        let mut state = bank.start(&seen.samples[0]);
        let half = seen.samples.len() / 2;
        for sample in &seen.samples[1..half] {
            bank.update(&mut state, sample);
        }
        assert!(state.input().gain() > 0.0, "learned before the jump");
        // The counter is replaced by another one; the step of the shaft adds to the jump.
        let past = jump.saturating_add(jump.signum() * 100);
        for sample in &seen.samples[half..half + 200] {
            let jumped = Sample {
                count: sample.count + Counts(past),
                ..*sample
            };
            let v = bank.update(&mut state, &jumped);
            assert!(v.0.is_finite());
            let gain = state.input().gain() * 1e6;
            assert!((0.0..2.0 * 60_000.0).contains(&gain), "{jump}: {gain}");
        }
    }
}

#[test]
fn a_current_that_moves_the_shaft_improves_the_velocity() {
    for delay in [0, 4] {
        let seen = driven(&Drive {
            gain: 60_000.0,
            friction: 5_000.0,
            delay,
        });
        let plain = seen.rms(&seen.run(&Imm::new(RATE).expect("valid")));
        let motor = seen.rms(&seen.run(&ImmMotor::learning(RATE).expect("valid")));
        assert!(motor < 0.7 * plain, "{delay}: {motor} {plain}");
        let plain = seen.rms(&seen.run(&ImmEdge::with_edges(CLOCK, RATE).expect("valid")));
        let motor = seen.rms(&seen.run(&ImmMotorEdge::learning(CLOCK, RATE).expect("valid")));
        assert!(motor < 0.7 * plain, "{delay}, edges: {motor} {plain}");
    }
}

#[test]
fn a_current_without_effect_costs_nothing() {
    // Nothing but the hand moves the shaft.
    let seen = driven(&Drive {
        gain: 0.0,
        friction: 500.0,
        delay: 0,
    });
    let plain = seen.rms(&seen.run(&Imm::new(RATE).expect("valid")));
    let motor = seen.rms(&seen.run(&ImmMotor::learning(RATE).expect("valid")));
    assert!(motor < 1.02 * plain, "{motor} {plain}");
}

/// What an observer assumes wrongly.
#[derive(Debug)]
struct Wrong {
    /// Factors of torque constant, inertia and friction.
    torque: f64,
    mass: f64,
    friction: f64,
    /// Whether the current has the other sign.
    reversed: bool,
}

const RIGHT: Wrong = Wrong {
    torque: 1.0,
    mass: 1.0,
    friction: 1.0,
    reversed: false,
};

/// The count of the other shaft never changes: its encoder is stuck in every case, and the hand's torque reaches
/// the observer by nothing but the counts.
#[test]
fn a_followed_observer_of_another_device_costs_little() {
    let per_count = core::f64::consts::TAU / 4096.0;
    let right = CoupledMotor::DCX35L;
    let MotorModel {
        torque_constant,
        inertia,
        ..
    } = right.motor;
    let mut seen = driven(&Drive {
        gain: torque_constant / inertia / per_count,
        friction: right.coulomb_friction / inertia / per_count,
        delay: 0,
    });
    let plain = [
        seen.rms(&seen.run(&Imm::new(RATE).expect("valid"))),
        seen.rms(&seen.run(&ImmEdge::with_edges(CLOCK, RATE).expect("valid"))),
    ];
    for case in [
        RIGHT,
        Wrong {
            mass: 10.0,
            ..RIGHT
        },
        Wrong { mass: 0.1, ..RIGHT },
        Wrong {
            torque: 10.0,
            ..RIGHT
        },
        Wrong {
            torque: 1e-3,
            ..RIGHT
        },
        Wrong {
            friction: 0.0,
            ..RIGHT
        },
        Wrong {
            friction: 10.0,
            ..RIGHT
        },
        Wrong {
            reversed: true,
            ..RIGHT
        },
        Wrong {
            reversed: true,
            friction: 0.0,
            ..RIGHT
        },
    ] {
        let mut wrong = right;
        wrong.motor.torque_constant *= case.torque;
        wrong.motor.inertia *= case.mass;
        wrong.coulomb_friction *= case.friction;
        let sign = if case.reversed { -1.0 } else { 1.0 };
        let turned = |seen: &mut Seen| {
            for sample in &mut seen.samples {
                *sample = sample.with_current(Amps::new(sign * sample.current.get()));
            }
        };
        turned(&mut seen);
        let design = || ObserverDesign::new(&wrong, RATE, &UNSURE);
        let counts = ImmAdaptive::following(design().adaptive().build(), RATE);
        let edges = design().with_edges(CLOCK).adaptive().build();
        let edges = ImmAdaptiveEdge::following(edges, CLOCK, RATE);
        let found = [
            seen.rms(&seen.run(&counts.expect("valid"))),
            seen.rms(&seen.run(&edges.expect("valid"))),
        ];
        turned(&mut seen);
        println!("{case:?}: {found:?}, plain {plain:?}");
        for (found, plain) in found.iter().zip(plain) {
            assert!(*found < 1.1 * plain, "{case:?}: {found} {plain}");
        }
    }
}

#[test]
fn variance_of_driven_banks_covers_the_error() {
    let seen = driven(&Drive {
        gain: 60_000.0,
        friction: 5_000.0,
        delay: 0,
    });
    let bank = ImmMotor::learning(RATE).expect("valid");
    let mut state = bank.start(&seen.samples[0]);
    let (mut inside, mut acceleration) = (0, 0.0f64);
    for (sample, truth) in seen.samples.iter().zip(&seen.velocities).skip(1) {
        let error = f64::from(bank.update(&mut state, sample).0) - truth;
        inside += u32::from(error.abs() < 2.0 * f64::from(bank.variance(&state).std_dev().0));
        acceleration = acceleration.max(f64::from(bank.acceleration(&state).0));
    }
    let share = f64::from(inside) / (seen.samples.len() - 1) as f64;
    assert!(share > 0.88 && share < 1.0, "{share}");
    assert!(acceleration > 0.0);
}
