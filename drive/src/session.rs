//! A session: what a command does from the first message to the end.

use drivers::Command;
use drivers::link::{Frame, Message};
use haptic_control::{Mode, Request, SceneKind};
use terminal::failure::Failure;
use terminal::output::note;

use crate::board::{Answer, Board};
use crate::follow::follow;
use crate::interrupt;
use crate::record::Recorder;
use crate::refusal::UNVERIFIED;
use crate::settings;
use crate::timed::Change;
use crate::watch::state;

/// Earliest time at which a board is armed, ms of its time: current monitors of the amplifiers need it until
/// they are near zero.
const EARLIEST_MS: u32 = 10;

/// Parts of a session.
pub(crate) struct Plan {
    /// The scene to select.
    pub(crate) scene: Option<SceneKind>,
    /// Changes of parameters and estimators in order, each with its time from the begin of the scene, s.
    pub(crate) changes: Vec<(f64, Change)>,
    /// Length in the board's time, from the begin of the scene if there is one, s; `None`: until
    /// Ctrl-C.
    pub(crate) seconds: Option<f64>,
    /// Interval of the lines of text in the board's time, s; `None`: no lines.
    pub(crate) every: Option<f64>,
    /// The recording to make.
    pub(crate) recorder: Option<Recorder>,
    /// Whether standard output has the recording, so that the lines of text go to standard error.
    pub(crate) has_stdout: bool,
    /// Whether keep-alives are sent. Without them, the session sends no command.
    pub(crate) keeps_alive: bool,
}

impl Plan {
    /// Checks what can be checked before the board gets a command.
    ///
    /// # Errors
    /// [`Failure::Input`] if the recording has no place, or a change comes after the end.
    fn check(&self) -> Result<(), Failure> {
        self.recorder.as_ref().map_or(Ok(()), Recorder::check)?;
        let Some(end) = self.seconds else {
            return Ok(());
        };
        match self.changes.iter().find(|(at, _)| *at >= end) {
            Some((at, _)) => Err(Failure::Input(format!(
                "the change at {at} s comes after the end at {end} s; give a longer --seconds"
            ))),
            None => Ok(()),
        }
    }
}

/// Arms the board, renders a scene if the plan has one, and disarms at the end.
///
/// # Errors
/// [`Failure::Check`] if the board does not arm, refuses a change or stops; [`Failure::Input`] if the
/// connection is lost or the plan cannot be followed. A board that was armed is disarmed in every case.
pub(crate) fn armed(board: &mut Board, answer: &Answer, plan: Plan) -> Result<(), Failure> {
    plan.check()?;
    admits(board, plan.scene)?;
    interrupt::take();
    arm(board, answer, plan.scene)?;
    ended(board, answer, plan)
}

/// Checks that the board admits a scene: it refuses one in closed loop until its signs are verified, which it would tell
/// once it is armed.
fn admits(board: &mut Board, scene: Option<SceneKind>) -> Result<(), Failure> {
    match scene.filter(|scene| scene.is_closed_loop()) {
        Some(scene) if !settings::present(board)?.are_signs_verified() => Err(Failure::Check(
            format!("scene {scene}: the board refuses it: {UNVERIFIED}"),
        )),
        _ => Ok(()),
    }
}

/// Arms the board, renders a scene if the plan has one, and disarms at the end; without keep-alives in the
/// plan, only listens. Hands every message to `sink`.
///
/// # Errors
/// As [`armed`]; [`Failure::Check`] after an interrupt.
pub(crate) fn observed(
    board: &mut Board,
    answer: &Answer,
    plan: Plan,
    sink: &mut dyn FnMut(Message),
) -> Result<(), Failure> {
    interrupt::take();
    if plan.keeps_alive {
        let armed = arm(board, answer, plan.scene);
        let followed = armed.and_then(|()| follow(board, answer, plan, sink));
        // After an error too: what the caller does next may take its time.
        let disarmed = board.disarm();
        followed.and(disarmed.map(drop))?;
    } else {
        follow(board, answer, plan, sink)?;
    }
    if interrupt::came() {
        return Err(Failure::Check("interrupted".to_owned()));
    }
    Ok(())
}

/// Arms the board for a scene, if there is one, and waits until it is. A scene that another program has begun would run
/// on if the command for this one were lost: no frame tells which scene runs.
fn arm(board: &mut Board, answer: &Answer, scene: Option<SceneKind>) -> Result<(), Failure> {
    board.disarm_at_the_end();
    // A board that starts with this connection is younger.
    let earliest = answer.hello.rate / 1000 * EARLIEST_MS;
    let refusal = |frame: &Frame| format!("not armed: it starts again and again, {}", state(frame));
    let is_due = |frame: &Frame| frame.tick >= earliest || interrupt::came();
    let frame = board.wait(answer.hello.rate, is_due, refusal)?;
    if interrupt::came() {
        return Ok(());
    }
    if scene.is_some() && Mode::from_code(frame.state) == Some(Mode::Running) {
        board.disarm()?;
        board.disarm_at_the_end();
    }
    board.send(Command::Request(Request::Arm))?;
    board.wait(
        answer.hello.rate,
        |frame| is_ready(Mode::from_code(frame.state)) || interrupt::came(),
        |frame| {
            format!(
                "not armed: {}; remove the cause, then run again",
                state(frame)
            )
        },
    )?;
    Ok(())
}

/// Keeps a board alive that is enabled already, and disarms it at the end.
///
/// # Errors
/// As [`armed`]; [`Failure::Check`] if the amplifiers are not enabled.
pub(crate) fn kept_alive(board: &mut Board, answer: &Answer, plan: Plan) -> Result<(), Failure> {
    plan.check()?;
    interrupt::take();
    enabled(board, answer)?;
    board.disarm_at_the_end();
    ended(board, answer, plan)
}

/// Checks that the amplifiers of a board are enabled. A board that settles is armed by itself.
fn enabled(board: &mut Board, answer: &Answer) -> Result<(), Failure> {
    let refusal = |frame: &Frame| {
        let state = state(frame);
        format!("nothing to keep alive: {state}; cargo drive arm arms the board")
    };
    let is_settled = |frame: &Frame| Mode::from_code(frame.state) != Some(Mode::Settling);
    let frame = board.wait(answer.hello.rate, is_settled, refusal)?;
    match is_ready(Mode::from_code(frame.state)) {
        true => Ok(()),
        false => Err(Failure::Check(refusal(&frame))),
    }
}

/// Follows the plan, disarms the board and writes the recording.
fn ended(board: &mut Board, answer: &Answer, mut plan: Plan) -> Result<(), Failure> {
    let mut recorder = plan.recorder.take();
    let followed = follow(board, answer, plan, &mut sink(&mut recorder)).and_then(|()| {
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
    plan.check()?;
    interrupt::take();
    let mut recorder = plan.recorder.take();
    let followed = follow(board, answer, plan, &mut sink(&mut recorder));
    written(followed, recorder)
}

/// Hands messages to the recorder, if there is one.
fn sink(recorder: &mut Option<Recorder>) -> impl FnMut(Message) {
    move |message| {
        if let Some(recorder) = recorder {
            recorder.take(message);
        }
    }
}

/// Writes the recording, after an error too: the time before a stop tells its reason. The error of the
/// session comes before that of the file.
fn written(followed: Result<(), Failure>, recorder: Option<Recorder>) -> Result<(), Failure> {
    let written = recorder.map_or(Ok(()), Recorder::write);
    followed.and(written)
}

/// Whether a scene can be selected or runs.
pub(crate) fn is_ready(mode: Option<Mode>) -> bool {
    matches!(mode, Some(Mode::Armed | Mode::Running))
}

#[cfg(test)]
mod tests {
    use std::path::PathBuf;

    use super::*;
    use crate::board::tests::{answer, sent};
    use crate::strokes::plan;
    use crate::watch::tests::FRAME;

    fn recorder(out: PathBuf) -> Option<Recorder> {
        Some(Recorder::new(&answer().hello, out))
    }

    /// What comes is lost otherwise.
    #[test]
    fn recording_without_a_place_is_refused_before_its_session_begins() {
        for session in [armed, kept_alive, unarmed] {
            let (mut board, end) = sent(&[]);
            drop(end);
            let plan = Plan {
                recorder: recorder(env!("CARGO_MANIFEST_DIR").into()),
                ..plan(None, true, 1.0)
            };
            let error = session(&mut board, &answer(), plan).unwrap_err();
            assert!(error.to_string().contains("is a folder"), "{error}");
        }
    }

    #[test]
    fn error_of_the_session_comes_before_that_of_its_file() {
        let stopped = Err(Failure::Check("stopped".to_owned()));
        let folder = tempfile::tempdir().unwrap();
        // No frame came, which is an error of the file.
        let recorder = || recorder(folder.path().join("run.csv"));
        assert_eq!(written(stopped.clone(), recorder()), stopped);
        assert!(written(Ok(()), recorder()).is_err());
    }

    #[test]
    fn board_that_settles_is_not_refused() {
        let enabled_after = |states: &[Mode]| {
            let frames = states.iter().map(|state| {
                let state = *state as u8;
                Frame { state, ..FRAME }.into()
            });
            let (mut board, _end) = sent(&frames.collect::<Vec<_>>());
            enabled(&mut board, &answer())
        };
        for last in [Mode::Armed, Mode::Running] {
            assert_eq!(enabled_after(&[Mode::Settling, last]), Ok(()));
        }
        for last in [Mode::Boot, Mode::Safe] {
            let error = enabled_after(&[Mode::Settling, last]).unwrap_err();
            let said = error.to_string();
            assert!(said.starts_with("nothing to keep alive: "), "{said}");
        }
    }
}
