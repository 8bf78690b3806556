//! What one run of the plant, or one recording of a real motor, leaves behind.

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

/// A sampled run, one entry a tick in every column that is there.
///
/// A column that nobody asked for is `None`: it was not simulated, or the recording lacks it.
#[derive(Clone, Debug, Default)]
pub struct Trace {
    /// Control rate, Hz.
    pub rate_hz: f64,
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

    /// Whether there is no tick at all.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.counts_large.is_empty()
    }

    /// Period of one tick, s.
    #[must_use]
    pub fn period_s(&self) -> f64 {
        1.0 / self.rate_hz
    }
}

/// Which optional columns a simulation has to produce; what nobody reads is not simulated.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Columns {
    /// The small encoder.
    pub counts_small: bool,
    /// Edge time stamps of the large encoder.
    pub edges: bool,
}
