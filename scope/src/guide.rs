//! A guided procedure of `drive`, run for a page beside the stream of the board.

use std::sync::mpsc::{Receiver, channel};
use std::thread::{self, JoinHandle};

use drive::guided::Guided;
use drive::port::{PipeEnd, Port};
use haptic_control::Stop;
use serde_json::{Value, json};
use terminal::failure::Failure;

/// A procedure that runs or has ended.
pub(crate) struct Guide {
    what: Guided,
    lines: Vec<String>,
    run: Option<Run>,
    /// `None` while it runs and after success.
    failure: Option<String>,
    /// Whether a reset of the board ended it, whose cause is not known yet.
    awaits_cause: bool,
}

/// The thread of a procedure, which holds the other end of the pipe.
struct Run {
    pipe: PipeEnd,
    said: Receiver<String>,
    thread: JoinHandle<Result<(), Failure>>,
}

impl Guide {
    /// Begins a procedure.
    pub(crate) fn start(what: Guided) -> Self {
        let (port, pipe) = Port::pipe("board");
        let (say, said) = channel();
        let named = thread::Builder::new().name(what.as_str().to_owned());
        let spawned = named.spawn(move || {
            // A page that has gone needs no lines.
            what.run(port, move |line| drop(say.send(line)))
        });
        let (run, failure) = match spawned {
            Ok(thread) => (Some(Run { pipe, said, thread }), None),
            Err(error) => (None, Some(format!("a thread: {error}"))),
        };
        Self {
            what,
            lines: Vec::new(),
            run,
            failure,
            awaits_cause: false,
        }
    }

    pub(crate) const fn what(&self) -> Guided {
        self.what
    }

    pub(crate) const fn runs(&self) -> bool {
        self.run.is_some()
    }

    /// Takes bytes of the board.
    pub(crate) fn heard(&self, bytes: &[u8]) {
        if let Some(run) = self.run.as_ref().filter(|_| !bytes.is_empty()) {
            // A procedure that has ended reads no more.
            let _ = run.pipe.to.send(bytes.to_vec());
        }
    }

    /// The bytes for the board since the last call.
    pub(crate) fn take_bytes(&mut self) -> Vec<u8> {
        let Some(run) = &self.run else {
            return Vec::new();
        };
        // In this order: what a procedure does before its end is taken.
        let is_over = run.thread.is_finished();
        let bytes = run.pipe.from.try_iter().flatten().collect();
        self.lines.extend(run.said.try_iter());
        if is_over {
            self.join();
        }
        bytes
    }

    /// Takes the result of a thread that has ended.
    fn join(&mut self) {
        if let Some(run) = self.run.take() {
            self.lines.extend(run.said.try_iter());
            let ended = run.thread.join();
            let ended =
                ended.unwrap_or_else(|_| Err(Failure::Check("the procedure panicked".to_owned())));
            self.failure = ended.err().map(|failure| failure.to_string());
        }
    }

    /// Ends the procedure where it is, for this reason; one that has ended already has its own result. Whether it was ended
    /// here: the board has to be disarmed after it.
    pub(crate) fn abandon(&mut self, why: &str) -> bool {
        if (self.run.as_ref()).is_some_and(|run| run.thread.is_finished()) {
            self.join();
        }
        let is_ended = self.run.take().is_some();
        if is_ended {
            self.failure = Some(format!("{}: {why}", self.what.as_str()));
        }
        is_ended
    }

    /// Ends the procedure as the board has started again. Its next identity has the cause.
    pub(crate) fn restarted(&mut self) {
        self.awaits_cause |= self.runs();
        self.abandon("the board has started again");
    }

    /// Takes the cause of the latest reset, which an identity has.
    pub(crate) fn reset(&mut self, cause: Stop) {
        if std::mem::take(&mut self.awaits_cause) && cause != Stop::None {
            self.failure = Some(format!(
                "{}: the board has started again, cause {}",
                self.what.as_str(),
                cause.as_str()
            ));
        }
    }

    pub(crate) fn json(&self) -> Value {
        json!({
            "name": self.what.as_str(),
            "runs": self.runs(),
            "lines": self.lines,
            "failure": self.failure,
        })
    }
}
