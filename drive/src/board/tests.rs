//! Tests of waits.

use std::thread::sleep;

use drivers::link::LONGEST;

use super::*;
use crate::port::PipeEnd;
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
fn wait_ends_where_nothing_comes_or_no_end() {
    let (mut board, _end) = sent(&[]);
    assert!(board.wait(10_000, |_| true, |_| String::new()).is_err());
    let now = Instant::now();
    for (behind, ends) in [(0, true), (READ, false), (MOST_BEHIND + READ, true)] {
        board.behind = behind;
        assert_eq!(board.is_over(now), ends);
    }
}
