//! The newest counts.

use crate::units::{Count, Counts};

/// The newest sample and up to N before it.
#[derive(Clone, Copy, Debug)]
pub(super) struct Recent<const N: usize> {
    pub(super) newest: Count,
    /// The newest step, and how many of the newest are equal to it, at most N; 0 before the first.
    step: Counts,
    equal: u32,
    /// The samples before the newest, newest first from `head` on; twice, so that they are in one
    /// piece.
    older: [[Count; N]; 2],
    /// Below N.
    head: u32,
    /// How many of the older samples there are, at most N.
    known: u32,
}

/// Equal if they hold the same samples, wherever these begin.
impl<const N: usize> PartialEq for Recent<N> {
    fn eq(&self, other: &Self) -> bool {
        self.newest == other.newest && self.older(N) == other.older(N)
    }
}

impl<const N: usize> Eq for Recent<N> {}

impl<const N: usize> Recent<N> {
    /// One sample.
    pub(super) const fn new(first: Count) -> Self {
        Self {
            newest: first,
            step: Counts(0),
            equal: 0,
            older: [[first; N]; 2],
            head: 0,
            known: 0,
        }
    }

    /// Forgets all but the sample `first`.
    pub(super) const fn restart(&mut self, first: Count) {
        self.newest = first;
        self.equal = 0;
        self.known = 0;
    }

    /// Whether N + 1 samples read the same.
    pub(super) const fn at_rest(&self) -> bool {
        self.step.0 == 0 && self.equal == N as u32
    }

    /// How many of the newest steps are equal.
    pub(super) const fn equal_steps(&self) -> usize {
        self.equal as usize
    }

    /// One more sample.
    #[inline(always)]
    pub(super) fn push(&mut self, count: Count) {
        let step = count - self.newest;
        let equal = if step == self.step { self.equal } else { 0 };
        self.equal = (equal + 1).min(N as u32);
        self.step = step;
        self.known = (self.known + 1).min(N as u32);
        // One less, modulo N.
        let head = (self.head as usize).wrapping_sub(1).min(N - 1);
        let [once, twice] = &mut self.older;
        once[head] = self.newest;
        twice[head] = self.newest;
        self.head = head as u32;
        self.newest = count;
    }

    /// The samples before the newest, newest first, at most `most` of them.
    #[inline(always)]
    pub(super) fn older(&self, most: usize) -> &[Count] {
        let head = self.head as usize;
        let end = head + most.min(self.known as usize);
        // Always inside.
        self.older.as_flattened().get(head..end).unwrap_or(&[])
    }
}
