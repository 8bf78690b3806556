//! M/T method for an encoder with uneven boundaries.

use core::ops::RangeInclusive;

use crate::branch::unlikely;
use crate::design::DesignError;
use crate::design::const_math::limited;
use crate::edge_clock::EdgeClock;
use crate::estimator::{VaryingPeriod, VelocityEstimator};
use crate::interval::limited_period;
use crate::memory::memory;
use crate::sample::{LARGEST_OFFSET, Sample, Signals};
use crate::units::{Count, CountsPerTick, Hertz};

/// Gain of an offset by the error of a prediction.
const OFFSET_GAIN: f32 = 0.05;

/// Distances between two edges from which the place of the newer one is learned, counts. Two boundaries
/// are at least half a count apart; over more than two counts the error is one of the motion.
const LEARNED_FROM: RangeInclusive<f32> = 0.4..=2.5;

/// Gains of the prediction, of its position and of its velocity. It remembers a few boundaries.
const POSITION_GAIN: f32 = 0.3;
const VELOCITY_GAIN: f32 = 0.05;

/// Error beyond which the prediction starts again, counts.
const LARGEST_ERROR: f32 = 2.0;

/// M/T method that learns the places of the boundaries.
///
/// The boundaries of an encoder repeat their deviations: those of a disc with every line, 4 counts, those
/// of three Hall sensors with every electrical turn, 6 counts. The method is [`MOverT`](crate::MOverT) with
/// the learned offset o of each boundary of a period of P counts, in its displacement:
/// ```text
/// v = (e_k + o_k - e_j - o_j) / (t_k - t_j)        without a new edge: |v| <= d / (t - t_k)
/// ```
/// with d the distance from the last edge to the next boundary in the direction of v, at most 1.5 counts.
/// A prediction at constant velocity, corrected at every edge with gains 0.3 and 0.05, gives the error r
/// of each stamped edge, and `o = o - 0.05 (r - r̄)`, limited to ±1/4 count. r̄ is the mean of r over P
/// edges, which an acceleration causes. Nothing is learned from an edge more than two counts after the last
/// one, where the motion dominates r. The offset of an edge without time stamp, and of the boundary that was
/// crossed last, does not change; at rest none does. P = 12 serves encoder lines and Hall sensors.
///
/// ```
/// use estimator_core::*;
/// const M_OVER_T: LearnedMOverT<12> =
///     preset!(LearnedMOverT::new(Hertz(1e6), Hertz(1000.0)));
/// let edge = |boundary, age| Edge { boundary: Count(boundary), age: ClockTicks(age) };
/// let first = Sample::new(Count(0)).with_edge(edge(0, 0));
/// let mut state = M_OVER_T.start(&first);
/// // Two counts in 800 of 1000 µs, before anything is learned.
/// let next = Sample::new(Count(2)).with_edge(edge(2, 200));
/// assert!((M_OVER_T.update(&mut state, &next).0 - 2.5).abs() < 0.1);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(C)]
pub struct LearnedMOverT<const P: usize> {
    clock: EdgeClock,
}

memory!([const P: usize] LearnedMOverT<P> { clock });

impl<const P: usize> LearnedMOverT<P> {
    /// The method for time stamps by a clock of frequency `clock`. `P` outside 1 to 255 does not compile.
    ///
    /// # Errors
    /// [`DesignError::RATE`], [`DesignError::CLOCK`].
    pub const fn new(clock: Hertz, rate: Hertz) -> Result<Self, DesignError> {
        const { assert!(1 <= P && P <= 255, "period of 1 to 255 counts") };
        match EdgeClock::new(clock, rate) {
            Ok(clock) => Ok(Self { clock }),
            Err(error) => Err(error),
        }
    }
}

/// State of a [`LearnedMOverT`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LearnedMOverTState<const P: usize> {
    anchor: Count,
    /// Place of the boundary below the anchor's quantisation interval in the period.
    lower: u8,
    /// Position of the last edge with its offset, from the middle of the anchor's interval, counts.
    edge: f32,
    /// Predicted position at the time of the last edge, from the same point, counts.
    predicted: f32,
    /// Velocity of the prediction, counts/tick.
    slope: f32,
    /// Mean error of the prediction, counts.
    mean_error: f32,
    /// Time since the last edge, ticks.
    since: f32,
    velocity: f32,
    /// Offset of each boundary of the period, counts.
    offsets: [f32; P],
}

impl<const P: usize> LearnedMOverTState<P> {
    /// Place in the period, and position with its offset, of the boundary above (1/2) or below (-1/2) the
    /// anchor's interval.
    #[inline]
    fn boundary(&self, position: f32) -> (usize, f32) {
        let lower = usize::from(self.lower);
        let place = match position > 0.0 {
            true if lower + 1 == P => 0,
            true => lower + 1,
            false => lower,
        };
        let offset = self.offsets.get(place).copied().unwrap_or(0.0);
        (place, position + offset)
    }

    /// Corrects the prediction at an edge and returns its error, counts, unless it starts again.
    #[inline]
    fn correct(&mut self, edge: f32, time: f32) -> Option<f32> {
        let expected = self.predicted + self.slope * time;
        let error = edge - expected;
        if !(-LARGEST_ERROR..=LARGEST_ERROR).contains(&error) {
            (self.predicted, self.slope) = (edge, self.velocity);
            return None;
        }
        self.predicted = expected + POSITION_GAIN * error;
        self.slope += VELOCITY_GAIN * error / time;
        self.mean_error += (error - self.mean_error) * (1.0 / P as f32);
        Some(error)
    }

    /// Learns the offset of the boundary `place` from the error of the prediction.
    #[inline]
    fn learn(&mut self, place: usize, error: f32) {
        if let Some(offset) = self.offsets.get_mut(place) {
            let error = limited(error - self.mean_error, LARGEST_OFFSET);
            *offset = limited(*offset - OFFSET_GAIN * error, LARGEST_OFFSET);
        }
    }
}

impl<const P: usize> VelocityEstimator for LearnedMOverT<P> {
    type State = LearnedMOverTState<P>;
    const NEEDS: Signals = Signals {
        edge: true,
        ..Signals::COUNT
    };

    fn start(&self, first: &Sample) -> LearnedMOverTState<P> {
        let edge = self.clock.fresh(first);
        let position = edge.map_or(0.0, |edge| edge.position);
        LearnedMOverTState {
            anchor: first.count,
            lower: 0,
            edge: position,
            predicted: position,
            slope: 0.0,
            mean_error: 0.0,
            since: edge.map_or(0.0, |edge| edge.age),
            velocity: 0.0,
            offsets: [0.0; P],
        }
    }

    fn update(&self, state: &mut LearnedMOverTState<P>, sample: &Sample) -> CountsPerTick {
        self.advance(state, sample, 1.0)
    }
}

impl<const P: usize> VaryingPeriod for LearnedMOverT<P> {
    fn update_over(
        &self,
        state: &mut LearnedMOverTState<P>,
        sample: &Sample,
        period: f32,
    ) -> CountsPerTick {
        self.advance(state, sample, limited_period(period))
    }
}

impl<const P: usize> LearnedMOverT<P> {
    /// Processes a sample that comes `period` ticks after the one before.
    #[inline(always)]
    fn advance(
        &self,
        state: &mut LearnedMOverTState<P>,
        sample: &Sample,
        period: f32,
    ) -> CountsPerTick {
        let step = sample.count - state.anchor;
        let counts = step.to_f32();
        state.anchor = sample.count;
        let period_counts = P as i32;
        let part = if -period_counts < step.0 && step.0 < period_counts {
            step.0
        } else {
            unlikely();
            step.0 % period_counts
        };
        let turned = part + i32::from(state.lower);
        state.lower = if turned < 0 {
            turned + period_counts
        } else if turned < period_counts {
            turned
        } else {
            turned - period_counts
        } as u8;
        state.edge -= counts;
        state.predicted -= counts;
        state.since += period;
        let (position, age, is_stamped) = match self.clock.fresh_within(sample, period) {
            Some(edge) => (edge.position, edge.age, true),
            None if counts > 0.0 => (-0.5, 0.5 * period, false),
            None if counts < 0.0 => (0.5, 0.5 * period, false),
            None => {
                let distance = if state.velocity > 0.0 {
                    state.boundary(0.5).1 - state.edge
                } else {
                    state.edge - state.boundary(-0.5).1
                };
                // Behind a boundary without time stamp the last edge can be beyond it.
                let distance = if distance > 0.0 { distance } else { 0.0 };
                state.velocity = limited(state.velocity, distance / state.since);
                return CountsPerTick(state.velocity);
            }
        };
        let (place, edge) = state.boundary(position);
        let displacement = edge - state.edge;
        let time = state.since - age;
        // Two stamps of the same instant give no velocity.
        if time > 0.0 {
            state.velocity = displacement / time;
            let error = state.correct(edge, time);
            let is_told = is_stamped && LEARNED_FROM.contains(&displacement.abs());
            if let Some(error) = error.filter(|_| is_told) {
                state.learn(place, error);
            }
        }
        state.edge = edge;
        state.since = age;
        CountsPerTick(state.velocity)
    }
}

#[cfg(test)]
mod tests;
