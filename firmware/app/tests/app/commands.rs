use drivers::{Command, encode};
use firmware_app::commands::{Commands, Messages, Rejected};
use firmware_app::control::Message;
use firmware_app::large::{Large, LargeEstimator as _};
use firmware_app::scene::FIRST;
use haptic_control::Request;

use crate::bench::messages;

/// The counts after these bytes and 256 reports.
fn rejected(bytes: &[u8]) -> Option<[Rejected; 2]> {
    let mut queue = Messages::new();
    let (producer, mut consumer) = queue.split();
    let mut commands = Commands::new(producer);
    let mut bytes = bytes.iter().copied();
    while bytes.len() > 0 {
        commands.receive(|| bytes.next());
        while consumer.dequeue().is_some() {}
    }
    let reports: Vec<_> = (0..256).map(|_| commands.report()).collect();
    assert!(reports[..255].iter().all(Option::is_none));
    reports[255]
}

#[test]
fn request_is_converted_to_a_message() {
    // As docs/telemetry.md has the frame: select scene 2.
    let [Message::Request(request)] = messages(&[[0xA5, 3, 2, 0, 0, 0, 0, 0, 0, 0, 0xAD]])[..]
    else {
        panic!("one request");
    };
    assert_eq!(request, Request::Select(2));
}

#[test]
fn poll_reads_at_most_64_bytes_and_only_if_the_queue_has_room() {
    let arm = encode(Command::Request(Request::Arm));
    let mut queue = Messages::new();
    let (producer, mut consumer) = queue.split();
    let mut commands = Commands::new(producer);
    let mut bytes = arm.repeat(20).into_iter();
    commands.receive(|| bytes.next());
    assert_eq!(bytes.len(), 20 * 11 - 64);
    for _ in 0..5 {
        commands.receive(|| bytes.next());
    }
    // The queue holds 7 messages; their bytes are taken and no other.
    assert_eq!(bytes.len(), 13 * 11);
    let mut taken = 0;
    while bytes.len() > 0 || consumer.ready() {
        while consumer.dequeue().is_some() {
            taken += 1;
        }
        commands.receive(|| bytes.next());
    }
    assert_eq!(taken, 20);
}

#[test]
fn rejected_commands_are_counted_by_reason() {
    let tune = |scene, value| {
        encode(Command::Tune {
            scene,
            parameter: 0,
            value,
        })
    };
    // The first parameter of each scene, far out of bounds; off and free-air have none.
    let scene = if FIRST == 1 { 4 } else { FIRST };
    let counts = rejected(&tune(99, 0.1)).expect("a report");
    let unknown = Rejected {
        unknown: 1,
        ..Rejected::default()
    };
    assert_eq!(counts, [Rejected::default(), unknown]);
    let number_of_none = encode(Command::Estimator(2));
    assert_eq!(rejected(&number_of_none).expect("a report")[1], unknown);
    let garbage = Rejected {
        garbage: 3,
        ..Rejected::default()
    };
    assert_eq!(rejected(&[1, 2, 3]).expect("a report")[1], garbage);
    assert_eq!(rejected(&encode(Command::Request(Request::Arm))), None);
    if matches!(scene, 2..=8) {
        let out = rejected(&tune(scene, 1e9)).expect("a report")[1];
        assert_eq!(
            out,
            Rejected {
                out_of_bounds: 1,
                ..Rejected::default()
            }
        );
        let nan = rejected(&tune(scene, f32::NAN)).expect("a report")[1];
        assert_eq!(
            nan,
            Rejected {
                not_finite: 1,
                ..Rejected::default()
            }
        );
    }
}

#[test]
fn counts_are_reported_once() {
    let mut queue = Messages::new();
    let (producer, _consumer) = queue.split();
    let mut commands = Commands::new(producer);
    let mut bytes = [1].into_iter();
    commands.receive(|| bytes.next());
    let reports = (0..1024).filter_map(|_| commands.report()).count();
    assert_eq!(reports, 1);
    let mut bytes = [2].into_iter();
    commands.receive(|| bytes.next());
    let reports: Vec<_> = (0..256).filter_map(|_| commands.report()).collect();
    let [[before, now]] = reports[..] else {
        panic!("one report");
    };
    assert_eq!((before.garbage, now.garbage), (1, 2));
}

#[test]
fn estimators_are_chosen_by_number_where_there_is_a_choice() {
    let choices = [0, 1].map(|number| messages(&[encode(Command::Estimator(number))]).len());
    let two = !cfg!(any(
        feature = "large-foaw",
        feature = "large-kalman",
        feature = "large-adaptive"
    ));
    assert_eq!(choices, [usize::from(two); 2]);
    assert!(Large::choice(2).is_none());
}
