//! The values of a row, from a frame and from what a simulation knows of it.

use std::f64::consts::TAU;

use channels::Values;
use drivers::link::Frame;
use experiments::transparency::Fingertip;
use simulation::device::Device;

use crate::tactile::Tactile;

/// What only the emulated board knows of a frame.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Truth {
    /// Virtual time, s.
    pub(crate) t: f64,
    pub(crate) large: [f64; 2],
    pub(crate) handle: [f64; 2],
    /// Torque on the hand, N.m.
    pub(crate) felt: f64,
    /// Currents of the motors, A.
    pub(crate) currents: [f64; 2],
    /// Largest number of instructions of a tick since the frame before.
    pub(crate) instructions: u32,
    /// Intended angle of the hand, rad.
    pub(crate) hand: Option<f64>,
}

/// Converts frames to the units of the channels.
pub(crate) struct Conversion {
    /// Angles of a count of both encoders, rad.
    turn_rad: [f64; 2],
    fingertip: Fingertip,
    tactile: Tactile,
}

impl Conversion {
    /// For the encoders and the handle of a device.
    pub(crate) fn new(device: &Device) -> Self {
        let stages = &device.stages;
        let turns = [stages.large.counts_per_rev, stages.small.counts_per_rev];
        Self {
            turn_rad: turns.map(|counts| TAU / f64::from(counts)),
            fingertip: Fingertip::new(device),
            tactile: Tactile::new(),
        }
    }

    /// The values of a frame at time `t`, s, with its truth if it is known.
    pub(crate) fn values(&mut self, t: f64, frame: &Frame, truth: Option<&Truth>) -> Values {
        let mut values = self.told(t, frame);
        if let Some(truth) = truth {
            self.add_truth(&mut values, truth, frame.seq);
        }
        values
    }

    /// What the board tells.
    fn told(&self, t: f64, frame: &Frame) -> Values {
        let angle = |counts: u32, turn: f64| f64::from(counts as i32) * turn;
        // The board sends zeros where the scene needs no velocity.
        let needed = |value: f32| match frame.sigma_large {
            0.0 => f64::NAN,
            _ => value.into(),
        };
        Values {
            t,
            velocity_large: needed(frame.velocity_large),
            sigma_large: needed(frame.sigma_large),
            velocity_small: frame.velocity_small.into(),
            torque: frame.torque.into(),
            current: frame.current.into(),
            current_small: frame.current_small.into(),
            cycles: frame.cycles.into(),
            large_angle: angle(frame.counts_large, self.turn_rad[0]),
            handle_angle: angle(frame.counts_small, self.turn_rad[1]),
            state: frame.state.into(),
            cause: frame.cause.into(),
            estimator: frame.estimator.into(),
            overruns: frame.overruns.into(),
            drops: frame.drops.into(),
            ..Values::default()
        }
    }

    /// Adds what only a simulation knows of the frame of this number.
    fn add_truth(&mut self, values: &mut Values, truth: &Truth, seq: u32) {
        [values.large_angle, values.true_omega] = truth.large;
        [values.handle_angle, values.true_handle] = truth.handle;
        [values.current_large_true, values.current_small_true] = truth.currents;
        values.felt = truth.felt;
        values.force = truth.felt * self.fingertip.mn_per_nm;
        values.parasitic = (truth.felt - values.torque) * self.fingertip.mn_per_nm;
        values.instructions = truth.instructions.into();
        values.hand_angle = truth.hand.unwrap_or(f64::NAN);
        values.tactile = self.tactile.next(values.parasitic, seq);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn velocity_that_a_scene_does_not_need_has_no_value() {
        let mut conversion = Conversion::new(&Device::default());
        let mut velocity = |sigma_large: f32| {
            let frame = Frame {
                sigma_large,
                velocity_large: 3.0,
                ..Frame::default()
            };
            conversion.values(0.0, &frame, None).velocity_large
        };
        assert_eq!(velocity(0.5), 3.0);
        assert!(velocity(0.0).is_nan());
    }

    #[test]
    fn force_is_the_torque_over_the_radius_and_what_the_scene_does_not_want_is_parasitic() {
        let device = Device::default();
        let frame = Frame {
            torque: 0.25,
            ..Frame::default()
        };
        let truth = Truth {
            t: 0.0,
            large: [0.0; 2],
            handle: [0.0; 2],
            felt: 0.75,
            currents: [0.0; 2],
            instructions: 0,
            hand: None,
        };
        let values = Conversion::new(&device).values(0.0, &frame, Some(&truth));
        let torque_nm = |force_mn: f64| force_mn / 1e3 * device.handle.diameter_m / 2.0;
        assert!((torque_nm(values.force) - 0.75).abs() < 1e-9);
        assert!((torque_nm(values.parasitic) - 0.5).abs() < 1e-9);
    }
}
