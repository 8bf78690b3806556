//! Index pulses in the control task.

use drivers::{Setting, Settings};
use estimator_core::{Count, Counts};
use firmware_app::control::Message;
use firmware_app::index::{Indexing, Indication, Indications as _, Indices};
use haptic_control::{Mode, Request, Stop};

use crate::bench::{Bench, CALM, pulses, ticks};

const WANTED: bool = <Indices as Indexing>::WANTED;

/// One tick with these pulses of the large and the small encoder.
fn pulse(bench: &mut Bench, large: Option<u32>, small: Option<u32>) {
    bench.pulses = pulses([large, small].map(|count| count.map(Count)));
    bench.step(&CALM);
}

/// 4096 and 20 000 counts a turn; an image that captures no index goes on.
#[test]
fn pulse_that_is_not_whole_turns_after_the_first_stops_the_device() {
    for (large, small, is_well) in [
        (Some(100 + 4096), None, true),
        (Some(100 + 4099), Some(7 - 20_000), true),
        (None, Some(7 + 40_003), true),
        (Some(100 + 4100), None, false),
        (Some(100 + 20_000), None, false),
        (None, Some(7 + 4096), false),
        (None, Some(7 + 19_996), false),
    ] {
        let mut bench = Bench::start(0);
        pulse(&mut bench, Some(100), Some(7));
        assert_eq!(bench.state(), (Mode::Armed, Stop::None));
        let unsigned = |count: Option<i32>| count.map(i32::cast_unsigned);
        pulse(&mut bench, unsigned(large), unsigned(small));
        let expected = match WANTED && !is_well {
            true => (Mode::Safe, Stop::LostCounts),
            false => (Mode::Armed, Stop::None),
        };
        assert_eq!(bench.state(), expected, "{large:?} {small:?}");
    }
}

#[test]
fn device_is_armed_again_after_lost_counts_and_takes_the_next_pulse_for_the_reference() {
    // Counts a turn.
    for (large, turn) in [(true, 4096), (false, 20_000)] {
        let mut bench = Bench::start(0);
        let at = |bench: &mut Bench, count| match large {
            true => pulse(bench, Some(count), None),
            false => pulse(bench, None, Some(count)),
        };
        at(&mut bench, 100);
        at(&mut bench, 2000);
        bench.request(Request::Arm);
        bench.run(ticks(0.03));
        at(&mut bench, 2000 + turn);
        at(&mut bench, 2000 + 3 * turn);
        assert_eq!(bench.state(), (Mode::Armed, Stop::None), "{turn}");
    }
}

#[test]
fn report_has_pulses_count_deviation_and_position_of_both() {
    let mut bench = Bench::start(0);
    let first = bench.record().sample;
    pulse(&mut bench, Some(100), None);
    pulse(&mut bench, Some(102 + 4096), None);
    let reported = bench.take_index().pair(false);
    assert_eq!(reported.is_some(), WANTED);
    let Some([large, small]) = reported else {
        return;
    };
    let position = first.count - Count(100);
    let expected = Indication {
        pulses: 2,
        count: Count(4198),
        deviation: 2,
        position,
    };
    assert_eq!(large, expected);
    let nothing = Indication {
        pulses: 0,
        count: Count(0),
        deviation: 0,
        position: Counts(0),
    };
    assert_eq!(small, nothing);
    // Nothing new since.
    assert_eq!(bench.take_index().pair(false), None);
    assert_eq!(bench.take_index().pair(true), Some([large, small]));
}

/// A frame reports the pulses of all ticks since the one before.
#[test]
fn pulse_of_either_encoder_in_any_tick_is_reported_once() {
    for (large, small) in [(Some(100), None), (None, Some(7))] {
        let mut bench = Bench::start(0);
        pulse(&mut bench, large, small);
        pulse(&mut bench, None, None);
        let due = [(); 2].map(|()| bench.take_index().pair(false).is_some());
        assert_eq!(due, [WANTED, false], "{large:?} {small:?}");
    }
}

/// The mechanical zeros are 40 counts above the index of the large encoder, and 7 below that of the small one.
#[test]
fn reported_positions_are_relative_to_the_mechanical_zeros() {
    let mut settings = Settings::COMMISSIONED;
    assert!(settings.set(Setting::OffsetLarge, 40.0));
    assert!(settings.set(Setting::OffsetSmall, -7.0));
    let mut changed = Bench::start(0);
    let message = Message::Settings(settings, Request::KeepAlive);
    changed.control.accept(Some(message));
    for mut bench in [Bench::with(&settings, Stop::None, false), changed] {
        let sample = bench.record().sample;
        pulse(&mut bench, Some(100), Some(200));
        if let Some(pair) = bench.take_index().pair(true) {
            let from = [
                sample.count - Count(100 + 40),
                sample.coupled - Count(200 - 7),
            ];
            assert_eq!(pair.map(|one| one.position), from);
        }
    }
}
