//! The delay of an estimate against the true velocity.

use std::ops::Range;

/// Peak-to-peak value of the true velocity below which no delay is computed, rad/s.
const MOVES_RAD_S: f64 = 1e-3;

/// Delay of the estimate against the truth, samples; negative if the estimate leads. It is the
/// shift with the least mean square error, refined below one sample by a parabola.
///
/// Every shift compares the estimates of `scored` in `margin..len - margin` with the truth, also where it is not
/// known. The search begins at zero, doubles the shift in the direction of the smaller error, and then halves the
/// bracket of the minimum. The result is `None` if the truth does not move, if the trace is shorter than three margins
/// or if the best shift is not below the margin.
pub(super) fn samples(
    truth: &[f64],
    estimate: &[f32],
    margin: usize,
    scored: &[Range<usize>],
) -> Option<f64> {
    if margin < 2 || truth.len() < 3 * margin {
        return None;
    }
    let inner = |range: &Range<usize>| range.start.max(margin)..range.end.min(truth.len() - margin);
    let scored: Vec<_> = scored
        .iter()
        .map(inner)
        .filter(|range| !range.is_empty())
        .collect();
    let samples: usize = scored.iter().map(Range::len).sum();
    let truths = || scored.iter().flat_map(|range| &truth[range.clone()]);
    let (low, high) = truths().fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), &w| {
        (low.min(w), high.max(w))
    });
    // No sample has a span of minus infinity.
    if high - low < MOVES_RAD_S {
        return None;
    }
    let cost = |shift: isize| {
        let squares = scored.iter().map(|range| {
            let start = range.start.wrapping_add_signed(-shift);
            square_error(&estimate[range.clone()], &truth[start..start + range.len()])
        });
        squares.sum::<f64>() / samples as f64
    };
    let limit = margin as isize;

    let at_zero = cost(0);
    let (ahead, behind) = (cost(1), cost(-1));
    let direction = if ahead < at_zero && ahead <= behind {
        1
    } else if behind < at_zero {
        -1
    } else {
        return Some(vertex(behind, at_zero, ahead));
    };
    // Three shifts in that direction with their errors. The error at best[1] is the smallest.
    let side = |distance: isize| cost(direction * distance);
    let mut best = [
        (0, at_zero),
        (1, ahead.min(behind)),
        (2, side(2.min(limit))),
    ];
    while best[2].1 < best[1].1 {
        let next = (2 * best[2].0).min(limit);
        if next == best[2].0 {
            // The error decreases up to the limit: the minimum is one step before the limit, or
            // beyond.
            let inner = (limit - 1, side(limit - 1));
            if inner.1 >= best[2].1 {
                return None;
            }
            best = [best[1], inner, best[2]];
            break;
        }
        best = [best[1], best[2], (next, side(next))];
    }
    while best[2].0 - best[0].0 > 2 {
        let [left, middle, right] = best;
        let right_is_wider = right.0 - middle.0 > middle.0 - left.0;
        let probe = if right_is_wider {
            middle.0.midpoint(right.0)
        } else {
            left.0.midpoint(middle.0)
        };
        let probed = (probe, side(probe));
        best = match (right_is_wider, probed.1 < middle.1) {
            (true, true) => [middle, probed, right],
            (true, false) => [left, middle, probed],
            (false, true) => [left, probed, middle],
            (false, false) => [probed, middle, right],
        };
    }
    let distance = best[1].0 as f64 + vertex(best[0].1, best[1].1, best[2].1);
    Some(direction as f64 * distance)
}

/// Abscissa of the minimum of the parabola through (-1, left), (0, middle), (1, right).
fn vertex(left: f64, middle: f64, right: f64) -> f64 {
    let curvature = left - 2.0 * middle + right;
    if curvature > 0.0 {
        0.5 * (left - right) / curvature
    } else {
        0.0
    }
}

/// Sum of the squared differences. Independent sums let the compiler use vector instructions.
fn square_error(estimate: &[f32], truth: &[f64]) -> f64 {
    const LANES: usize = 8;
    let (estimates, estimate_rest) = estimate.as_chunks::<LANES>();
    let (truths, truth_rest) = truth.as_chunks::<LANES>();
    let mut sums = [0.0; LANES];
    for (estimates, truths) in estimates.iter().zip(truths) {
        for lane in 0..LANES {
            let error = f64::from(estimates[lane]) - truths[lane];
            sums[lane] += error * error;
        }
    }
    let rest = estimate_rest.iter().zip(truth_rest);
    let rest: f64 = rest.map(|(&e, &w)| (f64::from(e) - w).powi(2)).sum();
    sums.iter().sum::<f64>() + rest
}

#[cfg(test)]
#[expect(clippy::single_range_in_vec_init, reason = "one range is meant")]
mod tests {
    use super::*;
    use std::f64::consts::TAU;

    /// The delay where all samples but a margin are scored.
    fn samples(truth: &[f64], estimate: &[f32], margin: usize) -> Option<f64> {
        super::samples(truth, estimate, margin, &[margin..truth.len()])
    }

    fn wave(at: f64) -> f64 {
        3.0 * (TAU * at / 400.0).sin() + 2.0 * (TAU * at / 950.0).cos()
    }

    fn lagging(by: f64, n: usize) -> (Vec<f64>, Vec<f32>) {
        (0..n)
            .map(|i| (wave(i as f64), wave(i as f64 - by) as f32))
            .unzip()
    }

    #[test]
    fn delay_of_a_ramp_by_one_and_a_half_samples_is_found() {
        let (truth, late): (Vec<f64>, Vec<f32>) = (0..1003)
            .map(|i| (0.5 * f64::from(i), (0.5 * (f64::from(i) - 1.5)) as f32))
            .unzip();
        let found = samples(&truth, &late, 100).unwrap();
        assert!((found - 1.5).abs() < 1e-4, "{found}");
    }

    #[test]
    fn any_delay_or_lead_below_the_margin_is_found() {
        for by in [0.0, 0.3, 1.0, 2.5, 3.0, 7.25, 20.0, 61.4, 97.0, 99.0] {
            for by in [by, -by] {
                let (truth, estimate) = lagging(by, 4000);
                let found = samples(&truth, &estimate, 100).unwrap();
                assert!((found - by).abs() < 2e-3, "{by} samples: {found}");
            }
        }
    }

    /// The error of a square wave grows with the shift in proportion: no parabola leads to its minimum.
    #[test]
    fn delay_of_a_square_wave_is_found() {
        let wave = |i: i32| if i.rem_euclid(800) < 400 { 1.0 } else { -1.0 };
        let truth: Vec<f64> = (0..4000).map(wave).collect();
        for by in [-97, -5, -1, 0, 1, 2, 5, 97] {
            let estimate: Vec<f32> = (0..4000).map(|i| wave(i - by) as f32).collect();
            assert_eq!(samples(&truth, &estimate, 100), Some(f64::from(by)));
        }
        assert_eq!(vertex(3.0, 2.0, 1.0), 0.0);
    }

    #[test]
    fn noise_changes_the_delay_little() {
        let (truth, mut estimate) = lagging(4.0, 4000);
        for (i, value) in estimate.iter_mut().enumerate() {
            *value += if (i * 7919) % 13 > 6 { 1.0 } else { -1.0 };
        }
        let found = samples(&truth, &estimate, 100).unwrap();
        assert!((found - 4.0).abs() < 0.3, "{found}");
    }

    #[test]
    fn delay_is_none_without_motion_room_or_minimum() {
        let (truth, estimate) = lagging(1.0, 4000);
        let still = vec![2.0; 4000];
        assert_eq!(samples(&still, &estimate, 100), None);
        assert_eq!(samples(&truth[..299], &estimate[..299], 100), None);
        assert!(samples(&truth[..300], &estimate[..300], 100).is_some());
        let (truth, estimate) = lagging(130.0, 4000);
        assert_eq!(samples(&truth, &estimate, 100), None);
    }

    #[test]
    fn every_sample_counts_in_the_square_error() {
        // 1 + 4 + ... + 361 = 19 * 20 * 39 / 6.
        let truth: Vec<f64> = (1..20).map(f64::from).collect();
        assert_eq!(square_error(&[0.0; 19], &truth), 19.0 * 130.0);
        assert_eq!(
            square_error(&[0.0; 2], &truth[17..]),
            18.0 * 18.0 + 19.0 * 19.0
        );
    }

    /// A part that is not scored has another delay.
    #[test]
    fn delay_is_that_of_the_scored_samples() {
        let (truth, mut estimate) = lagging(4.0, 4000);
        let (_, later) = lagging(40.0, 4000);
        estimate[1000..2500].copy_from_slice(&later[1000..2500]);
        let found = super::samples(&truth, &estimate, 100, &[100..1000, 2500..4000]).unwrap();
        assert!((found - 4.0).abs() < 2e-3, "{found}");
        let found = super::samples(&truth, &estimate, 100, &[1000..2500]).unwrap();
        assert!((found - 40.0).abs() < 2e-3, "{found}");
        assert_eq!(super::samples(&truth, &estimate, 100, &[]), None);
        // None of these is farther than the margin from the end.
        assert_eq!(super::samples(&truth, &estimate, 100, &[3901..3990]), None);
    }

    #[test]
    fn smallest_margin_is_of_two_samples() {
        let (truth, late) = lagging(1.0, 50);
        assert_eq!(samples(&truth, &late, 1), None);
        let found = samples(&truth, &late, 2).unwrap();
        assert!((found - 1.0).abs() < 0.01, "{found}");
    }
}
