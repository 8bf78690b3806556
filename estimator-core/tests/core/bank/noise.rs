//! The noise of the boundaries and of the counts, which a bank learns.

use estimator_core::{Count, Hertz, Imm, ImmEdge, ModelBank, Sample, VelocityEstimator};

use super::{CLOCK, Random, Seen, hand, rms};

#[test]
fn the_noise_of_boundaries_is_estimated() {
    // The variance of a uniform error within ±noise is a third of its square.
    for (noise, lowest, highest) in [(0.0, 0.0, 1.1e-3), (0.2, 0.004, 0.05)] {
        let seen = Seen::new(1000.0, 6000, noise, &|t| 20_000.0 * hand(t));
        let bank: ImmEdge = ModelBank::with_edges(CLOCK, Hertz(1000.0)).expect("valid");
        let mut state = bank.start(&seen.samples[0]);
        let (mut sum, mut number) = (0.0, 0.0);
        for (tick, sample) in seen.samples.iter().enumerate().skip(1) {
            bank.update(&mut state, sample);
            if tick > 2000 {
                sum += f64::from(state.boundary_variance());
                number += 1.0;
            }
        }
        let mean = sum / number;
        println!("{noise}: {mean}");
        assert!(mean >= lowest && mean <= highest, "{noise}: {mean}");
    }
}

/// A magnetic encoder whose counts are noisy: the variance is learned in a second, and the velocity is far better
/// than the differences. Without noise it stays small.
#[test]
fn the_noise_of_counts_is_estimated() {
    for (deviation, [lowest, highest], share) in [
        (0.0, [0.0, 0.1], 0.4),
        (1.0, [0.33, 3.0], 0.2),
        (5.0, [8.0, 75.0], 0.1),
        (50.0, [800.0, 7500.0], 0.1),
    ] {
        let seen = Seen::new(1000.0, 6000, 0.0, &|t| 16_384.0 * hand(t));
        let mut random = Random(7);
        // The sum of three has the variance 1.
        let mut noise = || (0..3).map(|_| random.next()).sum::<f64>() * deviation;
        let counts: Vec<_> = (seen.counts.iter())
            .map(|count| (count + 0.5 + noise()).floor() as i64)
            .collect();
        let bank: Imm = ModelBank::new(Hertz(1000.0)).expect("valid");
        let mut state = bank.start(&Sample::new(Count(counts[0] as u32)));
        let (mut learned, mut errors, mut differences, mut number) = (0.0, 0.0, 0.0, 0.0);
        for tick in 1..counts.len() {
            let velocity = bank.update(&mut state, &Sample::new(Count(counts[tick] as u32)));
            if tick > 1000 {
                let truth = seen.velocities[tick];
                learned += f64::from(state.boundary_variance());
                errors += (f64::from(velocity.0) - truth).powi(2);
                differences += ((counts[tick] - counts[tick - 1]) as f64 - truth).powi(2);
                number += 1.0;
            }
        }
        let (mean, ratio) = (learned / number, (errors / differences).sqrt());
        println!("{deviation}: R {mean}, error {ratio}");
        assert!(mean >= lowest && mean <= highest, "{deviation}: {mean}");
        assert!(ratio < share, "{deviation}: {ratio}");
    }
}

/// `deviation` times a Gaussian noise, as a function of time in s, that changes `hz` times a second and lasts
/// `seconds`.
fn noise(deviation: f64, hz: f64, seconds: f64, seed: u64) -> impl Fn(f64) -> f64 {
    let mut random = Random(seed);
    // The sum of three has the variance 1.
    let mut one = || (0..3).map(|_| random.next()).sum::<f64>() * deviation;
    let mut values: Vec<f64> = (0..(hz * seconds) as usize).map(|_| one()).collect();
    values.extend([0.0, 0.0]);
    move |t: f64| {
        let place = (t * hz).clamp(0.0, (values.len() - 2) as f64);
        let at = (place as usize).min(values.len() - 2);
        values[at] + (place - at as f64) * (values[at + 1] - values[at])
    }
}

/// A magnetic encoder with noisy lines, 1, 4 or 8 times a tick. From a noise of a count on, the stamps are worth
/// nothing, and the bank is that on counts. A smaller one is a noise of the boundaries.
#[test]
fn noisy_stamps_do_no_harm() {
    for (counts, per_tick, rate) in [(4096.0, 1.0, 1e3), (1024.0, 8.0, 1e3), (16_384.0, 4.0, 4e3)] {
        let bank: ImmEdge = ModelBank::with_edges(CLOCK, Hertz(rate)).expect("valid");
        let on_counts: Imm = ModelBank::new(Hertz(rate)).expect("valid");
        let clean = Seen::new(rate, 4000, 0.0, &|t| counts * hand(t));
        for (deviation, share) in [
            (0.1, 0.2),
            (0.3, 0.25),
            (1.0, 0.12),
            (3.0, 0.06),
            (10.0, 0.06),
        ] {
            let noise = noise(deviation, per_tick * rate, 4001.0 / rate, 29);
            let mut seen = Seen::new(rate, 4000, 0.0, &|t| counts * hand(t) + noise(t));
            seen.velocities.clone_from(&clean.velocities);
            let differences = seen.rms(&seen.finite_difference());
            let ratio = seen.rms(&seen.run(&bank)) / differences;
            let of_counts = seen.rms(&seen.run(&on_counts)) / differences;
            println!("{counts} counts at {rate} Hz, noise {deviation}: {ratio}, imm {of_counts}");
            assert!(ratio < share, "{counts}, {deviation}: {ratio}");
        }
    }
}

/// A disturbance of a second makes the stamps noisy. Two seconds later they are used as if it had not been.
#[test]
fn stamps_are_used_again_after_a_disturbance() {
    let noise = noise(3.0, 1000.0, 1.0, 31);
    let bank: ImmEdge = ModelBank::with_edges(CLOCK, Hertz(1000.0)).expect("valid");
    let clean = Seen::new(1000.0, 5000, 0.0, &|t| 4096.0 * hand(t));
    let seen = Seen::new(1000.0, 5000, 0.0, &|t| 4096.0 * hand(t) + noise(t));
    let error = |velocities: &[f64]| rms(&clean.velocities[3000..], &velocities[3000..]);
    let (disturbed, exact) = (error(&seen.run(&bank)), error(&clean.run(&bank)));
    println!("{disturbed} of {exact}");
    assert!(disturbed < 1.02 * exact, "{disturbed} of {exact}");
}
