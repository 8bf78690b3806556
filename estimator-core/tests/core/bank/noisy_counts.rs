//! Counts with a noise below one count, and the start of a motion behind it.

use std::f64::consts::PI;

use estimator_core::{Count, Hertz, Imm, ImmPair, ModelBank, Sample, VelocityEstimator};

use super::Random;

/// Errors of `imm`, `imm-pair` and finite difference, counts/tick.
#[derive(Debug, Default)]
struct Errors {
    all: [Vec<f64>; 3],
}

impl Errors {
    /// Errors after `begin` s of a shaft with `motion`, counts and counts/s of time in s, whose counts have a
    /// Gaussian noise.
    fn of(
        hz: f64,
        [begin, end]: [f64; 2],
        deviation: f64,
        seed: u64,
        motion: impl Fn(f64) -> [f64; 2],
    ) -> Self {
        let mut random = Random(seed);
        // The sum of twelve has the variance 4.
        let mut noise = || (0..12).map(|_| random.next()).sum::<f64>() / 2.0 * deviation;
        let mut counts = |t: f64| (motion(t)[0] + noise()).floor() as i64;
        let imm: Imm = ModelBank::new(Hertz(hz)).expect("valid");
        let pair: ImmPair = ModelBank::new(Hertz(hz)).expect("valid");
        let mut before = counts(0.0);
        let first = Sample::new(Count(before as u32));
        let (mut state, mut of_pair) = (imm.start(&first), pair.start(&first));
        let mut errors = Self::default();
        for tick in 1..(end * hz) as u32 {
            let t = f64::from(tick) / hz;
            let count = counts(t);
            let sample = Sample::new(Count(count as u32));
            let estimates = [
                imm.update(&mut state, &sample).0.into(),
                pair.update(&mut of_pair, &sample).0.into(),
                (count - before) as f64,
            ];
            before = count;
            if t > begin {
                let truth = motion(t)[1] / hz;
                for (errors, estimate) in errors.all.iter_mut().zip(estimates) {
                    errors.push(estimate - truth);
                }
            }
        }
        errors
    }

    /// RMS of both banks over that of finite difference.
    fn ratios(&self) -> [f64; 2] {
        let [imm, pair, differences] = [0, 1, 2].map(|k| {
            let squares = self.all[k].iter().map(|x| x * x);
            squares.sum::<f64>().sqrt()
        });
        [imm / differences, pair / differences]
    }

    /// Largest error of both banks.
    fn largest(&self) -> [f64; 2] {
        [0, 1].map(|k| self.all[k].iter().fold(0.0, |most, x| x.abs().max(most)))
    }
}

/// A noise of less than a count is learned at every speed. Of a shaft at rest in the middle of a count few counts tell of
/// it.
#[test]
fn small_noise_of_counts_is_learned() {
    for deviation in [0.1, 0.2, 0.3, 0.5] {
        for hz in [1000.0, 10_000.0] {
            // At rest in the middle of a count, counts/tick; the slowest crosses four counts in the time.
            for speed in [0.0, 1.0 / hz, 0.05, 0.37, 1.63, 7.39] {
                if (deviation, speed) == (0.1, 0.0) {
                    continue;
                }
                let motion = |t: f64| [100.5 + speed * hz * t, speed * hz];
                let errors = Errors::of(hz, [1.0, 5.0], deviation, 1234, motion);
                let ratios = errors.ratios();
                println!("{deviation} counts, {hz} Hz, {speed} counts/tick: {ratios:.4?}");
                let bound = if speed > 0.0 { 0.01 } else { 0.1 };
                let is_good = ratios.iter().all(|ratio| *ratio < bound);
                assert!(is_good, "{deviation} {hz} {speed}: {ratios:?}");
            }
        }
    }
}

/// A bank that has learned a noise takes the start of a motion for more of it, and lags, only until the shifts have
/// one sign.
#[test]
fn motion_that_begins_after_a_noisy_rest_is_followed() {
    const PER_RAD: f64 = 16_384.0 / (2.0 * PI);
    // 30 rad/s in 0.2 s.
    let motion = |t: f64| {
        let (t, w) = ((t - 1.0).max(0.0), PI / 0.2);
        let [x, v] = match t < 0.2 {
            true => [15.0 * (t - (w * t).sin() / w), 15.0 * (1.0 - (w * t).cos())],
            false => [3.0 + 30.0 * (t - 0.2), 30.0],
        };
        [PER_RAD * (x + 0.3), PER_RAD * v]
    };
    for (hz, bound) in [
        (1000.0, 0.7),
        (5000.0, 0.2),
        (10_000.0, 0.15),
        (20_000.0, 0.1),
    ] {
        for seed in 101..106 {
            let errors = Errors::of(hz, [0.9, 1.5], 0.7, seed, motion);
            let [rms, largest] = [errors.ratios(), errors.largest().map(|x| x * hz / PER_RAD)];
            println!("{hz} Hz, seed {seed}: RMS {rms:.3?} of FD, largest {largest:.1?} rad/s");
            assert!(rms.iter().all(|x| *x < bound), "{hz} {seed}: {rms:?}");
            assert!(
                largest.iter().all(|x| *x < 30.0),
                "{hz} {seed}: {largest:?}"
            );
        }
    }
}
