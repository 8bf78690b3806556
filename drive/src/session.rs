//! A session: what a command does from the first message to the end.

use std::time::{Duration, Instant};

use drivers::Command;
use drivers::link::{Frame, Message};
use haptic_control::{Mode, Request, SceneKind};
use terminal::failure::Failure;
use terminal::output::{note, print_bytes};

use crate::board::{Answer, Board, refusal};
use crate::interrupt;
use crate::pace::Pace;
use crate::record::Recorder;
use crate::timed::Change;
use crate::watch::{Every, line, state};

/// Longest silence of a board that sends a thousand frames a second.
const SILENCE: Duration = Duration::from_secs(1);

/// Parts of a session.
pub(crate) struct Plan {
    /// The scene to select.
    pub(crate) scene: Option<SceneKind>,
    /// Changes of parameters and estimators, each with its time, s.
    pub(crate) changes: Vec<(f64, Change)>,
    /// Length in the board's time, s; `None`: until Ctrl-C.
    pub(crate) seconds: Option<f64>,
    /// Interval of the lines of text in the board's time, s; `None`: no lines.
    pub(crate) every: Option<f64>,
    /// The recording to make.
    pub(crate) recorder: Option<Recorder>,
    /// Whether keep-alives are sent.
    pub(crate) keeps_alive: bool,
}

/// Arms the board, renders a scene if the plan has one, and disarms at the end.
///
/// # Errors
/// [`Failure::Check`] if the board does not arm, refuses a change or stops; [`Failure::Input`] if the
/// connection is lost. The board is disarmed in every case.
pub(crate) fn armed(board: &mut Board, answer: &Answer, plan: Plan) -> Result<(), Failure> {
    interrupt::take();
    board.disarm_at_the_end();
    board.send(Command::Request(Request::Arm))?;
    board.wait(
        |frame| is_ready(Mode::from_code(frame.state)),
        |frame| {
            format!(
                "not armed: {}; remove the cause, then run again",
                state(frame)
            )
        },
    )?;
    ended(board, answer, plan)
}

/// Keeps a board alive that is enabled already, and disarms it at the end.
///
/// # Errors
/// As [`armed`]; [`Failure::Check`] if the amplifiers are not enabled.
pub(crate) fn kept_alive(board: &mut Board, answer: &Answer, plan: Plan) -> Result<(), Failure> {
    interrupt::take();
    board.wait(
        |frame| is_ready(Mode::from_code(frame.state)),
        |frame| {
            format!(
                "nothing to keep alive: {}; cargo drive arm arms the board",
                state(frame)
            )
        },
    )?;
    board.disarm_at_the_end();
    ended(board, answer, plan)
}

/// Follows the plan, disarms the board and writes the recording.
fn ended(board: &mut Board, answer: &Answer, mut plan: Plan) -> Result<(), Failure> {
    let mut recorder = plan.recorder.take();
    let followed = follow(board, answer, plan, recorder.as_mut()).and_then(|()| {
        let frame = board.disarm()?;
        note(format_args!("disarmed: {}", state(&frame)));
        Ok(())
    });
    written(followed, recorder)
}

/// Shows and records what a board sends, without a request for its amplifiers.
///
/// # Errors
/// [`Failure::Input`] if the connection is lost or the recording cannot be written.
pub(crate) fn unarmed(board: &mut Board, answer: &Answer, mut plan: Plan) -> Result<(), Failure> {
    interrupt::take();
    let mut recorder = plan.recorder.take();
    let followed = follow(board, answer, plan, recorder.as_mut());
    written(followed, recorder)
}

/// Writes the recording, after an error too: the time before a stop tells its reason. The error of the
/// session comes before that of the file.
fn written(followed: Result<(), Failure>, recorder: Option<Recorder>) -> Result<(), Failure> {
    let written = recorder.map_or(Ok(()), Recorder::write);
    followed.and(written)
}

fn is_ready(mode: Option<Mode>) -> bool {
    matches!(mode, Some(Mode::Armed | Mode::Running))
}

/// Follows the plan to its end, and hands what comes to the recorder.
fn follow(
    board: &mut Board,
    Answer { hello, rejected }: &Answer,
    plan: Plan,
    mut recorder: Option<&mut Recorder>,
) -> Result<(), Failure> {
    let Plan {
        scene,
        mut changes,
        seconds,
        every,
        recorder: _,
        keeps_alive,
    } = plan;
    if let Some(scene) = scene {
        board.send(Command::Request(Request::Select(scene.number())))?;
    }
    // The next one last.
    changes.sort_by(|(a, _), (b, _)| b.total_cmp(a));
    let mut every = every.map(|seconds| Every::new(seconds, hello.rate));
    let mut pace = Pace::new(hello.rate, Instant::now());
    let mut clock = Clock::new(hello.rate);
    let (mut heard, mut mode, mut tick) = (Instant::now(), None, None);
    while !interrupt::came() {
        let now = Instant::now();
        if keeps_alive && pace.is_due(now, tick) {
            board.send(Command::Request(Request::KeepAlive))?;
        }
        if now.duration_since(heard) > SILENCE {
            return Err(board.silent());
        }
        let Some(message) = board.next(pace.next().min(heard + SILENCE))? else {
            continue;
        };
        if let Some(recorder) = &mut recorder {
            recorder.take(message);
        }
        if let (Message::Rejected(now), Some(before)) = (message, rejected)
            && let Some(reason) = refusal(before, &now)
        {
            return Err(Failure::Check(format!(
                "the board refuses a command: {reason}"
            )));
        }
        let Message::Frame(frame) = message else {
            continue;
        };
        (heard, tick) = (Instant::now(), Some(frame.tick));
        if keeps_alive {
            stopped(mode, &frame)?;
        }
        mode = Mode::from_code(frame.state);
        if every.as_mut().is_some_and(|every| every.selects(&frame)) {
            print_bytes(format!("{}\n", line(&frame, hello.rate)).as_bytes())?;
        }
        let elapsed = clock.elapsed(frame.tick);
        while let Some((_, change)) = changes.pop_if(|(at, _)| *at <= elapsed) {
            board.send(change.command())?;
            // The answer has the counts of refused commands.
            board.send(Command::Identify)?;
        }
        if seconds.is_some_and(|seconds| elapsed >= seconds) {
            break;
        }
    }
    Ok(())
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

/// Time of a board since the first frame. The tick of a board that starts again begins at 0.
struct Clock {
    rate_hz: f64,
    last: Option<u32>,
    ticks: u64,
}

impl Clock {
    fn new(rate_hz: u32) -> Self {
        Self {
            rate_hz: f64::from(rate_hz.max(1)),
            last: None,
            ticks: 0,
        }
    }

    /// Seconds from the first frame to this tick.
    fn elapsed(&mut self, tick: u32) -> f64 {
        let step = self.last.map_or(0, |last| tick.wrapping_sub(last));
        self.last = Some(tick);
        // A step back is a start.
        if i32::try_from(step).is_ok() {
            self.ticks += u64::from(step);
        }
        self.ticks as f64 / self.rate_hz
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn time_continues_over_a_wrap_and_a_start() {
        let mut clock = Clock::new(1000);
        let times = [u32::MAX - 9, u32::MAX, 990, 0, 1000].map(|tick| clock.elapsed(tick));
        assert_eq!(times, [0.0, 0.009, 1.0, 1.0, 2.0]);
    }
}
