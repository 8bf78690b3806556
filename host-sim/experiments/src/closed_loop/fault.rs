//! Faults of an encoder.

use estimator_core::{Count, Sample};

/// Fault of an encoder.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum EncoderFault {
    /// Phase A is stuck; edges of phase B move the count up and down by one.
    StuckA,
    /// Phase B is stuck.
    StuckB,
    /// Both phases are stuck.
    StuckBoth,
    /// The phases are exchanged; the count runs backwards.
    Swapped,
}

/// A faulty encoder.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Faulty {
    /// The encoder of the large motor, which closes the loop.
    Large(EncoderFault),
    /// The encoder of the handle.
    Small(EncoderFault),
}

impl EncoderFault {
    /// Every fault.
    pub const ALL: [Self; 4] = [Self::StuckA, Self::StuckB, Self::StuckBoth, Self::Swapped];

    /// The faulty count. `count` is the correct count, `since` the count when the fault began.
    #[must_use]
    pub fn counted(self, count: Count, since: Count) -> Count {
        // Phases of a count, in Gray code.
        let a = |count: Count| count.0.wrapping_add(1) / 2 % 2;
        let b = |count: Count| count.0 / 2 % 2;
        // The level of the stuck phase decides the direction in which edges of the other one count.
        let edge = |still: u32, from: u32, to: u32| {
            let way = if still == from { 1 } else { -1 };
            since.0.wrapping_add_signed(way * i32::from(from != to))
        };
        Count(match self {
            Self::StuckA => edge(1 - a(since), b(since), b(count)),
            Self::StuckB => edge(b(since), a(since), a(count)),
            Self::StuckBoth => since.0,
            Self::Swapped => since.0.wrapping_sub(count.0.wrapping_sub(since.0)),
        })
    }
}

/// A fault in a run.
pub(super) struct OngoingFault {
    /// Tick from which on the encoder is faulty.
    from: usize,
    faulty: Faulty,
    /// Count when the fault began.
    since: Option<Count>,
}

impl OngoingFault {
    /// The encoder is faulty from the tick `from` on.
    pub(super) const fn new(from: usize, faulty: Faulty) -> Self {
        Self {
            from,
            faulty,
            since: None,
        }
    }

    /// Replaces the correct count in the sample of tick `k` by the faulty one.
    pub(super) fn distort(&mut self, k: usize, sample: &mut Sample) {
        if k < self.from {
            return;
        }
        let (count, fault) = match self.faulty {
            Faulty::Large(fault) => (&mut sample.count, fault),
            Faulty::Small(fault) => (&mut sample.coupled, fault),
        };
        *count = fault.counted(*count, *self.since.get_or_insert(*count));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn stuck_phase_counts_edges_of_the_other_up_and_down() {
        for since in 40..44 {
            for fault in [EncoderFault::StuckA, EncoderFault::StuckB] {
                let at = |count| fault.counted(Count(count), Count(since)).0;
                assert_eq!(at(since), since);
                // The other phase has an edge on one side of the count, which is counted correctly.
                let right = [at(since - 1) == since - 1, at(since + 1) == since + 1];
                assert_eq!(
                    right.iter().filter(|right| **right).count(),
                    1,
                    "{fault:?} {since}"
                );
                let most = (since - 30..since + 30)
                    .map(|count| at(count).abs_diff(since))
                    .max();
                assert_eq!(most, Some(1));
            }
        }
    }

    #[test]
    fn exchanged_phases_count_backwards_over_the_wrap() {
        let at = |count| EncoderFault::Swapped.counted(Count(count), Count(3)).0;
        assert_eq!([at(3), at(13), at(u32::MAX)], [3, u32::MAX - 6, 7]);
    }
}
