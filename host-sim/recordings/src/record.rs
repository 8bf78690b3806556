//! Conversion of telemetry to a recording.

mod longest;

use std::fmt::Write as _;

use crate::recording::MEASURED;
use crate::telemetry::{COLUMNS, Column, Frame, LearnedLine, MeasuredLine, Run, Telemetry};
use simulation::trace::EDGE_CLOCK_HZ;
use terminal::failure::Failure;

pub use longest::write_longest;

/// The columns of the learned parameters.
const LEARNED: &str = ",learned_damping,learned_friction,learned_torque_constant";

/// A run as CSV with one row per frame. `t` starts at the first frame and follows from ticks and
/// control rate.
///
/// The fields of a frame that every frame has are columns. `edge_tick` and `edge_bound` are present if
/// the firmware stamps edges, and empty for a frame without a stamp. `current_measured` and
/// `current_small_measured` are present if the firmware measures currents, and empty for a frame without
/// the line, as the first one may be. `supply`, V, is present if the firmware measures the voltage of the
/// amplifiers' supply. The three `learned_*` columns are present if any frame has them,
/// and empty in the other rows. `true_omega` is the last column, if every frame has one.
#[must_use]
pub fn csv(run: &Run, rate_hz: f64, true_omega: impl Fn(&Frame) -> Option<f64>) -> String {
    let truth: Option<Vec<f64>> = run.frames.iter().map(|(_, f)| true_omega(f)).collect();
    let edges = run.frames.iter().any(|(_, f)| f.side_lines.edge.is_some());
    let measured = measured(run) > 0;
    let supply = run
        .frames
        .iter()
        .any(|(_, f)| f.side_lines.supply.is_some());
    let learned = run
        .frames
        .iter()
        .any(|(_, f)| f.side_lines.learned.is_some());
    let known = |(_, value): &&Column| run.frames.iter().all(|(_, frame)| value(frame).is_some());
    let columns: Vec<_> = COLUMNS.iter().filter(known).collect();
    let mut text = "t".to_owned();
    for (name, _) in &columns {
        text.push(',');
        text += name;
    }
    let [large, small] = MEASURED;
    let more = [
        (",edge_tick,edge_bound", edges),
        (&format!(",{large},{small}"), measured),
        (",supply", supply),
        (LEARNED, learned),
        (",true_omega", truth.is_some()),
    ];
    for (name, _) in more.iter().filter(|(_, there)| *there) {
        text += name;
    }
    text.push('\n');
    for (k, (tick, frame)) in run.frames.iter().enumerate() {
        let t = *tick as f64 / rate_hz;
        // Writing to a string cannot fail.
        let _ = write!(text, "{t}");
        for (_, value) in &columns {
            text.push(',');
            text += &value(frame).unwrap_or_default();
        }
        if edges {
            let _ = match frame.side_lines.edge {
                None => write!(text, ",,"),
                Some(edge) => {
                    let now = (t * EDGE_CLOCK_HZ).round() as i64;
                    write!(text, ",{},{}", now - i64::from(edge.age), edge.boundary)
                }
            };
        }
        if measured {
            let _ = match frame.side_lines.measured {
                None => write!(text, ",,"),
                Some(MeasuredLine { large, small }) => write!(text, ",{large},{small}"),
            };
        }
        if supply {
            let _ = match frame.side_lines.supply {
                None => write!(text, ","),
                Some(volts) => write!(text, ",{volts}"),
            };
        }
        if learned {
            let _ = match frame.side_lines.learned {
                None => write!(text, ",,,"),
                Some(LearnedLine {
                    damping,
                    friction,
                    torque_constant,
                }) => write!(text, ",{damping},{friction},{torque_constant}"),
            };
        }
        if let Some(truth) = &truth {
            let _ = write!(text, ",{}", truth[k]);
        }
        text.push('\n');
    }
    text
}

/// Number of frames with measured currents.
fn measured(run: &Run) -> usize {
    let has = |(_, frame): &&(u64, &Frame)| frame.side_lines.measured.is_some();
    run.frames.iter().filter(has).count()
}

/// The run to record: that of the given number, of which 1 is the first, by default the longest.
///
/// # Errors
/// [`Failure::Input`] if the run does not exist or has fewer than two frames.
pub fn choose<'a, 'b>(runs: &'b [Run<'a>], number: Option<usize>) -> Result<&'b Run<'a>, Failure> {
    let run = match number {
        None => runs.iter().rev().max_by_key(|run| run.frames.len()),
        Some(number) => runs.get(number.wrapping_sub(1)),
    };
    let run = run.ok_or_else(|| {
        let (number, runs) = (number.unwrap_or_default(), runs.len());
        Failure::Input(format!("--run {number}: no such run; give 1 to {runs}"))
    })?;
    if run.frames.len() < 2 {
        return Err(Failure::Input(
            "the run has only one telemetry frame; a recording needs at least two".to_owned(),
        ));
    }
    Ok(run)
}

/// Lines on the recorded run: missing frames, other runs, unreadable pieces, late ticks. `remedy` ends the line
/// on runs that were left out.
#[must_use]
pub fn report(telemetry: &Telemetry, runs: &[Run], run: &Run, remedy: &str) -> Vec<String> {
    let mut lines = Vec::new();
    let frames = run.frames.len();
    let gaps = &run.gaps;
    let plural = |n: u64, one: &str| format!("{n} {one}{}", if n == 1 { "" } else { "s" });
    lines.push(format!(
        "{} recorded, {} missing at {}",
        plural(frames as u64, "frame"),
        gaps.frames,
        plural(gaps.places, "place"),
    ));
    // What is measured beside the first frame began before the recording.
    let first = run.frames.first();
    let first = first.filter(|(_, frame)| frame.side_lines.measured.is_none());
    let unmeasured = frames - measured(run) - usize::from(first.is_some());
    if measured(run) > 0 && unmeasured > 0 {
        lines.push(format!(
            "{} without measured currents: their columns are empty there",
            plural(unmeasured as u64, "frame")
        ));
    }
    if let Some((device, presets)) = run.boot.and_then(|boot| boot.device.zip(boot.presets)) {
        lines.push(format!(
            "image built for device {device}, presets {presets}"
        ));
    }
    let others = |other: &&Run| !std::ptr::eq(*other, run);
    let left: Vec<_> = runs.iter().filter(others).map(|r| r.frames.len()).collect();
    if !left.is_empty() {
        lines.push(format!(
            "the firmware started {} times; left out: runs of {left:?} frames{remedy}",
            runs.len(),
        ));
    }
    let strays: u64 = runs.iter().map(|run| run.gaps.strays).sum();
    if strays > 0 {
        let strays = plural(strays, "damaged frame");
        lines.push(format!(
            "{strays} left out: seq and tick do not fit the neighbours"
        ));
    }
    if let Some(first) = telemetry.malformed.first() {
        let malformed = plural(telemetry.malformed.len() as u64, "piece");
        lines.push(format!(
            "{malformed} of the stream not readable, the first: {first}"
        ));
    }
    if let [(_, first), .., (_, last)] = run.frames.as_slice() {
        let late = last.overruns.wrapping_sub(first.overruns);
        if late > 0 {
            let late = plural(u64::from(late), "control tick");
            lines.push(format!(
                "{late} missed or late: t is too short by that number of periods"
            ));
        }
    }
    lines
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::recording::Recording;

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
}
