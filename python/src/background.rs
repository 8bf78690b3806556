//! Long work without the interpreter's lock, which Ctrl-C interrupts.

use std::mem;
use std::panic::resume_unwind;
use std::process;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, PoisonError};
use std::thread;
use std::time::Duration;

use pyo3::prelude::*;
use rayon::{ThreadPool, ThreadPoolBuilder};
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

/// The threads of parallel work and the process that they are of. A process that Python's multiprocessing has
/// forked has none of the threads of its parent: work for those would not end.
static THREADS: Mutex<Option<(u32, Arc<ThreadPool>)>> = Mutex::new(None);

/// The threads of this process.
fn threads() -> Result<Arc<ThreadPool>, Failure> {
    let mut kept = THREADS.lock().unwrap_or_else(PoisonError::into_inner);
    match &*kept {
        Some((owner, threads)) if *owner == process::id() => Ok(Arc::clone(threads)),
        _ => {
            let threads = ThreadPoolBuilder::new().build();
            let threads = Arc::new(threads.map_err(|error| format!("threads: {error}"))?);
            // Threads of the parent cannot be ended here.
            mem::forget(kept.replace((process::id(), Arc::clone(&threads))));
            Ok(threads)
        }
    }
}

/// Waits until `is_finished`. The error is that of a handler of a signal, as after Ctrl-C.
fn wait(py: Python<'_>, is_finished: impl Fn() -> bool) -> PyResult<()> {
    let mut pause = Duration::from_micros(100);
    while !is_finished() {
        py.detach(|| thread::sleep(pause));
        pause = LOOK.min(2 * pause);
        py.check_signals()?;
    }
    Ok(())
}

/// Runs `work` in a thread of its own. After Ctrl-C it ends at its next call of [`Stop::look`].
pub(crate) fn interruptible<T: Send>(
    py: Python<'_>,
    work: impl FnOnce(&Stop) -> Result<T, Failure> + Send,
) -> PyResult<T> {
    let stop = Stop::default();
    let threads = threads().map_err(value_error)?;
    let (waited, ended) = thread::scope(|scope| {
        let worker = scope.spawn(|| threads.install(|| work(&stop)));
        let waited = wait(py, || worker.is_finished());
        stop.0.store(waited.is_err(), Ordering::Relaxed);
        while !worker.is_finished() {
            py.detach(|| thread::sleep(LOOK));
        }
        (waited, worker.join())
    });
    waited?;
    outcome(ended)
}

/// Runs `work`, which cannot look for a stop, in a thread of its own. After Ctrl-C the call ends at once, and
/// the thread goes on to the end of its work or of the process; what it returns is dropped.
pub(crate) fn abandonable<T: Send + 'static>(
    py: Python<'_>,
    work: impl FnOnce() -> Result<T, Failure> + Send + 'static,
) -> PyResult<T> {
    let worker = thread::spawn(work);
    wait(py, || worker.is_finished())?;
    outcome(worker.join())
}

/// What a thread returned; its panic goes on.
fn outcome<T>(ended: thread::Result<Result<T, Failure>>) -> PyResult<T> {
    ended
        .unwrap_or_else(|panic| resume_unwind(panic))
        .map_err(value_error)
}
