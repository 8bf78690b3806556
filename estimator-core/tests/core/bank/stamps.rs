//! Stamps whose errors are not white: lines of an encoder that are out of place, and a clock with coarse steps.

use estimator_core::{ClockTicks, Edge, Hertz, ImmEdge, ModelBank};

use super::{CLOCK, Seen, rms};

/// Swings of a hand, revolutions, of time in s.
fn swing(t: f64) -> f64 {
    let turns = core::f64::consts::TAU * t;
    0.3 * (0.7 * turns).sin() + 0.03 * (4.1 * turns).sin() + 1e-4
}

/// The position that an encoder shows whose lines are off by `errors`, counts, one after the other.
fn with_lines(errors: [f64; 4], x: f64) -> f64 {
    let line = |n: f64| n + errors[n.rem_euclid(4.0) as usize];
    let n = x.floor();
    let n = if x < line(n) {
        n - 1.0
    } else if x >= line(n + 1.0) {
        n + 1.0
    } else {
        n
    };
    n + (x - line(n)) / (line(n + 1.0) - line(n))
}

/// The two channels of an optical encoder are seldom a quarter of a period apart, and seldom on for half of it. Such errors
/// have the opposite sign after two lines: their neighbours tell nothing of them.
#[test]
fn lines_out_of_place_are_learned() {
    for (counts, rate) in [(4096.0, 10e3), (1024.0, 4e3), (8192.0, 8e3)] {
        let ticks = (2.0 * rate) as usize;
        let bank: ImmEdge = ModelBank::with_edges(CLOCK, Hertz(rate)).expect("valid");
        let clean = Seen::new(rate, ticks, 0.0, &|t| counts * swing(t));
        let least = clean.rms(&clean.run(&bank));
        for errors in [
            [0.0, 0.05, 0.0125, -0.0375],
            [0.0, 0.1, 0.025, -0.075],
            [0.0, 0.0, 0.1, 0.1],
        ] {
            let mut seen = Seen::new(rate, ticks, 0.0, &|t| with_lines(errors, counts * swing(t)));
            seen.velocities.clone_from(&clean.velocities);
            let error = seen.rms(&seen.run(&bank));
            let ratio = error / least;
            println!("{counts} counts at {rate} Hz, {errors:?}: {ratio} of {least}");
            assert!(ratio < 4.0, "{counts}, {errors:?}: {ratio}");
        }
    }
}

impl Seen {
    /// The same motion with stamps that are rounded down to steps of `step_s`, s.
    fn with_coarse_stamps(mut self, rate: f64, step_s: f64) -> Self {
        for (tick, sample) in self.samples.iter_mut().enumerate() {
            let Some(Edge { boundary, age }) = sample.edge else {
                continue;
            };
            let now = tick as f64 / rate;
            let at = ((now - f64::from(age.0) / CLOCK.0) / step_s).floor() * step_s;
            let age = ClockTicks(((now - at) * CLOCK.0).round() as u32);
            *sample = sample.with_edge(Edge { boundary, age });
        }
        self
    }
}

/// A clock of 10 us a step puts the edges of a fast shaft counts away from their places, always to the same side. A bank
/// that trusts it finds a velocity at which each stamp contradicts its count, and stays there.
#[test]
fn stamps_that_contradict_the_counts_are_not_followed() {
    for (counts, rate, turns) in [
        (65_536.0, 10e3, 10.0),
        (4096.0, 10e3, 40.0),
        (16_384.0, 10e3, 15.0),
    ] {
        let bank: ImmEdge = ModelBank::with_edges(CLOCK, Hertz(rate)).expect("valid");
        // It speeds up for 0.3 s, and turns on.
        let place = |t: f64| {
            let began = f64::min(t, 0.3);
            counts * turns * (began * began / 0.6 + (t - began)) + 0.37
        };
        let seen = Seen::new(rate, (1.2 * rate) as usize, 0.0, &place);
        let seen = seen.with_coarse_stamps(rate, 10e-6);
        let estimates = seen.run(&bank);
        let from = (0.4 * rate) as usize;
        let error = rms(&seen.velocities[from..], &estimates[from..]);
        let ratio = error / (counts * turns / rate);
        println!("{counts} counts at {rate} Hz, {turns} turns/s: {ratio}");
        assert!(ratio < 0.05, "{counts}: {ratio}");
    }
}
