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

/// Speed over a window from which on the large motor is stopped, rad/s.
pub(crate) const LARGE_OVERSPEED: f64 = 150.0;

/// Slots of a window.
const SLOTS: usize = 5;

/// Largest displacements, currents and times, in counts, mA and ticks.
///
/// Positions are marked once a slot, and each slot ends a window of five: speeds are displacements
/// over such a sliding window, exact in integers.
///
/// What pushes the large motor is its current and the coupler's pull, `b ω_S / Kt_L`; b is not
/// known well, so the push is the weaker of the current alone and the two together, over all ticks
/// of a slot: no weaker coupler makes it less. A motor that is pushed cannot run the other way
/// ever faster, and one that is pushed harder than its friction holds cannot stay where it is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Monitor {
    /// Ticks of a slot, at least 1.
    pub slot: u32,
    /// Largest displacement of the handle in a window.
    pub handle: u32,
    /// Largest displacement of the large motor in a window.
    pub large: u32,
    /// Largest displacement of either in one tick.
    pub jump: u32,
    /// Longest time that the large motor is pushed without getting anywhere, slots.
    pub stall: u32,
    /// Push that no friction of the large motor withstands, mA of its current.
    pub stall_milliamps: i32,
    /// Push whose direction is certain, mA.
    pub push_milliamps: i32,
    /// The coupler's pull for a count of the handle in a slot, 2^-8 mA.
    pub pull: i32,
}

/// State of a [`Monitor`]: it latches the first cause.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct MonitorState {
    last: [Count; 2],
    /// Ticks of this slot.
    ticks: u32,
    /// Smallest and largest current of this slot, mA.
    currents: (i32, i32),
    /// The large motor at the ends of the slots of two windows, the latest first.
    large: [Count; 2 * SLOTS],
    /// The handle at the ends of the slots of a window.
    small: [Count; SLOTS],
    /// Direction of the push, and for how many slots.
    push: (i32, u32),
    /// Where the large motor was when it last moved, and slots pushed since.
    resting: (Count, u32),
    cause: Option<Cause>,
}

const NO_CURRENT: (i32, i32) = (i32::MAX, i32::MIN);

impl Monitor {
    /// Limits that no scene of `device` reaches in a hand that holds the handle, at a control rate:
    /// the handle 30 rad/s and the large motor 150 rad/s, over 5 ms (what is wanted of the large
    /// motor ends at 85 % of that); 50 ms without a count under 2.5 times the current that the
    /// large motor's friction is worth, 0.1 A at least. (With friction half as much again, its
    /// ripple of a tenth and a torque constant 20 % less, 2.1 times are needed to move.)
    ///
    /// ```
    /// use estimator_core::Hertz;
    /// use haptic_control::{DualStage, Monitor};
    /// const MONITOR: Monitor = Monitor::new(&DualStage::DEFAULT, Hertz(10e3));
    /// assert_eq!((MONITOR.slot, MONITOR.handle, MONITOR.large), (10, 478, 489));
    /// assert_eq!((MONITOR.stall, MONITOR.stall_milliamps), (50, 213));
    /// ```
    #[must_use]
    pub const fn new(device: &DualStage, rate: Hertz) -> Self {
        let rounded = (0.001 * rate.0 + 0.5) as u32;
        let slot = if rounded == 0 { 1 } else { rounded };
        let slot_s = slot as f64 / rate.0;
        let turns_per_rad_per_s = SLOTS as f64 * slot_s / (2.0 * PI);
        let rad_per_s_per_count = 2.0 * PI / device.small.counts_per_rev as f64 / slot_s;
        let milliamps_per_nm = 1e3 / device.large.torque_constant;
        let friction = 2.5 * device.large.coulomb * milliamps_per_nm;
        let pull = device.damping * rad_per_s_per_count * milliamps_per_nm;
        Self {
            slot,
            handle: (30.0 * turns_per_rad_per_s * device.small.counts_per_rev as f64) as u32 + 1,
            large: (LARGE_OVERSPEED * turns_per_rad_per_s * device.large.counts_per_rev as f64)
                as u32
                + 1,
            jump: 1 << 14,
            stall: (0.05 / slot_s) as u32,
            stall_milliamps: if friction > 100.0 {
                friction as i32
            } else {
                100
            },
            push_milliamps: 80,
            pull: (256.0 * pull) as i32,
        }
    }

    /// State at the first sample, with nothing to complain of.
    #[must_use]
    pub const fn start(&self, first: &Sample) -> MonitorState {
        MonitorState {
            last: [first.large, first.small],
            ticks: 0,
            currents: NO_CURRENT,
            large: [first.large; 2 * SLOTS],
            small: [first.small; SLOTS],
            push: (0, 0),
            resting: (first.large, 0),
            cause: None,
        }
    }

    /// One tick; whatever was found first stays found.
    pub fn check(&self, state: &mut MonitorState, sample: &Sample) -> Option<Cause> {
        let now = [sample.large, sample.small];
        let [large, small] = [0, 1].map(|i| distance(now[i] - state.last[i]));
        state.last = now;
        let milliamps = (sample.current.get() * 1000.0) as i32;
        let (low, high) = state.currents;
        state.currents = (low.min(milliamps), high.max(milliamps));
        state.ticks += 1;
        let mut found = None;
        if state.ticks >= self.slot {
            found = self.slot(state, sample);
            state.ticks = 0;
            state.currents = NO_CURRENT;
        }
        if large > self.jump || small > self.jump {
            found = Some(Cause::Jump);
        }
        state.cause = state.cause.or(found);
        state.cause
    }

    /// The end of a slot.
    fn slot(&self, state: &mut MonitorState, sample: &Sample) -> Option<Cause> {
        let handled = sample.small - state.small[0];
        let push = self.push(state.currents, handled);
        let direction = if push.saturating_abs() > self.push_milliamps {
            push.signum()
        } else {
            0
        };
        state.push = match state.push {
            (before, slots) if before == direction => (direction, slots.saturating_add(1)),
            _ => (direction, 1),
        };
        let (rest, still) = state.resting;
        let hard = push.saturating_abs() > self.stall_milliamps;
        // An encoder with a dead phase dithers by a count or two and gets nowhere.
        state.resting = if hard && distance(sample.large - rest) <= DITHER {
            (rest, still.saturating_add(1))
        } else {
            (sample.large, 0)
        };

        let handle = sample.small - state.small[SLOTS - 1];
        let moved = sample.large - state.large[SLOTS - 1];
        let before = state.large[SLOTS - 1] - state.large[2 * SLOTS - 1];
        state.small.copy_within(..SLOTS - 1, 1);
        state.small[0] = sample.small;
        state.large.copy_within(..2 * SLOTS - 1, 1);
        state.large[0] = sample.large;

        // Along the push: negative and falling is away from it, ever faster.
        let [moved_along, before_along] =
            [moved, before].map(|way| way.0.saturating_mul(direction));
        let faster = before_along.saturating_sub(moved_along);
        if distance(handle) > self.handle {
            Some(Cause::HandleOverspeed)
        } else if distance(moved) > self.large {
            Some(Cause::LargeOverspeed)
        } else if state.push.1 > 2 * SLOTS as u32 && moved_along < 0 && faster > FASTER {
            Some(Cause::Against)
        } else if state.resting.1 > self.stall {
            Some(Cause::NotMoving)
        } else {
            None
        }
    }

    /// What pushed the large motor at least, all through a slot in which the handle was displaced,
    /// mA; zero where it was not one way.
    fn push(&self, (low, high): (i32, i32), handled: Counts) -> i32 {
        let pull = handled.0.saturating_mul(self.pull) / 256;
        let forwards = low.min(low.saturating_add(pull));
        let backwards = high.max(high.saturating_add(pull));
        forwards.max(0) + backwards.min(0)
    }
}

/// Counts by which an encoder may move without getting anywhere.
const DITHER: u32 = 2;

/// Counts by which two windows may differ though the motor did not speed up: one of rounding at
/// each of three instants, the middle one twice, and as much for the disc.
const FASTER: i32 = 4;

fn distance(displacement: Counts) -> u32 {
    displacement.0.unsigned_abs()
}
