//! Faults of the large motor's encoder.

use estimator_core::Count;

/// What happens to the encoder that the loop is closed with.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Fault {
    /// Phase A stays what it is: B alone moves the count to and fro by one.
    StuckA,
    /// Phase B stays what it is.
    StuckB,
    /// Both stay what they are.
    StuckBoth,
    /// The phases are exchanged: the count runs backwards.
    Swapped,
}

impl Fault {
    /// Every fault.
    pub const ALL: [Self; 4] = [Self::StuckA, Self::StuckB, Self::StuckBoth, Self::Swapped];

    /// What is counted at `count`, of an encoder that has been faulty since `since`.
    #[must_use]
    pub fn counted(self, count: Count, since: Count) -> Count {
        // Phases of a count, in Gray's order.
        let a = |count: Count| count.0.wrapping_add(1) / 2 % 2;
        let b = |count: Count| count.0 / 2 % 2;
        // With one phase still, its level says which way the other one's edges count.
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_stuck_phase_counts_the_other_ones_edges_to_and_fro() {
        for since in 40..44 {
            for fault in [Fault::StuckA, Fault::StuckB] {
                let at = |count| fault.counted(Count(count), Count(since)).0;
                assert_eq!(at(since), since);
                // The phase that still moves has its edge on one side, and counts it as before.
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
        let at = |count| Fault::Swapped.counted(Count(count), Count(3)).0;
        assert_eq!([at(3), at(13), at(u32::MAX)], [3, u32::MAX - 6, 7]);
    }
}
