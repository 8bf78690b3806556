use drivers::{Command, Settings, encode};
use firmware_app::commands::{Asked, Channel, Commands, Messages, Rejected};
use firmware_app::control::Message;
use firmware_app::large::{Large, LargeEstimator as _};
use firmware_app::scene::{self, FIRST};
use haptic_control::Request;
use haptic_control::SceneKind;

use crate::bench::messages;

/// The counts after these bytes and 256 reports.
fn rejected(bytes: &[u8]) -> Option<[Rejected; 2]> {
    let mut queue = Messages::new();
    let (producer, mut consumer) = queue.split();
    let mut commands = Commands::new(producer, Settings::COMMISSIONED);
    let mut bytes = bytes.iter().copied();
    while bytes.len() > 0 {
        commands.receive(Channel::Rtt, || bytes.next());
        while consumer.dequeue().is_some() {}
    }
    let reports: Vec<_> = (0..256).map(|_| commands.report()).collect();
    assert!(reports[..255].iter().all(Option::is_none));
    reports[255]
}

#[test]
fn request_is_converted_to_a_message() {
    // As docs/telemetry.md has the frame: select scene 2.
    let found = messages(&[[0xA5, 3, 2, 0, 0, 0, 0, 0, 0, 0, 0xAD]]);
    if !scene::has(2) {
        assert!(found.is_empty());
        return;
    }
    let [Message::Request(request)] = found[..] else {
        panic!("one request");
    };
    assert_eq!(request, Request::Select(2));
}

#[test]
fn poll_reads_at_most_64_bytes_and_only_if_the_queue_has_room() {
    let arm = encode(Command::Request(Request::Arm));
    let mut queue = Messages::new();
    let (producer, mut consumer) = queue.split();
    let mut commands = Commands::new(producer, Settings::COMMISSIONED);
    let mut bytes = arm.repeat(20).into_iter();
    commands.receive(Channel::Rtt, || bytes.next());
    assert_eq!(bytes.len(), 20 * 11 - 64);
    for _ in 0..5 {
        commands.receive(Channel::Rtt, || bytes.next());
    }
    // The queue holds 7 messages; their bytes are taken and no other.
    assert_eq!(bytes.len(), 13 * 11);
    let mut taken = 0;
    while bytes.len() > 0 || consumer.ready() {
        while consumer.dequeue().is_some() {
            taken += 1;
        }
        commands.receive(Channel::Rtt, || bytes.next());
    }
    assert_eq!(taken, 20);
}

/// An image of one scene has off and that scene.
#[test]
fn scenes_that_the_image_has_are_selected_and_others_are_unknown() {
    let has = |scene: u8| match cfg!(one_scene) {
        true => [0, FIRST].contains(&scene),
        false => usize::from(scene) < SceneKind::ALL.len(),
    };
    for scene in 0..=u8::MAX {
        let select = encode(Command::Request(Request::Select(scene)));
        assert_eq!(
            messages(&[select]).len(),
            usize::from(has(scene)),
            "{scene}"
        );
        let unknown = rejected(&select).map_or(0, |[_, now]| now.unknown);
        assert_eq!(unknown, u32::from(!has(scene)), "{scene}");
    }
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
    let mut kinds = SceneKind::ALL.into_iter();
    let kind = kinds.find(|kind| kind.number() == scene);
    if !kind.expect("a scene").facts().parameters.is_empty() {
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

/// 1e-3 is in the range of the first parameter of each scene that has one.
#[test]
fn parameters_of_scenes_that_the_image_does_not_have_are_unknown() {
    for kind in SceneKind::ALL {
        let tune = encode(Command::Tune {
            scene: kind.number(),
            parameter: 0,
            value: 1e-3,
        });
        let is_taken = !messages(&[tune]).is_empty();
        assert!(!is_taken || scene::has(kind.number()), "{kind}");
    }
}

#[test]
fn counts_are_reported_once() {
    let mut queue = Messages::new();
    let (producer, _consumer) = queue.split();
    let mut commands = Commands::new(producer, Settings::COMMISSIONED);
    let mut bytes = [1].into_iter();
    commands.receive(Channel::Rtt, || bytes.next());
    let reports = (0..1024).filter_map(|_| commands.report()).count();
    assert_eq!(reports, 1);
    let mut bytes = [2].into_iter();
    commands.receive(Channel::Rtt, || bytes.next());
    let reports: Vec<_> = (0..256).filter_map(|_| commands.report()).collect();
    let [[before, now]] = reports[..] else {
        panic!("one report");
    };
    assert_eq!((before.garbage, now.garbage), (1, 2));
}

#[test]
fn identity_is_asked_once_after_the_commands_before_it() {
    let mut queue = Messages::new();
    let (producer, _consumer) = queue.split();
    let mut commands = Commands::new(producer, Settings::COMMISSIONED);
    assert_eq!(commands.asked(), Asked::default());
    let unknown = encode(Command::Estimator(255));
    let mut bytes = [unknown, encode(Command::Identify)].into_iter().flatten();
    commands.receive(Channel::Rtt, || bytes.next());
    let counts = Rejected {
        unknown: 1,
        ..Rejected::default()
    };
    let identity = Asked {
        identity: true,
        ..Asked::default()
    };
    assert_eq!((commands.asked(), commands.rejected()), (identity, counts));
    assert_eq!(commands.asked(), Asked::default());
}

/// A host that has asked again counts the answers.
#[test]
fn each_question_for_the_identity_has_its_answer() {
    let mut queue = Messages::new();
    let (producer, _consumer) = queue.split();
    let mut commands = Commands::new(producer, Settings::COMMISSIONED);
    let unknown = encode(Command::Estimator(255));
    let question = encode(Command::Identify);
    let mut port = [question, question, unknown, question]
        .into_iter()
        .flatten();
    let mut rtt = question.into_iter();
    let mut unknown_at = Vec::new();
    // Each look begins with the other channel.
    for first in [Channel::Port, Channel::Rtt].repeat(5) {
        for channel in [first, Channel::Port, Channel::Rtt] {
            commands.receive(channel, || match channel {
                Channel::Port => port.next(),
                Channel::Rtt => rtt.next(),
            });
        }
        if commands.asked().identity {
            unknown_at.push(commands.rejected().unknown);
        }
    }
    assert_eq!(unknown_at, [0, 0, 0, 1]);
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

/// Half a frame on one channel does not touch a frame on the other, and garbage of both is counted.
#[test]
fn channels_have_parsers_of_their_own_and_share_the_queue_and_the_counts() {
    let arm = encode(Command::Request(Request::Arm));
    let mut queue = Messages::new();
    let (producer, mut consumer) = queue.split();
    let mut commands = Commands::new(producer, Settings::COMMISSIONED);
    let feed = |commands: &mut Commands<'_>, channel, bytes: &[u8]| {
        let mut bytes = bytes.iter().copied();
        commands.receive(channel, || bytes.next());
    };
    feed(&mut commands, Channel::Rtt, &arm[..5]);
    feed(&mut commands, Channel::Port, &arm);
    assert!(commands.is_used(Channel::Port) && !commands.is_used(Channel::Rtt));
    feed(&mut commands, Channel::Rtt, &arm[5..]);
    feed(&mut commands, Channel::Rtt, &[1, 2]);
    feed(&mut commands, Channel::Port, &[3]);
    let mut arms = 0;
    while let Some(message) = consumer.dequeue() {
        arms += u32::from(matches!(message, Message::Request(Request::Arm)));
    }
    assert_eq!(arms, 2);
    let counts = (0..256).find_map(|_| commands.report()).expect("a report");
    let garbage = Rejected {
        garbage: 3,
        ..Rejected::default()
    };
    assert_eq!(counts, [Rejected::default(), garbage]);
}
