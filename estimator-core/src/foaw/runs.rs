//! The newest counts as runs of equal counts.

use crate::units::Count;

/// Samples in a row that read the same count: the count modulo 2^24 above, their number less one
/// below.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Run(u32);

impl Run {
    /// Before the first sample.
    const NONE: Self = Self(0xFF);

    /// How many samples; 0 before the first.
    pub(super) const fn length(self) -> i32 {
        match self {
            Self::NONE => 0,
            Self(word) => (word & 0xFF) as i32 + 1,
        }
    }

    pub(super) const fn is_one_sample(self) -> bool {
        self.0 & 0xFF == 0
    }

    /// Counts from this run to `newest`, if it is of one sample.
    pub(super) const fn displacement_if_one(self, newest: Count) -> Option<i32> {
        match self.0 & 0xFF {
            0 => Some((newest.0 << 8).wrapping_sub(self.0) as i32 >> 8),
            _ => None,
        }
    }

    /// Counts from this run to `newest`; less than 2^23.
    pub(super) const fn displacement_to(self, newest: Count) -> i32 {
        ((newest.0 << 8).wrapping_sub(self.0 & !0xFF) as i32) >> 8
    }
}

/// The newest N + 1 samples and perhaps some more, as runs.
#[derive(Clone, Copy, Debug)]
pub(super) struct Runs<const N: usize> {
    /// The newest sample, and how many read the same in a row, at most N + 1.
    pub(super) newest: Count,
    pub(super) length: i32,
    /// The N runs before, twice: N of them from `head` on, newest first, are whole. Every run has
    /// a sample at least, so these reach back far enough.
    older: [[Run; N]; 2],
    /// Below N.
    head: u8,
}

/// Equal if they hold the same runs in the same order, wherever they begin.
impl<const N: usize> PartialEq for Runs<N> {
    fn eq(&self, other: &Self) -> bool {
        self.newest == other.newest && self.window().eq(other.window())
    }
}

impl<const N: usize> Eq for Runs<N> {}

impl<const N: usize> Runs<N> {
    /// One sample.
    pub(super) const fn new(first: Count) -> Self {
        Self {
            newest: first,
            length: 1,
            older: [[Run::NONE; N]; 2],
            head: 0,
        }
    }

    /// One more sample of the newest count.
    pub(super) const fn extend(&mut self) {
        if self.length <= N as i32 {
            self.length += 1;
        }
    }

    /// A sample of another count.
    pub(super) fn push(&mut self, count: Count) {
        let head = match self.head {
            0 => N - 1,
            head => usize::from(head) - 1,
        };
        let run = Run(self.newest.0 << 8 | (self.length - 1) as u32);
        for copy in &mut self.older {
            // The index is always inside.
            if let Some(slot) = copy.get_mut(head) {
                *slot = run;
            }
        }
        self.head = head as u8;
        self.newest = count;
        self.length = 1;
    }

    /// The older runs, newest first; their lengths become 0 where history ends.
    pub(super) fn older(&self) -> &[Run; N] {
        // The head is always inside; the default is never taken and spares a panic.
        let from_head = self.older.as_flattened().get(usize::from(self.head)..);
        from_head
            .and_then(<[Run]>::first_chunk)
            .unwrap_or(&self.older[0])
    }

    /// Displacement to and length of the runs of the newest N + 1 samples, newest first.
    fn window(&self) -> impl Iterator<Item = (i32, i32)> {
        let newest = [(0, self.length)].into_iter();
        let older = self.older().iter();
        let older = older.map(|run| (run.displacement_to(self.newest), run.length()));
        let mut left = N as i32 + 1;
        newest
            .chain(older)
            .map_while(move |(displacement, length)| {
                let length = length.min(left);
                left -= length;
                (length > 0).then_some((displacement, length))
            })
    }
}
