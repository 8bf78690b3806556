//! The weighted sum by its definition, its delay, rest and restart.

use super::super::SavitzkyGolay;
use super::super::draws::draw;
use super::*;
use crate::units::Counts;

fn after<E: VelocityEstimator>(filter: &E, position: impl Fn(i64) -> i64, ticks: i64) -> f32 {
    let sample = |k: i64| Sample::new(Count(position(k) as u32));
    let mut state = filter.start(&sample(0));
    (1..=ticks).fold(0.0, |_, k| filter.update(&mut state, &sample(k)).0)
}

#[test]
fn velocity_is_the_weighted_sum_by_its_definition() {
    let mut seed = 1;
    for n in [1, 2, 3, 15, 127, 128] {
        let filter = Algebraic::<128, 1, 2>::new(n).unwrap();
        let mut state = filter.start(&Sample::new(Count(0)));
        let (mut count, mut steps) = (Count(0), [0.0f64; 400]);
        for k in 0..steps.len() {
            let step = (draw(&mut seed) % 401) as i32 - 200;
            count = Count(count.0.wrapping_add_signed(step));
            steps.copy_within(..399, 1);
            steps[0] = f64::from(step);
            let found = filter.update(&mut state, &Sample::new(count)).0;
            let t = |i: usize| (i as f64 + 0.5) / n as f64;
            let u = |i: usize| t(i) * (1.0 - t(i)).powi(2);
            let mean = |of: &dyn Fn(usize) -> f64| {
                let sum = (0..n).map(u).sum::<f64>();
                (0..n).map(|i| u(i) * of(i)).sum::<f64>() / sum
            };
            let m = mean(&t);
            let s = mean(&|i| (t(i) - m).powi(2));
            let line = |i: usize| {
                if n == 1 {
                    1.0
                } else {
                    1.0 + m * (m - t(i)) / s
                }
            };
            let exact = mean(&|i| line(i) * steps[i]);
            // n roundings of terms up to 200 times the largest weight.
            let error = (f64::from(found) - exact).abs();
            assert!(error < 1e-3, "{n} {k}: {found} for {exact}");
        }
    }
}

#[test]
fn order_1_follows_ramp_and_parabola_without_delay() {
    for n in [2, 3, 15, 64] {
        let filter = Algebraic::<64, 1, 2>::new(n).unwrap();
        let ramp = after(&filter, |k| 7 * k, 100);
        assert!((ramp - 7.0).abs() < 1e-4, "{n}: {ramp}");
        // Position k², so the velocity at tick 100 is 200.
        let parabola = after(&filter, |k| k * k, 100);
        assert!((parabola - 200.0).abs() < 5e-3, "{n}: {parabola}");
    }
}

#[test]
fn order_0_has_the_delay_of_its_weight() {
    // Of many intervals: n (KAPPA + 1)/(KAPPA + MU + 2), 2/5 of 100; velocity 2 per tick lower for
    // each tick of delay.
    let filter = Algebraic::<128, 1, 2>::delayed(100).unwrap();
    let found = after(&filter, |k| k * k, 400);
    assert!((found - (800.0 - 2.0 * 40.0)).abs() < 0.1, "{found}");
    let alike = Algebraic::<128, 2, 2>::delayed(100).unwrap();
    let found = after(&alike, |k| k * k, 400);
    assert!((found - (800.0 - 2.0 * 50.0)).abs() < 0.1, "{found}");
}

#[test]
fn equal_powers_of_one_are_the_savitzky_golay_filter_of_many_intervals() {
    let algebraic = Algebraic::<128, 1, 1>::new(128).unwrap();
    let parabola = SavitzkyGolay::<128>::new(128).unwrap();
    // A cubic, which both follow with an error.
    let cubic = |k: i64| k * k * k / 1000;
    let [a, b] = [
        after(&algebraic, cubic, 1000),
        after(&parabola, cubic, 1000),
    ];
    let exact = 3.0 * 1000.0;
    assert!((a - b).abs() < 0.05 * (b - exact).abs(), "{a} and {b}");
}

#[test]
fn rest_is_exactly_zero_after_the_window() {
    let filter = Algebraic::<15, 1, 2>::new(15).unwrap();
    let mut state = filter.start(&Sample::new(Count(0)));
    for k in 1..40 {
        filter.update(&mut state, &Sample::new(Count(k * k)));
    }
    let rest = Sample::new(Count(39 * 39));
    for tick in 1..=20 {
        let v = filter.update(&mut state, &rest).0;
        assert_eq!(v == 0.0, tick >= 15, "{tick}: {v}");
    }
}

#[test]
fn step_of_2_to_15_counts_restarts_and_a_smaller_one_is_taken() {
    for n in [1, 15] {
        let filter = Algebraic::<15, 1, 2>::new(n).unwrap();
        for step in [32_767, -32_767, 32_768, -32_768, 40_000, -65_000, 1 << 20] {
            let mut state = filter.start(&Sample::new(Count(0)));
            filter.update(&mut state, &Sample::new(Count(9)));
            let landed = Sample::new(Count(9) + Counts(step));
            let v = filter.update(&mut state, &landed).0;
            let is_restarted = state == filter.start(&landed);
            assert_eq!(is_restarted, step.abs() >= 1 << 15, "{step}");
            assert!(v == step as f32 || n > 1 && !is_restarted, "{step}: {v}");
        }
    }
}

#[test]
fn window_out_of_range_is_refused() {
    for window in [0, 16] {
        let refused = Algebraic::<15, 1, 2>::new(window);
        assert_eq!(refused, Err(DesignError::WINDOW));
    }
    assert!(Algebraic::<15, 1, 2>::delayed(15).is_ok());
}
