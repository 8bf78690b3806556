//! Telemetry as a recording.

use std::fmt::Write as _;

use crate::failure::Failure;
use crate::telemetry::{Frame, Run, Telemetry};

/// The columns: those that [`Recording`](crate::recording::Recording) knows, then what the board
/// made of them.
const COLUMNS: &str = "t,counts_large,counts_small,current,current_small,torque,velocity_large,\
    velocity_small,state,cause";

/// A run as CSV: one row a frame, `t` from its first frame, by its ticks and the control rate.
///
/// `true_omega` is a last column, if every frame has one.
#[must_use]
pub fn csv(run: &Run, rate_hz: f64, true_omega: impl Fn(&Frame) -> Option<f64>) -> String {
    let truth: Option<Vec<f64>> = run.frames.iter().map(|(_, f)| true_omega(f)).collect();
    let mut text = COLUMNS.to_owned();
    text += if truth.is_some() {
        ",true_omega\n"
    } else {
        "\n"
    };
    for (k, (tick, frame)) in run.frames.iter().enumerate() {
        let t = *tick as f64 / rate_hz;
        let Frame {
            large,
            small,
            il,
            is,
            torque,
            wl,
            ws,
            state,
            cause,
            ..
        } = frame;
        // Writing to a string cannot fail.
        let _ = write!(
            text,
            "{t},{large},{small},{il},{is},{torque},{wl},{ws},{state},{cause}"
        );
        if let Some(truth) = &truth {
            let _ = write!(text, ",{}", truth[k]);
        }
        text.push('\n');
    }
    text
}

/// Which run to record, 1 is the first; without a number the longest.
///
/// # Errors
/// [`Failure::Input`] where there is none, or none of two frames.
pub fn choose<'a, 'b>(runs: &'b [Run<'a>], number: Option<usize>) -> Result<&'b Run<'a>, Failure> {
    let run = match number {
        None => runs.iter().rev().max_by_key(|run| run.frames.len()),
        Some(number) => runs.get(number.wrapping_sub(1)),
    };
    let run = run.ok_or_else(|| {
        let (number, runs) = (number.unwrap_or_default(), runs.len());
        Failure::Input(format!("--run {number}: there are {runs} runs, from 1"))
    })?;
    if run.frames.len() < 2 {
        return Err(Failure::Input(
            "only one telemetry frame in a run; a recording needs two at least".to_owned(),
        ));
    }
    Ok(run)
}

/// What was lost of a run, and what is not in its recording, in lines.
#[must_use]
pub fn report(telemetry: &Telemetry, runs: &[Run], run: &Run) -> Vec<String> {
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
    let others = |other: &&Run| !std::ptr::eq(*other, run);
    let left: Vec<_> = runs.iter().filter(others).map(|r| r.frames.len()).collect();
    if !left.is_empty() {
        lines.push(format!(
            "the firmware began {} times; left out: runs of {left:?} frames (--run N takes another)",
            runs.len(),
        ));
    }
    let strays: u64 = runs.iter().map(|run| run.gaps.strays).sum();
    if strays > 0 {
        let strays = plural(strays, "damaged frame");
        lines.push(format!("{strays} left out: numbers that fit nowhere"));
    }
    if let Some(first) = telemetry.malformed.first() {
        let malformed = plural(telemetry.malformed.len() as u64, "piece");
        lines.push(format!("{malformed} not readable, the first: {first}"));
    }
    if let [(_, first), .., (_, last)] = run.frames.as_slice() {
        let late = last.overruns.wrapping_sub(first.overruns);
        if late > 0 {
            let late = plural(u64::from(late), "control tick");
            lines.push(format!("{late} missed or late: t is that much short"));
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

    #[test]
    fn a_log_becomes_a_recording_that_replay_reads() {
        let telemetry = Telemetry::text(log(0..4).as_bytes());
        let runs = telemetry.runs();
        let run = choose(&runs, None).unwrap();
        let text = csv(run, run.rate_hz.unwrap(), |_| None);
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
            report(&telemetry, &runs, run),
            ["4 frames recorded, 0 missing at 0 places"]
        );
    }

    #[test]
    fn the_longest_run_is_recorded_and_the_others_are_told() {
        let text = log(3..8) + &log(0..3) + "frame seq=";
        let telemetry = Telemetry::text((text + "\n").as_bytes());
        let runs = telemetry.runs();
        assert_eq!(choose(&runs, None).unwrap().frames.len(), 5);
        let second = choose(&runs, Some(2)).unwrap();
        assert_eq!(second.frames.len(), 3);
        let said = report(&telemetry, &runs, second);
        assert!(
            said[1].contains("began 2 times; left out: runs of [5]"),
            "{said:?}"
        );
        assert!(said[2].contains("1 piece not readable"), "{said:?}");
        assert!(choose(&runs, Some(3)).is_err() && choose(&runs, Some(0)).is_err());
        let one = Telemetry::text(log(0..1).as_bytes());
        assert!(choose(&one.runs(), None).is_err());
        assert!(choose(&[], None).is_err());
    }
}
