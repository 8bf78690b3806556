//! Detection of a moving start, and the gain after it.

use super::gain::Gain;
use super::innovation::Innovation;

/// Detector of a motor that is already moving at the first sample.
///
/// The estimate begins at rest, so the first innovations are then large. They must not be attributed
/// to parameter errors, and the gains of an observer that adapts its parameters are small. A moving
/// start is detected by an innovation e, n ticks after the one before, that exceeds the error of the
/// first position and of the parameters at the ends of their range, while the age is below
/// 1 / K_v:
/// ```text
/// |e| > 1/2 + 0.6 |v| n
/// ```
/// From there until the age reaches 1 / K_v, the velocity is the mean since that point, propagated
/// by the model, `K_v = 1 / max(1, age)`, and the disturbance has no gain.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct MovingStart {
    phase: Phase,
    /// Ticks from the start to the last correction; after a moving start, from its detection.
    age: f32,
}

/// Phase of the detection.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Phase {
    /// No innovation contradicts a start at rest.
    AtRest,
    /// A moving start was detected.
    Moving,
    /// The start is over.
    Over,
}

/// Largest error of the first position, counts: half a quantisation interval.
const POSITION_ERROR: f32 = 0.5;

impl MovingStart {
    /// The detector at the first sample.
    pub(super) const fn new() -> Self {
        Self {
            phase: Phase::AtRest,
            age: 0.0,
        }
    }

    /// Whether a moving start was detected and its velocity is not found yet.
    pub(super) fn is_moving(&self) -> bool {
        self.phase == Phase::Moving
    }

    /// The gain that replaces `gain` after a moving start. `velocity` is the predicted velocity,
    /// `largest_error` the largest relative error of the damping.
    #[inline(always)]
    pub(super) fn gain(
        &mut self,
        innovation: &Innovation,
        gain: &Gain,
        velocity: f32,
        largest_error: f32,
    ) -> Option<Gain> {
        let gap = innovation.gap;
        if self.phase == Phase::Over || gap == 0.0 {
            return None;
        }
        self.age += gap;
        if self.age * gain.velocity >= 1.0 {
            self.phase = Phase::Over;
            return None;
        }
        if self.phase == Phase::AtRest {
            let explained = POSITION_ERROR + largest_error * velocity.abs() * gap;
            if innovation.error.abs() <= explained {
                return None;
            }
            self.phase = Phase::Moving;
            self.age = gap;
        }
        let age = self.age;
        Some(Gain {
            velocity: if age > 1.0 { 1.0 / age } else { 1.0 },
            disturbance: 0.0,
            ..*gain
        })
    }
}
