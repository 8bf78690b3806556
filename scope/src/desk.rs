//! The desk at which the messages of a board become rows for the pages.

use std::sync::Arc;
use std::time::{Duration, Instant};

use drive::starts::is_start;
use drivers::Command;
use drivers::link::{Frame, Hello, Message};
use haptic_control::{Mode, Request, Stop};
use serde_json::{Value, json};
use simulation::device::Device;
use terminal::failure::Failure;

use crate::batch::Batch;
use crate::bench::Bench;
use crate::estimators::{Estimators, Reading};
use crate::fault_watch::{FaultWatch, sentence};
use crate::hub::{Event, Hub};
use crate::order::Order;
use crate::parameters::Tuned;
use crate::recorder::Recorder;
use crate::refusals::Refusals;
use crate::selection::Selection;
use crate::values::{Conversion, Truth};

/// Telemetry frames of a second.
pub(crate) const FRAMES_HZ: f64 = 1e3;
/// Time between two frames from which on some between them are missing, s.
pub(crate) const GAP_S: f64 = 2.5 / FRAMES_HZ;
/// Interval of the status.
pub(crate) const STATUS: Duration = Duration::from_millis(100);

/// The desk of a source.
pub(crate) struct Desk {
    pub(crate) hub: Arc<Hub>,
    conversion: Conversion,
    estimators: Estimators,
    batch: Batch,
    recorder: Option<Recorder>,
    hello: Option<Hello>,
    /// Whether the identity has come since the latest frame. A board that starts tells it before its first frame.
    is_hello_new: bool,
    last: Option<Frame>,
    /// Time of the last row, s.
    t: f64,
    refusals: Refusals,
    selection: Selection,
    tuned: Tuned,
    told: Instant,
    pub(crate) fault: Option<FaultWatch>,
    bench: Bench,
}

impl Desk {
    /// The desk for a board with this device.
    ///
    /// # Errors
    /// [`Failure::Input`] if an estimator cannot be built.
    pub(crate) fn new(hub: Arc<Hub>, device: &Device) -> Result<Self, Failure> {
        Ok(Self {
            hub,
            conversion: Conversion::new(device),
            estimators: Estimators::new(device, FRAMES_HZ)?,
            batch: Batch::new(),
            recorder: None,
            hello: None,
            is_hello_new: false,
            last: None,
            t: 0.0,
            refusals: Refusals::default(),
            selection: Selection::NONE,
            tuned: Tuned::new(),
            told: Instant::now(),
            fault: None,
            bench: Bench::default(),
        })
    }

    /// Identity of the image, once it has come.
    pub(crate) const fn hello(&self) -> Option<&Hello> {
        self.hello.as_ref()
    }

    /// Whether an amplifier is enabled, by the latest frame.
    pub(crate) fn is_on(&self) -> bool {
        let mode = self.last.and_then(|frame| Mode::from_code(frame.state));
        mode.is_some_and(Mode::is_enabled)
    }

    /// Time of the last row, s.
    pub(crate) const fn t(&self) -> f64 {
        self.t
    }

    /// The board has started again.
    pub(crate) fn restarted(&mut self) {
        (self.last, self.hello) = (None, None);
        self.refusals.restarted();
        self.hub.identify(None);
        self.forget();
        self.estimators.restart();
        self.bench.restarted();
        self.end_recording();
    }

    /// The board has neither scene nor parameters of before.
    fn forget(&mut self) {
        (self.selection, self.tuned) = (Selection::NONE, Tuned::new());
    }

    /// The command that disarms the board. It ends a procedure for this reason.
    pub(crate) fn disarm(&mut self, why: &str) -> Command {
        self.bench.abandon(why);
        self.selection = Selection::NONE;
        self.refusals.forget();
        Command::Request(Request::Disarm)
    }

    /// The cause for which the board is in its safe state, by the latest frame.
    fn stop(&self) -> Option<Stop> {
        let last = self.last.as_ref()?;
        let is_safe = Mode::from_code(last.state) == Some(Mode::Safe);
        Stop::from_code(last.cause).filter(|_| is_safe)
    }

    /// Follows an order as far as the desk does, and returns the command for the board.
    pub(crate) fn order(&mut self, order: &Order) -> Option<Command> {
        if *order == Order::Disarm {
            // A stop that the procedure has not seen yet comes before the order.
            let stopped =
                |cause: Stop| format!("the board stopped: state safe, cause {}", cause.as_str());
            let why = self
                .stop()
                .map_or_else(|| "ended by Disarm".to_owned(), stopped);
            return Some(self.disarm(&why));
        }
        if !self.bench.order(order, self.hello.is_some()) {
            return None;
        }
        match *order {
            Order::Record { on: true } => {
                if let (None, Some(hello)) = (&self.recorder, &self.hello) {
                    self.recorder = Some(Recorder::new(hello));
                    // So that a replay has the same estimates from its first row on.
                    self.estimators.restart();
                }
            }
            Order::Record { on: false } => self.end_recording(),
            Order::Scene { number } => {
                self.selection.order(number, self.t);
                self.tuned.select(number);
            }
            Order::Tune {
                scene,
                parameter,
                value,
            } => {
                if let Some(hello) = &self.hello {
                    self.tuned.set(scene, parameter, value, hello);
                }
            }
            _ => {}
        }
        let command = order.command()?;
        if order.changes_the_board() {
            self.refusals.forget();
        }
        Some(command)
    }

    /// Ends a recording, if there is one, and keeps it for downloads.
    fn end_recording(&mut self) {
        if let Some(recorder) = self.recorder.take() {
            self.hub.keep(Arc::new(recorder.finish()));
        }
    }

    /// The source ends: what is not told is told, and a recording ends.
    pub(crate) fn close(&mut self) {
        self.end_recording();
        if let Some(bytes) = self.batch.rest() {
            self.hub.tell(Event::Rows(bytes));
        }
    }

    /// Takes bytes of the board, before their messages.
    pub(crate) fn heard(&self, bytes: &[u8]) {
        self.bench.heard(bytes);
    }

    /// Bytes for the board that are no order of a page: those of a guided procedure.
    pub(crate) fn take_bytes(&mut self) -> Vec<u8> {
        self.bench.take_bytes(self.hub.is_abandoned())
    }

    /// The source ends: bytes that end a procedure and undo what it has left.
    pub(crate) fn last_bytes(&mut self) -> Vec<u8> {
        self.bench.last_bytes()
    }

    /// Takes a message of the board, with the truth of a frame if it is known.
    pub(crate) fn message(&mut self, message: Message, truth: Option<&Truth>) {
        if let Some(recorder) = &mut self.recorder {
            recorder.take(message);
        }
        self.bench.message(&message);
        match message {
            Message::Hello(hello) => {
                (self.hello, self.is_hello_new) = (Some(hello), true);
                self.hub.identify(self.hello);
            }
            Message::Frame(frame) => self.frame(&frame, truth),
            Message::Rejected(now) => {
                let is_scene_refused = self.refusals.take(&now);
                if is_scene_refused {
                    self.selection.refused(self.t);
                }
            }
            _ => {}
        }
    }

    fn frame(&mut self, frame: &Frame, truth: Option<&Truth>) {
        let rate = self.hello.map_or(0.0, |hello| f64::from(hello.rate));
        if let Some(last) = self.last.filter(|_| rate > 0.0) {
            let ticks = frame.tick.wrapping_sub(last.tick);
            self.t += f64::from(ticks.min(hz(rate))) / rate;
            if frame.seq.wrapping_sub(last.seq) != 1 {
                self.estimators.restart();
            }
        }
        if let Some(truth) = truth {
            self.t = truth.t;
        }
        let is_hello_new = std::mem::take(&mut self.is_hello_new);
        if self.last.is_some_and(|last| is_start(&last, frame)) {
            self.forget();
            self.bench.restarted();
            if let Some(hello) = self.hello.filter(|_| is_hello_new) {
                self.bench.message(&hello.into());
            }
        }
        let mode = |frame: &Frame| Mode::from_code(frame.state);
        let before = self.last.as_ref().and_then(mode);
        self.selection.frame(before, mode(frame), self.t);
        self.last = Some(*frame);
        let values = self.conversion.values(self.t, frame, truth);
        if let Some(watch) = &mut self.fault {
            watch.frame((self.t * 1e9) as u64, frame, values.force);
        }
        let estimates = self.estimators.next(&Reading {
            counts_large: frame.counts_large,
            counts_small: frame.counts_small,
            current: frame.current,
        });
        let mut row = values.all().to_vec();
        row.extend(estimates);
        self.batch.add(&row);
        if let Some(recorder) = &mut self.recorder {
            recorder.row(frame.seq, &row, values.true_omega);
            if recorder.is_full() {
                self.end_recording();
            }
        }
    }

    /// Sends the rows and the status that are due. `more` is what the source adds to the status.
    pub(crate) fn tell(&mut self, more: impl FnOnce() -> Value) {
        if let Some(bytes) = self.batch.due() {
            self.hub.tell(Event::Rows(bytes));
        }
        if self.told.elapsed() < STATUS {
            return;
        }
        self.told = Instant::now();
        let mode = self.last.and_then(|frame| Mode::from_code(frame.state));
        let cause = self.last.and_then(|frame| Stop::from_code(frame.cause));
        let recording = self.recorder.as_ref();
        let mut status = json!({
            "t": self.t,
            "mode": mode.map(Mode::as_str),
            "on": self.is_on(),
            "cause": cause.map(Stop::as_str),
            "words": cause.filter(|cause| *cause != Stop::None).map(|cause| sentence(cause.meaning())),
            "scene": self.selection.scene(),
            "tuned": self.tuned.json(),
            "refusal": self.refusals.json(),
            "recording": recording.map(Recorder::len),
            "recorded": self.hub.recording().is_some(),
            "fault": self.fault.as_ref().map(FaultWatch::json),
        });
        for more in [self.bench.json(), more()] {
            if let (Value::Object(status), Value::Object(more)) = (&mut status, more) {
                status.extend(more);
            }
        }
        self.hub.status(status);
    }
}

/// Ticks of a second.
fn hz(rate: f64) -> u32 {
    rate as u32
}

#[cfg(test)]
mod tests;
