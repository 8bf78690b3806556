use firmware_app::config::{AUTO_ARM, RATE_HZ};
use firmware_app::rest::Rest;
use firmware_app::telemetry::{DEPTH, Record};
use haptic_control::Mode;

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
