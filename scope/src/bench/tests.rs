//! Tests of settings, orders to store and procedures.

use drive::patience::AGAIN;
use drivers::link::{Hello, Setting, Stored};

use super::*;

fn setting(number: u8, value: f32) -> Message {
    Message::Setting(Setting {
        number,
        count: 3,
        value,
    })
}

#[test]
fn settings_are_shown_when_all_have_come() {
    let mut bench = Bench::default();
    // The end of an answer from before, one in which a message was lost, and one without its begin.
    for (number, value) in [(2, 9.0), (0, 7.0), (2, 8.0), (1, 6.0)] {
        bench.message(&setting(number, value));
        assert_eq!(bench.settings, None);
    }
    for (number, value) in [(0, 1.0), (1, 2.0), (2, 3.0)] {
        assert_eq!(bench.settings, None);
        bench.message(&setting(number, value));
    }
    assert_eq!(bench.settings, Some(vec![1.0, 2.0, 3.0]));
    bench.restarted();
    assert_eq!(bench.settings, None);
}

#[test]
fn outcome_of_a_store_is_told_again() {
    let mut bench = Bench::default();
    for number in 1..3 {
        bench.message(&Message::Stored(Stored { outcome: 1 }));
        let told = &bench.json()["stored"];
        assert_eq!(told["number"], number);
        assert!(told["words"].as_str().is_some_and(|w| w.contains("disarm")));
    }
}

/// The board is certain that its amplifiers are disabled some frames after they are.
#[test]
fn order_to_store_that_comes_too_early_is_sent_again_unless_another_one_follows() {
    let outcome = |saved: Saved| {
        Message::Stored(Stored {
            outcome: saved as u8,
        })
    };
    for (other, waits) in [
        (Order::Alive, true),
        (Order::Settings, true),
        (Order::Arm, false),
    ] {
        let mut bench = Bench::default();
        assert!(bench.order(&Order::Store, true) && bench.order(&other, true));
        bench.message(&outcome(Saved::Enabled));
        assert_eq!(bench.stored.is_none(), waits);
        std::thread::sleep(AGAIN);
        let sent = bench.take_bytes(false);
        assert_eq!(sent == encode(Command::Store), waits, "{sent:?}");
        bench.message(&outcome(Saved::Stored));
        let told = &bench.json()["stored"];
        assert_eq!(told["words"], "settings stored");
    }
}

/// What the page shows after an order is none of the order before.
#[test]
fn outcome_of_a_store_is_not_told_of_the_next_one() {
    let mut bench = Bench::default();
    for number in 1..3 {
        assert!(bench.order(&Order::Store, true));
        assert!(bench.json()["stored"].is_null());
        let outcome = Saved::Stored as u8;
        bench.message(&Message::Stored(Stored { outcome }));
        let told = json!({"words": "settings stored", "number": number});
        assert_eq!(bench.json()["stored"], told);
    }
}

#[test]
fn procedure_holds_other_commands_back_until_the_order_to_disarm() {
    let mut bench = Bench {
        guide: Some(Guide::start(Guided::BringUp)),
        ..Bench::default()
    };
    let set = Order::Set {
        setting: 0,
        value: 1.0,
    };
    for order in [Order::Alive, Order::Arm, Order::Store, set] {
        assert!(!bench.order(&order, true), "{order:?}");
    }
    assert!(bench.order(&Order::Record { on: true }, true));
    bench.abandon("ended by Disarm");
    assert!(bench.order(&Order::Disarm, true) && bench.order(&Order::Arm, true));
    let ended = &bench.json()["guide"];
    assert_eq!(
        (&ended["runs"], &ended["failure"]),
        (&json!(false), &json!("bring-up: ended by Disarm"))
    );
}

#[test]
fn procedure_that_a_reset_ends_has_the_cause_of_the_reset() {
    let hello = |cause: Stop| {
        Message::Hello(Hello {
            cause: cause as u8,
            ..Hello::default()
        })
    };
    for (cause, said) in [
        (
            Stop::Watchdog,
            "bring-up: the board has started again, cause watchdog",
        ),
        (Stop::None, "bring-up: the board has started again"),
    ] {
        let mut bench = Bench {
            guide: Some(Guide::start(Guided::BringUp)),
            ..Bench::default()
        };
        bench.message(&hello(Stop::Jump));
        bench.restarted();
        // The page disarms it then, and the next resets are of another time.
        bench.abandon("ended by Disarm");
        bench.message(&hello(cause));
        bench.message(&hello(Stop::Jump));
        assert_eq!(bench.json()["guide"]["failure"], said);
    }
}

/// The board is left with the zeros of the repeated strokes.
#[test]
fn calibration_that_is_ended_is_undone_before_anything_can_be_stored() {
    for (what, undoes) in [(Guided::Calibrate, true), (Guided::BringUp, false)] {
        let mut bench = Bench {
            guide: Some(Guide::start(what)),
            ..Bench::default()
        };
        let answer = |bench: &mut Bench, zero: f32| {
            for number in 0..3 {
                bench.message(&setting(number, if number == 0 { zero } else { 1.0 }));
            }
        };
        answer(&mut bench, 2048.0);
        answer(&mut bench, 2036.0);
        bench.abandon("ended by Disarm");
        assert_eq!(bench.json()["undoes"], undoes);
        assert_eq!(bench.order(&Order::Store, true), !undoes);
        if undoes {
            let name = "bring-up".to_owned();
            bench.order(&Order::Guide { name }, true);
            assert_eq!(bench.json()["guide"]["name"], "calibrate");
        }
        let zero = encode(Command::Set {
            setting: 0,
            value: 2048.0,
        });
        assert!(bench.take_bytes(false).is_empty(), "the board is silent");
        bench.message(&Message::Stored(Stored { outcome: 1 }));
        let sent = bench.take_bytes(false);
        assert_eq!(sent.starts_with(&zero), undoes, "{sent:?}");
        answer(&mut bench, 2048.0);
        assert!(bench.order(&Order::Store, true));
    }
}

#[test]
fn calibration_is_undone_to_the_settings_of_its_own_begin() {
    let mut bench = Bench {
        before: Some(vec![2036.0; 3]),
        ..Bench::default()
    };
    let name = "calibrate".to_owned();
    bench.order(&Order::Guide { name }, true);
    for number in 0..3 {
        bench.message(&setting(number, 2048.0));
    }
    bench.abandon("ended by Disarm");
    bench.message(&Message::Stored(Stored { outcome: 1 }));
    let zero = encode(Command::Set {
        setting: 0,
        value: 2048.0,
    });
    let sent = bench.take_bytes(false);
    assert!(sent.starts_with(&zero), "{sent:?}");
}

#[test]
fn calibration_that_ends_with_the_server_is_disarmed_and_undone() {
    let mut bench = Bench {
        guide: Some(Guide::start(Guided::Calibrate)),
        before: Some(vec![2048.0; 4]),
        ..Bench::default()
    };
    let sent = bench.last_bytes();
    let disarm = encode(Command::Request(Request::Disarm));
    assert!(sent.starts_with(&disarm) && sent.len() > disarm.len());
    assert_eq!(bench.last_bytes(), Vec::<u8>::new());
}

#[test]
fn procedure_waits_for_the_identity_of_the_board_and_for_the_one_before() {
    let mut bench = Bench::default();
    let guide = |name: &str| Order::Guide {
        name: name.to_owned(),
    };
    assert!(!bench.order(&guide("bring-up"), false));
    assert!(bench.json()["guide"].is_null());
    assert!(!bench.order(&guide("bring-up"), true));
    bench.order(&guide("calibrate"), true);
    assert_eq!(bench.json()["guide"]["name"], "bring-up");
}

#[test]
fn procedure_without_a_page_ends_with_a_disarm() {
    let mut bench = Bench {
        guide: Some(Guide::start(Guided::BringUp)),
        ..Bench::default()
    };
    let disarm = encode(Command::Request(Request::Disarm)).to_vec();
    assert_eq!(bench.take_bytes(true), disarm);
    assert_eq!(bench.take_bytes(true), Vec::<u8>::new());
}
