//! Tests of waits.

use std::thread::sleep;

use drivers::link::LONGEST;

use super::*;
use crate::follow::follow;
use crate::port::PipeEnd;
use crate::session::Plan;
use crate::watch::tests::FRAME;

/// A board of little patience, and its end of the line, which has sent these messages, each for itself.
fn sent(messages: &[Message]) -> (Board, PipeEnd) {
    let (port, end) = Port::pipe("board");
    for message in messages {
        let mut buffer = [0; LONGEST];
        let bytes = message.encode(&mut buffer).unwrap().to_vec();
        end.to.send(bytes).unwrap();
    }
    (Board::new(port, Duration::from_millis(50)), end)
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
    let answer = Answer {
        hello: Hello::default(),
        rejected: None,
    };
    let plan = Plan {
        scene: None,
        changes: Vec::new(),
        seconds: None,
        every: None,
        recorder: None,
        has_stdout: false,
        keeps_alive: false,
    };
    let mut came = Vec::new();
    let ended = follow(&mut board, &answer, plan, &mut |message| came.push(message));
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
