//! M/T method: counts over the time between edges.

use crate::design::DesignError;
use crate::design::const_math::limited;
use crate::edge_clock::EdgeClock;
use crate::estimator::{VaryingPeriod, VelocityEstimator};
use crate::interval::limited_period;
use crate::memory::memory;
use crate::sample::{Sample, Signals};
use crate::units::{Count, CountsPerTick, Hertz};

/// M/T method: displacement over time between the latest edges of two ticks (Ohmae et al. 1982),
/// ```text
/// v = (e_k - e_j) / (t_k - t_j)        without a new edge: |v| <= 1 / (t - t_k)
/// ```
/// where k is the last tick with an edge and j the last tick with an edge before k. The bound, one
/// count over the time since the last edge, reduces the velocity to zero at rest. The velocity is
/// exact while it is constant; the delay is half the time between edges.
///
/// A change of the count without a time stamp is assumed to have happened half a tick ago, or half an
/// interval ago where the intervals between samples vary.
///
/// ```
/// use estimator_core::*;
/// const M_OVER_T: MOverT = preset!(MOverT::new(Hertz(1e6), Hertz(1000.0)));
/// let edge = |boundary, age| Edge { boundary: Count(boundary), age: ClockTicks(age) };
/// let first = Sample::new(Count(0)).with_edge(edge(0, 0));
/// let mut state = M_OVER_T.start(&first);
/// // Two counts in 800 of 1000 µs.
/// let next = Sample::new(Count(2)).with_edge(edge(2, 200));
/// assert!((M_OVER_T.update(&mut state, &next).0 - 2.5).abs() < 1e-6);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(C)]
pub struct MOverT {
    clock: EdgeClock,
}

memory!(MOverT { clock });

impl MOverT {
    /// The method for time stamps by a clock of frequency `clock`.
    ///
    /// # Errors
    /// [`DesignError::RATE`], [`DesignError::CLOCK`].
    pub const fn new(clock: Hertz, rate: Hertz) -> Result<Self, DesignError> {
        match EdgeClock::new(clock, rate) {
            Ok(clock) => Ok(Self { clock }),
            Err(error) => Err(error),
        }
    }
}

/// State of a [`MOverT`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MOverTState {
    anchor: Count,
    /// Position of the last edge, from the middle of the anchor's quantisation interval, counts.
    edge: f32,
    /// Time since the last edge, ticks.
    since: f32,
    velocity: f32,
}

impl VelocityEstimator for MOverT {
    type State = MOverTState;
    const NEEDS: Signals = Signals {
        edge: true,
        ..Signals::COUNT
    };

    fn start(&self, first: &Sample) -> MOverTState {
        let edge = self.clock.fresh(first);
        MOverTState {
            anchor: first.count,
            edge: edge.map_or(0.0, |edge| edge.position),
            since: edge.map_or(0.0, |edge| edge.age),
            velocity: 0.0,
        }
    }

    fn update(&self, state: &mut MOverTState, sample: &Sample) -> CountsPerTick {
        self.advance(state, sample, 1.0)
    }
}

impl VaryingPeriod for MOverT {
    fn update_over(&self, state: &mut MOverTState, sample: &Sample, period: f32) -> CountsPerTick {
        self.advance(state, sample, limited_period(period))
    }
}

impl MOverT {
    /// Processes a sample that comes `period` ticks after the one before.
    #[inline(always)]
    fn advance(&self, state: &mut MOverTState, sample: &Sample, period: f32) -> CountsPerTick {
        let counts = (sample.count - state.anchor).to_f32();
        state.anchor = sample.count;
        state.edge -= counts;
        state.since += period;
        let latest = match self.clock.fresh_within(sample, period) {
            Some(edge) => Some((edge.position, edge.age)),
            None if counts > 0.0 => Some((-0.5, 0.5 * period)),
            None if counts < 0.0 => Some((0.5, 0.5 * period)),
            None => None,
        };
        if let Some((edge, age)) = latest {
            let time = state.since - age;
            // Two stamps of the same instant give no velocity.
            if time > 0.0 {
                state.velocity = (edge - state.edge) / time;
            }
            state.edge = edge;
            state.since = age;
        } else {
            state.velocity = limited(state.velocity, 1.0 / state.since);
        }
        CountsPerTick(state.velocity)
    }
}
