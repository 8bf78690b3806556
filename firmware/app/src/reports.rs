//! Reports of counts that seldom change.

/// Calls for one report.
const EVERY: u8 = u8::MAX;

/// Decides when counts are reported. The caller asks once per frame.
#[derive(Debug, Default)]
pub struct Reports<T> {
    reported: T,
    calls: u8,
}

impl<T: Copy + PartialEq> Reports<T> {
    /// The counts of the last report and of now, at every 256th call if they differ.
    pub fn take(&mut self, now: T) -> Option<[T; 2]> {
        let due = self.calls == EVERY;
        self.calls = self.calls.wrapping_add(1);
        if !due || now == self.reported {
            return None;
        }
        let before = core::mem::replace(&mut self.reported, now);
        Some([before, now])
    }
}
