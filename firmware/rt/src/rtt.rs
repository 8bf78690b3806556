//! RTT: the log goes up channel 0, messages of the link go up channel 1, commands come down channel 0.
//!
//! `defmt-rtt` has no down channel and `rtt-target` masks interrupts for every frame; here a frame
//! is staged whole and published by one store; a task that interrupts a frame loses its own. When
//! the buffer is full the frame is dropped and counted, never waited for.

use core::cell::UnsafeCell;
use core::sync::atomic::{AtomicU8, AtomicU32, Ordering};

use cortex_m::peripheral::SCB;

/// Bytes that wait for the probe: at least 67 lines of a telemetry frame, which has 59 bytes before
/// and at most 61 after its encoding.
const UP: usize = 4096;
/// Bytes of the link that wait for the probe.
const LINK: usize = 4096;
/// Bytes of commands that wait, and that one look takes at most.
const DOWN: usize = 64;
/// Owner while no frame is being written.
const UNOWNED: u32 = u32::MAX;

/// A channel as the probe reads it; references have the layout of its pointers.
#[repr(C)]
struct Channel<const N: usize> {
    name: &'static [u8; 6],
    buffer: &'static [AtomicU8; N],
    size: u32,
    write: AtomicU32,
    read: AtomicU32,
    /// Bits 0 and 1: mode of a full buffer. The probe can request blocking, which is ignored.
    flags: AtomicU32,
}

/// The control block that a probe looks for.
#[repr(C)]
struct Block {
    id: [u8; 16],
    up_channels: u32,
    down_channels: u32,
    up: Channel<UP>,
    link: Channel<LINK>,
    down: Channel<DOWN>,
}

static NAME: [u8; 6] = *b"defmt\0";
static MESSAGES: [u8; 6] = *b"link\0\0";
static COMMANDS: [u8; 6] = *b"cmds\0\0";
static UP_BUFFER: [AtomicU8; UP] = [const { AtomicU8::new(0) }; UP];
// SAFETY: the section is RAM that the start-up code does not touch; every content is bytes, and no
// byte is read before it was written. Its clearing would delay the start of the watchdog.
#[unsafe(link_section = ".uninit.link")]
static LINK_BUFFER: [AtomicU8; LINK] = [const { AtomicU8::new(0) }; LINK];
static DOWN_BUFFER: [AtomicU8; DOWN] = [const { AtomicU8::new(0) }; DOWN];

// SAFETY: the name is the one that probes look for, and nothing else here has it.
#[unsafe(no_mangle)]
static _SEGGER_RTT: Block = Block {
    id: *b"SEGGER RTT\0\0\0\0\0\0",
    up_channels: 2,
    down_channels: 1,
    up: Channel::new(&NAME, &UP_BUFFER),
    link: Channel::new(&MESSAGES, &LINK_BUFFER),
    down: Channel::new(&COMMANDS, &DOWN_BUFFER),
};

impl<const N: usize> Channel<N> {
    const fn new(name: &'static [u8; 6], buffer: &'static [AtomicU8; N]) -> Self {
        Self {
            name,
            buffer,
            size: N as u32,
            write: AtomicU32::new(0),
            read: AtomicU32::new(0),
            flags: AtomicU32::new(0),
        }
    }

    /// An index that the probe wrote, whatever it wrote.
    fn index(&self, at: &AtomicU32) -> usize {
        at.load(Ordering::Acquire) as usize % N
    }
}

/// The next byte that came down, if any.
pub fn receive() -> Option<u8> {
    let down = &_SEGGER_RTT.down;
    let (read, write) = (down.index(&down.read), down.index(&down.write));
    if read == write {
        return None;
    }
    let byte = down.buffer[read].load(Ordering::Relaxed);
    down.read
        .store(((read + 1) % DOWN) as u32, Ordering::Release);
    Some(byte)
}

/// Publishes a frame of the link, unless there is no room for it. For the task of lowest priority.
pub fn send(frame: &[u8]) {
    let up = &_SEGGER_RTT.link;
    let (read, write) = (up.index(&up.read), up.index(&up.write));
    let used = (LINK + write - read) % LINK;
    // A full buffer would look empty.
    if frame.len() >= LINK - used {
        return;
    }
    for (k, &byte) in frame.iter().enumerate() {
        up.buffer[(write + k) % LINK].store(byte, Ordering::Relaxed);
    }
    let end = (write + frame.len()) % LINK;
    up.write.store(end as u32, Ordering::Release);
}

/// Frames lost because the buffer was full or another frame was being written.
pub fn lost() -> u32 {
    LOST.load(Ordering::Relaxed)
}

/// Frees the stage from any owner, for a caller after which no other task runs. A frame that is being
/// written is dropped: its bytes were not published.
pub(crate) fn take_over() {
    if OWNER.swap(UNOWNED, Ordering::Relaxed) != UNOWNED {
        LOST.fetch_add(1, Ordering::Relaxed);
        // SAFETY: the owner does not run again, and nobody else has the cell.
        unsafe { (*STAGE.0.get()).encoder = defmt::Encoder::new() };
    }
}

static LOST: AtomicU32 = AtomicU32::new(0);
/// Exception number of the task that writes a frame.
static OWNER: AtomicU32 = AtomicU32::new(UNOWNED);
static STAGE: Stage = Stage(UnsafeCell::new(Staged {
    encoder: defmt::Encoder::new(),
    cursor: Cursor { at: 0, fits: true },
}));

struct Stage(UnsafeCell<Staged>);

// SAFETY: only the owner touches the cell, see `with_stage`; `take_over` is for those for whom all
// others never run again.
unsafe impl Sync for Stage {}

struct Staged {
    encoder: defmt::Encoder,
    cursor: Cursor,
}

/// Where the next byte of the frame goes.
struct Cursor {
    at: usize,
    fits: bool,
}

impl Cursor {
    fn put(&mut self, bytes: &[u8]) {
        let up = &_SEGGER_RTT.up;
        let read = up.index(&up.read);
        for &byte in bytes {
            let next = (self.at + 1) % UP;
            if next == read || !self.fits {
                self.fits = false;
                return;
            }
            up.buffer[self.at].store(byte, Ordering::Relaxed);
            self.at = next;
        }
    }
}

fn context() -> u32 {
    // 0 in thread mode, else the exception: no two run at once with the same number.
    match SCB::vect_active() {
        cortex_m::peripheral::scb::VectActive::ThreadMode => 0,
        cortex_m::peripheral::scb::VectActive::Exception(exception) => {
            exception.irqn() as u8 as u32
        }
        cortex_m::peripheral::scb::VectActive::Interrupt { irqn } => 16 + u32::from(irqn),
    }
}

/// Does something with the stage, if the caller owns it.
fn with_stage(f: impl FnOnce(&mut Staged)) {
    if OWNER.load(Ordering::Relaxed) == context() {
        // SAFETY: the owner is one context. Another that interrupts it does not own the stage and
        // does not come here, and `f` does not log.
        f(unsafe { &mut *STAGE.0.get() });
    }
}

#[defmt::global_logger]
struct Logger;

// SAFETY: `acquire` gives the stage to one context until it calls `release`; for every other the
// methods do nothing.
unsafe impl defmt::Logger for Logger {
    fn acquire() {
        let owned =
            OWNER.compare_exchange(UNOWNED, context(), Ordering::Acquire, Ordering::Relaxed);
        if owned.is_err() {
            LOST.fetch_add(1, Ordering::Relaxed);
            return;
        }
        with_stage(|Staged { encoder, cursor }| {
            let up = &_SEGGER_RTT.up;
            *cursor = Cursor {
                at: up.index(&up.write),
                fits: true,
            };
            encoder.start_frame(|bytes| cursor.put(bytes));
        });
    }

    unsafe fn write(bytes: &[u8]) {
        with_stage(|Staged { encoder, cursor }| encoder.write(bytes, |bytes| cursor.put(bytes)));
    }

    unsafe fn flush() {}

    unsafe fn release() {
        with_stage(|Staged { encoder, cursor }| {
            encoder.end_frame(|bytes| cursor.put(bytes));
            if cursor.fits {
                _SEGGER_RTT
                    .up
                    .write
                    .store(cursor.at as u32, Ordering::Release);
            } else {
                LOST.fetch_add(1, Ordering::Relaxed);
            }
            OWNER.store(UNOWNED, Ordering::Release);
        });
    }
}
