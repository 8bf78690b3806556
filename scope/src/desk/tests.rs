//! Tests of the desk of a board.

use drivers::link::Rejected;

use super::*;

/// The page asks for the settings each second, also between a refusal and the next status.
#[test]
fn refusal_is_told_until_the_next_command_and_a_question_is_none() {
    let (hub, _orders) = Hub::new("token".to_owned(), Value::Null);
    let mut desk = Desk::new(hub, &Device::default()).expect("a desk");
    for unknown in [0, 1] {
        let counts = Rejected {
            unknown,
            ..Rejected::default()
        };
        desk.message(counts.into(), None);
    }
    for (order, is_told) in [
        (Order::Alive, true),
        (Order::Settings, true),
        (Order::Scene { number: 0 }, false),
    ] {
        assert!(desk.order(&order).is_some());
        assert_eq!(!desk.refusals.json().is_null(), is_told, "{order:?}");
    }
    let counts = Rejected {
        unknown: 2,
        ..Rejected::default()
    };
    desk.message(counts.into(), None);
    assert!(!desk.refusals.json().is_null());
    assert!(desk.order(&Order::Disarm).is_some());
    assert!(desk.refusals.json().is_null());
}

/// The desk of a board of 10 kHz that has told its identity and sent a frame.
fn desk() -> Desk {
    let (hub, _orders) = Hub::new("token".to_owned(), Value::Null);
    let mut desk = Desk::new(hub, &Device::default()).expect("a desk");
    desk.message(crate::order::tests::hello().into(), None);
    desk.message(frame(100, 1000).into(), None);
    desk
}

/// A frame of a motor that turns.
fn frame(seq: u32, tick: u32) -> Frame {
    Frame {
        seq,
        tick,
        counts_large: tick,
        state: Mode::Running as u8,
        ..Frame::default()
    }
}

/// The estimates of the latest row.
fn estimates(desk: &mut Desk) -> Vec<f64> {
    let bytes = desk.batch.rest().expect("a row");
    let (_, rows) = crate::batch::rows(&bytes);
    let latest = rows.last().expect("a row");
    latest[channels::CHANNELS.len()..].to_vec()
}

#[test]
fn scene_that_is_refused_or_ended_by_disarm_is_not_shown() {
    let wall = Order::Scene { number: 2 };
    let mut desk = desk();
    assert!(desk.order(&wall).is_some());
    assert_eq!(desk.selection.scene(), 2);
    assert!(desk.order(&Order::Disarm).is_some());
    assert_eq!(desk.selection.scene(), 0);
    for (unverified, shown) in [(0, 2), (1, 0)] {
        assert!(desk.order(&wall).is_some());
        let counts = Rejected {
            unverified,
            ..Rejected::default()
        };
        desk.message(counts.into(), None);
        assert_eq!(desk.selection.scene(), shown);
    }
}

#[test]
fn set_point_and_parameters_are_shown_as_the_board_has_them() {
    let torque = haptic_control::SceneKind::Torque.number();
    let tune = |scene: u8, parameter: u8, value: f32| Order::Tune {
        scene,
        parameter,
        value,
    };
    let mut desk = desk();
    for order in [tune(torque, 0, 0.0078125), tune(2, 1, 0.25)] {
        assert!(desk.order(&order).is_some());
    }
    assert!(desk.order(&Order::Scene { number: torque }).is_some());
    assert_eq!(desk.tuned.json(), json!({ "2.1": 0.25 }));
    // The board starts again.
    desk.message(Frame::default().into(), None);
    assert_eq!(desk.tuned.json(), json!({}));
    assert_eq!(desk.selection.scene(), 0);
}

#[test]
fn estimates_begin_again_and_time_goes_on_by_a_second_behind_missing_frames() {
    let mut desk = desk();
    desk.message(frame(101, 1010).into(), None);
    assert!(estimates(&mut desk).iter().any(|it| *it != 0.0));
    let before = desk.t();
    desk.message(frame(103, 1030).into(), None);
    assert!(estimates(&mut desk).iter().all(|it| *it == 0.0));
    assert!((desk.t() - before - 2e-3).abs() < 1e-9);
    let before = desk.t();
    desk.message(frame(900_000, 9_000_000).into(), None);
    assert!((desk.t() - before - 1.0).abs() < 1e-9);
}

#[test]
fn recording_ends_with_the_board_and_when_it_is_full() {
    let record = Order::Record { on: true };
    let mut desk = desk();
    assert_eq!(desk.order(&record), None);
    desk.message(frame(101, 1010).into(), None);
    // A second order does not begin anew.
    assert_eq!(desk.order(&record), None);
    assert_eq!(desk.recorder.as_ref().map(Recorder::len), Some(1));
    desk.restarted();
    assert!(desk.recorder.is_none() && desk.hub.recording().is_some());

    let mut recorder = Recorder::new(&Hello::default());
    for seq in 2..crate::recorder::LONGEST as u32 {
        recorder.row(seq, &[], f64::NAN);
    }
    desk.recorder = Some(recorder);
    desk.message(frame(1, 10).into(), None);
    assert!(desk.recorder.is_some());
    desk.message(frame(2, 20).into(), None);
    assert!(desk.recorder.is_none());
}

/// Nobody else sees the restart of a board at a port. An order to store would store what the flash had.
#[test]
fn start_that_the_numbers_of_the_frames_tell_ends_procedure_and_order_to_store() {
    let (hub, _orders) = Hub::new("token".to_owned(), Value::Null);
    let mut desk = Desk::new(hub, &Device::default()).expect("a desk");
    let mut start = |orders: &[Order], cause: Stop| {
        let (old, new) = (Hello::default(), cause as u8);
        let new = Hello { cause: new, ..old };
        desk.message(old.into(), None);
        let frame = Frame {
            seq: 100,
            tick: 1000,
            ..Frame::default()
        };
        desk.message(frame.into(), None);
        for order in orders {
            let _ = desk.order(order);
        }
        desk.message(new.into(), None);
        desk.message(Frame::default().into(), None);
        desk.bench.json()
    };
    let name = "bring-up".to_owned();
    let told = start(&[Order::Guide { name }], Stop::Watchdog);
    let said = "bring-up: the board has started again, cause watchdog";
    assert_eq!(told["guide"]["failure"], said);
    let told = start(&[Order::Store], Stop::None);
    let said = told["stored"]["words"].as_str().unwrap_or_default();
    assert!(said.starts_with("not stored: the board has started again, and has lost"));
}

/// The thread of a procedure may not have seen the stop yet.
#[test]
fn procedure_that_a_stop_of_the_board_ends_has_its_cause_although_the_page_disarms() {
    let of = |state: Mode, cause: Stop| {
        let (hub, _orders) = Hub::new("token".to_owned(), Value::Null);
        let mut desk = Desk::new(hub, &Device::default()).expect("a desk");
        desk.message(Message::Hello(Hello::default()), None);
        let name = "bring-up".to_owned();
        assert_eq!(desk.order(&Order::Guide { name }), None);
        let frame = Frame {
            state: state as u8,
            cause: cause as u8,
            ..Frame::default()
        };
        desk.message(Message::Frame(frame), None);
        let disarm = Command::Request(Request::Disarm);
        assert_eq!(desk.order(&Order::Disarm), Some(disarm));
        desk.bench.json()["guide"]["failure"].clone()
    };
    let stopped = of(Mode::Safe, Stop::AmplifierFault);
    assert_eq!(
        stopped,
        "bring-up: the board stopped: state safe, cause amplifier-fault"
    );
    assert_eq!(of(Mode::Armed, Stop::None), "bring-up: ended by Disarm");
}
