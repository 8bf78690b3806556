//! How deep the stack has been: RAM painted before the start, and what is left of the paint.

use rigless::emulator::Memory;
use rigless::soc::Width;

const PAINT: u64 = 0xA5C3_5A3C;

/// Memory that the stack may take: its lowest address and the one behind its highest.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Stack(pub(crate) [u64; 2]);

impl Stack {
    /// Addresses of its words, from the lowest.
    pub(crate) fn words(self) -> impl Iterator<Item = u64> {
        let [low, high] = self.0;
        (low.next_multiple_of(4)..high).step_by(4)
    }

    /// Addresses of its words, from the highest.
    pub(crate) fn words_down(self) -> impl Iterator<Item = u64> {
        let [low, high] = self.0;
        (1..=(high - low) / 4).map(move |k| high - 4 * k)
    }

    /// Paints all of it.
    pub(crate) fn paint(self, memory: &mut dyn Memory) {
        for address in self.words() {
            // It is RAM: the write cannot be refused.
            let _ = memory.write(address, Width::W32, PAINT);
        }
    }

    /// Paints its lowest words again.
    pub(crate) fn paint_lowest(self, memory: &mut dyn Memory) {
        for address in self.words().take(16) {
            let _ = memory.write(address, Width::W32, PAINT);
        }
    }

    /// Bytes from its top to the lowest word without paint.
    pub(crate) fn used(self, memory: &mut dyn Memory) -> u64 {
        let touched = |at: &u64| memory.read(*at, Width::W32).ok() != Some(PAINT);
        let lowest = self.words().find(touched);
        lowest.map_or(0, |lowest| self.0[1] - lowest)
    }
}
