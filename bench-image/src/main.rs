//! The image: says that it is ready, runs what it is asked to, for ever.
#![no_std]
#![no_main]

use cortex_m_rt::entry;
use panic_halt as _;

/// The emulator stops at a call of this function.
#[inline(never)]
fn ready() {
    core::hint::black_box(());
}

#[entry]
fn main() -> ! {
    loop {
        ready();
        bench_image::mailbox::run_job();
    }
}
