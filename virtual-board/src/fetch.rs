//! Estimated waits of the instruction fetch from flash, after RM0090, "Adaptive real-time memory
//! accelerator".
//!
//! Flash is read in lines of 128 bits. A read takes 5 cycles more than a hit. The cache holds
//! [`CACHED`] lines and replaces the least recently used one. While a line is executed, the next one is read
//! ahead. The cache is empty at the start: other tasks run between two control tasks. Literals, which have a
//! cache of their own, and stalls of the bus are not in the model.

use std::collections::{BTreeSet, VecDeque};

/// Bytes of a line.
const LINE: u64 = 16;
/// Lines that the cache holds.
pub const CACHED: usize = 64;
/// Wait states at 168 MHz and 2.7 to 3.6 V.
const WAITS: u32 = 5;

/// Instruction fetches of a control task.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Fetches {
    /// Number of different lines.
    pub lines: u32,
    /// Cycles in which the core waits for a line.
    pub waits: u32,
}

/// The state of cache and read-ahead.
#[derive(Debug, Default)]
pub(crate) struct Fetch {
    /// Cached lines, the least recently used one first.
    cache: VecDeque<u64>,
    /// The line that is read ahead, and the cycle at which it is there.
    ahead: Option<(u64, u32)>,
    current: Option<u64>,
    seen: BTreeSet<u64>,
    waits: u32,
}

impl Fetch {
    /// Fetches the halves of the instruction at `address`, which begins after `cycles` without waits.
    pub(crate) fn instruction(&mut self, address: u64, is_wide: bool, cycles: u32) {
        self.line(address / LINE, cycles);
        if is_wide {
            self.line((address + 2) / LINE, cycles);
        }
    }

    fn line(&mut self, line: u64, cycles: u32) {
        if self.current == Some(line) {
            return;
        }
        self.current = Some(line);
        self.seen.insert(line);
        let now = cycles + self.waits;
        if !self.is_used_again(line) {
            self.waits += match self.ahead {
                Some((ahead, at)) if ahead == line => at.saturating_sub(now),
                _ => WAITS,
            };
            self.keep(line);
        }
        if !self.cache.contains(&(line + 1))
            && self.ahead.is_none_or(|(ahead, _)| ahead != line + 1)
        {
            self.ahead = Some((line + 1, cycles + self.waits + WAITS + 1));
        }
    }

    /// Whether a line is cached; it is then the most recently used one.
    fn is_used_again(&mut self, line: u64) -> bool {
        let at = self.cache.iter().position(|cached| *cached == line);
        if let Some(at) = at {
            self.cache.remove(at);
            self.cache.push_back(line);
        }
        at.is_some()
    }

    fn keep(&mut self, line: u64) {
        if self.cache.len() >= CACHED {
            self.cache.pop_front();
        }
        self.cache.push_back(line);
    }

    /// What the instructions so far have fetched.
    pub(crate) fn fetches(&self) -> Fetches {
        Fetches {
            lines: self.seen.len() as u32,
            waits: self.waits,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Instructions of two bytes and one cycle each in these lines, one line after the other; the waits of
    /// the last round of `rounds`.
    fn waits(lines: &[u64], rounds: usize) -> u32 {
        let mut fetch = Fetch::default();
        let (mut cycles, mut before) = (0, 0);
        for _ in 0..rounds {
            before = fetch.fetches().waits;
            for line in lines {
                for half in 0..8 {
                    fetch.instruction(LINE * line + 2 * half, false, cycles);
                    cycles += 1;
                }
            }
        }
        fetch.fetches().waits - before
    }

    #[test]
    fn line_that_is_read_ahead_is_waited_for_only_if_the_one_before_is_short() {
        // Eight cycles a line are more than the six of a read: only the first line is waited for.
        let lines: Vec<_> = (0..20).collect();
        assert_eq!(waits(&lines, 1), 5);
        // Four instructions of four bytes take four cycles: two more for each line after the first.
        let mut fetch = Fetch::default();
        for n in 0..40 {
            fetch.instruction(4 * n, true, n as u32);
        }
        let wanted = Fetches {
            lines: 10,
            waits: 5 + 9 * 2,
        };
        assert_eq!(fetch.fetches(), wanted);
    }

    #[test]
    fn branch_to_a_line_that_is_not_cached_is_waited_for() {
        assert_eq!(waits(&[0, 10, 20, 30], 1), 4 * 5);
        assert_eq!(waits(&[0, 10, 20, 30], 2), 0);
    }

    #[test]
    fn cache_holds_64_lines_and_replaces_the_least_recently_used_one() {
        let every_other = |n: u64| (0..n).map(|k| 2 * k).collect::<Vec<_>>();
        assert_eq!(waits(&every_other(64), 2), 0);
        assert_eq!(waits(&every_other(65), 2), 65 * 5);
        // The first line is used again before one line too many: it stays, and the second one goes.
        let again = [every_other(64), vec![0, 128, 0]].concat();
        assert_eq!(waits(&again, 1), 65 * 5);
        let gone = [again, vec![2]].concat();
        assert_eq!(waits(&gone, 1), 66 * 5);
    }

    #[test]
    fn wide_instruction_may_need_two_lines() {
        let mut fetch = Fetch::default();
        fetch.instruction(14, true, 0);
        assert_eq!(fetch.fetches().lines, 2);
    }
}
