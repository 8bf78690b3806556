//! A ring of the newest counts.

use core::fmt::Debug;
use core::ops::Range;

use super::fit::Straight;
use crate::units::{Count, Counts};

/// What a fit keeps of each sample about the steps before it: [`Stretches`] or nothing, `()`.
pub trait Steps: Copy + Debug + Eq {
    #[doc(hidden)]
    const NEW: Self;
    /// Stores the number of equal steps before a sample.
    #[doc(hidden)]
    fn keep(&mut self, head: usize, equal: u8);
}

impl Steps for () {
    const NEW: Self = ();
    #[inline(always)]
    fn keep(&mut self, _: usize, _: u8) {}
}

/// For each of N samples the number of equal steps before it, at least 1, at most the window; stored
/// twice, as the samples.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Stretches<const N: usize>([[u8; N]; 2]);

impl<const N: usize> Stretches<N> {
    /// In a window of few intervals too few samples are skipped: what the stretches take where every step
    /// differs from the one before weighs more.
    pub(super) const KEPT: bool = N > 16;
}

impl<const N: usize> Steps for Stretches<N> {
    const NEW: Self = Self([[1; N]; 2]);
    #[inline(always)]
    fn keep(&mut self, head: usize, equal: u8) {
        if Self::KEPT {
            let [once, twice] = &mut self.0;
            once[head] = equal;
            twice[head] = equal;
        }
    }
}

/// The newest N + 1 samples.
#[derive(Clone, Copy, Debug)]
pub struct Recent<const N: usize, S> {
    pub(super) newest: Count,
    /// The newest step; [out of reach](Self::OUT_OF_REACH) before the first.
    step: Counts,
    /// Number of newest steps that are equal, at most the window; 1 before the first.
    equal: u32,
    /// Below N.
    head: u32,
    /// The samples before the newest, newest first from `head` on, stored twice so that they are
    /// contiguous. A sentinel [out of reach](Self::OUT_OF_REACH) precedes the first sample.
    older: [[Count; N]; 2],
    /// What `equal` was when each of them was the newest.
    steps: S,
}

/// Two rings are equal if they hold the same samples since the first, at whatever index.
impl<const N: usize, S: Steps> PartialEq for Recent<N, S> {
    fn eq(&self, other: &Self) -> bool {
        self.newest == other.newest && self.since_first().eq(other.since_first())
    }
}

impl<const N: usize, S: Steps> Eq for Recent<N, S> {}

impl<const N: usize, S: Steps> Recent<N, S> {
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
            step: Self::OUT_OF_REACH,
            equal: 1,
            head: 0,
            older: [[first + Self::OUT_OF_REACH; N]; 2],
            steps: S::NEW,
        }
    }

    /// Removes all samples but `first`.
    pub(super) fn restart(&mut self, first: Count) {
        self.keep(first + Self::OUT_OF_REACH);
        self.newest = first;
        self.step = Self::OUT_OF_REACH;
        self.equal = 1;
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

    /// The newest steps that are equal.
    #[inline(always)]
    pub(super) const fn straight(&self) -> Straight {
        Straight {
            newest: self.newest,
            intervals: self.equal as usize,
            step: self.step.0,
        }
    }

    /// Adds a sample to a window of n intervals, at least 1.
    #[inline(always)]
    pub(super) fn push(&mut self, count: Count, n: u8) {
        let step = count - self.newest;
        self.keep(self.newest);
        let equal = if step == self.step { self.equal } else { 0 };
        self.equal = equal.min(u32::from(n) - 1) + 1;
        self.step = step;
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
        self.steps.keep(head, self.equal as u8);
        self.head = head as u32;
    }

    /// The samples before the newest, newest first, at most `most` of them.
    #[inline(always)]
    pub(super) fn older(&self, most: usize) -> &[Count] {
        let head = self.head as usize;
        inside(self.older.as_flattened(), head..head + most.min(N))
    }
}

impl<const N: usize> Recent<N, Stretches<N>> {
    /// The samples and the numbers of equal steps before them, at the index of their age in ticks, at most
    /// `most`. What is at index 0 has no meaning.
    #[inline(always)]
    pub(super) fn by_age(&self, most: usize) -> (&[Count], &[u8]) {
        // A slice begins one before its first sample, so that an age needs no subtraction.
        let head = match self.head as usize {
            0 => N,
            head => head,
        };
        let ages = head - 1..head + most.min(N);
        (
            inside(self.older.as_flattened(), ages.clone()),
            inside(self.steps.0.as_flattened(), ages),
        )
    }
}

/// The part at `range`, which is always inside.
#[inline(always)]
fn inside<T>(of: &[T], range: Range<usize>) -> &[T] {
    of.get(range).unwrap_or(&[])
}
