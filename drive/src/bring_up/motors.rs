//! The responses of both motors and of the coupler to the strokes, against the device file.

use std::f64::consts::TAU;

use drivers::link::Frame;
use tuned::DEVICE;

use crate::check::Line;
use crate::response::{Motion, Response};
use crate::strokes::Seen;

/// Bounds of a measured constant over that of the device file: outside of them a sign or a wire is wrong.
const WRONG: [f64; 2] = [0.3, 3.0];
/// Bounds outside of which the device file should be identified anew: it is assumed good to 15 %, and the
/// estimate here to as much.
const DIFFERS: [f64; 2] = [0.7, 1.4];
/// Least size of a response over that of the device file from which on its sign means something: the pull of the
/// coupler and friction leave a few per cent.
const HARDLY: f64 = 0.1;
/// Least part of the acceleration's variance that a motor's response explains.
const EXPLAINED: f64 = 0.5;

/// The responses of both motors to the strokes.
pub(super) fn motors(_: &'static str, seen: &Seen) -> Vec<Line> {
    // Frames that were lost would be steps of the angle: the longest run without a gap counts.
    let run = seen.longest_run();
    let angles = |count: fn(&Frame) -> u32, per_turn: u32| -> Vec<f64> {
        let first = run.first().map_or(0, count);
        let rad = |frame| f64::from(count(frame).wrapping_sub(first).cast_signed()) * TAU;
        run.iter()
            .map(|frame| rad(frame) / f64::from(per_turn))
            .collect()
    };
    let currents = |current: fn(&Frame) -> f32| -> Vec<f64> {
        run.iter().map(|frame| f64::from(current(frame))).collect()
    };
    let large = angles(|frame| frame.counts_large, DEVICE.large.counts_per_rev);
    let small = angles(|frame| frame.counts_small, DEVICE.small.counts_per_rev);
    let [of_large, of_small] = [
        (&large, &small, currents(|frame| frame.current)),
        (&small, &large, currents(|frame| frame.current_small)),
    ]
    .map(|(angle, coupled, current)| {
        Response::of(Motion {
            angle,
            coupled,
            current: &current,
        })
    });
    let mut lines = Vec::new();
    for (name, response, motor) in [
        ("large motor", of_large, DEVICE.large),
        ("small motor", of_small, DEVICE.small),
    ] {
        let gain = motor.torque_constant / motor.inertia;
        lines.push((name, gained(response, gain)));
    }
    // The handle's inertia is smaller, so that the coupler's pull shows more there.
    let pull = DEVICE.damping / DEVICE.small.inertia;
    if let Some(response) = of_small.filter(|_| lines.iter().all(|(_, result)| result.is_ok())) {
        lines.push(("coupler", coupled(response, pull)));
    }
    lines
}

const DIRECTION: &str = "a positive current has to turn its counts up";

/// Whether a motor turns its own counts up, as much as the device file says.
fn gained(response: Option<Response>, expected: f64) -> Result<String, String> {
    let moved = response.filter(|response| response.explained > EXPLAINED);
    let Some(Response { gain, .. }) = moved else {
        return Err(format!(
            "its current does not explain the motion of its encoder: check the motor's leads, both lines of \
             the encoder, and that its plug is not in the place of the other; {DIRECTION}"
        ));
    };
    let ratio = gain / expected;
    let found = format!("{gain:.0} rad/s² per A, {ratio:.2} of the device file");
    if ratio.abs() < HARDLY {
        Err(format!(
            "{found}: the motor hardly turns with its current; check its leads and its amplifier"
        ))
    } else if gain < 0.0 {
        Err(format!(
            "{found}: {DIRECTION}; exchange lines A and B of the encoder, or the motor's leads, so that \
             both shafts count up in one direction"
        ))
    } else {
        judged(found, ratio)
    }
}

/// Whether the coupler pulls the handle to where the large motor turns.
fn coupled(Response { coupling, .. }: Response, expected: f64) -> Result<String, String> {
    let ratio = coupling / expected;
    let found = format!("{coupling:.0} 1/s, {ratio:.2} of the device file");
    if ratio < WRONG[0] {
        Err(format!(
            "{found}: it should pull the handle to where the large motor turns; exchange lines A and B \
             and the leads of one motor, so that both shafts count up in one direction"
        ))
    } else {
        judged(found, ratio)
    }
}

/// A ratio that is right, differs, or is wrong.
fn judged(found: String, ratio: f64) -> Result<String, String> {
    let outside = |[low, high]: [f64; 2]| ratio < low || ratio > high;
    if outside(WRONG) {
        Err(format!(
            "{found}: check counts per turn, the amplifier's scale and the device file"
        ))
    } else if outside(DIFFERS) {
        Ok(format!(
            "{found}: identify this device (cargo sim identify) and build for its file"
        ))
    } else {
        Ok(found)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::response::tests::motion;
    use crate::watch::tests::FRAME;

    /// A handle that moves as the device file says beside a large motor without a current. The coupler is judged where
    /// both motors pass alone.
    #[test]
    fn frames_after_lost_ones_and_a_coupler_beside_a_failed_motor_are_left_out() {
        let gain = DEVICE.small.torque_constant / DEVICE.small.inertia;
        let [angle, coupled, current] = motion(gain, DEVICE.damping / DEVICE.small.inertia);
        let counts = |angle: f64, per_turn: u32| {
            let counts = (angle / TAU * f64::from(per_turn)).round();
            (counts as i32).cast_unsigned()
        };
        let frame = |k: usize| Frame {
            seq: k as u32,
            counts_large: counts(coupled[k], DEVICE.large.counts_per_rev),
            counts_small: counts(angle[k], DEVICE.small.counts_per_rev),
            current: 0.0,
            current_small: current[k] as f32,
            ..FRAME
        };
        let seen = Seen {
            // Half a period of the large motor is lost.
            frames: (0..2000).chain(2157..3000).map(frame).collect(),
            ..Seen::default()
        };
        let lines = motors("", &seen);
        let [("large motor", Err(said)), ("small motor", Ok(_))] = &lines[..] else {
            panic!("{lines:?}");
        };
        assert!(said.contains("check the motor's leads"), "{said}");
    }

    #[test]
    fn signs_and_sizes_of_responses_are_judged() {
        let response = |gain, coupling, explained| Response {
            gain,
            coupling,
            explained,
        };
        let gain = |gain, explained| gained(Some(response(gain, 0.0, explained)), 1000.0);
        let same = gain(1100.0, 0.9).unwrap();
        assert!(same.ends_with("1.10 of the device file"), "{same}");
        for differs in [600.0, 1600.0] {
            assert!(gain(differs, 0.9).unwrap().contains("identify"));
        }
        for (wrong, told) in [
            (-1000.0, "exchange"),
            (-150.0, "exchange"),
            (-20.0, "hardly turns"),
            (50.0, "hardly turns"),
            (200.0, "check counts"),
            (4000.0, "check counts"),
        ] {
            assert!(gain(wrong, 0.9).unwrap_err().contains(told), "{wrong}");
        }
        // On either side of each bound, by the factor of the device file and the part that is explained.
        let outcome = |result: Result<String, String>| match result {
            Ok(text) if text.contains("identify") => "differs",
            Ok(_) => "right",
            Err(text) if text.contains("hardly turns") => "hardly",
            Err(_) => "wrong",
        };
        for (ratio, expected) in [
            (0.09, "hardly"),
            (0.11, "wrong"),
            (0.29, "wrong"),
            (0.31, "differs"),
            (0.69, "differs"),
            (0.71, "right"),
            (1.39, "right"),
            (1.41, "differs"),
            (2.9, "differs"),
            (3.1, "wrong"),
        ] {
            assert_eq!(outcome(gain(1000.0 * ratio, 0.9)), expected, "{ratio}");
        }
        assert!(gain(1000.0, 0.49).unwrap_err().contains("does not explain"));
        assert_eq!(outcome(gain(1000.0, 0.51)), "right");
        assert!(gained(None, 1000.0).is_err());
        let pull = |coupling| coupled(response(0.0, coupling, 1.0), 100.0);
        assert!(pull(100.0).is_ok() && pull(-100.0).is_err());
        assert!(pull(29.0).unwrap_err().contains("pull the handle") && pull(31.0).is_ok());
        assert!(pull(400.0).unwrap_err().contains("check"));
    }
}
