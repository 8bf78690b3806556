//! Memory and error flags of the serial port: two rings of bytes that DMA fills and empties while the
//! core runs.
//!
//! Both rings are atomics, so that bytes which DMA changes are no data race in the language either.

use core::sync::atomic::{AtomicU8, Ordering, fence};

use embedded_dma::{ReadBuffer, WriteBuffer};
use stm32f4xx_hal::pac;

/// Bytes of the receive ring: 7 ms at 1.5 Mbaud.
pub const RECEIVE_RING: usize = 1024;
/// Bytes of the transmit ring: 14 ms at 1.5 Mbaud.
pub const TRANSMIT_RING: usize = 2048;

// SAFETY: the section is RAM that the start-up code does not touch; every content is bytes, and no
// byte is read before it was written. Its clearing would delay the start of the watchdog.
#[unsafe(link_section = ".uninit.received")]
static RECEIVED: [AtomicU8; RECEIVE_RING] = [const { AtomicU8::new(0) }; RECEIVE_RING];
// SAFETY: the section is RAM that the start-up code does not touch; every content is bytes, and no
// byte is read before it was written. Its clearing would delay the start of the watchdog.
#[unsafe(link_section = ".uninit.transmitted")]
static TRANSMITTED: [AtomicU8; TRANSMIT_RING] = [const { AtomicU8::new(0) }; TRANSMIT_RING];

/// The receive ring as the buffer of a DMA stream. A stream that gets it as both of its buffers fills
/// it round and round.
pub struct ReceiveRing;

// SAFETY: the memory is a static, and it is the same at each call. It is read as atomics alone, for
// which every byte is valid.
unsafe impl WriteBuffer for ReceiveRing {
    type Word = u8;

    unsafe fn write_buffer(&mut self) -> (*mut u8, usize) {
        (RECEIVED.as_ptr().cast_mut().cast(), RECEIVED.len())
    }
}

/// The byte at this place of the receive ring, modulo its length.
#[must_use]
pub fn received(at: usize) -> u8 {
    // DMA has written the byte before its counter said so, and the counter was read before.
    fence(Ordering::Acquire);
    RECEIVED[at % RECEIVE_RING].load(Ordering::Relaxed)
}

/// Stores a byte at this place of the transmit ring, modulo its length.
pub fn store_transmitted(at: usize, byte: u8) {
    TRANSMITTED[at % TRANSMIT_RING].store(byte, Ordering::Relaxed);
}

/// Consecutive bytes of the transmit ring as the buffer of a DMA stream.
pub struct Chunk(&'static [AtomicU8]);

impl Chunk {
    /// The bytes from `start` on, `length` of them. Empty if they are not within the ring.
    #[must_use]
    pub fn new(start: usize, length: usize) -> Self {
        let end = start.saturating_add(length);
        Self(TRANSMITTED.get(start..end).unwrap_or_default())
    }
}

// SAFETY: the memory is a part of a static, and it is the same at each call.
unsafe impl ReadBuffer for Chunk {
    type Word = u8;

    unsafe fn read_buffer(&self) -> (*const u8, usize) {
        // The bytes were stored before DMA is told of them.
        fence(Ordering::Release);
        (self.0.as_ptr().cast(), self.0.len())
    }
}

/// Whether a byte has come with an overrun, noise or a framing error since the last call. A read of the
/// status and then one of the data clears these flags.
#[must_use]
pub fn line_error() -> bool {
    // SAFETY: nothing else reads these registers but DMA, which reads the data while a byte waits. The
    // core reads the data only if none waits, so it takes no byte from DMA, unless a byte ends between
    // the two reads: that one is right behind a broken one.
    unsafe {
        let usart = &*pac::USART3::ptr();
        let status = usart.sr().read();
        let error =
            status.ore().bit_is_set() || status.nf().bit_is_set() || status.fe().bit_is_set();
        if error && status.rxne().bit_is_clear() {
            let _ = usart.dr().read();
        }
        error
    }
}
