//! Percentiles of magnitudes.

/// The percentile `share` (0 to 1) of the magnitudes of `values`, by nearest rank: the smallest
/// magnitude that at least this share of the magnitudes does not exceed.
///
/// # Panics
/// If `values` is empty.
///
/// ```
/// let values = (1..=200).map(|i| f64::from(if i % 2 == 0 { i } else { -i }));
/// assert_eq!(scoring::percentile(values, 0.99), 198.0);
/// ```
#[must_use]
pub fn percentile(values: impl Iterator<Item = f64>, share: f64) -> f64 {
    let mut sizes: Vec<f64> = values.map(f64::abs).collect();
    let rank = (share * sizes.len() as f64).ceil() as usize;
    let at = rank.clamp(1, sizes.len()) - 1;
    *sizes.select_nth_unstable_by(at, f64::total_cmp).1
}

#[cfg(test)]
mod tests {
    use super::percentile;

    #[test]
    fn percentile_is_the_value_at_its_rank() {
        let values = || (1..=200).map(|i| f64::from(if i % 2 == 0 { i } else { -i }));
        assert_eq!(percentile(values(), 0.99), 198.0);
        assert_eq!(percentile(values(), 1.0), 200.0);
        assert_eq!(percentile([-3.0].into_iter(), 0.99), 3.0);
    }

    /// 148 of 150 magnitudes are 98.7 % of them, 149 are 99.3 %.
    #[test]
    fn at_least_the_share_does_not_exceed_a_percentile_between_two_ranks() {
        let values = (1..=150).map(f64::from);
        assert_eq!(percentile(values, 0.99), 149.0);
        assert_eq!(percentile([4.0, -1.0].into_iter(), 0.6), 4.0);
    }
}
