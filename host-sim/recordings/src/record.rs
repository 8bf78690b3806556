//! Conversion of telemetry to a recording.

mod longest;

use std::fmt::Write as _;

use crate::recording::MEASURED;
use crate::telemetry::{
    COLUMNS, Column, Frame, LearnedLine, MeasuredLine, Run, SideLines, Telemetry,
};
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
///
/// A value that is not finite is an empty field. A frame whose command of a current is not finite has no row: no
/// command reads one without it.
#[must_use]
pub fn csv(run: &Run, rate_hz: f64, true_omega: impl Fn(&Frame) -> Option<f64>) -> String {
    let rows = || run.frames.iter().filter(|(_, frame)| is_row(frame));
    let truth: Option<Vec<f64>> = rows().map(|(_, f)| true_omega(f)).collect();
    let side = SideColumns::of(run);
    let known = |(_, value): &&Column| run.frames.iter().all(|(_, frame)| value(frame).is_some());
    let columns: Vec<_> = COLUMNS.iter().filter(known).collect();
    let mut text = "t".to_owned();
    for (name, _) in &columns {
        text.push(',');
        text += name;
    }
    text += &side.head();
    if truth.is_some() {
        text += ",true_omega";
    }
    text.push('\n');
    for (k, (tick, frame)) in rows().enumerate() {
        let t = *tick as f64 / rate_hz;
        // Writing to a string cannot fail.
        let _ = write!(text, "{t}");
        for (_, value) in &columns {
            text.push(',');
            text += &value(frame).unwrap_or_default();
        }
        side.write(&mut text, &frame.side_lines, t);
        if let Some(truth) = &truth {
            let _ = write!(text, ",{}", truth[k]);
        }
        text.push('\n');
    }
    text
}

/// Which optional columns a recording has from side lines.
struct SideColumns {
    edges: bool,
    measured: bool,
    supply: bool,
    learned: bool,
}

impl SideColumns {
    fn of(run: &Run) -> Self {
        let any = |is_there: fn(&SideLines) -> bool| {
            let mut frames = run.frames.iter();
            frames.any(|(_, frame)| is_there(&frame.side_lines))
        };
        Self {
            edges: any(|lines| lines.edge.is_some()),
            measured: measured(run) > 0,
            supply: any(|lines| lines.supply.is_some()),
            learned: any(|lines| lines.learned.is_some()),
        }
    }

    /// Their names, each behind a comma.
    fn head(&self) -> String {
        let [large, small] = MEASURED;
        let names = [
            (",edge_tick,edge_bound", self.edges),
            (&format!(",{large},{small}"), self.measured),
            (",supply", self.supply),
            (LEARNED, self.learned),
        ];
        let names = names.iter().filter(|(_, is_there)| *is_there);
        names.map(|(name, _)| *name).collect()
    }

    /// Writes the fields of a frame with these side lines at time `t`, s. A line that is missing leaves its fields
    /// empty.
    fn write(&self, text: &mut String, lines: &SideLines, t: f64) {
        // Writing to a string cannot fail.
        if self.edges {
            let _ = match lines.edge {
                None => write!(text, ",,"),
                Some(edge) => {
                    let now = (t * EDGE_CLOCK_HZ).round() as i64;
                    write!(text, ",{},{}", now - i64::from(edge.age), edge.boundary)
                }
            };
        }
        if self.measured {
            let _ = match lines.measured {
                None => write!(text, ",,"),
                Some(MeasuredLine { large, small }) => {
                    write!(text, ",{},{}", field(large), field(small))
                }
            };
        }
        if self.supply {
            let _ = match lines.supply {
                None => write!(text, ","),
                Some(volts) => write!(text, ",{}", field(volts)),
            };
        }
        if self.learned {
            let _ = match lines.learned {
                Some(LearnedLine {
                    damping,
                    friction,
                    torque_constant,
                }) if (damping + friction + torque_constant).is_finite() => {
                    write!(text, ",{damping},{friction},{torque_constant}")
                }
                _ => write!(text, ",,,"),
            };
        }
    }
}

/// Whether a frame has a row in a recording.
fn is_row(frame: &Frame) -> bool {
    (frame.current + frame.current_small).is_finite()
}

/// A value as a field, which is empty if it is not finite.
fn field(value: f64) -> String {
    match value.is_finite() {
        true => value.to_string(),
        false => String::new(),
    }
}

/// Whether a row of the frame has an empty field for a value that is not finite.
fn lacks(frame: &Frame) -> bool {
    let is_empty = |(_, value): &Column| value(frame).is_some_and(|text| text.is_empty());
    COLUMNS.iter().any(is_empty)
}

/// Number of frames with measured currents.
fn measured(run: &Run) -> usize {
    let has = |(_, frame): &&(u64, &Frame)| frame.side_lines.measured.is_some();
    run.frames.iter().filter(has).count()
}

/// The run to record: that of the given number, of which 1 is the first, by default the longest, and the first one of
/// several of this length.
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
    let number = |is: fn(&Frame) -> bool| run.frames.iter().filter(|(_, f)| is(f)).count() as u64;
    let left_out = number(|frame| !is_row(frame));
    if left_out > 0 {
        let left_out = plural(left_out, "frame");
        lines.push(format!(
            "{left_out} left out: the command of a current is not finite"
        ));
    }
    let lacking = number(|frame| is_row(frame) && lacks(frame));
    if lacking > 0 {
        let lacking = plural(lacking, "frame");
        lines.push(format!(
            "{lacking} with a value that is not finite: its field is empty there"
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
mod tests;
