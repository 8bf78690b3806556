//! A ring of the newest counts.

use crate::units::{Count, Counts};

/// The newest N + 1 samples.
#[derive(Clone, Copy, Debug)]
pub(super) struct Recent<const N: usize> {
    pub(super) newest: Count,
    /// The newest step, and the number of newest steps equal to it, at most the window; 0 before the
    /// first.
    step: Counts,
    equal: u32,
    /// Below N.
    head: u32,
    /// The samples before the newest, newest first from `head` on, stored twice so that they are
    /// contiguous. A sentinel [out of reach](Self::OUT_OF_REACH) precedes the first sample.
    older: [[Count; N]; 2],
}

/// Two rings are equal if they hold the same samples since the first, at whatever index.
impl<const N: usize> PartialEq for Recent<N> {
    fn eq(&self, other: &Self) -> bool {
        self.newest == other.newest && self.since_first().eq(other.since_first())
    }
}

impl<const N: usize> Eq for Recent<N> {}

impl<const N: usize> Recent<N> {
    /// Displacement from the first sample to the sentinel before it. The sentinel is outside every
    /// noise band, so no window extends past the first sample.
    ///
    /// Lines of a window rise by less than 2^15 + 2^14 counts/tick, which over N ticks is 2^14 N less
    /// than this. Its product with N fits i32.
    const OUT_OF_REACH: Counts = Counts((N as i32) << 16);

    /// A ring that holds one sample.
    pub(super) fn new(first: Count) -> Self {
        Self {
            newest: first,
            step: Counts(0),
            equal: 0,
            head: 0,
            older: [[first + Self::OUT_OF_REACH; N]; 2],
        }
    }

    /// Removes all samples but `first`.
    pub(super) fn restart(&mut self, first: Count) {
        self.keep(first + Self::OUT_OF_REACH);
        self.newest = first;
        self.equal = 0;
    }

    /// The samples before the newest, back to the first. No step between two of them is as long as
    /// the step to the sentinel.
    fn since_first(&self) -> impl Iterator<Item = Count> {
        let mut newer = self.newest;
        let within = move |older: &Count| {
            let step = *older - newer;
            newer = *older;
            step != Self::OUT_OF_REACH
        };
        self.older(N).iter().copied().take_while(within)
    }

    /// Whether all samples of a window of n intervals are equal. Another equal one changes nothing in it.
    pub(super) const fn at_rest(&self, n: u8) -> bool {
        self.step.0 == 0 && self.equal == n as u32
    }

    /// Number of newest steps that are equal, at most the window.
    pub(super) const fn equal_steps(&self) -> usize {
        self.equal as usize
    }

    /// Adds a sample to a window of n intervals, at least 1.
    #[inline(always)]
    pub(super) fn push(&mut self, count: Count, n: u8) {
        let step = count - self.newest;
        let equal = if step == self.step { self.equal } else { 0 };
        self.equal = equal.min(u32::from(n) - 1) + 1;
        self.step = step;
        self.keep(self.newest);
        self.newest = count;
    }

    /// Stores a sample before all older samples.
    #[inline(always)]
    fn keep(&mut self, count: Count) {
        // Decrement modulo N.
        let head = (self.head as usize).wrapping_sub(1).min(N - 1);
        let [once, twice] = &mut self.older;
        once[head] = count;
        twice[head] = count;
        self.head = head as u32;
    }

    /// The samples before the newest, newest first, at most `most` of them.
    #[inline(always)]
    pub(super) fn older(&self, most: usize) -> &[Count] {
        let head = self.head as usize;
        // Always inside.
        let older = self.older.as_flattened().get(head..head + most.min(N));
        older.unwrap_or(&[])
    }
}
