//! Long work without the interpreter's lock, which Ctrl-C interrupts.

use std::panic::resume_unwind;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread;
use std::time::Duration;

use pyo3::prelude::*;
use terminal::failure::Failure;

use crate::error::value_error;

/// Longest pause between two looks for Ctrl-C.
const LOOK: Duration = Duration::from_millis(20);

/// Whether the work shall stop.
#[derive(Default)]
pub(crate) struct Stop(AtomicBool);

/// What unwinds the thread of stopped work.
struct Stopped;

impl Stop {
    /// Called between the parts of the work: unwinds its thread once the user has pressed Ctrl-C.
    pub(crate) fn look(&self) {
        if self.0.load(Ordering::Relaxed) {
            resume_unwind(Box::new(Stopped));
        }
    }
}

/// Runs `work` in a thread of its own. After Ctrl-C it ends at its next call of [`Stop::look`].
pub(crate) fn interruptible<T: Send>(
    py: Python<'_>,
    work: impl FnOnce(&Stop) -> Result<T, Failure> + Send,
) -> PyResult<T> {
    let stop = Stop::default();
    let mut interrupt = None;
    let ended = thread::scope(|scope| {
        let worker = scope.spawn(|| work(&stop));
        let mut pause = Duration::from_micros(100);
        while !worker.is_finished() {
            py.detach(|| thread::sleep(pause));
            pause = LOOK.min(2 * pause);
            if let (None, Err(error)) = (&interrupt, py.check_signals()) {
                interrupt = Some(error);
                stop.0.store(true, Ordering::Relaxed);
            }
        }
        worker.join()
    });
    match (interrupt, ended) {
        (Some(error), _) => Err(error),
        (None, Ok(done)) => done.map_err(value_error),
        (None, Err(panic)) => resume_unwind(panic),
    }
}
