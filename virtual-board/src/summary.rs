//! Summary of a run, as `cargo board` prints it.

use std::fmt::{Display, Write as _};

use drivers::NO_ESTIMATOR;
use haptic_control::SceneKind;
use recordings::telemetry::Telemetry;

use crate::budget::{self, SETTLED_S};
use crate::run::{Outcome, Setup};
use crate::score::Range;

/// Name of a state or a cause with its code in telemetry.
fn numbered(name: &str, number: u8) -> String {
    format!("{} ({number})", name.replace('-', " "))
}

/// Why a run of this length has no parasitic force.
fn no_force(seconds: f64, was_reset: bool) -> String {
    if seconds <= SETTLED_S {
        format!("the run ends before the settling time of {SETTLED_S} s; give a longer --seconds")
    } else if was_reset {
        // The ticks of the frames begin again.
        "the firmware was reset".to_owned()
    } else {
        "no frame came after the start".to_owned()
    }
}

/// Lines of a name and a text each.
#[derive(Default)]
struct Lines(String);

impl Lines {
    fn add(&mut self, name: &str, text: impl Display) {
        // Writing to a string cannot fail.
        let _ = writeln!(self.0, "{name:<22}{text}");
    }
}

/// The summary of a run of `scene`, one line per quantity.
pub(crate) fn summary(scene: SceneKind, setup: &Setup, outcome: &Outcome) -> String {
    let mut lines = Lines::default();
    let speed = setup.seconds / outcome.wall.as_secs_f64();
    lines.add(
        "run",
        format!(
            "{} s of {}, seed {}, {speed:.1} virtual s a second",
            setup.seconds, scene, setup.seed
        ),
    );
    add_findings(&mut lines, setup, outcome);
    add_ticks(&mut lines, outcome);
    add_frames(&mut lines, &outcome.telemetry);
    for (at_ns, [large, small]) in outcome.enables.iter().skip(1) {
        let name = |on: &bool| if *on { "on" } else { "off" };
        let at = *at_ns as f64 * 1e-9;
        lines.add(
            "amplifiers",
            format!("{at:.5} s: large {}, small {}", name(large), name(small)),
        );
    }
    let diameter = setup.device.handle.diameter_m;
    let force = match outcome.parasitic(SETTLED_S, diameter) {
        Some(force) => format!("{:.2} mN rms, {:.2} mN at most", force.rms_mn, force.max_mn),
        None => format!(
            "unknown, because {}",
            no_force(setup.seconds, !outcome.restarts.is_empty())
        ),
    };
    lines.add("parasitic force", force);
    lines.0
}

/// What is wrong with the image or with the run, and the image's log.
fn add_findings(lines: &mut Lines, setup: &Setup, outcome: &Outcome) {
    for complaint in &outcome.complaints {
        lines.add("WIRING", complaint);
    }
    for objection in &outcome.objections {
        lines.add("NOT MODELLED", objection);
    }
    for said in &outcome.telemetry.log {
        lines.add("log", said);
    }
    for restart in &outcome.restarts {
        lines.add(
            "RESTART",
            format!("{:.4} s, {}", restart.at_s, restart.cause),
        );
    }
    let built_for = outcome.telemetry.boots.last().and_then(|boot| boot.device);
    let here = setup.device.stages.fingerprint();
    if let Some(other) = built_for.filter(|device| *device != here) {
        lines.add(
            "DEVICE",
            format!(
                "the image is built for device {other}, this run has device {here}: build the image \
                 with DEVICE=FILE.toml and give the same file as --device"
            ),
        );
    }
}

/// Length and distance of the control ticks.
fn add_ticks(lines: &mut Lines, outcome: &Outcome) {
    let range = |range: Option<Range>, unit: &str| {
        range.map_or("none".to_owned(), |r| {
            format!("{} to {}, mean {:.1} {unit}", r.min, r.max, r.mean)
        })
    };
    if let Some(cost) = outcome.instructions() {
        lines.add("control tick", range(Some(cost), "instructions"));
        lines.add(
            "share of the period",
            budget::share(cost, outcome.rate_hz()),
        );
    } else {
        lines.add("control tick", "none with both amplifiers enabled");
    }
    lines.add("control period", range(outcome.periods(), "ns"));
}

/// Number of the telemetry frames, and the state that the last one tells.
fn add_frames(lines: &mut Lines, telemetry: &Telemetry) {
    let malformed = telemetry.malformed.len();
    let frames = &telemetry.frames;
    lines.add("frames", format!("{}, {malformed} malformed", frames.len()));
    if let Some(last) = frames.last() {
        lines.add("mode", numbered(last.state.as_str(), last.state as u8));
        lines.add(
            "cause of the stop",
            numbered(last.cause.as_str(), last.cause as u8),
        );
        if let (Some(estimator), Some(sigma)) = (last.estimator, last.sigma_large) {
            let name = match estimator {
                NO_ESTIMATOR => "none in charge".to_owned(),
                number => {
                    format!(
                        "number {number}, which gives its standard deviation as {sigma:.3} rad/s"
                    )
                }
            };
            lines.add("estimator", name);
        }
        lines.add("missed control ticks", last.overruns);
        lines.add("lost frames", last.drops);
    }
    let mut latest = frames.iter().rev();
    if let Some(learned) = latest.find_map(|frame| frame.side_lines.learned) {
        lines.add(
            "learned",
            format!(
                "deviation of damping {:+.3}, of friction {:+.3}, of the torque constant {:+.3}",
                learned.damping, learned.friction, learned.torque_constant
            ),
        );
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use haptic_control::{Mode, Stop};

    #[test]
    fn missing_force_has_its_reason() {
        let short = "the run ends before the settling time of 0.4 s; give a longer --seconds";
        assert_eq!(no_force(0.35, false), short);
        assert_eq!(no_force(0.4, true), short);
        assert_eq!(no_force(1.0, true), "the firmware was reset");
        assert_eq!(no_force(1.0, false), "no frame came after the start");
    }

    #[test]
    fn codes_of_telemetry_have_names() {
        let mode = |mode: Mode| numbered(mode.as_str(), mode as u8);
        assert_eq!(mode(Mode::Safe), "safe (3)");
        assert_eq!(mode(Mode::Settling), "settling (4)");
        let cause = |cause: Stop| numbered(cause.as_str(), cause as u8);
        assert_eq!(cause(Stop::None), "none (0)");
        assert_eq!(cause(Stop::Stall), "not moving (4)");
    }
}
