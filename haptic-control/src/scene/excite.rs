use estimator_core::{Amps, Hertz, Skip};

use super::{Handle, Scene};
use crate::design_error::DesignError;
use crate::device::DualStage;
use crate::limits::Currents;
use crate::tuning::parameters;
use crate::units::{NewtonMetres, Radians};

mod pattern;

use pattern::{LARGEST, LARGEST_OF_STROKES, SECTIONS, Segment};

/// Excitation to identify the device from a recording: a fixed pattern of currents, open loop.
///
/// The first section has short strokes of both motors, in which a free handle stays within its
/// bounds. The other sections are for a clamped handle: steps between levels and slow sweeps of
/// the large motor. Each section runs four times with alternating sign, 16 s in all. The pattern
/// ends at zero current and does not repeat. Levels change at whole milliseconds, so that a
/// recording at 1 kHz contains the exact currents.
///
/// The currents are at most 0.9 A (large) and 0.15 A (small). A motor gets a part of them, the same in
/// the whole pattern, where its current limit is lower, or where 0.9 A against the coupler of a held
/// handle would drive the large motor beyond 60 rad/s. The excitation ends when the handle is more
/// than 2 rad from its angle at the start, or faster than 25 rad/s over a millisecond.
///
/// ```
/// use estimator_core::{Amps, Hertz};
/// use haptic_control::{DualStage, Excite};
/// let largest = |device| Excite::new(device, Hertz(10e3)).unwrap().largest().large;
/// assert_eq!(largest(&DualStage::DEFAULT), Amps::new(0.9));
/// // With half the damping, 0.9 A would drive the large motor at 88 rad/s.
/// let weak = DualStage { damping: 0.48e-3, ..DualStage::DEFAULT };
/// assert!((largest(&weak).get() - 0.9 * 60.0 / 87.75).abs() < 1e-6);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Excite {
    rate_hz: u32,
    /// Part of the pattern's current that each motor gets, large and small.
    share: [f32; 2],
}

parameters! { Excite }

/// State of an [`Excite`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ExciteState {
    /// Angle of the handle at the start, and a millisecond ago.
    start: Radians,
    before: Radians,
    /// Time into the millisecond, in parts of 1/1000 of a tick: a millisecond has as many as the rate in Hz.
    part: u32,
    section: u8,
    pass: u8,
    segment: u8,
    /// Step of the segment, and milliseconds into it.
    step: u8,
    elapsed: u16,
    currents: Currents,
}

/// Largest speed of the large motor, rad/s.
const LARGE_SPEED: f64 = 60.0;
/// Number of runs of a section, with alternating sign.
const PASSES: u8 = 4;

impl Excite {
    /// Largest angle of the handle from the start.
    pub const LARGEST_ANGLE: Radians = Radians(2.0);
    /// Largest change of the handle's angle in a millisecond.
    pub const LARGEST_STEP: Radians = Radians(0.025);

    /// Largest currents of the strokes, with which the pattern begins.
    pub const STROKES: Currents = {
        let [large, small] = LARGEST_OF_STROKES;
        Currents {
            large: Amps::new(large as f32 / 1000.0),
            small: Amps::new(small as f32 / 1000.0),
        }
    };

    /// Duration of the strokes, s.
    ///
    /// ```
    /// assert_eq!(haptic_control::Excite::STROKES_SECONDS, 3.888);
    /// ```
    pub const STROKES_SECONDS: f64 = {
        let strokes = SECTIONS[0];
        let (mut pass_ms, mut i) = (0, 0);
        while i < strokes.len() {
            pass_ms += strokes[i].steps as u32 * strokes[i].hold_ms as u32;
            i += 1;
        }
        (PASSES as u32 * pass_ms) as f64 / 1000.0
    };

    /// The excitation of `device` by a controller that runs at `rate`.
    ///
    /// # Errors
    /// [`DesignError::ExciteRate`] unless the rate is 1 to 100 kHz.
    pub const fn new(device: &DualStage, rate: Hertz) -> Result<Self, DesignError> {
        if !(rate.0 >= 1e3 && rate.0 <= 100e3) {
            return Err(DesignError::ExciteRate);
        }
        let [large, small] = [LARGEST[0] as f64 / 1000.0, LARGEST[1] as f64 / 1000.0];
        let at_speed = LARGE_SPEED * device.damping / device.large.torque_constant;
        let limit = least(device.large.current_limit, at_speed);
        Ok(Self {
            rate_hz: (rate.0 + 0.5) as u32,
            share: [
                least(1.0, limit / large) as f32,
                least(1.0, device.small.current_limit / small) as f32,
            ],
        })
    }

    /// Largest currents of the pattern.
    #[must_use]
    pub fn largest(&self) -> Currents {
        let [large, small] = LARGEST;
        self.currents(f32::from(large), f32::from(small))
    }

    /// The currents where the pattern has these, mA.
    fn currents(&self, large: f32, small: f32) -> Currents {
        let amps = |milliamps: f32, share: f32| Amps::new(share * (milliamps / 1000.0));
        Currents {
            large: amps(large, self.share[0]),
            small: amps(small, self.share[1]),
        }
    }
}

const fn least(a: f64, b: f64) -> f64 {
    if a < b { a } else { b }
}

impl ExciteState {
    fn segment(&self) -> Option<&'static Segment> {
        SECTIONS
            .get(usize::from(self.section))
            .and_then(|section| section.get(usize::from(self.segment)))
    }

    fn end(&mut self) {
        self.section = SECTIONS.len() as u8;
        self.currents = Currents::default();
    }

    /// Advances by a millisecond.
    fn advance(&mut self) {
        let Some(segment) = self.segment() else {
            return self.end();
        };
        self.elapsed += 1;
        if self.elapsed < segment.hold_ms {
            return;
        }
        self.elapsed = 0;
        self.step += 1;
        if self.step < segment.steps {
            return;
        }
        self.step = 0;
        self.segment += 1;
        if self.segment().is_some() {
            return;
        }
        self.segment = 0;
        self.pass += 1;
        if self.pass == PASSES {
            self.pass = 0;
            self.section += 1;
        }
    }

    fn drive(&mut self, excite: &Excite) {
        let Some(segment) = self.segment() else {
            return self.end();
        };
        let sign = if self.pass % 2 == 0 { 1.0 } else { -1.0 };
        let (large, small) = (segment.large(self.step), f32::from(segment.small));
        self.currents = excite.currents(sign * large, sign * small);
    }
}

impl Scene for Excite {
    type Velocity = Skip;
    type Acceleration = Skip;
    type Continuous = Skip;
    type Transient = Skip;
    type State = ExciteState;

    fn start(&self, angle: Radians) -> ExciteState {
        ExciteState {
            start: angle,
            before: angle,
            part: 0,
            section: 0,
            pass: 0,
            segment: 0,
            step: 0,
            elapsed: 0,
            currents: Currents::default(),
        }
    }

    fn torque(&self, state: &mut ExciteState, handle: &Handle<()>) -> NewtonMetres {
        // The first tick is the start of the first millisecond.
        state.drive(self);
        state.part += 1000;
        if state.part >= self.rate_hz {
            state.part -= self.rate_hz;
            state.advance();
            let (angle, moved) = (
                handle.angle.0 - state.start.0,
                handle.angle.0 - state.before.0,
            );
            state.before = handle.angle;
            let within = |x: f32, bound: f32| x < bound && x > -bound;
            if !within(angle, Self::LARGEST_ANGLE.0) || !within(moved, Self::LARGEST_STEP.0) {
                state.end();
            }
        }
        NewtonMetres(0.0)
    }

    fn open_loop(state: &ExciteState) -> Option<Currents> {
        Some(state.currents)
    }
}
