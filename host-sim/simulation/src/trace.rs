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
    /// True damping of the coupler from each tick to the next, N.m.s/rad: for scores only.
    pub true_damping: Option<Vec<f64>>,
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
