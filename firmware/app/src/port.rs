//! Bookkeeping of the serial port's rings: which bytes have come, and which are next to send.

/// What has gone wrong on the serial port since the start, modulo 2^32.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct PortFaults {
    /// Looks that found an overrun, noise or a framing error of what was received, or its DMA stopped.
    pub errors: u32,
    /// Frames lost because the queue was full.
    pub lost: u32,
}

/// Reader of a ring of `N` bytes that DMA fills round and round.
#[derive(Debug, Default)]
pub struct Inbox<const N: usize> {
    read: usize,
}

impl<const N: usize> Inbox<N> {
    /// Place of the next byte that has come, or nothing. `left` is the number of bytes that DMA has
    /// left until the end of the ring.
    pub fn take(&mut self, left: u16) -> Option<usize> {
        let write = N.saturating_sub(usize::from(left)) % N;
        if self.read == write {
            return None;
        }
        let at = self.read;
        self.read = (at + 1) % N;
        Some(at)
    }
}

/// Queue of frames in a ring of `N` bytes that DMA sends. A frame enters it whole or not at all.
#[derive(Debug, Default)]
pub struct Outbox<const N: usize> {
    /// First byte that is not sent.
    read: usize,
    /// Place of the next byte of a frame.
    write: usize,
    /// Bytes that DMA is sending.
    sending: usize,
    lost: u32,
}

impl<const N: usize> Outbox<N> {
    /// Frames lost because the ring was full, modulo 2^32.
    #[must_use]
    pub const fn lost(&self) -> u32 {
        self.lost
    }

    /// Hands each byte of a frame with its place to `store`, or counts the frame as lost.
    pub fn put(&mut self, frame: &[u8], mut store: impl FnMut(usize, u8)) {
        let used = (N + self.write - self.read) % N;
        // A full ring would look empty.
        if frame.len() >= N - used {
            self.lost = self.lost.wrapping_add(1);
            return;
        }
        for &byte in frame {
            store(self.write, byte);
            self.write = (self.write + 1) % N;
        }
    }

    /// Bytes to send next, as their first place and their number, after the bytes handed out before
    /// have been sent. They do not go round the ring's end.
    pub fn chunk(&mut self) -> Option<(usize, usize)> {
        self.read = (self.read + self.sending) % N;
        let end = if self.write < self.read {
            N
        } else {
            self.write
        };
        self.sending = end - self.read;
        (self.sending > 0).then_some((self.read, self.sending))
    }
}
