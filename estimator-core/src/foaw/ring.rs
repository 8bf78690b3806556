//! The newest counts, in a fixed ring.

use crate::units::Count;

/// The newest 1 to N counts.
#[derive(Clone, Copy, Debug)]
pub(super) struct Ring<const N: usize> {
    counts: [Count; N],
    /// Where the newest count is; below N.
    newest: u8,
    /// How many counts are held, 1 to N.
    held: u8,
}

/// Rings that hold the same counts in the same order are equal, wherever they begin.
impl<const N: usize> PartialEq for Ring<N> {
    fn eq(&self, other: &Self) -> bool {
        self.newest_first().eq(other.newest_first())
    }
}

impl<const N: usize> Eq for Ring<N> {}

impl<const N: usize> Ring<N> {
    /// A ring that holds one count.
    pub(super) const fn new(first: Count) -> Self {
        Self {
            counts: [first; N],
            newest: 0,
            held: 1,
        }
    }

    pub(super) fn newest(&self) -> Count {
        // The index is always below N; the default is never taken and spares a panic.
        self.counts
            .get(usize::from(self.newest))
            .copied()
            .unwrap_or_default()
    }

    pub(super) fn push(&mut self, count: Count) {
        let next = usize::from(self.newest) + 1;
        let next = if next < N { next } else { 0 };
        if let Some(slot) = self.counts.get_mut(next) {
            *slot = count;
        }
        self.newest = next as u8;
        if usize::from(self.held) < N {
            self.held += 1;
        }
    }

    /// The held counts, newest first.
    pub(super) fn newest_first(&self) -> impl Iterator<Item = Count> {
        let (recent, older) = self
            .counts
            .split_at_checked(usize::from(self.newest) + 1)
            .unwrap_or((&self.counts, &[]));
        let mut recent = recent.iter();
        let mut older = older.iter();
        (0..self.held).map_while(move |_| recent.next_back().or_else(|| older.next_back()).copied())
    }
}
