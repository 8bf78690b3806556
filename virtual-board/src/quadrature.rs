//! Quadrature: levels of an encoder's two lines for a count, and times of its edges.

use simulation::encoder::EdgeObserver;

/// Levels of A and B at a count. A leads in upward counting, as for an STM32 timer.
pub(crate) fn levels(count: u32) -> [bool; 2] {
    let phase = count & 3;
    [phase == 1 || phase == 2, phase >= 2]
}

/// An index, gated by A and B: high for one count per turn.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Index {
    /// Counts of a turn.
    turn: u32,
    /// Count at the begin of a run, which is arbitrary.
    first: u32,
}

impl Index {
    /// The index of a shaft of `turn` counts that is at the count `first`. The remainder of that count
    /// says how far away the index is.
    pub(crate) fn new(turn: u32, first: u32) -> Self {
        Self { turn, first }
    }

    /// Level at a count less than 2^31 counts away from the first: counts go round after 2^32, which
    /// are no whole turns.
    pub(crate) fn level(self, count: u32) -> bool {
        let moved = i64::from(count.wrapping_sub(self.first).cast_signed());
        (i64::from(self.first) + moved).rem_euclid(self.turn.into()) == 0
    }
}

/// Indices of the encoders.
pub(crate) const LARGE: usize = 0;
pub(crate) const SMALL: usize = 1;
pub(crate) const REFERENCE: usize = 2;

/// An edge to the next count.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Edge {
    pub(crate) at_ns: u64,
    pub(crate) encoder: usize,
    pub(crate) count: u32,
}

/// Records the edges of one encoder in one step of the plant.
pub(crate) struct Edges<'a> {
    pub(crate) into: &'a mut Vec<Edge>,
    pub(crate) encoder: usize,
    /// Count before the next edge.
    pub(crate) count: u32,
    pub(crate) from_ns: u64,
    pub(crate) step_ns: f64,
}

impl EdgeObserver for Edges<'_> {
    fn edge(&mut self, boundary: u32, part: impl FnOnce() -> f64) {
        // Boundary e lies between counts e - 1 and e.
        self.count = if boundary == self.count {
            self.count.wrapping_sub(1)
        } else {
            self.count.wrapping_add(1)
        };
        self.into.push(Edge {
            at_ns: self.from_ns + (part() * self.step_ns) as u64,
            encoder: self.encoder,
            count: self.count,
        });
    }
}

/// A signal generator instead of the large encoder: edges at a constant rate from time zero, counting
/// down if the rate is negative.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Generator {
    hz: f64,
    made: u32,
}

impl Generator {
    pub(crate) fn new(hz: f64) -> Self {
        Self { hz, made: 0 }
    }

    /// The edges up to a time.
    pub(crate) fn run(&mut self, until_ns: u64, into: &mut Vec<Edge>) {
        loop {
            let at_ns = (f64::from(self.made + 1) / self.hz.abs() * 1e9) as u64;
            if at_ns >= until_ns {
                return;
            }
            self.made += 1;
            let count = if self.hz < 0.0 {
                self.made.wrapping_neg()
            } else {
                self.made
            };
            into.push(Edge {
                at_ns,
                encoder: LARGE,
                count,
            });
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn index_is_high_for_one_count_a_turn() {
        // A turn is 20 000 counts, and the counts go round 7296 counts after a whole turn.
        for first in [0, 12_345, u32::MAX - 5000] {
            let index = Index::new(20_000, first);
            let counts =
                (-45_000..45_000).filter(|moved| index.level(first.wrapping_add_signed(*moved)));
            let counts: Vec<_> = counts.collect();
            let nearest = -((first % 20_000).cast_signed());
            assert!(counts.contains(&nearest), "{first}");
            assert!(counts.windows(2).all(|pair| pair[1] - pair[0] == 20_000));
            assert!((4..=5).contains(&counts.len()), "{counts:?}");
        }
    }

    #[test]
    fn one_line_changes_at_a_time_and_a_leads_in_upward_counting() {
        for count in [0, 1, 2, 3, 7, u32::MAX] {
            let (now, next) = (levels(count), levels(count.wrapping_add(1)));
            let changed = usize::from(now[0] != next[0]) + usize::from(now[1] != next[1]);
            assert_eq!(changed, 1, "{count}");
        }
        assert_eq!((levels(0), levels(1)), ([false, false], [true, false]));
    }
}
