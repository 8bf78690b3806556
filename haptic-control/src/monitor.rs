//! Checks of each tick that stop the device.

use core::f64::consts::PI;

use estimator_core::{Count, Counts, Hertz, Sample};

use crate::device::DualStage;
use crate::stop::Stop;

/// Speed over a window above which the large motor is stopped, rad/s.
pub(crate) const LARGE_OVERSPEED: f64 = 150.0;

/// Slots of a window.
const SLOTS: usize = 5;

/// Limits of displacements, currents and times, in counts, mA and ticks.
///
/// Positions are stored once per slot. A window is five slots, so a speed is the displacement over
/// a sliding window, exact in integers.
///
/// The drive of the large motor is its current plus the pull of the coupler, `b ω_S / Kt_L`, in mA
/// of its current. The damping b is uncertain, so the drive of a slot is the smaller of the current
/// alone and the sum of both, over all ticks of the slot: a weaker coupler does not reduce it. A
/// motor does not accelerate against its drive, and a motor whose drive exceeds its friction does
/// not rest.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Monitor {
    /// Ticks of a slot, at least 1.
    pub slot: u32,
    /// Largest displacement of the handle in a window, counts.
    pub handle_window: u32,
    /// Largest displacement of the large motor in a window, counts.
    pub large_window: u32,
    /// Largest displacement of either in one tick.
    pub jump: u32,
    /// Longest time in which the driven large motor may rest, slots.
    pub stall: u32,
    /// Drive above any friction of the large motor, mA of its current.
    pub stall_milliamps: i32,
    /// Drive whose direction is certain, mA.
    pub push_milliamps: i32,
    /// Pull of the coupler per count that the handle moves in a slot, 2^-8 mA.
    pub pull: i32,
}

/// State of a [`Monitor`], which latches the first cause.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct MonitorState {
    last: [Count; 2],
    /// Number of ticks of the present slot so far.
    ticks: u32,
    /// Smallest and largest current in the present slot, mA.
    currents: (i32, i32),
    /// Positions of the large motor and of the handle at the ends of slots, from which those of two windows
    /// are needed.
    ends: [Ring; 2],
    /// Number of the latest slot.
    latest: usize,
    /// Direction of the drive, and the number of slots with this direction.
    push: (i32, u32),
    /// Position of the large motor when it last moved, and the number of driven slots since.
    resting: (Count, u32),
    /// Whether the present slot is longer than others.
    given_up: bool,
    cause: Option<Stop>,
}

impl MonitorState {
    /// The latched cause.
    #[must_use]
    pub const fn cause(&self) -> Option<Stop> {
        self.cause
    }

    /// Gives up the present slot, for example because it misses ticks: at its end nothing is checked, and windows
    /// are those of the other slots.
    pub const fn give_up_slot(&mut self) {
        self.given_up = true;
    }

    /// Moves the positions at the ends of slots, so that nothing has moved since the latest end.
    fn pass_slot(&mut self, sample: &Sample) {
        for (ends, now) in self.ends.iter_mut().zip([sample.count, sample.coupled]) {
            let moved = now - ends.before(self.latest, 0);
            for end in &mut ends.0 {
                *end = *end + moved;
            }
        }
        self.given_up = false;
    }
}

const NO_CURRENT: (i32, i32) = (i32::MAX, i32::MIN);

impl Monitor {
    /// Limits that no scene of `device` reaches while a hand holds the handle, at a control rate:
    /// the handle 30 rad/s and the large motor 150 rad/s over 5 ms (the commanded velocity of the
    /// large motor is at most 85 % of that); 50 ms without a count under 2.5 times the current of
    /// the large motor's friction, at least 0.1 A. (A motor with 1.5 times the friction, 10 %
    /// ripple and a torque constant 20 % lower moves at 2.1 times that current.)
    ///
    /// ```
    /// use estimator_core::Hertz;
    /// use haptic_control::{DualStage, Monitor};
    /// const MONITOR: Monitor = Monitor::new(&DualStage::DEFAULT, Hertz(10e3));
    /// assert_eq!((MONITOR.slot, MONITOR.handle_window, MONITOR.large_window), (10, 478, 489));
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
        let friction = 2.5 * device.large.coulomb_friction * milliamps_per_nm;
        let pull = device.damping * rad_per_s_per_count * milliamps_per_nm;
        Self {
            slot,
            handle_window: (30.0 * turns_per_rad_per_s * device.small.counts_per_rev as f64) as u32
                + 1,
            large_window: (LARGE_OVERSPEED
                * turns_per_rad_per_s
                * device.large.counts_per_rev as f64) as u32
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

    /// State at the first sample, without a cause.
    #[must_use]
    pub const fn start(&self, first: &Sample) -> MonitorState {
        MonitorState {
            last: [first.count, first.coupled],
            ticks: 0,
            currents: NO_CURRENT,
            ends: [Ring([first.count; RING]), Ring([first.coupled; RING])],
            latest: 0,
            push: (0, 0),
            resting: (first.count, 0),
            given_up: false,
            cause: None,
        }
    }

    /// One tick. The first cause is latched.
    pub fn check(&self, state: &mut MonitorState, sample: &Sample) -> Option<Stop> {
        self.follow(state, sample);
        state.ticks += 1;
        if state.ticks >= self.slot {
            self.end_slot(state, sample);
        }
        state.cause
    }

    /// The part of [`Self::check`] that is due in every tick: a jump of a position, and the range of the
    /// current. Returns the latched cause in a tick with a jump.
    #[inline]
    pub fn follow(&self, state: &mut MonitorState, sample: &Sample) -> Option<Stop> {
        let now = [sample.count, sample.coupled];
        let moved = [0, 1].map(|i| now[i] - state.last[i]);
        state.last = now;
        let milliamps = (sample.current.get() * 1000.0) as i32;
        let (low, high) = state.currents;
        state.currents = (low.min(milliamps), high.max(milliamps));
        // One test of both: a displacement within the bound is not negative after the bound is added.
        let [large, small] = moved.map(|counts| counts.0.wrapping_add(self.jump as i32) as u32);
        if large.max(small) > self.jump.saturating_mul(2) {
            state.cause = state.cause.or(Some(Stop::Jump));
            return state.cause;
        }
        None
    }

    /// The rest of [`Self::check`], in the last tick of a slot. A caller that has a schedule calls it once
    /// in the ticks of a slot. Over a slot that is shorter a motor may be faster. Returns the latched cause.
    #[cold]
    #[inline(never)]
    pub fn end_slot(&self, state: &mut MonitorState, sample: &Sample) -> Option<Stop> {
        if state.given_up {
            state.pass_slot(sample);
        } else {
            let found = self.slot(state, sample);
            state.cause = state.cause.or(found);
        }
        state.ticks = 0;
        state.currents = NO_CURRENT;
        state.cause
    }

    /// Checks at the end of a slot.
    fn slot(&self, state: &mut MonitorState, sample: &Sample) -> Option<Stop> {
        let handled = sample.coupled - state.ends[1].before(state.latest, 0);
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
        // An encoder with a dead phase alternates between neighbouring counts.
        state.resting = if hard && distance(sample.count - rest) <= DITHER {
            (rest, still.saturating_add(1))
        } else {
            (sample.count, 0)
        };

        let [large, small] = &mut state.ends;
        let start = large.before(state.latest, SLOTS - 1);
        let handle = sample.coupled - small.before(state.latest, SLOTS - 1);
        let moved = sample.count - start;
        let before = start - large.before(state.latest, 2 * SLOTS - 1);
        state.latest = state.latest.wrapping_add(1);
        large.store(state.latest, sample.count);
        small.store(state.latest, sample.coupled);

        // Displacements along the drive. A negative, decreasing one is an acceleration against it.
        let accelerates_against = || {
            let [moved_along, before_along] =
                [moved, before].map(|displacement| displacement.0.saturating_mul(direction));
            moved_along < 0 && before_along.saturating_sub(moved_along) > FASTER
        };
        if distance(handle) > self.handle_window {
            Some(Stop::HandleOverspeed)
        } else if distance(moved) > self.large_window {
            Some(Stop::LargeOverspeed)
        } else if direction != 0 && state.push.1 > 2 * SLOTS as u32 && accelerates_against() {
            Some(Stop::RunawayDirection)
        } else if state.resting.1 > self.stall {
            Some(Stop::Stall)
        } else {
            None
        }
    }

    /// The smallest drive of the large motor in a slot with this displacement of the handle, mA;
    /// zero if its direction changed.
    fn push(&self, (low, high): (i32, i32), handled: Counts) -> i32 {
        let pull = handled.0.saturating_mul(self.pull) / 256;
        let forwards = low.min(low.saturating_add(pull));
        let backwards = high.max(high.saturating_add(pull));
        forwards.max(0) + backwards.min(0)
    }
}

/// Counts by which the encoder of a resting motor may change.
const DITHER: u32 = 2;

/// Counts by which the displacements of two windows may differ at constant speed: one count of
/// rounding at each of three instants, the middle one twice, and one for errors of the disc.
const FASTER: i32 = 4;

/// Slots that a [`Ring`] holds: at least those of two windows, and a power of two, so that no index is out of
/// bounds.
const RING: usize = (2 * SLOTS).next_power_of_two();

/// Positions at the ends of the latest slots, by the number of the slot.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Ring([Count; RING]);

impl Ring {
    /// The position at the end of the slot that was this number of slots before the slot `latest`.
    fn before(&self, latest: usize, slots: usize) -> Count {
        self.0[latest.wrapping_sub(slots) % RING]
    }

    fn store(&mut self, slot: usize, position: Count) {
        self.0[slot % RING] = position;
    }
}

fn distance(displacement: Counts) -> u32 {
    displacement.0.unsigned_abs()
}
