//! A driven bank with an input that is exact, and its weighting against the plain bank.

extern crate std;

use std::vec::Vec;

use super::{BankInput, DrivenBank, DrivenBankState, Evidence, FOLLOWED, START, root};
use crate::bank::interval::Likelihood;
use crate::bank::{ModelBank, ModelBankState, NoStamps, Stamped, Stamps};
use crate::confidence::Confidence;
use crate::estimator::{AccelerationEstimator, VelocityEstimator};
use crate::filters::draws::draw;
use crate::sample::{Edge, Sample, Signals};
use crate::sealed::Sealed;
use crate::units::{Amps, ClockTicks, Count, Hertz};

const RATE: Hertz = Hertz(1000.0);
const CLOCK: Hertz = Hertz(84e6);

/// The current in A stands for the acceleration in counts/tick²; 0 A stands for an unknown one.
#[derive(Clone, Copy)]
struct Known;

impl Sealed for Known {}

impl BankInput for Known {
    type State = ();
    const NEEDS: Signals = Signals::COUNT_AND_CURRENT;

    fn start(&self, _: &Sample) {}

    fn input<const K: usize>(
        &self,
        (): &mut (),
        sample: &Sample,
        _: &ModelBankState<K>,
    ) -> Option<f32> {
        let acceleration = sample.current.get();
        (acceleration != 0.0).then_some(acceleration)
    }
}

/// Samples of a shaft whose velocity is drawn anew each tick, 1 to 3 counts/tick, and changes at constant
/// acceleration in between; and the velocities at the samples, counts/tick.
fn erratic(ticks: usize) -> (Vec<Sample>, Vec<f64>) {
    let mut seed = 5;
    let (mut x, mut v) = (0.4, 2.0);
    let (mut samples, mut velocities) = (Vec::new(), Vec::new());
    for _ in 0..ticks {
        let next = 1.0 + 2.0 * (draw(&mut seed) >> 11) as f64 / (1u64 << 53) as f64;
        let u = next - v;
        let boundary = f64::floor(x + 0.5 * (v + next));
        let mut sample = Sample::new(Count(boundary as u32)).with_current(Amps::new(u as f32));
        if boundary > x {
            // v s + u s²/2 = boundary - x.
            let way = boundary - x;
            let s = 2.0 * way / (v + f64::sqrt(v * v + 2.0 * u * way));
            sample = sample.with_edge(Edge {
                boundary: Count(boundary as u32),
                age: ClockTicks(((1.0 - s) * CLOCK.0 / RATE.0) as u32),
            });
        }
        x += 0.5 * (v + next);
        v = next;
        samples.push(sample);
        velocities.push(v);
    }
    (samples, velocities)
}

/// The bank after each sample, without an error of its input.
fn run<S: Stamps>(
    bank: &DrivenBank<S, Known>,
    samples: &[Sample],
) -> Vec<(f32, DrivenBankState<()>)> {
    let mut state = bank.start(&samples[0]);
    let mut after = Vec::new();
    for sample in samples {
        after.push((bank.update(&mut state, sample).0, state));
    }
    after
}

/// Root mean square of the error of the velocity, after the first 200 ticks.
fn rms(found: impl Iterator<Item = f32>, velocities: &[f64]) -> f64 {
    let errors = found.zip(velocities).skip(200);
    let squares: Vec<_> = errors.map(|(v, t)| (f64::from(v) - t).powi(2)).collect();
    f64::sqrt(squares.iter().sum::<f64>() / squares.len() as f64)
}

#[test]
fn exact_input_leaves_the_error_of_a_motion_without_acceleration() {
    let (samples, velocities) = erratic(2000);
    let edges = DrivenBank::on_edges(Known, FOLLOWED, CLOCK, RATE).unwrap();
    let counts = DrivenBank::on_counts(Known, FOLLOWED, RATE).unwrap();
    // Variance of an edge at its least, and of a count, counts².
    for (name, after, variance) in [
        ("edges", run(&edges, &samples), 3e-4),
        ("counts", run(&counts, &samples), 1.0 / 12.0),
    ] {
        // Steady Kalman filter of position and velocity: deviation of the velocity, counts/s, for an
        // acceleration of the density of the lowest rung, counts²/s³.
        let (acceleration, position) = (1.1e-3f64, variance / RATE.0);
        let steady = (2f64.sqrt() * acceleration.powf(0.75) * position.powf(0.25)).sqrt();
        let driven = rms(after.iter().map(|(v, _)| *v), &velocities);
        let plain = rms(after.iter().map(|(_, s)| s.plain.velocity()), &velocities);
        // The members of upper rungs have larger ones.
        assert!(driven < 100.0 * steady / RATE.0, "{name}: {driven}");
        // The plain bank does not know the velocity before a tick, uniform over 2 counts/tick.
        assert!(plain > 0.1, "{name}: {plain}");
        assert!(after.last().unwrap().1.probability() > 0.99, "{name}");
    }
}

/// The input of a tick acts from an edge within it on.
#[test]
fn exact_edges_and_an_exact_input_leave_next_to_no_error() {
    let (samples, velocities) = erratic(2000);
    let bank = ModelBank::<2, Stamped>::with_edges(CLOCK, RATE).unwrap();
    let mut state = bank.start(&samples[0]);
    let found: Vec<_> = (samples.iter())
        .map(|sample| {
            bank.advance(&mut state, sample, Some(sample.current.get()), true);
            state.velocity()
        })
        .collect();
    let error = rms(found.into_iter(), &velocities);
    // A ten-thousandth of the changes of the velocity.
    assert!(error < 2e-4, "{error}");
}

#[test]
fn probability_is_the_probability_by_the_densities_of_both_banks() {
    let bank = DrivenBank::on_counts(Known, [20.0, 5.0], RATE).unwrap();
    // Error and variance of each bank's innovation, counts and counts².
    for (probability, plain, driven) in [
        (0.5, (0.1, 0.02), (0.1, 0.02)),
        (0.5, (0.1, 0.04), (0.05, 0.005)),
        (0.2, (0.3, 0.01), (0.3, 0.09)),
        (0.9, (0.02, 0.003), (0.4, 0.02)),
        (0.7, (2.0, 0.01), (1.9, 0.01)),
    ] {
        let evidence = |(error, variance): (f32, f32)| Evidence {
            likelihood: Likelihood::new(1.0, 0.5 * error * error / variance),
            variance,
        };
        let found = bank.probability(probability, &evidence(plain), &evidence(driven));
        let density = |(error, variance): (f32, f32)| {
            let [error, variance] = [error, variance].map(f64::from);
            (1.0 + error * error / (32.0 * variance)).powi(-16) / variance.sqrt()
        };
        let probability = f64::from(probability);
        let prior = probability + (1.0 - probability) * 0.02 - probability * 0.005;
        let odds = prior / (1.0 - prior) * density(driven) / density(plain);
        let found = f64::from(found / (1.0 - found));
        // The root is approximated to 8 %.
        assert!((found / odds - 1.0).abs() < 0.085, "{found} for {odds}");
    }
}

#[test]
fn bank_without_input_is_alone_while_the_input_is_unknown() {
    let (mut samples, _) = erratic(600);
    for sample in &mut samples[200..400] {
        sample.current = Amps::ZERO;
    }
    let bank = DrivenBank::on_counts(Known, FOLLOWED, RATE).unwrap();
    let alone = ModelBank::<3, NoStamps>::new(RATE).unwrap();
    let mut state = alone.start(&samples[0]);
    let after = run(&bank, &samples);
    for (tick, (sample, (found, driven))) in samples.iter().zip(&after).enumerate() {
        let plain = alone.update(&mut state, sample).0;
        if (200..400).contains(&tick) {
            assert_eq!(*found, plain, "{tick}");
            assert_eq!(driven.probability(), 0.0, "{tick}");
        } else {
            assert!(driven.probability() > 0.0, "{tick}");
        }
    }
}

#[test]
fn driven_bank_begins_with_the_likelier_members_of_the_plain_bank() {
    // Constant velocity: both banks find the same.
    let bank = DrivenBank::on_counts(Known, FOLLOWED, RATE).unwrap();
    let samples: Vec<_> = (0..402u32)
        .map(|k| {
            let current = if k < 400 { 0.0 } else { 1e-9 };
            Sample::new(Count(7 * k / 2)).with_current(Amps::new(current))
        })
        .collect();
    let after = run(&bank, &samples);
    let (velocity, state) = after[400];
    assert!((velocity - 3.5).abs() < 0.05, "{velocity}");
    assert!((state.driven.velocity() - 3.5).abs() < 0.05);
    assert!(
        (state.probability() - START).abs() < 0.1,
        "{}",
        state.probability()
    );
    // The acceleration is that of the mixture too.
    let parts = [state.plain.acceleration(), state.driven.acceleration()];
    let mean = 0.5 * (parts[0] + parts[1]);
    let found = bank.acceleration(&state).0;
    assert!((found - mean).abs() <= 0.1 * (parts[0] - parts[1]).abs() + 1e-9);
}

#[test]
fn mean_acceleration_and_variance_are_those_of_the_mixture() {
    let (samples, _) = erratic(300);
    let bank = DrivenBank::on_counts(Known, FOLLOWED, RATE).unwrap();
    let (_, mut state) = run(&bank, &samples)[299];
    state.probability = 0.25;
    state.driven.drive(3.0);
    let parts = |of: &dyn Fn(&DrivenBankState<()>) -> [f32; 2]| of(&state).map(f64::from);
    let v = parts(&|s| [s.plain.velocity(), s.driven.velocity()]);
    let a = parts(&|s| [s.plain.acceleration(), s.driven.acceleration()]);
    let p = parts(&|s| [s.plain.velocity_variance(), s.driven.velocity_variance()]);
    let mean = |x: [f64; 2]| 0.75 * x[0] + 0.25 * x[1];
    let second_moment = mean([p[0] + v[0] * v[0], p[1] + v[1] * v[1]]);
    let expected = second_moment - mean(v) * mean(v);
    let found = f64::from(bank.variance(&state).0);
    assert!((found / expected - 1.0).abs() < 1e-5, "{found} {expected}");
    let found = f64::from(bank.acceleration(&state).0);
    assert!(
        (found - mean(a)).abs() < 1e-5 * (a[0].abs() + a[1].abs()),
        "{found} {a:?}"
    );
}

#[test]
fn root_of_the_ratio_is_limited() {
    let bank = DrivenBank::on_counts(Known, [0.0, 0.0], RATE).unwrap();
    let certain = |variance| Evidence {
        likelihood: Likelihood::CERTAIN,
        variance,
    };
    for (ratio, limit) in [(1e6, 10.0), (1e-6, 0.1)] {
        let found = bank.probability(0.5, &certain(ratio), &certain(1.0));
        let odds = root(limit);
        assert!((found - odds / (1.0 + odds)).abs() < 1e-6, "{found}");
    }
}
