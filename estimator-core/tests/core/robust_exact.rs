//! The optimal robust exact differentiator against its definition over all pairs, and its theorem.

use estimator_core::{Count, DesignError, Hertz, RobustExact, Sample, VelocityEstimator};

use crate::motion::Draws;

const RATE: Hertz = Hertz(1000.0);

/// The differentiator with L = `bound` counts/tick².
fn differentiator(bound: f64, n: usize) -> RobustExact<128> {
    let per_tick = 6283.0 / std::f64::consts::TAU / (RATE.0 * RATE.0);
    RobustExact::new(6283, RATE, bound / per_tick, n).unwrap()
}

/// 2 sqrt(N / L) by the definition, over all pairs, from the displacements d_1, d_2 and so on.
fn definition(d: &[i32], bound: f64) -> f64 {
    let mut noise = 0.0f64;
    for l in 1..=d.len() {
        for j in 1..=l {
            let (length, part) = (l as f64, j as f64);
            let chord = f64::from(d[l - 1]) * part / length;
            let sag = bound * part * (length - part) / 2.0;
            let term = ((f64::from(d[j - 1]) - chord).abs() - sag) / 2.0;
            noise = noise.max(term);
        }
    }
    2.0 * (noise / bound).sqrt()
}

#[test]
fn velocity_is_that_of_the_definition() {
    let mut draws = Draws(1);
    // Exact in units of 2^-24.
    for bound in [0.000_976_562_5, 0.0625, 0.5, 8.0, 4096.0] {
        for n in [1, 2, 3, 15, 40] {
            let filter = differentiator(bound, n);
            for limit in [1, 4, 300] {
                let mut counts = [0i32; 150];
                let mut state = filter.start(&Sample::new(Count(0)));
                for k in 1..counts.len() {
                    let step = draws.within(limit) as i32;
                    counts[k] = counts[k - 1] + step;
                    let v = filter
                        .update(&mut state, &Sample::new(Count(counts[k] as u32)))
                        .0;
                    let length = k.min(n);
                    let mut d = [0; 40];
                    for (j, d) in d[..length].iter_mut().enumerate() {
                        *d = counts[k] - counts[k - 1 - j];
                    }
                    let wanted = definition(&d[..length], bound);
                    // At a whole number f64 may be on either side.
                    let of = |m: f64| {
                        let m = (m.ceil() as usize).clamp(1, length);
                        d[m - 1] as f32 / m as f32
                    };
                    let possible = [of(wanted * (1.0 - 1e-12)), of(wanted * (1.0 + 1e-12))];
                    assert!(
                        possible.contains(&v),
                        "{bound} {n} {k}: {v}, not {possible:?}"
                    );
                }
            }
        }
    }
}

/// The theorem: with a noise of half a count the error stays within 2 sqrt(2 N L) + L/2.
#[test]
fn error_is_within_the_worst_case_of_the_theorem() {
    let mut draws = Draws(7);
    for bound in [0.001, 0.039, 0.3] {
        let filter = differentiator(bound, 128);
        let worst = 2.0 * (2.0 * 0.5 * bound).sqrt() + bound / 2.0;
        let mut state = filter.start(&Sample::new(Count(0)));
        let (mut position, mut velocity) = (0.0f64, 0.0f64);
        let (mut acceleration, mut left) = (0.0, 0);
        for tick in 0..50_000 {
            if left == 0 {
                left = draws.bits() % 200 + 1;
                // Full acceleration of either sign, or none.
                acceleration = bound * draws.within(1) as f64;
            }
            left -= 1;
            position += velocity + acceleration / 2.0;
            velocity += acceleration;
            let count = Count(f64::round(position) as i64 as u32);
            let v = f64::from(filter.update(&mut state, &Sample::new(count)).0);
            let error = (v - velocity).abs();
            assert!(error <= worst, "{bound} {tick}: {v} for {velocity}");
        }
    }
}

/// Without noise the differentiator is exact but for the lag of half an interval.
#[test]
fn parabola_without_noise_gives_the_finite_difference() {
    let filter = differentiator(6.0, 128);
    let mut state = filter.start(&Sample::new(Count(0)));
    for k in 1..1000u32 {
        // Position 3 k², acceleration 6 counts/tick².
        let v = filter.update(&mut state, &Sample::new(Count(3 * k * k))).0;
        assert_eq!(v, (6 * k - 3) as f32);
    }
}

#[test]
fn velocity_is_zero_once_rest_fills_the_window() {
    for n in [1, 2, 15, 128] {
        let filter = differentiator(0.01, n);
        let mut count = Count(u32::MAX - 1000);
        let mut state = filter.start(&Sample::new(count));
        for velocity in [7, -i32::from(i16::MAX), 1, i32::from(i16::MAX)] {
            for _ in 0..200 {
                count = Count(count.0.wrapping_add_signed(velocity));
                filter.update(&mut state, &Sample::new(count));
            }
            for tick in 1..=n + 3 {
                let v = filter.update(&mut state, &Sample::new(count)).0;
                assert!(tick < n || v == 0.0, "n = {n}, tick {tick}: {v}");
            }
        }
    }
}

#[test]
fn jump_restarts_the_window() {
    let filter = differentiator(0.04, 20);
    let mut used = filter.start(&Sample::new(Count(0)));
    for k in 1..45 {
        filter.update(&mut used, &Sample::new(Count(k * k)));
    }
    let landed = Count(1 << 20);
    let jump = filter.update(&mut used, &Sample::new(landed)).0;
    assert_eq!(jump, ((1 << 20) - 44 * 44) as f32);
    let mut fresh = filter.start(&Sample::new(landed));
    for k in 1..40 {
        let sample = Sample::new(Count(landed.0 + 3 * k / 2));
        let one = filter.update(&mut used, &sample);
        assert_eq!(one, filter.update(&mut fresh, &sample), "{k}");
    }
}

#[test]
fn window_and_acceleration_out_of_range_are_refused() {
    let new = |acceleration, n| RobustExact::<15>::new(4096, RATE, acceleration, n).err();
    assert_eq!(new(60.0, 0), Some(DesignError::WINDOW));
    assert_eq!(new(60.0, 16), Some(DesignError::WINDOW));
    assert_eq!(new(0.0, 15), Some(DesignError::ACCELERATION));
    assert_eq!(new(60.0, 15), None);
}
