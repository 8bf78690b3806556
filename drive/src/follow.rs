//! A plan that is followed: keep-alives, changes at their times, and what the board sends.

use std::mem;
use std::ops::ControlFlow;
use std::time::Instant;

use drivers::Command;
use drivers::link::{Frame, Hello, Message, Rejected};
use haptic_control::{Mode, Request, SceneKind};
use terminal::failure::Failure;
use terminal::output::{note, print_to_reader};

use crate::board::{Answer, Board};
use crate::clock::{Clock, Limit};
use crate::interrupt;
use crate::pace::Pace;
use crate::refusal::NOISE;
use crate::sent::{ATTEMPTS, Order, Sent};
use crate::session::{Plan, is_ready};
use crate::timed::Change;
use crate::watch::{Every, line, state};

/// Follows the plan to its end, and hands what comes to `sink`.
///
/// # Errors
/// [`Failure::Check`] if the board refuses a change or stops, [`Failure::Input`] if the connection is lost.
pub(crate) fn follow(
    board: &mut Board,
    answer: &Answer,
    plan: Plan,
    sink: &mut dyn FnMut(Message),
) -> Result<(), Failure> {
    let mut course = Course::begin(board, answer, plan)?;
    while !interrupt::came() {
        course.due(board)?;
        let patience = board.patience();
        let until = course.pace.next().min(course.heard + patience);
        let Some(message) = board.next(until)? else {
            if board.is_over(course.heard + patience) {
                return Err(board.silent());
            }
            continue;
        };
        sink(message);
        if course.message(board, message)?.is_break() {
            break;
        }
    }
    course.leave(board);
    Ok(())
}

/// The course of a plan.
struct Course {
    hello: Hello,
    /// Changes that are not sent yet, the next one last.
    changes: Vec<(f64, Change)>,
    seconds: Option<f64>,
    every: Option<Every>,
    has_stdout: bool,
    keeps_alive: bool,
    sent: Sent,
    /// Whether the scene has still to start, and the longest time until it does.
    starts: bool,
    limit: Limit,
    pace: Pace,
    /// Time since the begin of the scene.
    clock: Clock,
    /// When the latest frame came, its state and its tick.
    heard: Instant,
    mode: Option<Mode>,
    tick: Option<u32>,
    /// Voltage of the supply, V. It comes after its frame: a line has that of the frame before.
    supply: Option<f32>,
    /// Whether the latest message was an identity.
    is_identity: bool,
}

impl Course {
    /// Begins a plan: selects its scene.
    fn begin(board: &mut Board, answer: &Answer, plan: Plan) -> Result<Self, Failure> {
        let Answer { hello, rejected } = answer;
        let Plan {
            scene,
            mut changes,
            seconds,
            every,
            recorder: _,
            has_stdout,
            keeps_alive,
        } = plan;
        changes.reverse();
        let (now, patience) = (Instant::now(), board.patience());
        let mut course = Self {
            hello: *hello,
            changes,
            seconds,
            every: every.map(|seconds| Every::new(seconds, hello.rate)),
            has_stdout,
            keeps_alive,
            sent: Sent::new(*rejected, scene, board.asked(), patience, now),
            starts: scene.is_some_and(|scene| scene != SceneKind::Off),
            limit: Limit::new(patience, hello.rate, now),
            pace: Pace::new(hello.rate, now),
            clock: Clock::new(hello.rate),
            heard: now,
            mode: None,
            tick: None,
            supply: None,
            is_identity: false,
        };
        if let Some(scene) = scene.filter(|_| !interrupt::came()) {
            let select = Command::Request(Request::Select(scene.number()));
            course.order(board, format!("scene {scene}"), select, 1)?;
        }
        Ok(course)
    }

    /// Sends what is due: a keep-alive, and a question for the counts of what the board rejected.
    fn due(&mut self, board: &mut Board) -> Result<(), Failure> {
        if self.keeps_alive && self.pace.is_due(Instant::now(), self.tick) {
            board.send(Command::Request(Request::KeepAlive))?;
        }
        if self.sent.asks(Instant::now()) {
            board.send(Command::Identify)?;
        }
        Ok(())
    }

    /// Takes a message; whether the plan goes on.
    fn message(&mut self, board: &mut Board, message: Message) -> Result<ControlFlow<()>, Failure> {
        // The counts after an identity are those of its answer.
        let is_identity = matches!(message, Message::Hello(_));
        let is_answer = mem::replace(&mut self.is_identity, is_identity);
        match message {
            Message::Rejected(now) if self.keeps_alive && is_answer => self.again(board, &now)?,
            Message::Rejected(now) if self.keeps_alive => self.sent.report(&now)?,
            Message::Supply(now) => self.supply = Some(now.volts),
            Message::Frame(frame) => return self.frame(board, &frame),
            _ => {}
        }
        Ok(ControlFlow::Continue(()))
    }

    /// Takes a frame: shows its line and sends the changes that are due; whether the plan goes on.
    fn frame(&mut self, board: &mut Board, frame: &Frame) -> Result<ControlFlow<()>, Failure> {
        (self.heard, self.tick) = (Instant::now(), Some(frame.tick));
        if self.keeps_alive {
            stopped(self.mode, frame)?;
        }
        self.mode = Mode::from_code(frame.state);
        if self
            .every
            .as_mut()
            .is_some_and(|every| every.selects(frame))
        {
            let text = line(frame, self.supply, &self.hello);
            if !is_read(&text, self.has_stdout)? {
                note("nobody reads the lines any more: the session ends");
                return Ok(ControlFlow::Break(()));
            }
        }
        // The select command takes its time, and may be lost.
        self.starts &= self.mode != Some(Mode::Running);
        if self.starts && self.limit.is_over(self.heard, frame.tick) {
            let state = state(frame);
            return Err(Failure::Check(format!(
                "the scene does not start: {state}; check the line, then run again"
            )));
        }
        if self.starts {
            return Ok(ControlFlow::Continue(()));
        }
        let elapsed = self.clock.elapsed(frame.tick);
        while let Some((_, change)) = self.changes.pop_if(|(at, _)| *at <= elapsed) {
            self.order(board, change.to_string(), change.command(), 1)?;
        }
        Ok(match self.seconds.is_some_and(|end| elapsed >= end) {
            true => ControlFlow::Break(()),
            false => ControlFlow::Continue(()),
        })
    }

    /// Tells which changes have no answer at the end.
    fn leave(&self, board: &mut Board) {
        let is_change = |order: &&Order| !matches!(order.command, Command::Request(_));
        for Order { name, .. } in self.sent.orders().filter(is_change) {
            board.note(format_args!(
                "{name}: the session ended before the board told whether it took it; give a longer --seconds"
            ));
        }
    }

    /// Sends a command for the first or a later time. A question follows it.
    fn order(
        &mut self,
        board: &mut Board,
        name: String,
        command: Command,
        times: u32,
    ) -> Result<(), Failure> {
        board.send(command)?;
        self.sent.add(Order {
            name,
            command,
            times,
        });
        Ok(())
    }

    /// Takes the counts of an answer, and sends commands again that may have been damaged. The frames tell whether a
    /// scene was selected.
    ///
    /// # Errors
    /// [`Failure::Check`] if the board has refused a command, [`Failure::Input`] if the connection is lost.
    fn again(&mut self, board: &mut Board, now: &Rejected) -> Result<(), Failure> {
        for Order {
            name,
            command,
            times,
        } in self.sent.answer(now)?
        {
            if let Command::Request(_) = command {
                continue;
            }
            if times >= ATTEMPTS {
                board.note(format_args!(
                    "{name}: sent {times} times, and each time bytes that are no command reached the board; {NOISE}"
                ));
                continue;
            }
            self.order(board, name, command, times + 1)?;
        }
        Ok(())
    }
}

/// Shows a line of text: beside a recording on standard output, as a note. Whether somebody reads on.
fn is_read(text: &str, has_stdout: bool) -> Result<bool, Failure> {
    if has_stdout {
        note(text);
        return Ok(true);
    }
    print_to_reader(format!("{text}\n").as_bytes())
}

/// Whether the board has stopped by itself since the frame before.
///
/// # Errors
/// [`Failure::Check`] with state and cause.
fn stopped(before: Option<Mode>, frame: &Frame) -> Result<(), Failure> {
    let now = Mode::from_code(frame.state);
    let ended = before == Some(Mode::Running) && now == Some(Mode::Armed);
    if is_ready(now) && !ended {
        return Ok(());
    }
    Err(Failure::Check(format!(
        "the board stopped: {}; remove the cause, then run again",
        state(frame)
    )))
}

#[cfg(test)]
mod tests {
    use std::time::Duration;

    use drivers::encode;

    use super::*;
    use crate::board::tests::{answer, sent};
    use crate::strokes::plan;
    use crate::watch::tests::FRAME;

    /// A session may last longer than the board may be silent.
    #[test]
    fn silence_begins_with_the_latest_frame() {
        let (mut board, _end) = sent(&[]);
        let plan = plan(None, false, 3600.0);
        let mut course = Course::begin(&mut board, &answer(), plan).unwrap();
        let earlier = course.heard.checked_sub(Duration::from_secs(1));
        course.heard = earlier.expect("a clock that has run for a second");
        let before = Instant::now();
        assert!(course.frame(&mut board, &FRAME).unwrap().is_continue());
        assert!(course.heard >= before);
    }

    #[test]
    fn change_at_the_begin_is_sent_with_the_first_frame() {
        let (mut board, end) = sent(&[]);
        let plan = Plan {
            changes: vec![(0.0, Change::Estimator(1)), (0.1, Change::Estimator(0))],
            ..plan(None, true, 3600.0)
        };
        let mut course = Course::begin(&mut board, &answer(), plan).unwrap();
        let armed = Frame {
            state: Mode::Armed as u8,
            ..FRAME
        };
        assert!(course.frame(&mut board, &armed).unwrap().is_continue());
        let came: Vec<_> = end.from.try_iter().collect();
        assert_eq!(came, [encode(Command::Estimator(1))]);
    }
}
