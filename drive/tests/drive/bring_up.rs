//! Bring-up of the emulated board, whole and with faults.

use drivers::{Setting, Settings};
use experiments::closed_loop::Hand;
use haptic_control::Mode;
use simulation::device::Device;
use virtual_board::fault::Fault;
use virtual_board::run::Setup;

use crate::emulated::{EmulatedBoard, blank, said, state_now};

#[test]
fn bring_up_passes_on_a_new_board_and_permits_closed_loop() {
    let (address, board) = EmulatedBoard::start(blank(None));
    let free_air = ["select", "free-air", "--seconds", "0.1"];
    assert_eq!(said(address, &free_air).1, Some(1));
    let (text, status) = said(address, &["bring-up", "--store"]);
    assert_eq!(status, Some(0), "{text}");
    assert!(
        text.lines().count() == 6 && !text.contains("FAIL"),
        "{text}"
    );
    // The emulated device is that of the file; the estimate is good to a tenth.
    for ratio in text
        .lines()
        .filter_map(|line| line.split_once(" of the device file"))
    {
        let ratio: f64 = ratio.0.rsplit(' ').next().unwrap().parse().unwrap();
        assert!((ratio - 1.0).abs() < 0.1, "{text}");
    }
    assert_eq!(said(address, &free_air).1, Some(0));
    let (text, _) = said(address, &["settings"]);
    assert!(text.contains("signs-verified  1 "), "{text}");
    let mut stored = Settings::DEFAULT;
    assert!(stored.set(Setting::SignsVerified, 1.0));
    assert_eq!(board.end().settings(), Some(stored));
}

/// Without friction, both shafts turn on from the first velocity of the handle. The board's own check takes twice
/// the counts for two turns, and finds nothing.
#[test]
fn bring_up_finds_counts_of_a_turn_that_are_not_those_of_the_device_file() {
    let stated = Device::default().frictionless();
    let mut doubled = stated.clone();
    doubled.stages.large.counts_per_rev *= 2;
    doubled.stages.small.counts_per_rev *= 2;
    for (device, word) in [(stated.clone(), "pass"), (doubled, "FAIL")] {
        let turns = [device.stages.large, device.stages.small].map(|motor| motor.counts_per_rev);
        let (address, board) = EmulatedBoard::with(
            "index-pulse",
            Setup {
                device,
                hand: Hand::Gone(60.0),
                ..blank(None)
            },
        );
        let (text, status) = said(address, &["bring-up", "--turns"]);
        // The shafts of a passing board do not rest after their turns.
        assert_eq!(status, Some(1), "{text}");
        let motors = [stated.stages.large, stated.stages.small];
        let names = ["large", "handle"];
        for ((turn, motor), name) in turns.iter().zip(motors).zip(names) {
            let line = text
                .lines()
                .find(|line| line.contains(&format!("turn, {name} encoder")));
            let line = line.unwrap_or_else(|| panic!("a line on the {name} encoder: {text}"));
            let found = format!(
                "{turn} counts from index to index, {} in the device file",
                motor.counts_per_rev
            );
            assert!(line.starts_with(word) && line.contains(&found), "{text}");
        }
        board.end();
    }
}

#[test]
fn bring_up_fails_with_an_encoder_whose_lines_are_exchanged_or_stuck() {
    const STUCK: &str = "a line of the large encoder is stuck";
    for (fault, reason) in [
        (Fault::Swapped, "exchange lines A and B"),
        (Fault::StuckA, STUCK),
        (Fault::StuckBoth, STUCK),
        (Fault::SmallSwapped, "the handle's encoder counts backwards"),
    ] {
        let (address, board) = EmulatedBoard::start(blank(Some(fault)));
        let (text, status) = said(address, &["bring-up"]);
        assert_eq!(status, Some(1), "{text}");
        let line = text.lines().find(|line| line.starts_with("FAIL"));
        assert!(line.is_some_and(|line| line.contains(reason)), "{text}");
        assert_eq!(state_now(address), Some(Mode::Boot));
        assert_eq!(
            said(address, &["select", "free-air", "--seconds", "0.1"]).1,
            Some(1)
        );
        board.end();
    }
}

/// The coupler still moves the handle, with a response of the wrong sign.
#[test]
fn bring_up_takes_an_open_lead_for_no_sign_error() {
    let (address, board) = EmulatedBoard::start(blank(Some(Fault::SmallOpenLead)));
    let (text, status) = said(address, &["bring-up"]);
    assert_eq!(status, Some(1), "{text}");
    let line = text.lines().find(|line| line.starts_with("FAIL"));
    let line = line.expect("a failed check");
    assert!(
        line.contains("small motor") && line.contains("check its leads"),
        "{text}"
    );
    assert!(!text.contains("exchange"), "{text}");
    board.end();
}
