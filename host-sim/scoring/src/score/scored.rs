//! The samples of a trace that are scored.

use std::ops::Range;

use super::SKIP_S;

/// Number of samples at the start of a trace at `rate_hz` that are not scored: those of [`SKIP_S`].
#[must_use]
pub fn skipped(rate_hz: f64) -> usize {
    (SKIP_S * rate_hz).round() as usize
}

/// Ranges of the samples that are scored, in order and not empty: of `samples` at `rate_hz`, those from
/// [`SKIP_S`] on at which the truth is `known`. `None` for `known` is a truth that is known everywhere.
///
/// # Panics
/// If `known` has fewer than `samples` values.
#[must_use]
pub fn scored(samples: usize, rate_hz: f64, known: Option<&[bool]>) -> Vec<Range<usize>> {
    let skip = skipped(rate_hz).min(samples);
    let mut ranges = Vec::new();
    let mut start = skip;
    for k in known.iter().flat_map(|known| skip..known[..samples].len()) {
        if known.is_some_and(|known| !known[k]) {
            ranges.push(start..k);
            start = k + 1;
        }
    }
    ranges.push(start..samples);
    ranges.retain(|range| !range.is_empty());
    ranges
}

/// Root mean square of those of `values` at `rate_hz` that are scored, as [`scored`]; 0 if there are none.
#[must_use]
pub fn rms_scored<T: Copy + Into<f64>>(values: &[T], rate_hz: f64, known: Option<&[bool]>) -> f64 {
    let ranges = scored(values.len(), rate_hz, known);
    let samples: usize = ranges.iter().map(Range::len).sum();
    let scored = ranges.into_iter().flat_map(|range| &values[range]);
    let squares: f64 = scored.map(|value| (*value).into().powi(2)).sum();
    (squares / samples.max(1) as f64).sqrt()
}

#[cfg(test)]
#[expect(clippy::single_range_in_vec_init, reason = "one range is meant")]
mod tests {
    use super::{rms_scored, scored};

    #[test]
    fn samples_after_the_start_at_which_the_truth_is_known_are_scored() {
        assert_eq!(scored(30, 100.0, None), [10..30]);
        assert_eq!(scored(10, 100.0, None), []);
        assert_eq!(scored(4, 100.0, None), []);
        let known =
            |unknown: &[usize]| -> Vec<_> { (0..30).map(|k| !unknown.contains(&k)).collect() };
        for (unknown, ranges) in [
            (&[][..], vec![10..30]),
            (&[3, 9], vec![10..30]),
            (&[10, 29], vec![11..29]),
            (&[15, 16, 20], vec![10..15, 17..20, 21..30]),
        ] {
            assert_eq!(
                scored(30, 100.0, Some(&known(unknown))),
                ranges,
                "{unknown:?}"
            );
        }
        assert_eq!(scored(30, 100.0, Some(&[false; 30])), []);
    }

    #[test]
    fn root_mean_square_is_that_of_the_scored_values() {
        let values: Vec<f32> = (0..30).map(|k| if k < 15 { 9.0 } else { 4.0 }).collect();
        let known: Vec<_> = (0..30).map(|k| k >= 14).collect();
        assert_eq!(
            rms_scored(&values, 100.0, Some(&known[..])),
            ((81.0 + 15.0 * 16.0) / 16.0_f64).sqrt()
        );
        assert_eq!(rms_scored(&values[..5], 100.0, None), 0.0);
    }
}
