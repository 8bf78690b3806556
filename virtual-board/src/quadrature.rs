//! Quadrature: levels of an encoder's two lines for a count, and times of its edges.

use simulation::encoder::EdgeObserver;

/// Levels of A and B at a count. A leads in upward counting, as for an STM32 timer.
pub(crate) fn levels(count: u32) -> [bool; 2] {
    let phase = count & 3;
    [phase == 1 || phase == 2, phase >= 2]
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
    fn one_line_changes_at_a_time_and_a_leads_in_upward_counting() {
        for count in [0, 1, 2, 3, 7, u32::MAX] {
            let (now, next) = (levels(count), levels(count.wrapping_add(1)));
            let changed = usize::from(now[0] != next[0]) + usize::from(now[1] != next[1]);
            assert_eq!(changed, 1, "{count}");
        }
        assert_eq!((levels(0), levels(1)), ([false, false], [true, false]));
    }
}
