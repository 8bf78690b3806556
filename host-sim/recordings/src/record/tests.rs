//! Tests of the conversion of telemetry to a recording.

use super::*;
use crate::recording::{BoardColumns, Recording};

fn log(frames: impl Iterator<Item = u32>) -> String {
    let mut log = "boot rate=10000 cause=0\n".to_owned();
    for k in frames {
        let _ = writeln!(
            log,
            "frame seq={k} tick={} large={} small={} wl=1.5 ws=-0.25 torque=0.01 il=0.5 \
             is=-0.125 state=2 cause=0 overruns=0 drops=0 cycles=900",
            10 * k,
            u32::MAX.wrapping_add(k),
            3 * k,
        );
    }
    log
}

/// A rate needs two frames, and two are enough.
#[test]
fn a_run_of_one_frame_is_refused() {
    for (frames, enough) in [(1, false), (2, true)] {
        let telemetry = Telemetry::text(log(0..frames).as_bytes());
        let runs = telemetry.runs();
        assert_eq!(choose(&runs, None).is_ok(), enough, "{frames} frames");
    }
}

#[test]
fn log_is_converted_to_a_recording_that_can_be_read() {
    let telemetry = Telemetry::text(log(0..4).as_bytes());
    let runs = telemetry.runs();
    let run = choose(&runs, None).unwrap();
    let text = csv(run, run.rate_hz().unwrap(), |_| None);
    assert_eq!(
        text.lines().nth(1),
        Some("0,4294967295,0,0.5,-0.125,0.01,1.5,-0.25,2,0")
    );
    let recording = Recording::parse(text.as_bytes(), "r").unwrap();
    assert_eq!(recording.t, [0.0, 0.001, 0.002, 0.003]);
    assert_eq!(recording.trace.counts_large, [u32::MAX, 0, 1, 2]);
    assert_eq!(recording.trace.counts_small, Some(vec![0, 3, 6, 9]));
    assert_eq!(recording.trace.current, Some(vec![0.5; 4]));
    assert_eq!(recording.trace.true_omega, None);
    assert_eq!(
        report(&telemetry, &runs, run, ""),
        ["4 frames recorded, 0 missing at 0 places"]
    );
}

#[test]
fn overruns_before_the_first_frame_are_ignored() {
    let text = log(0..4).replace("overruns=0", "overruns=5");
    let telemetry = Telemetry::text(text.as_bytes());
    let runs = telemetry.runs();
    assert_eq!(report(&telemetry, &runs, &runs[0], "").len(), 1);
    let (first, last) = text.split_once("frame seq=3").unwrap();
    let text = format!(
        "{first}frame seq=3{}",
        last.replace("overruns=5", "overruns=7")
    );
    let telemetry = Telemetry::text(text.as_bytes());
    let runs = telemetry.runs();
    let said = report(&telemetry, &runs, &runs[0], "");
    assert!(
        said[1].starts_with("2 control ticks missed or late"),
        "{said:?}"
    );
}

#[test]
fn edge_stamps_are_columns_of_the_recording() {
    let log = log(0..3) + "edge seq=2 bound=1 age=21000\n";
    let telemetry = Telemetry::text(log.as_bytes());
    let text = csv(&telemetry.runs()[0], 1e4, |_| Some(1.0));
    let header = "t,counts_large,counts_small,current,current_small,torque,velocity_large,\
                  velocity_small,state,cause,edge_tick,edge_bound,true_omega";
    assert_eq!(text.lines().next(), Some(header));
    assert!(text.lines().nth(1).unwrap().ends_with(",2,0,,,1"), "{text}");
    assert!(
        text.lines().nth(3).unwrap().ends_with(",2,0,147000,1,1"),
        "{text}"
    );
    let edges = Recording::parse(text.as_bytes(), "r").unwrap().trace.edges;
    let [None, None, Some(edge)] = edges.unwrap()[..] else {
        panic!("one edge");
    };
    assert!((edge.age_s - 250e-6).abs() < 1e-9 && edge.boundary == 1);
}

#[test]
fn measured_currents_are_columns_of_the_recording() {
    let beside = |from: u32| {
        let mut text = String::new();
        for (k, line) in (0..).zip(log(0..4).lines()) {
            let _ = writeln!(text, "{line}");
            // The boot line is the first one.
            if k > from {
                let k = k - 1;
                let _ = writeln!(text, "measured seq={k} large=0.{k} small=-0.{k}");
            }
        }
        text
    };
    let said = |log: &str| {
        let telemetry = Telemetry::text(log.as_bytes());
        let runs = telemetry.runs();
        report(&telemetry, &runs, &runs[0], "")
    };
    let lack = "2 frames without measured currents: their columns are empty there";
    assert_eq!(said(&beside(3))[1], lack);
    // The first frame may lack them.
    let log = beside(1);
    assert_eq!(said(&log).len(), 1);
    let telemetry = Telemetry::text(log.as_bytes());
    let runs = telemetry.runs();
    let text = csv(&runs[0], 1e4, |_| Some(1.0));
    let lines: Vec<_> = text.lines().collect();
    let end = "cause,current_measured,current_small_measured,true_omega";
    assert!(lines[0].ends_with(end), "{text}");
    assert!(lines[1].ends_with(",2,0,,,1"), "{text}");
    assert!(lines[2].ends_with(",2,0,0.1,-0.1,1"), "{text}");
    let recording = Recording::parse(text.as_bytes(), "r").unwrap();
    assert_eq!(recording.trace.current, Some(vec![0.1, 0.2, 0.3, 0.5]));
    let small = vec![-0.1, -0.2, -0.3, -0.125];
    assert_eq!(recording.current_small, Some(small));
}

#[test]
fn supply_is_a_column_that_is_empty_in_a_row_without_it() {
    let log = log(0..3) + "supply seq=2 volts=23.75\n";
    let telemetry = Telemetry::text(log.as_bytes());
    let text = csv(&telemetry.runs()[0], 1e4, |_| Some(1.0));
    let lines: Vec<_> = text.lines().collect();
    assert!(lines[0].ends_with(",cause,supply,true_omega"), "{text}");
    assert!(lines[1].ends_with(",2,0,,1"), "{text}");
    assert!(lines[3].ends_with(",2,0,23.75,1"), "{text}");
}

#[test]
fn edge_before_the_first_frame_has_a_negative_tick() {
    let (first, second) = (log(0..1), log(1..2));
    let second = second.split_once('\n').unwrap().1;
    let log = first + "edge seq=0 bound=0 age=84\n" + second;
    let telemetry = Telemetry::text(log.as_bytes());
    let text = csv(&telemetry.runs()[0], 1e4, |_| None);
    assert!(text.lines().nth(1).unwrap().ends_with(",-84,0"), "{text}");
}

#[test]
fn longest_run_is_recorded_and_the_others_are_reported() {
    let text = log(3..8) + &log(0..3) + "frame seq=";
    let telemetry = Telemetry::text((text + "\n").as_bytes());
    let runs = telemetry.runs();
    assert_eq!(choose(&runs, None).unwrap().frames.len(), 5);
    let second = choose(&runs, Some(2)).unwrap();
    assert_eq!(second.frames.len(), 3);
    let said = report(&telemetry, &runs, second, "; give --run");
    assert!(
        said[1].ends_with("started 2 times; left out: runs of [5] frames; give --run"),
        "{said:?}"
    );
    assert!(
        said[2].contains("1 piece of the stream not readable"),
        "{said:?}"
    );
    assert!(choose(&runs, Some(3)).is_err() && choose(&runs, Some(0)).is_err());
    let one = Telemetry::text(log(0..1).as_bytes());
    assert!(choose(&one.runs(), None).is_err());
    assert!(choose(&[], None).is_err());
}

/// After another image was flashed during a recording, the image is that of the run.
#[test]
fn image_of_the_recorded_run_is_told() {
    let of = |device: &str, log: String| {
        let boot = format!("boot rate=10000 cause=0 device={device} presets=00000001");
        log.replace("boot rate=10000 cause=0", &boot)
    };
    let text = of("0000000a", log(0..5)) + &of("0000000b", log(0..3));
    let telemetry = Telemetry::text(text.as_bytes());
    let runs = telemetry.runs();
    for (run, device) in runs.iter().zip(["0000000a", "0000000b"]) {
        let said = report(&telemetry, &runs, run, "");
        let line = format!("image built for device {device}, presets 00000001");
        assert_eq!(said[1], line);
    }
}

/// A board may send a value that is not finite. The recording is read by every command.
#[test]
fn value_that_is_not_finite_is_an_empty_field_and_such_a_current_no_row() {
    let mut lines: Vec<_> = log(0..6).split('\n').map(str::to_owned).collect();
    let frame = |k: usize| k + 1;
    lines[frame(1)] = lines[frame(1)].replace("wl=1.5", "wl=NaN");
    lines[frame(3)] = lines[frame(3)].replace("torque=0.01", "torque=inf");
    lines[frame(4)] = lines[frame(4)].replace("il=0.5", "il=NaN");
    lines.insert(frame(3), "measured seq=2 large=NaN small=0.25".to_owned());
    let telemetry = Telemetry::text(lines.join("\n").as_bytes());
    assert_eq!(telemetry.malformed, [""; 0]);
    let runs = telemetry.runs();
    let text = csv(&runs[0], 1e4, |frame| Some(f64::from(frame.seq)));
    let rows: Vec<_> = text.lines().skip(1).collect();
    assert_eq!(rows.len(), 5);
    assert_eq!(rows[1], "0.001,0,3,0.5,-0.125,0.01,,-0.25,2,0,,,1");
    assert_eq!(rows[2], "0.002,1,6,0.5,-0.125,0.01,1.5,-0.25,2,0,,0.25,2");
    assert_eq!(rows[3], "0.003,2,9,0.5,-0.125,,1.5,-0.25,2,0,,,3");
    let recording = Recording::parse(text.as_bytes(), "r").unwrap();
    assert_eq!(recording.t, [0.0, 0.001, 0.002, 0.003, 0.005]);
    let board = BoardColumns::parse(text.as_bytes(), "r").unwrap();
    let velocity = board.column("velocity_large").unwrap();
    let is_known: Vec<_> = velocity.iter().map(|omega| omega.is_finite()).collect();
    assert_eq!(is_known, [true, false, true, true, true]);
    let said = report(&telemetry, &runs, &runs[0], "");
    for line in [
        "1 frame left out: the command of a current is not finite",
        "2 frames with a value that is not finite: its field is empty there",
    ] {
        assert!(said.iter().any(|it| it == line), "{said:?}");
    }
}

#[test]
fn truth_is_asked_of_the_frames_that_have_a_row() {
    let text = log(0..4)
        .replacen("il=0.5", "il=NaN", 2)
        .replacen("il=NaN", "il=0.5", 1);
    let telemetry = Telemetry::text(text.as_bytes());
    let runs = telemetry.runs();
    // The frame without a row has no truth either.
    let truth = |frame: &Frame| (frame.seq != 1).then_some(f64::from(frame.seq) + 0.5);
    let recording = Recording::parse(csv(&runs[0], 1e4, truth).as_bytes(), "r").unwrap();
    assert_eq!(recording.trace.true_omega, Some(vec![0.5, 2.5, 3.5]));
}

#[test]
fn first_one_of_equally_long_runs_is_recorded() {
    let text = log(3..6) + &log(0..3) + &log(0..2);
    let telemetry = Telemetry::text(text.as_bytes());
    let runs = telemetry.runs();
    assert_eq!(runs.len(), 3);
    assert_eq!(choose(&runs, None).unwrap().frames[0].1.seq, 3);
}
