//! Transients of a trace.

use std::ops::Range;

/// Acceleration above which a transient begins, rad/s^2.
const THRESHOLD_RAD_S2: f64 = 100.0;
/// Half of the central difference that measures acceleration, s.
pub const HALF_SPAN_S: f64 = 0.002;
/// Duration of a transient after the acceleration was last above the threshold, s.
const HOLD_S: f64 = 0.020;

/// Ranges of samples within [`HOLD_S`] after the acceleration exceeded the threshold. The ranges
/// are in order, do not touch and begin at `from` or later.
///
/// A sample whose central difference extends beyond the trace does not start a transient.
pub(super) fn ranges(truth: &[f64], rate_hz: f64, from: usize) -> Vec<Range<usize>> {
    let half = ((HALF_SPAN_S * rate_hz).round() as usize).max(1);
    let hold = (HOLD_S * rate_hz).round() as usize;
    let rise = THRESHOLD_RAD_S2 * 2.0 * half as f64 / rate_hz;
    let mut found: Vec<Range<usize>> = Vec::new();
    for (offset, pair) in truth.windows(2 * half + 1).enumerate() {
        if (pair[2 * half] - pair[0]).abs() <= rise {
            continue;
        }
        let at = offset + half;
        let (start, end) = (at.max(from), (at + hold + 1).min(truth.len()));
        match found.last_mut() {
            _ if start >= end => {}
            Some(last) if start <= last.end => last.end = end,
            _ => found.push(start..end),
        }
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The central difference spans 4 samples at 1 kHz and 40 at 10 kHz, the hold 20 and 200.
    #[test]
    fn transient_lasts_from_2_ms_before_to_20_ms_after_a_step() {
        let mut truth = vec![0.0; 1000];
        truth[500..].fill(1.0);
        // |w[i+2] - w[i-2]| = 1 for i + 2 >= 500 and i - 2 < 500: i = 498..=501.
        assert_eq!(ranges(&truth, 1000.0, 100), vec![498..522]);
        assert_eq!(ranges(&truth, 1000.0, 510), vec![510..522]);
        assert!(ranges(&truth, 1000.0, 522).is_empty());
        assert_eq!(ranges(&truth, 10_000.0, 0), vec![480..720]);
    }

    #[test]
    fn transients_of_near_steps_merge() {
        let mut truth = vec![0.0; 1000];
        truth[300..].fill(1.0);
        truth[310..].fill(2.0);
        truth[400..].fill(-1.0);
        assert_eq!(ranges(&truth, 1000.0, 0), vec![298..332, 398..422]);
    }

    #[test]
    fn threshold_is_the_same_acceleration_at_every_rate() {
        for rate in [1000.0, 10_000.0, 11_600.0] {
            let ramp = |slope: f64| -> Vec<f64> {
                (0..2000).map(|i| slope * f64::from(i) / rate).collect()
            };
            assert!(ranges(&ramp(99.0), rate, 0).is_empty(), "{rate} Hz");
            assert_eq!(ranges(&ramp(-101.0), rate, 0).len(), 1, "{rate} Hz");
        }
    }

    #[test]
    fn short_trace_has_no_transient() {
        assert!(ranges(&[0.0, 100.0, 0.0], 1000.0, 0).is_empty());
    }
}
