//! Sampled signals of a simulated run, or of a recording of a real motor.

use std::ops::Range;

/// Rate of the clock that stamps encoder edges, Hz: a timer at half the board's 168 MHz.
pub const EDGE_CLOCK_HZ: f64 = 84e6;

/// The latest encoder edge known at a tick.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EdgeStamp {
    /// Seconds from the edge to the tick that reads it, never negative.
    pub age_s: f64,
    /// Boundary crossed, modulo 2^32: boundary `e` lies between counts `e - 1` and `e`.
    pub boundary: u32,
}

/// A sampled run, with one entry per tick in every present column.
///
/// A missing column is `None`: it was not simulated, or it is not in the recording.
#[derive(Clone, Debug, Default)]
pub struct Trace {
    /// Control rate, Hz.
    pub rate_hz: f64,
    /// Time from the tick before, in periods of `rate_hz`; `None` for a constant period. The first value
    /// is 1.
    pub periods: Option<Vec<f32>>,
    /// Large encoder, modulo 2^32.
    pub counts_large: Vec<u32>,
    /// Small encoder, modulo 2^32.
    pub counts_small: Option<Vec<u32>>,
    /// Large motor's commanded current, applied from this tick to the next, A.
    pub current: Option<Vec<f64>>,
    /// Latest large-encoder edge at or before each tick; `None` before the first edge.
    pub edges: Option<Vec<Option<EdgeStamp>>>,
    /// True velocity of the large motor at each tick, rad/s: for scores only.
    pub true_omega: Option<Vec<f64>>,
    /// Whether the true velocity is known at each tick; `None` if it is known at all of them: for scores only.
    pub known: Option<Vec<bool>>,
    /// True damping of the coupler from each tick to the next, N.m.s/rad: for scores only.
    pub true_damping: Option<Vec<f64>>,
}

/// Counts modulo 2^32 without their wraps: the first one between -2^31 and 2^31, the others by the changes.
#[must_use]
pub fn continued(counts: &[u32]) -> Vec<i64> {
    let mut last = 0;
    let mut at = 0;
    let next = |&count: &u32| {
        at += i64::from(count.wrapping_sub(last) as i32);
        last = count;
        at
    };
    counts.iter().map(next).collect()
}

impl Trace {
    /// Number of ticks.
    #[must_use]
    pub fn len(&self) -> usize {
        self.counts_large.len()
    }

    /// Whether the trace has no tick.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.counts_large.is_empty()
    }

    /// The rows `rows` of the trace, with the same columns.
    ///
    /// # Panics
    /// If the trace does not have these rows.
    #[must_use]
    pub fn rows(&self, rows: Range<usize>) -> Self {
        fn part<T: Clone>(column: Option<&Vec<T>>, rows: &Range<usize>) -> Option<Vec<T>> {
            column.map(|column| column[rows.clone()].to_vec())
        }
        Self {
            rate_hz: self.rate_hz,
            periods: part(self.periods.as_ref(), &rows),
            counts_large: self.counts_large[rows.clone()].to_vec(),
            counts_small: part(self.counts_small.as_ref(), &rows),
            current: part(self.current.as_ref(), &rows),
            edges: part(self.edges.as_ref(), &rows),
            true_omega: part(self.true_omega.as_ref(), &rows),
            known: part(self.known.as_ref(), &rows),
            true_damping: part(self.true_damping.as_ref(), &rows),
        }
    }

    /// Period of one tick, s.
    #[must_use]
    pub fn period_s(&self) -> f64 {
        1.0 / self.rate_hz
    }
}

/// Optional columns that a simulation produces. Other encoders are not simulated.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Columns {
    /// The small encoder.
    pub counts_small: bool,
    /// Edge time stamps of the large encoder.
    pub edges: bool,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn counts_go_on_across_the_wrap_of_the_counter() {
        let counts = [u32::MAX - 1, 1, 5, u32::MAX, 1 << 31, (1 << 31) - 1];
        let continued = continued(&counts);
        let half = 1_i64 << 31;
        assert_eq!(continued, [-2, 1, 5, -1, -half, -half - 1]);
    }

    #[test]
    fn part_of_a_trace_has_the_columns_of_the_whole() {
        let edge = |age_s| Some(EdgeStamp { age_s, boundary: 7 });
        let whole = Trace {
            rate_hz: 500.0,
            periods: Some(vec![1.0, 2.0, 3.0]),
            counts_large: vec![1, 2, 3],
            counts_small: Some(vec![4, 5, 6]),
            current: Some(vec![0.1, 0.2, 0.3]),
            edges: Some(vec![None, edge(0.5), edge(0.25)]),
            true_omega: Some(vec![7.0, 8.0, 9.0]),
            known: Some(vec![true, false, true]),
            true_damping: None,
        };
        assert_eq!((whole.len(), whole.is_empty()), (3, false));
        assert_eq!(whole.period_s(), 0.002);
        let part = whole.rows(1..3);
        assert_eq!(part.rate_hz, 500.0);
        assert_eq!(part.periods, Some(vec![2.0, 3.0]));
        assert_eq!(part.counts_large, [2, 3]);
        assert_eq!(part.counts_small, Some(vec![5, 6]));
        assert_eq!(part.current, Some(vec![0.2, 0.3]));
        assert_eq!(part.edges, Some(vec![edge(0.5), edge(0.25)]));
        assert_eq!(part.true_omega, Some(vec![8.0, 9.0]));
        assert_eq!(part.known, Some(vec![false, true]));
        assert_eq!(part.true_damping, None);
        let none = whole.rows(2..2);
        assert_eq!((none.len(), none.is_empty()), (0, true));
    }
}
