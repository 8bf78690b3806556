//! Observations of a board: at rest, and in the strokes with which the scene `excite` begins.

use drivers::link::{Frame, Index, Measured, Message};
use haptic_control::{Excite, SceneKind};
use terminal::failure::Failure;

use crate::board::{Answer, Board};
use crate::session::{self, Plan};

/// Time of the strokes that is observed, in which a free handle stays near its start, s.
const SECONDS: f64 = 3.8;
/// What follows the strokes is for a clamped handle.
const _: () = assert!(SECONDS < Excite::STROKES_SECONDS && Excite::STROKES_SECONDS < SECONDS + 0.1);

/// What a board sent.
#[derive(Clone, Debug, Default)]
pub(crate) struct Seen {
    pub(crate) frames: Vec<Frame>,
    pub(crate) measured: Vec<Measured>,
    pub(crate) indices: Vec<Index>,
    /// Voltages of the supply, V.
    pub(crate) supply: Vec<f32>,
}

impl Seen {
    /// The longest run of frames without a lost one.
    pub(crate) fn longest_run(&self) -> &[Frame] {
        let runs = self.frames.chunk_by(|a, b| b.seq == a.seq.wrapping_add(1));
        runs.max_by_key(|run| run.len()).unwrap_or_default()
    }
}

/// Asks to leave the handle free.
pub(crate) fn announce(board: &mut Board) {
    board.note(format_args!(
        "leave the handle free and do not touch it: the motors move it for {SECONDS} s, by 2 rad at most"
    ));
}

/// The plan of the strokes.
pub(crate) fn strokes() -> Plan {
    plan(Some(SceneKind::Excite), true, SECONDS)
}

/// A plan without changes and output.
pub(crate) fn plan(scene: Option<SceneKind>, keeps_alive: bool, seconds: f64) -> Plan {
    Plan {
        scene,
        changes: Vec::new(),
        seconds: Some(seconds),
        every: None,
        recorder: None,
        has_stdout: false,
        keeps_alive,
    }
}

/// What a board sends while a plan is followed.
///
/// # Errors
/// As [`session::observed`].
pub(crate) fn observe(board: &mut Board, answer: &Answer, plan: Plan) -> Result<Seen, Failure> {
    let mut seen = Seen::default();
    watch(board, answer, plan, &mut seen)?;
    Ok(seen)
}

/// Adds what a board sends while a plan is followed, also until it fails.
///
/// # Errors
/// As [`session::observed`].
pub(crate) fn watch(
    board: &mut Board,
    answer: &Answer,
    plan: Plan,
    seen: &mut Seen,
) -> Result<(), Failure> {
    session::observed(board, answer, plan, &mut |message| match message {
        Message::Frame(frame) => seen.frames.push(frame),
        Message::Measured(measured) => seen.measured.push(measured),
        Message::Index(index) => seen.indices.push(index),
        Message::Supply(supply) => seen.supply.push(supply.volts),
        _ => {}
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::watch::tests::FRAME;

    #[test]
    fn longest_run_without_a_lost_frame_is_used() {
        let numbers = [5, 6, 9, 10, 11, u32::MAX, 0];
        let seen = Seen {
            frames: numbers.map(|seq| Frame { seq, ..FRAME }).into(),
            ..Seen::default()
        };
        let run: Vec<_> = seen.longest_run().iter().map(|frame| frame.seq).collect();
        assert_eq!(run, [9, 10, 11]);
        assert!(Seen::default().longest_run().is_empty());
    }
}
