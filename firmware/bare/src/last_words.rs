//! One word that survives a reset.

use core::sync::atomic::{AtomicU32, Ordering};

use haptic_control::Stop;

/// High half of a word that was left on purpose.
const MARK: u32 = 0xDEAD_0000;

// SAFETY: the section is RAM that the start-up code does not touch; every content is an AtomicU32.
#[unsafe(link_section = ".uninit.last_words")]
static WORD: AtomicU32 = AtomicU32::new(0);

/// Leaves the cause of the reset to come.
pub fn leave(cause: Stop) {
    WORD.store(MARK | cause as u32, Ordering::SeqCst);
}

/// Takes what was left before the last reset.
pub fn take() -> Option<Stop> {
    let word = WORD.swap(0, Ordering::SeqCst);
    let code = (word & 0xFFFF_0000 == MARK).then_some(word as u8)?;
    Stop::from_code(code)
}
