//! Index pulses of an encoder: whether its counts are those of whole turns, and where its zero is.

use estimator_core::{Count, Counts};

use crate::device::Motor;
use crate::stop::Stop;

/// Check of the counts p at which the index of an encoder rises, one index per turn of N counts.
///
/// The first pulse p₀ is the reference. Each later pulse has to be whole turns away from it:
///
/// ```text
/// d = p - p₀ - k N     k the nearest integer
/// |d| > 3              counts were lost or gained: Stop::LostCounts
/// ```
///
/// **Tolerance.** An index that is high for w counts rises at its lower end if the encoder counts
/// upwards, and at its upper end, w - 1 counts further, if it counts downwards. Its line and those of the
/// counts pass filters and receivers of their own, so that each of the two may be captured one count
/// before or after that: pulses of one place are at most w + 1 counts apart. 3 counts admit an index of
/// one count (gated by both lines) and of two counts (gated by one line). One of four counts (not gated)
/// would stop the device at the first reversal over it. Counts that are lost by whole periods of the lines
/// are fours and are found at the next pulse; single ones are found once they sum up to four.
///
/// A wrong N of the device file shows at the first whole turn as well, unless the true number is a
/// multiple of it, which `cargo drive bring-up --turns` finds. With an N below 8, every count is near whole turns and nothing is found.
///
/// ```
/// use estimator_core::Count;
/// use haptic_control::{DualStage, Index, IndexState, Stop};
/// const INDEX: Index = Index::new(&DualStage::DEFAULT.large);
/// let mut state = IndexState::START;
/// assert_eq!(INDEX.check(&mut state, Some(Count(100))), None);
/// assert_eq!(INDEX.check(&mut state, None), None);
/// assert_eq!(INDEX.check(&mut state, Some(Count(100 + 4096))), None);
/// assert_eq!(INDEX.check(&mut state, Some(Count(100 - 4))), Some(Stop::LostCounts));
/// assert_eq!(state.deviation(), -4);
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Index {
    /// Counts of a turn, at least 1.
    turn: i32,
}

/// State of an [`Index`], which latches its finding.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct IndexState {
    /// Pulses since the reference was taken, and with it; 0 without a reference.
    pulses: u32,
    /// The first of these.
    reference: Count,
    /// The reference, whole turns away, nearest to the latest pulse. The counts go round after 2^32,
    /// which are no whole turns.
    nearest: Count,
    latest: Count,
    /// Distance of the latest pulse from whole turns, counts.
    deviation: i32,
    lost: bool,
}

impl IndexState {
    /// No pulse.
    pub const START: Self = Self {
        pulses: 0,
        reference: Count(0),
        nearest: Count(0),
        latest: Count(0),
        deviation: 0,
        lost: false,
    };

    /// Forgets a finding, when the device is armed or disarmed. The next pulse is the reference then,
    /// because the present one does not belong to the counts. The count and the deviation of the latest
    /// pulse stay.
    pub fn restart(&mut self) {
        if self.lost {
            (self.lost, self.pulses) = (false, 0);
        }
    }

    /// Pulses since the reference was taken, the reference included, up to 2^32 - 1; 0 without a
    /// reference.
    #[must_use]
    pub const fn pulses(&self) -> u32 {
        self.pulses
    }

    /// Count of the latest pulse; 0 before the first.
    #[must_use]
    pub const fn latest(&self) -> Count {
        self.latest
    }

    /// Distance of the latest pulse from whole turns after the reference, counts.
    #[must_use]
    pub const fn deviation(&self) -> i32 {
        self.deviation
    }

    /// Displacement of a count from a zero that is `offset` counts after the reference, modulo 2^32;
    /// `None` without a reference.
    #[must_use]
    pub fn position(&self, count: Count, offset: Counts) -> Option<Counts> {
        let Counts(displacement) = count - self.reference;
        (self.pulses > 0).then_some(Counts(displacement.wrapping_sub(offset.0)))
    }
}

impl Index {
    /// Largest distance of a pulse from whole turns, counts.
    pub const TOLERANCE: u32 = 3;

    /// The index of a motor's encoder.
    #[must_use]
    pub const fn new(motor: &Motor) -> Self {
        let turn = motor.counts_per_rev & i32::MAX as u32;
        Self {
            turn: if turn == 0 { 1 } else { turn as i32 },
        }
    }

    /// One tick, with the count of the latest pulse since the tick before, if there was one.
    pub fn check(&self, state: &mut IndexState, pulse: Option<Count>) -> Option<Stop> {
        if let Some(pulse) = pulse {
            if state.pulses == 0 {
                (state.reference, state.nearest) = (pulse, pulse);
            }
            let beyond = (pulse - state.nearest).0.rem_euclid(self.turn);
            state.deviation = if beyond > self.turn / 2 {
                beyond - self.turn
            } else {
                beyond
            };
            state.nearest = pulse + Counts(-state.deviation);
            state.latest = pulse;
            state.pulses = state.pulses.saturating_add(1);
            state.lost |= state.deviation.unsigned_abs() > Self::TOLERANCE;
        }
        state.lost.then_some(Stop::LostCounts)
    }
}
