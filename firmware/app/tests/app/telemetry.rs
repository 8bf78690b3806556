use core::f32::consts::TAU;

use estimator_core::{Amps, ClockTicks, Count, Edge, Variance};
use firmware_app::ammeter::{Ammeter, Measure, Measured};
use firmware_app::config::{EDGES, RATE_HZ};
use firmware_app::index::{Indexing, Indices, Reported};
use firmware_app::large::Learnable as _;
use firmware_app::scene::Estimation;
use firmware_app::supply::{Voltmeter, Watch};
use firmware_app::telemetry::{Frame, Frames, Record, Sender};
use haptic_control::{Currents, Volts};

use crate::bench::{Bench, CALM, pulses, readings, supply};

fn record() -> Record {
    let mut bench = Bench::new();
    bench.step(&CALM);
    bench.record()
}

const MEASURED: Currents = Currents {
    large: Amps::new(0.25),
    small: Amps::new(-0.5),
};

/// The means of ammeters that have measured these currents.
fn measured() -> Measured {
    let mut ammeter = Ammeter::new();
    ammeter.update(&readings(MEASURED), &MEASURED, true);
    ammeter.update(&readings(MEASURED), &MEASURED, true);
    ammeter.take_means();
    ammeter.update(&readings(MEASURED), &MEASURED, true);
    ammeter.take_means()
}

/// The report of indices, with or without a pulse of both since the one before.
fn index(pulse: bool) -> Reported {
    let mut indices = Indices::start();
    indices.check(&pulses([pulse.then_some(Count(4)); 2]));
    indices.take_reported(&record().sample)
}

/// The frame of this record, after `before` others.
fn frame(record: Record, before: u32) -> Frame {
    frame_with(record, index(false), before)
}

/// The frame of this record and these indices, after `before` others.
fn frame_with(record: Record, index: Reported, before: u32) -> Frame {
    let mut queue = Frames::new();
    let (producer, mut consumer) = queue.split();
    let mut sender = Sender::new(producer);
    for _ in 0..before {
        sender.send(record, measured(), index, supply(24.5), 0, None);
        consumer.dequeue().expect("a frame");
    }
    sender.send(record, measured(), index, supply(24.5), 321, Some(Count(7)));
    consumer.dequeue().expect("a frame")
}

#[test]
fn frames_are_made_at_1_khz_from_the_first_tick_on() {
    let mut bench = Bench::new();
    let due: Vec<u32> = (0..RATE_HZ)
        .filter(|_| {
            bench.step(&CALM);
            bench.control.makes_frame()
        })
        .collect();
    assert_eq!(due.len(), 1000);
    assert!(due.iter().enumerate().all(|(k, at)| *at == 10 * k as u32));
}

#[test]
fn dropped_frames_leave_a_gap_in_seq_equal_to_drops() {
    let mut queue = Frames::new();
    let (producer, mut consumer) = queue.split();
    let mut sender = Sender::new(producer);
    let record = record();
    for _ in 0..40 {
        sender.send(record, measured(), index(false), supply(24.5), 0, None);
    }
    let waiting: Vec<_> = core::iter::from_fn(|| consumer.dequeue()).collect();
    let found = waiting.len() as u32;
    assert!(found < 40);
    assert!(waiting.iter().map(|frame| frame.seq).eq(0..found));
    assert!(waiting.iter().all(|frame| frame.drops(0) == 0));
    sender.send(record, measured(), index(false), supply(24.5), 0, None);
    let next = consumer.dequeue().expect("there is place again");
    assert_eq!(next.seq, 40);
    assert_eq!(next.drops(0), 40 - found);
    // And those that were lost behind the queue.
    assert_eq!(next.drops(5), 40 - found + 5);
}

#[test]
fn frame_has_the_values_of_its_record() {
    let record = record();
    let frame = frame(record, 3);
    assert_eq!((frame.seq, frame.cycles), (3, 321));
    assert_eq!(frame.reference, Some(Count(7)));
    assert_eq!(
        frame.measured(),
        <Ammeter as Measure>::WANTED.then_some(MEASURED)
    );
    assert_eq!(
        frame.supply(),
        <Voltmeter as Watch>::WANTED.then_some(Volts(24.5))
    );
    assert_eq!(frame.record.tick, record.tick);
}

#[test]
fn sigma_is_in_rad_per_s_and_a_missing_estimator_is_255() {
    let mut record = record();
    let of = |number, variance| Estimation {
        variance: Variance(variance),
        number,
    };
    record.estimation = of(None, 0.0);
    assert_eq!(frame(record, 0).estimator(), 255);
    assert_eq!(frame(record, 0).deviation(), 0.0);
    // Two counts a tick are two 4096ths of a turn, 10 000 times a second.
    record.estimation = of(Some(1), 4.0);
    assert_eq!(frame(record, 0).estimator(), 1);
    let sigma = 2.0 * TAU / 4096.0 * RATE_HZ as f32;
    assert!((frame(record, 0).deviation() / sigma - 1.0).abs() < 1e-6);
}

#[test]
fn edge_line_is_sent_by_images_with_edge_stamps() {
    let edge = Edge {
        boundary: Count(9),
        age: ClockTicks(100),
    };
    let mut record = record();
    record.sample.edge = Some(edge);
    assert_eq!(frame(record, 0).edge(), EDGES.then_some(edge));
    record.sample.edge = None;
    assert_eq!(frame(record, 0).edge(), None);
}

#[test]
fn learned_line_is_sent_with_one_frame_of_128() {
    let record = record();
    let learned = record.learned.deviations();
    assert_eq!(learned.is_some(), cfg!(feature = "large-adaptive"));
    for (seq, due) in [
        (0, true),
        (1, false),
        (127, false),
        (128, true),
        (129, false),
    ] {
        assert_eq!(
            frame(record, seq).learned(),
            learned.filter(|_| due),
            "{seq}"
        );
    }
}

#[test]
fn index_line_is_sent_after_a_pulse_and_with_one_frame_of_128() {
    let record = record();
    for (seq, pulse, due) in [
        (0, false, true),
        (1, false, false),
        (1, true, true),
        (127, false, false),
        (128, false, true),
    ] {
        let sent = frame_with(record, index(pulse), seq).index();
        let expected = <Indices as Indexing>::WANTED && due;
        assert_eq!(sent.is_some(), expected, "{seq} {pulse}");
    }
}
