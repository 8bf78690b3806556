//! The cause of a reset, in a word of RAM that survives the reset.

use core::sync::atomic::{AtomicU32, Ordering};

use haptic_control::Stop;

/// High half of a word that [`store`] has written.
const MARK: u32 = 0xDEAD_0000;

// SAFETY: the section is RAM that the start-up code does not touch; every content is an AtomicU32.
#[unsafe(link_section = ".uninit.reset_cause")]
static WORD: AtomicU32 = AtomicU32::new(0);

/// Stores the cause of the reset that is about to happen.
pub fn store(cause: Stop) {
    WORD.store(MARK | cause as u32, Ordering::SeqCst);
}

/// Returns the cause stored before the last reset, and clears it.
pub fn take() -> Option<Stop> {
    let word = WORD.swap(0, Ordering::SeqCst);
    let code = (word & 0xFFFF_0000 == MARK).then_some(word as u8)?;
    Stop::from_code(code)
}
