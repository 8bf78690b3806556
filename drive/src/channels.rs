//! The currents of both motors: commands, measured currents, amplifiers.

use std::collections::HashMap;

use drivers::link::{Frame, Hello, Measured};
use drivers::{FULL_SCALES, Setting};
use estimator_core::Amps;
use haptic_control::{Excite, Mode};
use tuned::DEVICE;

use crate::strokes::Seen;

/// Feature of an image that measures currents.
pub(crate) const FEATURE: &str = "current-monitor";

/// Consecutive frames that a pair needs, all with one command and in the running scene. The measured
/// current beside the last one is the mean since the last but one. The command is three milliseconds old
/// by then: an amplifier of 300 Hz has 0.4 % of a step left.
const FRAMES: usize = 5;

/// A motor with its amplifier.
pub(crate) struct Channel {
    /// Name of the motor.
    pub(crate) motor: &'static str,
    /// Name of the check of its current.
    pub(crate) check: &'static str,
    command: fn(&Frame) -> f32,
    measured: fn(&Measured) -> f32,
    /// Current at the ends of the DAC.
    pub(crate) full_scale: Amps,
    /// Largest current in the strokes.
    pub(crate) stroke: Amps,
    /// Current limit of the motor, A.
    pub(crate) limit: f64,
    /// Settings of its DAC.
    pub(crate) zero: Setting,
    pub(crate) gain: Setting,
}

/// Both motors.
pub(crate) const CHANNELS: [Channel; 2] = [
    Channel {
        motor: "large motor",
        check: "current, large motor",
        command: |frame| frame.current,
        measured: |measured| measured.large,
        full_scale: FULL_SCALES[0],
        stroke: Excite::STROKES.large,
        limit: DEVICE.large.current_limit,
        zero: Setting::ZeroLarge,
        gain: Setting::GainLarge,
    },
    Channel {
        motor: "small motor",
        check: "current, small motor",
        command: |frame| frame.current_small,
        measured: |measured| measured.small,
        full_scale: FULL_SCALES[1],
        stroke: Excite::STROKES.small,
        limit: DEVICE.small.current_limit,
        zero: Setting::ZeroSmall,
        gain: Setting::GainSmall,
    },
];

/// Whether an image measures currents.
pub(crate) fn are_measured(hello: &Hello) -> bool {
    hello.features.has(FEATURE)
}

/// Steady commands, each with its measured current, A.
pub(crate) fn pairs(seen: &Seen, channel: &Channel) -> Vec<[f64; 2]> {
    let measured: HashMap<_, _> = seen.measured.iter().map(|it| (it.seq, it)).collect();
    let pair = |frames: &[Frame]| {
        let [first, .., last] = frames else {
            return None;
        };
        let command = (channel.command)(first);
        let is_steady = |frame: &Frame| {
            (channel.command)(frame) == command && frame.state == Mode::Running as u8
        };
        let is_whole = last.seq.wrapping_sub(first.seq) as usize == FRAMES - 1;
        let measured = measured.get(&last.seq)?;
        let pair = [command, (channel.measured)(measured)].map(f64::from);
        (is_whole && frames.iter().all(is_steady)).then_some(pair)
    };
    seen.frames.windows(FRAMES).filter_map(pair).collect()
}

#[cfg(test)]
pub(crate) mod tests {
    use drivers::link::FEATURES;

    use super::*;
    use crate::watch::tests::FRAME;

    /// Commands in blocks of 12 frames of both signs, as in the strokes, with the currents that `flows`
    /// makes of motor and command; those of the three milliseconds after a change are far off.
    pub(crate) fn seen(flows: impl Fn(usize, f32) -> f32) -> Seen {
        let mut seen = Seen::default();
        let mut before = [0.0; 2];
        for seq in 0..1200 {
            let level = [1.0, -1.0, 0.4, 0.0, -0.4, 0.7, -0.7][seq as usize / 12 % 7];
            let [current, current_small] = [0.3 * level, -0.15 * level];
            // The mean since the frame before is that of the command before.
            let [large, small] = [0, 1].map(|motor| match seq % 12 {
                1..=3 => 9.0,
                _ => flows(motor, before[motor]),
            });
            before = [current, current_small];
            seen.frames.push(Frame {
                seq,
                current,
                current_small,
                state: Mode::Running as u8,
                ..FRAME
            });
            seen.measured.push(Measured { seq, large, small });
        }
        seen
    }

    #[test]
    fn feature_is_one_of_the_firmware() {
        assert!(FEATURES.contains(&FEATURE));
    }

    #[test]
    fn lost_frames_and_frames_outside_the_scene_make_no_pair() {
        let number = |change: fn(&mut Seen)| {
            let mut seen = seen(|_, command| command);
            change(&mut seen);
            pairs(&seen, &CHANNELS[0]).len()
        };
        assert_eq!(number(|_| ()), 800);
        // Frame 6 of a block is in five windows of this block, of which the first one ends with it.
        let lost = number(|seen| {
            seen.frames.remove(606);
        });
        let armed = number(|seen| seen.frames[606].state = Mode::Armed as u8);
        let unmeasured = number(|seen| {
            seen.measured.remove(606);
        });
        assert_eq!([lost, armed, unmeasured], [795, 795, 799]);
    }
}
