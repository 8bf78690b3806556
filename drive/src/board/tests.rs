//! Tests of waits and sessions.

use std::sync::mpsc::channel;
use std::thread::sleep;

use drivers::link::LONGEST;

use super::*;
use crate::follow::follow;
use crate::port::PipeEnd;
use crate::refusal::UNVERIFIED;
use crate::strokes::plan;
use crate::watch::tests::FRAME;

/// A board of little patience, and its end of the line, which has sent these messages, each for itself.
pub(crate) fn sent(messages: &[Message]) -> (Board, PipeEnd) {
    let (port, end) = Port::pipe("board");
    for message in messages {
        let mut buffer = [0; LONGEST];
        let bytes = message.encode(&mut buffer).unwrap().to_vec();
        end.to.send(bytes).unwrap();
    }
    (Board::new(port, Duration::from_millis(50)), end)
}

/// A session ends before by what a test does.
const LONG: f64 = 3600.0;

/// No command has been rejected before the session.
pub(crate) fn answer() -> Answer {
    Answer {
        hello: Hello {
            rate: 10_000,
            ..Hello::default()
        },
        rejected: Some(Rejected::default()),
    }
}

#[test]
fn answer_that_comes_while_the_process_stands_still_is_taken() {
    let messages = [FRAME.into(), FRAME.into(), Hello::default().into()];
    let (mut board, _end) = sent(&messages);
    let answer = board.ask(Command::Identify, |message| match message {
        Message::Hello(hello) => Some(hello),
        _ => {
            sleep(Duration::from_millis(200));
            None
        }
    });
    assert_eq!(answer.unwrap(), Some(Hello::default()));
}

#[test]
fn frame_that_comes_while_the_process_stands_still_ends_a_wait() {
    let (mut board, _end) = sent(&[Rejected::default().into(), FRAME.into()]);
    // The end of the wait has passed at its begin.
    board.patience = Duration::ZERO;
    let frame = board.wait(10_000, |_| true, |_| String::new());
    assert_eq!(frame.unwrap(), FRAME);
}

#[test]
fn frame_that_comes_behind_other_bytes_while_the_process_stands_still_ends_no_session() {
    let (mut board, end) = sent(&[]);
    board.patience = Duration::ZERO;
    let mut buffer = [0; LONGEST];
    let frame = Message::from(FRAME).encode(&mut buffer).unwrap().to_vec();
    end.to.send(vec![0; READ]).unwrap();
    end.to.send(frame).unwrap();
    drop(end);
    let mut came = Vec::new();
    let plan = plan(None, false, LONG);
    let mut sink = |message| came.push(message);
    let ended = follow(&mut board, &answer(), plan, &mut sink);
    assert_eq!(came, [FRAME.into()]);
    let lost = ended.unwrap_err().to_string();
    assert!(lost.contains("connection lost"), "{lost}");
}

#[test]
fn wait_ends_where_nothing_comes_or_no_end() {
    let (mut board, _end) = sent(&[]);
    assert!(board.wait(10_000, |_| true, |_| String::new()).is_err());
    let now = Instant::now();
    assert!(!board.is_over(now), "what has come since is not read");
    assert_eq!(board.next(now).unwrap(), None);
    for (behind, ends) in [(0, true), (READ, false), (MOST_BEHIND + READ, true)] {
        board.behind = behind;
        assert_eq!(board.is_over(now), ends);
    }
}

/// The frames tell whether it was selected. A scene that is selected twice begins twice.
#[test]
fn scene_is_selected_once_though_bytes_that_are_no_command_come() {
    let noise = Rejected {
        garbage: 1,
        ..Rejected::default()
    };
    let (mut board, PipeEnd { to, from }) = sent(&[Hello::default().into(), noise.into()]);
    drop(to);
    let plan = plan(Some(SceneKind::Wall), true, LONG);
    assert!(follow(&mut board, &answer(), plan, &mut |_| ()).is_err());
    let select = encode(Command::Request(Request::Select(SceneKind::Wall.number())));
    assert_eq!(from.try_iter().filter(|it| *it == select).count(), 1);
}

/// A program that shows the lines itself has no terminal.
#[test]
fn listener_gets_results_and_notes_in_their_order() {
    let (mut board, _end) = sent(&[]);
    let (to, heard) = channel();
    board.speak_to(Box::new(move |line| to.send(line).unwrap()));
    board.note("leave the handle free");
    board.print("pass  at rest").unwrap();
    let lines: Vec<_> = heard.try_iter().collect();
    assert_eq!(lines, ["leave the handle free", "pass  at rest"]);
}

/// Its frames do not tell the start where none came before.
#[test]
fn start_that_the_counts_tell_ends_a_change() {
    let earlier = Rejected {
        unknown: 1,
        ..Rejected::default()
    };
    let hello = Hello {
        protocol: PROTOCOL,
        ..Hello::default()
    };
    let answers = [earlier, Rejected::default()].map(|counts| [hello.into(), counts.into()]);
    let (mut board, _end) = sent(&answers.concat());
    let said = board
        .change(Command::Estimator(1), "estimator")
        .unwrap_err();
    let begin = "estimator: the board has started again; find the cause of the reset";
    assert!(said.to_string().starts_with(begin), "{said}");
}

/// Counts that come without an identity are no answer to a question, before the first answer and after it.
#[test]
fn refused_scene_is_named_after_counts_without_a_question() {
    let none = Rejected::default();
    let now = Rejected {
        unverified: 1,
        ..none
    };
    let identity = Message::from(Hello::default());
    let messages = [
        none.into(),
        identity,
        none.into(),
        none.into(),
        identity,
        now.into(),
    ];
    let (mut board, PipeEnd { to, from: _from }) = sent(&messages);
    drop(to);
    // A question from before the session.
    board.send(Command::Identify).unwrap();
    let plan = plan(Some(SceneKind::Wall), true, LONG);
    let ended = follow(&mut board, &answer(), plan, &mut |_| ());
    let said = format!("scene wall: the board refuses it: {UNVERIFIED}");
    assert_eq!(ended, Err(Failure::Check(said)));
}

#[test]
fn refusal_without_a_question_ends_a_session_that_sends_commands_alone() {
    for (keeps_alive, said) in [(true, UNVERIFIED), (false, "connection lost")] {
        let now = Rejected {
            unverified: 1,
            ..Rejected::default()
        };
        let (mut board, PipeEnd { to, from: _from }) = sent(&[now.into()]);
        drop(to);
        let plan = plan(None, keeps_alive, LONG);
        let ended = follow(&mut board, &answer(), plan, &mut |_| ());
        let error = ended.unwrap_err().to_string();
        assert!(error.contains(said), "{error}");
    }
}
