//! RTT access through the target's memory, as by a debug probe.

use rigless::emulator::Memory;
use rigless::soc::Width;

/// Bytes from the control block's start to the first up channel, and of a channel.
const HEADER: u64 = 24;
const CHANNEL: u64 = 24;
/// Offsets in a channel.
const BUFFER: u64 = 4;
const SIZE: u64 = 8;
const WRITE: u64 = 12;
const READ: u64 = 16;

/// The block at this address; empty until the firmware has set it up.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Rtt(pub(crate) u64);

impl Rtt {
    fn ready(self, memory: &mut dyn Memory) -> bool {
        b"SEGGER RTT".iter().enumerate().all(|(k, &byte)| {
            memory.read(self.0 + k as u64, Width::W8).ok() == Some(u64::from(byte))
        })
    }

    fn word(memory: &mut dyn Memory, address: u64) -> u64 {
        memory.read(address, Width::W32).unwrap_or(0)
    }

    /// Reads the bytes in an up channel, if the firmware has so many.
    pub(crate) fn drain(self, channel: u64, memory: &mut dyn Memory, into: &mut Vec<u8>) {
        if !self.ready(memory) || Self::word(memory, self.0 + 16) <= channel {
            return;
        }
        let channel = self.0 + HEADER + CHANNEL * channel;
        let [buffer, size, write, mut read] =
            [BUFFER, SIZE, WRITE, READ].map(|at| Self::word(memory, channel + at));
        if size == 0 || write >= size || read >= size || read == write {
            return;
        }
        while read != write {
            into.push(memory.read(buffer + read, Width::W8).unwrap_or(0) as u8);
            read = (read + 1) % size;
        }
        // A write to RAM cannot fail.
        let _ = memory.write(channel + READ, Width::W32, read);
    }

    /// Writes as many of `bytes` to down channel 0 as fit, and returns their number.
    pub(crate) fn feed(self, memory: &mut dyn Memory, bytes: &[u8]) -> usize {
        if !self.ready(memory) || Self::word(memory, self.0 + 20) == 0 {
            return 0;
        }
        let channel = self.0 + HEADER + CHANNEL * Self::word(memory, self.0 + 16);
        let [buffer, size, mut write, read] =
            [BUFFER, SIZE, WRITE, READ].map(|at| Self::word(memory, channel + at));
        let mut put = 0;
        for &byte in bytes {
            let next = write + 1;
            let next = if next >= size { 0 } else { next };
            if size == 0 || next == read {
                break;
            }
            let _ = memory.write(buffer + write, Width::W8, u64::from(byte));
            (write, put) = (next, put + 1);
        }
        let _ = memory.write(channel + WRITE, Width::W32, write);
        put
    }
}
