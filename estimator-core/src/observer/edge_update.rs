//! Correction by edge time stamps.

use super::correction::{Correction, excess};
use super::count_update::CountUpdate;
use super::gain::Gain;
use super::gain_table::GainTable;
use super::innovation::{Innovation, Prediction};
use crate::design::DesignError;
use crate::design::const_math::limited;
use crate::edge_clock::EdgeClock;
use crate::memory::memory;
use crate::sample::{LARGEST_OFFSET, Sample, Signals};
use crate::sealed::Sealed;
use crate::units::Hertz;

/// Correction by the time stamp of the latest edge of each tick.
///
/// The innovation is the position of the boundary less the predicted position at the instant of the
/// edge. On ticks without an edge the position is clamped to the quantisation interval, as in
/// [`CountUpdate`]. The crossing time is then unknown, so the gain is that of a gap 3 ms longer.
///
/// The four boundaries of an encoder line deviate from their nominal positions. The offset o of each
/// is estimated from its innovations, `o += μ e` with μ = 0.02, and limited to ±1/4 count. Without
/// an edge, hence at rest, no offset changes.
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(C)]
pub struct EdgeUpdate {
    pub(super) clock: EdgeClock,
    pub(super) table: GainTable,
    /// Ticks added to a gap that ends without an edge.
    pub(super) unstamped: f32,
}

memory!(EdgeUpdate {
    clock,
    table,
    unstamped
});

/// State of [`EdgeUpdate`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EdgeUpdateState {
    /// Time since the last edge, ticks.
    since: f32,
    /// Time since the last correction, ticks.
    alone: f32,
    /// Offset of each boundary of a line, counts.
    offsets: [f32; 4],
}

/// Gain μ of an offset.
const OFFSET_GAIN: f32 = 0.02;

/// Time added to a gap that ends without an edge, s.
const UNSTAMPED: f64 = 3e-3;

impl EdgeUpdate {
    pub(super) const fn new(
        clock: Hertz,
        rate: Hertz,
        counts: CountUpdate,
    ) -> Result<Self, DesignError> {
        match EdgeClock::new(clock, rate) {
            Ok(clock) => Ok(Self {
                clock,
                table: counts.table,
                unstamped: (UNSTAMPED * rate.0) as f32,
            }),
            Err(error) => Err(error),
        }
    }
}

impl Sealed for EdgeUpdate {}

impl Correction for EdgeUpdate {
    type State = EdgeUpdateState;
    type Gain<'a> = &'a Gain;
    const NEEDS: Signals = Signals {
        edge: true,
        ..Signals::COUNT
    };
    const DENSE: bool = true;

    fn start(&self) -> EdgeUpdateState {
        EdgeUpdateState {
            since: 0.0,
            alone: 0.0,
            offsets: [0.0; 4],
        }
    }

    fn velocity_variance(&self, state: &EdgeUpdateState) -> f32 {
        self.table.velocity_variance(state.since)
    }

    #[inline(always)]
    fn innovation<'a>(
        &'a self,
        state: &mut EdgeUpdateState,
        prediction: Prediction,
        sample: &Sample,
    ) -> Option<(Innovation, &'a Gain)> {
        let since = state.since + 1.0;
        let Some(edge) = self.clock.fresh(sample) else {
            state.since = since;
            state.alone += 1.0;
            let error = excess(prediction.from + prediction.displacement)?;
            let waited = state.alone;
            let gap = waited + self.unstamped;
            state.alone = 0.0;
            let innovation = Innovation {
                error,
                age: 0.0,
                position_gain: 1.0,
                gap: 0.0,
                waited,
            };
            return Some((innovation, self.table.gain(gap)));
        };
        state.since = edge.age;
        state.alone = edge.age;
        let passed = 1.0 - edge.age;
        let at_edge = prediction.from
            + passed * (prediction.displacement - 0.5 * prediction.velocity_change * edge.age);
        let offset = &mut state.offsets[edge.phase % 4];
        let error = edge.position + *offset - at_edge;
        *offset = limited(*offset - OFFSET_GAIN * error, LARGEST_OFFSET);
        let gap = since - edge.age;
        let gain = self.table.gain(gap);
        let innovation = Innovation {
            error,
            age: edge.age,
            position_gain: gain.position,
            gap,
            waited: gap,
        };
        Some((innovation, gain))
    }
}
