//! The balance of the large motor's torques, on motions whose current follows from the equation of motion.

mod learned;
mod motions;

use std::f64::consts::TAU;

use estimator_core::{Amps, Count, Hertz, Sample};
use haptic_control::{Balance, DualStage, Motor, Stop};

const DEVICE: DualStage = DualStage::DEFAULT;
const CONSTANT: f64 = DEVICE.large.torque_constant;
/// The described friction and the largest error of the amplifier's zero, A.
const FRICTION: f64 = DEVICE.large.coulomb_friction / CONSTANT;
const ZERO: f64 = 15.0 / 2047.0 * DEVICE.large.current_limit;
/// Length of a window, s.
const WINDOW_S: f64 = 0.02;

/// True constants over the described ones, and the amplifier's zero, A.
#[derive(Clone, Copy)]
struct True {
    inertia: f64,
    constant: f64,
    damping: f64,
    friction: f64,
    zero: f64,
}

const NOMINAL: True = True {
    inertia: 1.0,
    constant: 1.0,
    damping: 1.0,
    friction: 1.0,
    zero: 0.0,
};

/// A shaft that turns to and fro about a constant speed: speed, amplitude, rad/s, and frequency, Hz.
#[derive(Clone, Copy)]
struct Shaft(f64, f64, f64);

impl Shaft {
    fn angle(self, t: f64) -> f64 {
        self.0 * t + self.1 * (1.0 - (TAU * self.2 * t).cos()) / (TAU * self.2)
    }

    fn speed(self, t: f64) -> f64 {
        self.0 + self.1 * (TAU * self.2 * t).sin()
    }

    fn acceleration(self, t: f64) -> f64 {
        TAU * self.2 * self.1 * (TAU * self.2 * t).cos()
    }
}

/// The current that makes this motion, A.
fn current(of: True, large: Shaft, small: Shaft, t: f64) -> f64 {
    let speed = large.speed(t);
    let torque = of.inertia * DEVICE.large.inertia * large.acceleration(t)
        + of.damping * DEVICE.damping * (speed - small.speed(t))
        + of.friction * DEVICE.large.coulomb_friction * speed.signum();
    torque / (of.constant * CONSTANT) + of.zero
}

fn counts(angle: f64, per_rev: u32) -> Count {
    // Near the wrap of the counters.
    Count((angle / TAU * f64::from(per_rev)).floor() as i32 as u32).plus(u32::MAX - 50)
}

trait Plus {
    fn plus(self, by: u32) -> Self;
}

impl Plus for Count {
    fn plus(self, by: u32) -> Self {
        Self(self.0.wrapping_add(by))
    }
}

/// Time of the first finding, s.
fn found_s(
    rate: f64,
    seconds: f64,
    large: impl Fn(f64) -> f64,
    small: impl Fn(f64) -> f64,
    amps: impl Fn(f64) -> f64,
) -> Option<f64> {
    found_by_s(
        &Balance::new(&DEVICE, Hertz(rate)),
        rate,
        seconds,
        large,
        small,
        amps,
    )
}

/// Time of the first finding of `balance`, s.
fn found_by_s(
    balance: &Balance,
    rate: f64,
    seconds: f64,
    large: impl Fn(f64) -> f64,
    small: impl Fn(f64) -> f64,
    amps: impl Fn(f64) -> f64,
) -> Option<f64> {
    let sample = |k: u32| {
        let t = f64::from(k) / rate;
        Sample::new(counts(large(t), DEVICE.large.counts_per_rev))
            .with_coupled(counts(small(t), DEVICE.small.counts_per_rev))
            // The current over the period that ends now.
            .with_current(Amps::new(amps(t - 0.5 / rate) as f32))
    };
    let mut state = balance.start(&sample(0));
    (1..(seconds * rate) as u32).find_map(|k| {
        let found = balance.check(&mut state, &sample(k));
        assert!(found.is_none() || found == Some(Stop::TorqueBalance));
        found.map(|_| f64::from(k) / rate)
    })
}

/// Every combination of the ends of the tolerances.
fn corners() -> impl Iterator<Item = True> {
    (0..32).map(|i| {
        let end = |bit: u32, [low, high]: [f64; 2]| if i >> bit & 1 == 0 { low } else { high };
        True {
            inertia: end(0, [0.7, 1.3]),
            constant: end(1, [0.8, 1.2]),
            damping: end(2, [0.6, 1.4]),
            friction: end(3, [0.2, 1.5]),
            zero: end(4, [-ZERO, ZERO]),
        }
    })
}

/// Free air, a wall at the largest speed, a viscous scene, and one without a hand's motion.
const MOTIONS: [[Shaft; 2]; 5] = [
    [Shaft(0.0, 4.0, 1.0), Shaft(0.0, 4.0, 1.0)],
    [Shaft(-70.0, -50.0, 1.5), Shaft(0.5, 2.0, 1.5)],
    [Shaft(0.0, -4.0, 2.0), Shaft(0.0, 4.0, 2.0)],
    [Shaft(100.0, 0.0, 1.0), Shaft(0.0, 0.0, 1.0)],
    [Shaft(20.0, 15.0, 3.0), Shaft(2.0, 3.0, 0.7)],
];

#[test]
fn device_within_the_tolerances_is_balanced() {
    for rate in [1e3, 10e3] {
        for [large, small] in MOTIONS {
            for of in corners() {
                let amps = |t| current(of, large, small, t);
                let found = found_s(rate, 1.5, |t| large.angle(t), |t| small.angle(t), amps);
                assert_eq!(found, None, "{rate} Hz");
            }
        }
    }
}

/// A handle whose count turns round at 0.5 s.
fn swapped(small: Shaft) -> impl Fn(f64) -> f64 {
    move |t| {
        let at = small.angle(t.min(0.5));
        at - (small.angle(t) - at)
    }
}

#[test]
fn handle_that_counts_backwards_is_found_where_the_large_motor_turns() {
    for rate in [1e3, 10e3] {
        for sign in [1.0, -1.0] {
            // The large motor follows the wrong count in free air, or turns on in the wall. The speeds are
            // about those of the emulated press.
            let hand = Shaft(sign * 4.0, 0.0, 1.0);
            let follows = |t: f64| {
                sign * if t < 0.5 {
                    4.0 * t
                } else {
                    2.0 - 4.0 * (t - 0.5)
                }
            };
            let way = |t: f64| if t < 0.5 { sign } else { -sign };
            let amps = |t: f64| {
                let speed = 4.0 * way(t);
                let torque = DEVICE.damping * (speed - hand.speed(t))
                    + DEVICE.large.coulomb_friction * way(t);
                torque / CONSTANT
            };
            let free = found_s(rate, 1.0, follows, swapped(hand), amps);
            let wall = Shaft(-sign * 100.0, 0.0, 1.0);
            let pressed = found_s(
                rate,
                1.0,
                |t| wall.angle(t),
                swapped(hand),
                |t| current(NOMINAL, wall, hand, t),
            );
            for found in [free, pressed] {
                // Three windows hold the fault and nothing else by then.
                let in_time = found.is_some_and(|s| s > 0.5 && s < 0.5 + 5.0 * WINDOW_S);
                assert!(in_time, "{rate} Hz, {sign}: {free:?}, {pressed:?}");
            }
        }
    }
}

/// The largest error by positions with no slip, A: four positions of the large encoder of 1.33 counts in the
/// change of its displacement, with J / Kt 1.3 / 0.8 of the described one, and two of each encoder in the
/// slip, with b / Kt 1.4 / 0.8 of it.
fn rounding() -> f64 {
    let [large, small] =
        [DEVICE.large, DEVICE.small].map(|motor| TAU / f64::from(motor.counts_per_rev));
    let accelerated = DEVICE.large.inertia * 4.0 * 1.33 * large / (WINDOW_S * WINDOW_S);
    let slipped = DEVICE.damping * 2.0 * (1.33 * large + small) / WINDOW_S;
    (1.625 * accelerated + 1.75 * slipped) / CONSTANT
}

/// Both shafts turn at a speed at which each count is a whole one at every window's end.
const EVEN: f64 = TAU * 10.0;

#[test]
fn first_windows_allow_the_largest_friction_and_the_errors() {
    let largest = 1.65 / 0.8 * FRICTION + ZERO + rounding();
    for sign in [1.0, -1.0] {
        for (amps, found) in [(largest - 2e-3, false), (largest + 2e-3, true)] {
            // No window is checked before the end of the second one.
            let seconds = 0.0022 + 2.0 * WINDOW_S;
            let turn = |t: f64| sign * EVEN * t;
            let at = found_s(10e3, seconds, turn, turn, |_| sign * amps);
            assert_eq!(at.is_some(), found, "{amps}");
            // Against the motion: only the amplifier's zero.
            let against = amps - largest + ZERO + rounding();
            let at = found_s(10e3, seconds, turn, turn, |_| -sign * against);
            assert_eq!(at.is_some(), found, "{against}");
            // A motor that rests holds against either direction.
            let at = found_s(10e3, seconds, |_| 0.0, |_| 0.0, |_| sign * amps);
            assert_eq!(at.is_some(), found, "{amps} at rest");
        }
    }
}

/// The amplifier's lag twice, and a tick: 0.26 ms of a current that grows by 100 A/s.
#[test]
fn current_that_grows_may_be_late() {
    let slope = 100.0;
    let late_s = 2.0 / (TAU * DEVICE.amplifier_bandwidth.0) + 1e-4;
    let largest = 1.65 / 0.8 * FRICTION + ZERO + rounding();
    // The middle of the first two windows, which begin half a millisecond and a tick after the start.
    let middle = 6e-4 + WINDOW_S;
    for sign in [1.0, -1.0] {
        // The sums take the current at the end of each tick: half a tick later, a fifth of this time.
        for (part, found) in [(0.7, false), (1.1, true)] {
            let turn = |t: f64| sign * EVEN * t;
            let amps = |t: f64| sign * (largest + slope * (t - middle + part * late_s));
            let at = found_s(10e3, 0.0022 + 2.0 * WINDOW_S, turn, turn, amps);
            assert_eq!(at.is_some(), found, "{part}, {sign}");
        }
    }
}

/// As of friction that nobody has measured.
#[test]
fn described_friction_is_at_least_50_ma() {
    for (described, assumed) in [(0.0, 0.05), (0.04, 0.05), (0.06, 0.06)] {
        let large = Motor {
            coulomb_friction: described * CONSTANT,
            ..DEVICE.large
        };
        let balance = Balance::new(&DualStage { large, ..DEVICE }, Hertz(10e3));
        let largest = 1.65 / 0.8 * assumed + ZERO + rounding();
        for (amps, found) in [(largest - 2e-3, false), (largest + 2e-3, true)] {
            let turn = |t: f64| EVEN * t;
            let seconds = 0.0022 + 2.0 * WINDOW_S;
            let at = found_by_s(&balance, 10e3, seconds, turn, turn, |_| amps);
            assert_eq!(at.is_some(), found, "{described} A: {amps} A");
        }
    }
}

#[test]
fn motor_that_turns_by_four_counts_in_each_quarter_of_a_window_has_a_direction() {
    let count = TAU / f64::from(DEVICE.large.counts_per_rev);
    // More than the amplifier's zero and the errors, against the motion; less than the friction of a motor
    // that rests.
    let against = ZERO + 2.0 * rounding();
    assert!(against < FRICTION);
    for (counts, found) in [(3.0, false), (4.0, true)] {
        for sign in [1.0, -1.0] {
            let speed = counts * count / (0.25 * WINDOW_S);
            let turn = |t: f64| sign * (speed * t + 0.5 * count);
            let at = found_s(10e3, 0.1, turn, turn, |_| -sign * against);
            assert_eq!(at.is_some(), found, "{counts} counts, {sign}");
        }
    }
}

/// Whichever quarter it is, the friction of a motor that rests for a part of a window has either sign.
#[test]
fn motor_that_rests_in_one_quarter_of_each_window_has_no_direction() {
    let count = TAU / f64::from(DEVICE.large.counts_per_rev);
    let against = ZERO + 2.0 * rounding();
    for sign in [1.0, -1.0] {
        for resting in [None, Some(0), Some(1), Some(2), Some(3)] {
            // Windows begin 6 ticks after the start, and each other quarter has 8 counts.
            let turn = |t: f64| {
                let quarters = (t - 6e-4) / (0.25 * WINDOW_S);
                let whole = quarters.div_euclid(4.0);
                let within = quarters - 4.0 * whole;
                let rested = resting.map_or(0.0, |quarter: u8| {
                    (within - f64::from(quarter)).clamp(0.0, 1.0)
                });
                let each = if resting.is_some() { 3.0 } else { 4.0 };
                sign * (8.0 * (each * whole + within - rested) + 0.5) * count
            };
            let at = found_s(10e3, 0.1, turn, turn, |_| -sign * against);
            assert_eq!(at.is_some(), resting.is_none(), "{resting:?}, {sign}");
        }
    }
}

#[test]
fn inertia_belongs_to_the_balance() {
    // Both shafts accelerate together: the current is that of the friction and of the inertia, 0.4 A.
    let shaft = Shaft(40.0, 30.0, 9.0);
    let amps = |t| current(NOMINAL, shaft, shaft, t);
    let angle = |t| shaft.angle(t);
    assert_eq!(found_s(10e3, 1.0, angle, angle, amps), None);
    assert!(found_s(10e3, 1.0, angle, angle, |_| FRICTION).is_some());
}

#[test]
fn window_with_missed_ticks_is_not_checked() {
    let balance = Balance::new(&DEVICE, Hertz(10e3));
    let rest = Sample::new(Count(7)).with_current(Amps::new(0.5));
    let mut state = balance.start(&rest);
    for _ in 0..300 {
        // One tick before a second window is whole.
        for _ in 0..400 {
            assert_eq!(balance.check(&mut state, &rest), None);
        }
        state.begin_after(1);
    }
    // The next tick begins a window; two windows later, and a tick, they are checked.
    let at = (1..).find(|_| balance.check(&mut state, &rest).is_some());
    assert_eq!(at, Some(402));
}

/// A step of the current that no single window finds, as [`learned`] has it.
#[test]
fn windows_before_and_after_missed_ticks_are_not_compared() {
    let balance = Balance::new(&DEVICE, Hertz(10e3));
    let amps = DEVICE.damping * EVEN / CONSTANT + FRICTION;
    let step = 0.4 * FRICTION + 2.0 * rounding() + 3e-3;
    let found = |misses_ticks: bool| {
        let sample = |k: u32| {
            let angle = EVEN * f64::from(k) / 10e3;
            let current = amps + if k <= 3000 { 0.0 } else { step };
            Sample::new(counts(angle, DEVICE.large.counts_per_rev))
                .with_current(Amps::new(current as f32))
        };
        let mut state = balance.start(&sample(0));
        (1..5000).any(|k| {
            if misses_ticks && k == 3000 {
                state.begin_after(1);
            }
            balance.check(&mut state, &sample(k)).is_some()
        })
    };
    assert!(found(false));
    assert!(!found(true));
}

/// A schedule of a millisecond, which calls [`Balance::pass`] in four ticks of ten.
#[test]
fn four_ticks_of_ten_find_what_every_tick_finds() {
    let balance = Balance::new(&DEVICE, Hertz(10e3));
    // Both shafts turn; the current is that of the friction, and from tick 5000 on not.
    let sample = |k: u32| {
        Sample::new(Count(k))
            .with_coupled(Count(5 * k))
            .with_current(Amps::new(if k < 5000 { 0.085 } else { 0.715 }))
    };
    for start in 0..10 {
        let mut whole = balance.start(&sample(start));
        let mut parts = whole;
        let first = (start..).find(|k| k % 10 == 1).unwrap() - start;
        whole.begin_after(first + 1);
        parts.begin_after(first + 1);
        let mut times = 0;
        for k in start..10_000 {
            let found = balance.check(&mut whole, &sample(k));
            parts.add(&sample(k));
            let in_parts = match k % 10 {
                1 => balance.pass(&mut parts, &sample(k), 7),
                2..=4 => balance.pass(&mut parts, &sample(k), 1),
                _ => None,
            };
            assert_eq!(in_parts, found, "tick {k}, from {start}");
            times += u32::from(found.is_some());
        }
        assert!(times > 5, "{times}");
    }
}
