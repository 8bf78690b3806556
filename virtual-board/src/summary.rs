//! Summary of a run, as `cargo board` prints it.

use std::fmt::Write as _;

use drivers::NO_ESTIMATOR;
use haptic_control::SceneKind;

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

/// The summary of a run of `scene`, one line per quantity.
pub(crate) fn summary(scene: SceneKind, setup: &Setup, outcome: &Outcome) -> String {
    let mut out = String::new();
    let mut line = |name: &str, text: String| {
        // Writing to a string cannot fail.
        let _ = writeln!(out, "{name:<22}{text}");
    };
    let speed = setup.seconds / outcome.wall.as_secs_f64();
    line(
        "run",
        format!(
            "{} s of {}, seed {}, {speed:.1} virtual s a second",
            setup.seconds, scene, setup.seed
        ),
    );
    for complaint in &outcome.complaints {
        line("WIRING", complaint.clone());
    }
    for objection in &outcome.objections {
        line("NOT MODELLED", objection.clone());
    }
    for said in &outcome.telemetry.log {
        line("log", said.clone());
    }
    for restart in &outcome.restarts {
        line(
            "RESTART",
            format!("{:.4} s, {}", restart.at_s, restart.cause),
        );
    }
    let built_for = outcome.telemetry.boots.last().and_then(|boot| boot.device);
    let here = setup.device.stages.fingerprint();
    if let Some(other) = built_for.filter(|device| *device != here) {
        line(
            "DEVICE",
            format!(
                "the image is built for device {other}, this run has device {here}: build the image \
                 with DEVICE=FILE.toml and give the same file as --device"
            ),
        );
    }
    let range = |range: Option<Range>, unit: &str| {
        range.map_or("none".to_owned(), |r| {
            format!("{} to {}, mean {:.1} {unit}", r.min, r.max, r.mean)
        })
    };
    if let Some(cost) = outcome.instructions() {
        line("control tick", range(Some(cost), "instructions"));
        line(
            "share of the period",
            budget::share(cost, outcome.rate_hz()),
        );
    } else {
        let text = "none with both amplifiers enabled";
        line("control tick", text.to_owned());
    }
    line("control period", range(outcome.periods(), "ns"));
    let malformed = outcome.telemetry.malformed.len();
    let frames = &outcome.telemetry.frames;
    line("frames", format!("{}, {malformed} malformed", frames.len()));
    if let Some(last) = frames.last() {
        line("mode", numbered(last.state.as_str(), last.state as u8));
        line(
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
            line("estimator", name);
        }
        line("missed control ticks", last.overruns.to_string());
        line("lost frames", last.drops.to_string());
    }
    if let Some(learned) = frames
        .iter()
        .rev()
        .find_map(|frame| frame.side_lines.learned)
    {
        line(
            "learned",
            format!(
                "deviation of damping {:+.3}, of friction {:+.3}, of the torque constant {:+.3}",
                learned.damping, learned.friction, learned.torque_constant
            ),
        );
    }
    for (at_ns, [large, small]) in outcome.enables.iter().skip(1) {
        let name = |on: &bool| if *on { "on" } else { "off" };
        let at = *at_ns as f64 * 1e-9;
        line(
            "amplifiers",
            format!("{at:.5} s: large {}, small {}", name(large), name(small)),
        );
    }
    let diameter = setup.device.handle.diameter_m;
    match outcome.parasitic(SETTLED_S, diameter) {
        Some(force) => line(
            "parasitic force",
            format!("{:.2} mN rms, {:.2} mN at most", force.rms_mn, force.max_mn),
        ),
        None => line(
            "parasitic force",
            format!(
                "unknown, because {}",
                no_force(setup.seconds, !outcome.restarts.is_empty())
            ),
        ),
    }
    out
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
