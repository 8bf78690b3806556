//! What stops the device: a pure check of each tick that the firmware's safety state calls too.

use core::f64::consts::PI;

use estimator_core::{Count, Counts, Hertz, Sample};

use crate::device::DualStage;

/// Why the device was stopped.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Cause {
    /// The handle moved faster than allowed.
    HandleOverspeed,
    /// The large motor moved faster than allowed.
    LargeOverspeed,
    /// A counter jumped further than any motion could.
    Jump,
    /// The large motor's current was high for long and its encoder did not move.
    NotMoving,
    /// The large motor sped up against its current: an encoder's phases are swapped, or a motor's.
    Against,
}

impl Cause {
    /// Name in tables and recordings.
    #[must_use]
    pub const fn as_str(self) -> &'static str {
        match self {
            Self::HandleOverspeed => "handle-overspeed",
            Self::LargeOverspeed => "large-overspeed",
            Self::Jump => "jump",
            Self::NotMoving => "not-moving",
            Self::Against => "against",
        }
    }
}

/// Largest displacements and times, in counts and ticks.
///
/// Speeds are displacements over `window` ticks, exact in integers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Monitor {
    /// Ticks over which speed is measured, at least 1.
    pub window: u32,
    /// Largest displacement of the handle in a window.
    pub handle: u32,
    /// Largest displacement of the large motor in a window.
    pub large: u32,
    /// Largest displacement of either in one tick.
    pub jump: u32,
    /// Longest time at a current above `stall_milliamps` without getting anywhere, ticks.
    pub stall: u32,
    /// Magnitude of the large motor's current from which it has to move, mA.
    pub stall_milliamps: u32,
}

/// State of a [`Monitor`]: it latches the first cause.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct MonitorState {
    last: [Count; 2],
    window_start: [Count; 2],
    ticks: u32,
    /// Displacement of the large motor in the window before.
    before: Counts,
    /// Where the large motor was when it last moved.
    resting: Count,
    still: u32,
    /// Ticks for which the large motor's current has been high in one direction, and that one.
    pushed: (u32, i32),
    cause: Option<Cause>,
}

impl Monitor {
    /// Limits that no scene of `device` reaches at a control rate: the handle 30 rad/s and the
    /// large motor 150 rad/s, over 5 ms; 250 ms at more than 1 A without a count.
    ///
    /// ```
    /// use estimator_core::Hertz;
    /// use haptic_control::{DualStage, Monitor};
    /// const MONITOR: Monitor = Monitor::new(&DualStage::DEFAULT, Hertz(10e3));
    /// assert_eq!((MONITOR.window, MONITOR.handle, MONITOR.large), (50, 478, 489));
    /// ```
    #[must_use]
    pub const fn new(device: &DualStage, rate: Hertz) -> Self {
        let rounded = (0.005 * rate.0 + 0.5) as u32;
        let window = if rounded == 0 { 1 } else { rounded };
        let turns_per_rad_per_s = window as f64 / rate.0 / (2.0 * PI);
        Self {
            window,
            handle: (30.0 * turns_per_rad_per_s * device.small.counts_per_rev as f64) as u32 + 1,
            large: (150.0 * turns_per_rad_per_s * device.large.counts_per_rev as f64) as u32 + 1,
            jump: 1 << 14,
            stall: (0.25 * rate.0) as u32,
            stall_milliamps: 1000,
        }
    }

    /// State at the first sample, with nothing to complain of.
    #[must_use]
    pub const fn start(&self, first: &Sample) -> MonitorState {
        MonitorState {
            last: [first.large, first.small],
            window_start: [first.large, first.small],
            ticks: 0,
            before: Counts(0),
            resting: first.large,
            still: 0,
            pushed: (0, 0),
            cause: None,
        }
    }

    /// One tick; whatever was found first stays found.
    pub fn check(&self, state: &mut MonitorState, sample: &Sample) -> Option<Cause> {
        let now = [sample.large, sample.small];
        let [large, small] = [0, 1].map(|i| distance(now[i] - state.last[i]));
        state.last = now;
        let milliamps = (sample.current.get() * 1000.0) as i32;
        let push = if milliamps.unsigned_abs() > self.stall_milliamps {
            milliamps.signum()
        } else {
            0
        };
        // An encoder with a dead phase dithers by a count or two and gets nowhere.
        if push == 0 || distance(sample.large - state.resting) > DITHER {
            state.resting = sample.large;
            state.still = 0;
        } else {
            state.still = state.still.saturating_add(1);
        }
        state.pushed = match state.pushed {
            (ticks, direction) if direction == push => (ticks.saturating_add(1), push),
            _ => (1, push),
        };
        state.ticks += 1;
        let mut found = None;
        if state.still > self.stall {
            found = Some(Cause::NotMoving);
        }
        if state.ticks >= self.window {
            state.ticks = 0;
            let [moved, handled] = [0, 1].map(|i| now[i] - state.window_start[i]);
            let [large, handle] = [moved, handled].map(distance);
            state.window_start = now;
            // In the direction of the push: negative and falling is away from it, ever faster.
            let (ticks, push) = state.pushed;
            let along = [moved, state.before].map(|moved| moved.0.saturating_mul(push));
            state.before = moved;
            let faster = along[1].saturating_sub(along[0]);
            if ticks > self.window && along[0] < 0 && faster > 2 * DITHER as i32 {
                found = Some(Cause::Against);
            }
            if large > self.large {
                found = Some(Cause::LargeOverspeed);
            }
            if handle > self.handle {
                found = Some(Cause::HandleOverspeed);
            }
        }
        if large > self.jump || small > self.jump {
            found = Some(Cause::Jump);
        }
        state.cause = state.cause.or(found);
        state.cause
    }
}

/// Counts by which an encoder may move without getting anywhere.
const DITHER: u32 = 2;

fn distance(displacement: Counts) -> u32 {
    displacement.0.unsigned_abs()
}
