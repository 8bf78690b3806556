//! The bank against a reference in f64: textbook matrices, the exact truncated Gaussian, absolute
//! positions. And what it promises: rest, a variance, a noise of the boundaries, any encoder.

mod constant_speed;
mod definition;
mod driven;
mod noise;
mod noisy_counts;
mod stamps;
mod uneven;

use estimator_core::{
    AccelerationEstimator, ClockTicks, Confidence, Count, DesignError, Edge, Hertz, Imm, ImmEdge,
    ImmMotor, ImmPair, LearnedCurrent, MOverT, ModelBank, Sample, VelocityEstimator,
};

use definition::Definition;

const CLOCK: Hertz = Hertz(84e6);

/// A motion as an encoder sees it.
struct Seen {
    samples: Vec<Sample>,
    /// Boundary and age, ticks, of the latest edge of each tick with a new one.
    edges: Vec<Option<(f64, f64)>>,
    counts: Vec<f64>,
    /// True velocity, counts per tick.
    velocities: Vec<f64>,
}

impl Seen {
    /// The position `place` of time in s, counts, at `rate` Hz. The instant of an edge is found by
    /// bisection, and off by up to `noise` counts.
    fn new(rate: f64, ticks: usize, noise: f64, place: &dyn Fn(f64) -> f64) -> Self {
        let times: Vec<_> = (0..ticks).map(|tick| tick as f64 / rate).collect();
        Self::at(&times, rate, noise, place)
    }

    /// As [`Seen::new`], at these times in s; ticks are 1/`rate` s.
    fn at(times: &[f64], rate: f64, noise: f64, place: &dyn Fn(f64) -> f64) -> Self {
        let mut seen = Self {
            samples: Vec::new(),
            edges: Vec::new(),
            counts: Vec::new(),
            velocities: Vec::new(),
        };
        let mut latest: Option<(f64, f64)> = None;
        let mut random = Random(1);
        for (tick, &now) in times.iter().enumerate() {
            let interval = tick
                .checked_sub(1)
                .map_or(0.0, |before| now - times[before]);
            let count = place(now).floor();
            // The finest step in which a tick is searched.
            let parts = 64;
            let mut fresh = false;
            for part in 0..if tick == 0 { 0 } else { parts } {
                let at = |part: f64| now - (1.0 - part / f64::from(parts)) * interval;
                let (mut a, mut b) = (at(f64::from(part)), at(f64::from(part + 1)));
                if place(a).floor() == place(b).floor() {
                    continue;
                }
                for _ in 0..40 {
                    let middle = 0.5 * (a + b);
                    if place(middle).floor() == place(a).floor() {
                        a = middle;
                    } else {
                        b = middle;
                    }
                }
                let boundary = place(a).floor().max(place(b).floor());
                latest = Some((b, boundary));
                fresh = true;
            }
            let step = 1e-6 / rate;
            let velocity = (place(now + step) - place(now - step)) / (2.0 * step) / rate;
            let mut sample = Sample::new(Count(count as i64 as u32));
            let mut edge = None;
            if let Some((time, boundary)) = latest {
                let late = if velocity == 0.0 {
                    0.0
                } else {
                    noise * random.next() / velocity.abs()
                };
                let age = ((now - time) * rate + late).clamp(0.0, 0.999 * interval * rate);
                let age = if fresh { age } else { (now - time) * rate };
                let ticks = (age / rate * CLOCK.0).min(4e9) as u32;
                sample = sample.with_edge(Edge {
                    boundary: Count(boundary as i64 as u32),
                    age: ClockTicks(ticks),
                });
                if fresh && (boundary == count || boundary == count + 1.0) {
                    edge = Some((boundary, f64::from(ticks) / CLOCK.0 * rate));
                }
            }
            seen.samples.push(sample);
            seen.edges.push(edge);
            seen.counts.push(count);
            seen.velocities.push(velocity);
        }
        seen
    }

    /// The estimates, counts per tick.
    fn run<E: VelocityEstimator>(&self, estimator: &E) -> Vec<f64> {
        let mut state = estimator.start(&self.samples[0]);
        let updates = self.samples[1..].iter();
        let mut velocities = vec![0.0];
        velocities.extend(updates.map(|s| f64::from(estimator.update(&mut state, s).0)));
        velocities
    }

    /// Root mean square of the error, after the first 100 ticks.
    fn rms(&self, estimates: &[f64]) -> f64 {
        rms(&self.velocities[100..], &estimates[100..])
    }

    fn finite_difference(&self) -> Vec<f64> {
        let mut differences = vec![0.0];
        differences.extend(self.counts.windows(2).map(|pair| pair[1] - pair[0]));
        differences
    }
}

fn rms(a: &[f64], b: &[f64]) -> f64 {
    let squares = a.iter().zip(b).map(|(a, b)| (a - b) * (a - b));
    (squares.sum::<f64>() / a.len() as f64).sqrt()
}

/// Uniform numbers within ±1.
struct Random(u64);

impl Random {
    fn next(&mut self) -> f64 {
        self.0 = self
            .0
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 11) as f64 / (1u64 << 52) as f64 - 1.0
    }
}

/// A hand: slow swings, tremor, and a knock at 1.5 s. Revolutions, of time in s.
fn hand(t: f64) -> f64 {
    let knock = if t > 1.5 {
        (-(t - 1.5) / 0.05).exp() * ((t - 1.5) * 90.0).sin()
    } else {
        0.0
    };
    0.2 * (1.9 * t).sin() + 0.003 * (50.0 * t).sin() + 0.004 * knock + 0.0001
}

const BANKS: [&str; 3] = ["imm", "imm-edge", "imm-pair"];

/// Distance between a bank and its definition, and the error of both, RMS, counts per tick.
#[derive(Debug)]
struct Apart {
    error: f64,
    least: f64,
    apart: f64,
}

impl Apart {
    fn new(seen: &Seen, found: &[f64], defined: &[f64]) -> Self {
        Self {
            error: seen.rms(found),
            least: seen.rms(defined),
            apart: rms(&found[100..], &defined[100..]),
        }
    }

    /// Whether the bank has the error of its definition.
    fn has_least_error(&self) -> bool {
        self.error < 1.1 * self.least
    }

    /// Whether the bank differs from its definition by less than the error of both.
    fn is_near(&self) -> bool {
        self.apart < 0.5 * self.least
    }
}

#[test]
fn the_bank_follows_its_definition() {
    for counts in [64.0, 1024.0, 16_384.0] {
        let seen = Seen::new(1000.0, 3000, 0.0, &|t| counts * hand(t));
        let pairs = [
            (
                seen.run(&Imm::new(Hertz(1000.0)).expect("valid")),
                Definition::run(3, 1000.0, &seen.counts, None),
            ),
            (
                seen.run(&ImmEdge::with_edges(CLOCK, Hertz(1000.0)).expect("valid")),
                Definition::run(3, 1000.0, &seen.counts, Some(&seen.edges)),
            ),
            (
                seen.run(&ImmPair::new(Hertz(1000.0)).expect("valid")),
                Definition::run(2, 1000.0, &seen.counts, None),
            ),
        ];
        for (name, (found, defined)) in BANKS.iter().zip(&pairs) {
            let apart = Apart::new(&seen, found, defined);
            println!("{counts} {name}: {apart:?}");
            let follows = apart.has_least_error() && apart.is_near();
            assert!(follows, "{counts} {name}: {apart:?}");
        }
    }
}

#[test]
fn one_bank_serves_every_encoder_and_rate() {
    for rate in [500.0, 1000.0, 10_000.0, 20_000.0] {
        for counts in [64.0, 1000.0, 40_000.0, 1e6] {
            let ticks = (3.0 * rate) as usize;
            let seen = Seen::new(rate, ticks, 0.0, &|t| counts * hand(t));
            let difference = seen.rms(&seen.finite_difference());
            let counted = seen.rms(&seen.run(&Imm::new(Hertz(rate)).expect("valid")));
            let stamped =
                seen.rms(&seen.run(&ImmEdge::with_edges(CLOCK, Hertz(rate)).expect("valid")));
            // Above some 20 counts a tick the error of finite difference is its delay alone, and that
            // of the bank the knock.
            let part = if counts > 20.0 * rate { 1.0 } else { 0.3 };
            for error in [counted, stamped] {
                assert!(
                    error < part * difference,
                    "{rate} Hz, {counts} counts: {error}, finite difference {difference}"
                );
            }
        }
    }
}

/// A shaft turns at constant speed, meets a spring for 17 ms and turns back. Before it all members are sure
/// that nothing accelerates.
#[test]
fn an_impact_after_a_calm_motion_is_followed() {
    let spring = std::f64::consts::TAU * 30.0;
    let (contact, end) = (0.5, 0.5 + std::f64::consts::PI / spring);
    let turned = move |t: f64| match t {
        t if t < contact => t,
        t if t < end => contact + (spring * (t - contact)).sin() / spring,
        t => contact - (t - end),
    };
    for rate in [1000.0, 5000.0] {
        for counts in [4096.0, 65_536.0] {
            let seen = Seen::new(rate, (0.7 * rate) as usize, 0.0, &|t| counts * turned(t));
            let part = (contact * rate) as usize..((end + 0.01) * rate) as usize;
            let error = |found: &[f64]| rms(&seen.velocities[part.clone()], &found[part.clone()]);
            let difference = error(&seen.finite_difference());
            let pairs = [
                (
                    seen.run(&Imm::new(Hertz(rate)).expect("valid")),
                    Definition::run(3, rate, &seen.counts, None),
                ),
                (
                    seen.run(&ImmEdge::with_edges(CLOCK, Hertz(rate)).expect("valid")),
                    Definition::run(3, rate, &seen.counts, Some(&seen.edges)),
                ),
                (
                    seen.run(&ImmPair::new(Hertz(rate)).expect("valid")),
                    Definition::run(2, rate, &seen.counts, None),
                ),
            ];
            for (name, (found, defined)) in BANKS.iter().zip(&pairs) {
                let [found, defined] = [found, defined].map(|velocities| error(velocities));
                let case = format!(
                    "{rate} Hz, {counts} counts, {name}: {found:.3}, definition {defined:.3}"
                );
                println!("{case}, finite difference {difference:.3}");
                // Rounding decides whether an innovation near a limit is an impact.
                assert!(found < 1.2 * defined, "{case}");
                assert!(
                    found < 1.1 * difference,
                    "{case}, finite difference {difference}"
                );
            }
        }
    }
}

/// A shaft swings by some counts, so slowly that a count takes many ticks. The members do not take the edge
/// after a long time for a knock: the error stays near that of M/T, whose speed is at most a count over the
/// time since the edge, at any rate.
#[test]
fn a_slow_swing_is_no_knock() {
    for rate in [500.0, 1000.0, 10_000.0] {
        let ticks = (20.0 * rate) as usize;
        let seen = Seen::new(rate, ticks, 0.0, &|t| {
            1.4 * (2.3 * t).sin() + 0.9 * (1.1 * t).sin() + 0.2
        });
        let timed = seen.rms(&seen.run(&MOverT::new(CLOCK, Hertz(rate)).expect("valid")));
        let counted = seen.rms(&seen.run(&Imm::new(Hertz(rate)).expect("valid")));
        let stamped = seen.rms(&seen.run(&ImmEdge::with_edges(CLOCK, Hertz(rate)).expect("valid")));
        println!("{rate} Hz: M/T {timed:.2e}, bank {counted:.2e}, stamped {stamped:.2e}");
        for error in [counted, stamped] {
            assert!(error < 1.3 * timed, "{rate} Hz: {error}, M/T {timed}");
        }
    }
}

#[test]
fn the_velocity_is_zero_from_0_3_s_of_rest_on() {
    for rate in [500.0, 1000.0, 20_000.0] {
        let bank = ImmEdge::with_edges(CLOCK, Hertz(rate)).expect("valid");
        let mut random = Random(7);
        for _ in 0..20 {
            let (speed, stop) = (3000.0 * random.next(), 0.2 + 0.1 * random.next());
            let seen = Seen::new(rate, rate as usize, 0.0, &|t| speed * t.min(stop) + 0.5);
            let mut state = bank.start(&seen.samples[0]);
            let mut last = 0.0;
            for (tick, sample) in seen.samples.iter().enumerate().skip(1) {
                let velocity = bank.update(&mut state, sample).0;
                let now = tick as f64 / rate;
                if seen.counts[tick] != seen.counts[tick - 1] {
                    last = now;
                }
                if now > last + 0.3 + 1.0 / rate {
                    assert_eq!(velocity, 0.0, "{rate} {speed} {now}");
                    assert_eq!(bank.acceleration(&state).0, 0.0, "{rate} {speed} {now}");
                } else if now < stop - 0.01 && now > 0.1 {
                    assert!(velocity != 0.0, "{rate} {speed} {now}");
                }
            }
        }
    }
}

#[test]
fn the_variance_covers_the_error() {
    for counts in [64.0, 1000.0, 40_000.0] {
        let seen = Seen::new(1000.0, 3000, 0.0, &|t| counts * hand(t));
        let bank: Imm = ModelBank::new(Hertz(1000.0)).expect("valid");
        let mut state = bank.start(&seen.samples[0]);
        let (mut squares, mut outside, mut number) = (0.0, 0, 0);
        for (tick, sample) in seen.samples.iter().enumerate().skip(1) {
            let off = f64::from(bank.update(&mut state, sample).0) - seen.velocities[tick];
            let variance = f64::from(bank.variance(&state).0);
            if tick > 100 {
                squares += off * off / variance;
                outside += i32::from(off * off > 9.0 * variance);
                number += 1;
            }
        }
        let mean = squares / f64::from(number);
        println!("{counts}: {mean:.3}, outside three deviations {outside} of {number}");
        // A Gaussian has 1 and 0.3 %. The motion is none: no wrong claim by more than a factor of 2 in
        // the deviation.
        assert!(mean > 0.25 && mean < 4.0, "{counts}: {mean}");
        assert!(outside * 20 < number, "{counts}: {outside} of {number}");
    }
}

#[test]
fn rates_out_of_range_are_refused() {
    // 1 / 1e-310 is infinite.
    for rate in [99.0, 100_001.0, 1e-310, 1e300] {
        let refused = Some(DesignError::RATE_OF_BANK);
        assert_eq!(Imm::new(Hertz(rate)).err(), refused);
        assert_eq!(LearnedCurrent::new(Hertz(rate)).err(), refused);
        assert_eq!(ImmMotor::learning(Hertz(rate)).err(), refused);
    }
    for rate in [100.0, 100_000.0] {
        assert!(Imm::new(Hertz(rate)).is_ok());
    }
    for rate in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        assert_eq!(Imm::new(Hertz(rate)).err(), Some(DesignError::RATE));
    }
    let slow = ImmEdge::with_edges(Hertz(999.0), Hertz(1000.0));
    assert_eq!(slow.err(), Some(DesignError::CLOCK));
}
