use drivers::{Command, Settings, encode};
use firmware_app::commands::{Channel, Commands, Messages, WAITING};
use firmware_app::config::{AUTO_ARM, DECIMATION, RATE_HZ};
use firmware_app::rest::Rest;
use firmware_app::telemetry::{DEPTH, Record};
use haptic_control::{Mode, Request};

use crate::bench::Bench;

/// A record of a mode, half a second after the start.
fn record(mode: Mode) -> Record {
    Record {
        state: mode,
        tick: RATE_HZ / 2,
        ..Bench::new().record()
    }
}

#[test]
fn amplifiers_are_certainly_off_after_more_frames_than_the_queue_holds() {
    for last in [Mode::Settling, Mode::Armed, Mode::Running] {
        let mut rest = Rest::default();
        for mode in [Mode::Boot, Mode::Safe] {
            rest.frame(&record(last));
            let frames = (1..1000).find(|_| {
                rest.frame(&record(mode));
                rest.is_certain()
            });
            assert!(frames.is_some_and(|frames| frames > DEPTH), "{frames:?}");
        }
        rest.arms();
        assert!(!rest.is_certain());
        // The frames that waited in the queue are of before the request.
        for _ in 0..=DEPTH {
            rest.frame(&record(Mode::Boot));
            assert!(!rest.is_certain());
        }
    }
}

/// The request is the last of as many messages as can wait, and as many frames as can wait are of before it.
#[test]
fn request_that_waits_behind_others_is_not_taken_for_a_refused_one() {
    if AUTO_ARM {
        // Its control is armed already.
        return;
    }
    let mut queue = Messages::new();
    let (producer, mut waiting) = queue.split();
    let mut commands = Commands::new(producer, Settings::COMMISSIONED);
    for first in 0..DECIMATION {
        let mut bench = Bench::new();
        bench.wait(RATE_HZ / 4 + first);
        let mut rest = Rest::default();
        for _ in 0..RATE_HZ {
            rest.frame(&record(Mode::Boot));
        }
        for k in 0..WAITING {
            let last = k + 1 == WAITING;
            let request = if last {
                Request::Arm
            } else {
                Request::KeepAlive
            };
            let mut bytes = encode(Command::Request(request)).into_iter();
            commands.receive(Channel::Port, || bytes.next());
        }
        assert!(commands.take_arms());
        rest.arms();
        for _ in 0..DEPTH - 1 {
            rest.frame(&record(Mode::Boot));
        }
        while bench.record().state == Mode::Boot {
            if let Some(record) = bench.step_with(&mut waiting) {
                rest.frame(&record);
            }
            assert!(!rest.is_certain(), "{first}");
        }
    }
}

#[test]
fn image_that_arms_by_itself_is_not_at_rest_before_it_has() {
    let mut rest = Rest::default();
    for tick in (0..RATE_HZ / 10).step_by(10) {
        rest.frame(&Record {
            tick,
            ..record(Mode::Boot)
        });
    }
    assert_eq!(rest.is_certain(), !AUTO_ARM);
}
