//! Measurement of the stack depth: RAM is filled with a pattern before the start, and the words that
//! still have it are counted.

use rigless::emulator::Memory;
use rigless::soc::Width;

const PAINT: u64 = 0xA5C3_5A3C;

/// Memory of the stack: lowest address, and the address after its end.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Stack(pub(crate) [u64; 2]);

impl Stack {
    /// Addresses of the words in rising order.
    pub(crate) fn words(self) -> impl Iterator<Item = u64> {
        let [low, high] = self.0;
        (low.next_multiple_of(4)..high).step_by(4)
    }

    /// Addresses of the words in falling order.
    pub(crate) fn words_down(self) -> impl Iterator<Item = u64> {
        let [low, high] = self.0;
        (1..=(high - low) / 4).map(move |k| high - 4 * k)
    }

    /// Fills all words with the pattern.
    pub(crate) fn paint(self, memory: &mut dyn Memory) {
        for address in self.words() {
            // A write to RAM cannot fail.
            let _ = memory.write(address, Width::W32, PAINT);
        }
    }

    /// Fills the lowest words again.
    pub(crate) fn paint_lowest(self, memory: &mut dyn Memory) {
        for address in self.words().take(16) {
            let _ = memory.write(address, Width::W32, PAINT);
        }
    }

    /// Bytes from the top to the lowest word without the pattern.
    pub(crate) fn used(self, memory: &mut dyn Memory) -> u64 {
        let touched = |at: &u64| memory.read(*at, Width::W32).ok() != Some(PAINT);
        let lowest = self.words().find(touched);
        lowest.map_or(0, |lowest| self.0[1] - lowest)
    }
}
