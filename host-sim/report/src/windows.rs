//! Windows of a trace that figures show.

use std::ops::Range;

use super::Traces;
use scoring::score::skipped;

/// Samples at the start of a trace that figures and scores leave out.
fn start(traces: &Traces) -> usize {
    skipped(traces.rate_hz)
}

/// Window from `before_s` before to `after_s` after the start of the largest change of velocity
/// within 4 ms.
///
/// Of several equal changes the first; `None` if the trace is shorter or its velocity is constant.
pub(super) fn around_step(traces: &Traces, before_s: f64, after_s: f64) -> Option<Range<usize>> {
    let half = ((0.002 * traces.rate_hz).round() as usize).max(1);
    let before = (before_s * traces.rate_hz).round() as usize;
    let after = (after_s * traces.rate_hz).round() as usize;
    let truth = &traces.truth;
    let first = start(traces) + before + half;
    let last = truth.len().checked_sub(after.max(half) + 1)?;
    let mut best = (None, 0.0);
    for at in first..=last {
        let rise = (truth[at + half] - truth[at - half]).abs();
        // 1 % larger, so that rounding does not choose among equal steps.
        if rise > 1.01 * best.1 {
            best = (Some(at), rise);
        }
    }
    // A velocity that begins to move rises most in the 4 ms that begin there.
    let onset = best.0? - half;
    Some(onset - before..onset + after + 1)
}

/// The window of `span_s` with the smallest relative change of the true velocity, in it and in the
/// time `2 span_s` before it, so that estimators have settled.
///
/// The speed is at least half of the largest one; `None` if there is no such window.
pub(super) fn steady(traces: &Traces, span_s: f64) -> Option<Range<usize>> {
    let span = (span_s * traces.rate_hz).round() as usize;
    let settle = 2 * span;
    let truth = &traces.truth;
    let fastest = truth.iter().fold(0.0_f64, |m, w| m.max(w.abs()));
    let mut best: Option<(f64, Range<usize>)> = None;
    let mut from = start(traces);
    while span > 1 && from + settle + span < truth.len() {
        let end = from + settle + span + 1;
        let window = &truth[from..end];
        let low = window.iter().copied().fold(f64::INFINITY, f64::min);
        let high = window.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        let slowest = low.max(-high);
        let unsteady = (high - low) / slowest;
        if slowest >= 0.5 * fastest
            && slowest > 0.0
            && best
                .as_ref()
                .is_none_or(|(least, _)| unsteady < 0.9 * least)
        {
            best = Some((unsteady, from + settle..end));
        }
        from += span.div_ceil(4);
    }
    best.map(|(_, window)| window)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn traces(n: usize, of_time: impl Fn(f64) -> f64) -> Traces {
        Traces {
            rate_hz: 1000.0,
            truth: (0..n).map(|i| of_time(i as f64 / 1000.0)).collect(),
            estimates: Vec::new(),
        }
    }

    #[test]
    fn window_surrounds_the_largest_step_after_the_start() {
        let steps = |t: f64| match t {
            _ if t < 0.0495 => 0.0,
            _ if t < 0.3995 => 50.0,
            _ if t < 0.7995 => 52.0,
            _ => 45.0,
        };
        // The first 4 ms to hold all of the step at 0.8 s begin at 0.796 s.
        assert_eq!(
            around_step(&traces(1000, steps), 0.06, 0.06),
            Some(736..857)
        );
        assert_eq!(around_step(&traces(100, steps), 0.06, 0.06), None);
        assert_eq!(around_step(&traces(1000, |_| 3.0), 0.06, 0.06), None);
    }

    #[test]
    fn step_of_a_motor_begins_where_it_begins_to_move() {
        let rise = |t: f64| 20.0 * (1.0 - (-(t - 0.5).max(0.0) / 0.012).exp());
        assert_eq!(around_step(&traces(1000, rise), 0.06, 0.06), Some(440..561));
    }

    #[test]
    fn steady_window_has_a_high_and_constant_speed() {
        let profile = |t: f64| if t < 1.0 { -20.0 * t } else { -18.0 };
        let found = steady(&traces(2000, profile), 0.1).unwrap();
        assert!(found.start >= 1200 && found.len() == 101, "{found:?}");
        assert_eq!(steady(&traces(2000, |_| 0.0), 0.1), None);
        assert_eq!(steady(&traces(400, |_| 4.0), 0.1), None);
        assert_eq!(steady(&traces(401, |_| 4.0), 0.1), Some(300..401));
    }

    #[test]
    fn samples_that_no_score_uses_are_skipped() {
        assert_eq!(start(&traces(1000, |_| 0.0)), 100);
    }
}
