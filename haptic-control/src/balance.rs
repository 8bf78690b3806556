//! Whether the torques on the large motor balance: a check of the handle's encoder while the device runs.

mod judgement;
mod range;
mod window;

use core::f64::consts::PI;

use estimator_core::{Count, Hertz, Sample};

use crate::device::DualStage;
use crate::stop::Stop;

use range::Range;
use window::{Block, EMPTY, REST, Terms};

/// Balance of the large motor's torques over windows of 20 ms.
///
/// With the motion `J dω_L/dt = Kt i - b (ω_L - ω_S) - friction`, divided by Kt and averaged over a window,
///
/// ```text
/// c = α a + β s + d φ
/// c  mean current of the large motor
/// a  J Δω_L / (Kt T), s = b (Δθ_L - Δθ_S) / (Kt T)     with the constants of the description
/// φ  friction / Kt along the direction d of the motion, and the amplifier's zero
/// α, β  true J / Kt and b / Kt over those of the description
/// ```
///
/// The torque of the hand is not in it. α, β and φ are unknown within ranges. A window that no values in
/// these ranges explain is [`Stop::TorqueBalance`]: the handle's encoder counts backwards or not at all, or
/// another part between current and motion of the large motor fails. A handle's encoder that counts backwards
/// changes the right side by `2 β b ω_S / Kt`.
///
/// **Ranges before the first window.** J is known to 30 %, Kt to 20 %, b to 40 %. Friction is 0 to 1.5 times
/// the described one, and 10 % more along a turn; at least 50 mA are assumed to be described. The amplifier's
/// zero is within 15 of 2047 steps of the current limit. A motor that does not turn in one direction
/// throughout has any friction between those of both directions.
///
/// **Errors of measurement.** A position is off by less than one count, and by a third of a count more of the
/// large encoder's disc. Charge and positions are means over a window, so that T Δω_L is the difference of the
/// displacements in two windows. The current acts later than it is commanded by up to two times the
/// amplifier's lag and a tick.
///
/// **Learning.** Each window narrows the ranges of β and, of a motor that turns, of φ in its direction to
/// what explains the window. 5 % of β and 40 % of the described friction are added on both sides, which
/// friction varies by along a turn and with speed. The ranges widen again with 1.5 % and 10 % of these
/// quantities per second, for a coupler that becomes warm: three times the 30 % in 60 s of the description.
///
/// **Two windows of the same direction**, with one between them, have the same friction within 40 % of the
/// described one, and the same amplifier's zero. Their difference is checked with these.
///
/// Nothing is found while the large motor rests: static friction takes up any torque of the coupler below it.
///
/// The work is spread over five ticks: four in succession, and one a fifth of a quarter after the second of
/// these. Those of [`Balance::start`] do not end a slot of
/// [`Monitor`](crate::Monitor).
///
/// ```
/// use estimator_core::{Amps, Count, Hertz, Sample};
/// use haptic_control::{Balance, DualStage, Stop};
/// const BALANCE: Balance = Balance::new(&DualStage::DEFAULT, Hertz(10e3));
/// // Both shafts turn at 15.3 rad/s, and the current is that of the friction.
/// let turning = |k: i32, large: i32, milliamps: f32| {
///     Sample::new(Count((large * k) as u32))
///         .with_coupled(Count((large * 5 * k) as u32))
///         .with_current(Amps::new(milliamps / 1000.0))
/// };
/// let mut state = BALANCE.start(&turning(0, 1, 85.0));
/// assert!((1..5000).all(|k| BALANCE.check(&mut state, &turning(k, 1, 85.0)).is_none()));
/// // The handle would turn backwards with this current: 2 b ω = 29 mN·m are 0.63 A.
/// let found = (5000..6000).find_map(|k| BALANCE.check(&mut state, &turning(k, 1, 715.0)));
/// assert_eq!(found, Some(Stop::TorqueBalance));
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Balance {
    /// Ticks of a quarter of a window, at least 5.
    quarter: u32,
    /// Ticks from the first part of learning to the second.
    later: u32,
    /// Ticks until the first window begins.
    first: u32,
    /// Windows in a tick.
    per_window: f32,
    /// a per count that the displacement in a window changes to the next one, A.
    inertia: f32,
    /// Coupler's torque over Kt per count of the large and of the small motor in a window, A.
    drag: [f32; 2],
    /// Error by positions, A.
    rounding: f32,
    /// Error by the amplifier's lag, per change of the current.
    lag: f32,
    /// Friction over Kt with the amplifier's zero, A.
    friction: Range,
    /// Variation of the friction over Kt, A.
    variation: f32,
    /// Widening of a friction's range in a window, A.
    friction_drift: f32,
    /// Widening of β's range in a window.
    damping_drift: f32,
}

/// State of a [`Balance`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BalanceState {
    /// Ticks until the next event.
    left: u32,
    event: Event,
    /// Sum of the currents in the present window, A, and the sum of that over its ticks.
    charge: f32,
    area: f32,
    /// Counts at the begin of the present window, and weighted sums of the displacements since.
    large: Count,
    small: Count,
    sums: [i32; 2],
    /// Displacement of the large motor at the end of the quarter before, and its direction in every quarter.
    quarters: i32,
    direction: Option<i32>,
    /// The present window, and the one before; `None` if it is not whole.
    block: Block,
    before: Option<Block>,
    now: Terms,
    /// What the friction of the present window has to be.
    remainder: Range,
    /// The terms before those of now, the latest first.
    past: [Terms; PAST],
    /// β.
    damping: Range,
    /// Friction along the motion, forwards and backwards, with the amplifier's zero, A.
    friction: [Range; 2],
}

/// The next thing to do.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Event {
    /// Begin a window.
    Begin,
    /// Take the positions after one, two, three and four quarters.
    First,
    Second,
    Third,
    Fourth,
    /// Compute the terms and check them.
    Judge,
    /// Compare them with those before.
    Compare,
    /// Narrow the range of β, and then those of the friction.
    LearnDamping,
    LearnFriction,
}

/// Terms that are kept. Those of two windows in succession have half of their time in common.
const PAST: usize = 2;
/// Quarter of a window, s.
const QUARTER_S: f64 = 0.005;

const INERTIA: (f64, f64) = (0.7, 1.3);
const CONSTANT: (f64, f64) = (0.8, 1.2);
const DAMPING: (f64, f64) = (0.6, 1.4);
/// 1.5, and 10 % along a turn.
const LARGEST_FRICTION: f64 = 1.65;
/// Described friction that is assumed at least, A.
const LEAST_FRICTION: f64 = 0.05;
const ZERO: f64 = 15.0 / 2047.0;
/// Variation of the friction, over the described one.
const VARIATION: f64 = 0.4;

const ALPHA: Range = quotient(INERTIA);
const BETA: Range = quotient(DAMPING);
/// What β varies by.
const TIGHT: (f32, f32) = (0.95, 1.05);
/// Parts of a second's widening.
const DRIFT: (f64, f64) = (0.015, 0.1);

/// Error of a position of the large encoder and of the handle's, counts.
const POSITION: (f64, f64) = (1.33, 1.0);
/// Displacement of the large motor in every quarter of a window that has a certain direction, counts: more than
/// the errors of two positions. A motor that rests or turns back for a part of a window has less friction in
/// the mean, and one that does so and still moves by this much in each quarter has it for a small part.
const TURNS: i32 = 4;

const fn quotient((low, high): (f64, f64)) -> Range {
    Range {
        low: (low / CONSTANT.1) as f32,
        high: (high / CONSTANT.0) as f32,
    }
}

impl Balance {
    /// The balance of `device` at a control rate.
    #[must_use]
    pub const fn new(device: &DualStage, rate: Hertz) -> Self {
        let quarter = match (QUARTER_S * rate.0 + 0.5) as u32 {
            ticks if ticks > 5 => ticks,
            _ => 5,
        };
        // In a schedule of a millisecond, the tick after the one that begins and ends windows.
        let later = match quarter / 5 {
            ticks if ticks > 3 => ticks - 2,
            _ => 1,
        };
        let window = 4 * quarter;
        let window_s = window as f64 / rate.0;
        let constant = device.large.torque_constant;
        let radians = [
            2.0 * PI / device.large.counts_per_rev as f64,
            2.0 * PI / device.small.counts_per_rev as f64,
        ];
        let inertia = device.large.inertia * radians[0] / (window_s * window_s) / constant;
        let drag = device.damping / constant / window_s;
        let described = device.large.coulomb_friction / constant;
        let friction = if described > LEAST_FRICTION {
            described
        } else {
            LEAST_FRICTION
        };
        let zero = ZERO * device.large.current_limit;
        // The change of a displacement has four positions, the slip two of each encoder.
        let rounding = inertia * ALPHA.high as f64 * 4.0 * POSITION.0
            + drag * BETA.high as f64 * 2.0 * (radians[0] * POSITION.0 + radians[1] * POSITION.1);
        let late_s = 2.0 * device.amplifier_lag() + 1.0 / rate.0;
        Self {
            quarter,
            later,
            first: 1 + (0.0005 * rate.0) as u32,
            per_window: 1.0 / window as f32,
            inertia: inertia as f32,
            drag: [(drag * radians[0]) as f32, (drag * radians[1]) as f32],
            rounding: rounding as f32,
            lag: (late_s / window_s) as f32,
            friction: Range {
                low: -zero as f32,
                high: (friction * LARGEST_FRICTION / CONSTANT.0 + zero) as f32,
            },
            variation: (VARIATION * friction) as f32,
            friction_drift: (DRIFT.1 * friction * window_s) as f32,
            damping_drift: (DRIFT.0 * window_s) as f32,
        }
    }

    /// State at the first sample, without a finding and without knowledge.
    #[must_use]
    pub const fn start(&self, first: &Sample) -> BalanceState {
        BalanceState {
            left: self.first,
            event: Event::Begin,
            charge: 0.0,
            area: 0.0,
            large: first.count,
            small: first.coupled,
            sums: [0; 2],
            quarters: 0,
            direction: None,
            block: EMPTY,
            before: None,
            now: REST,
            remainder: self.friction,
            past: [REST; PAST],
            damping: BETA,
            friction: [self.friction; 2],
        }
    }

    /// One tick, with the current over the period that ends now. The finding of a window is returned once.
    pub fn check(&self, state: &mut BalanceState, sample: &Sample) -> Option<Stop> {
        state.add(sample);
        self.pass(state, sample, 1)
    }

    /// The rest of [`Self::check`] after [`BalanceState::add`], for the last of so many ticks. A caller that
    /// has a schedule calls it in the ticks in which something may be due: the four that
    /// [`BalanceState::begin_after`] leads to, and those a quarter of a window later.
    #[inline]
    pub fn pass(&self, state: &mut BalanceState, sample: &Sample, ticks: u32) -> Option<Stop> {
        state.left = state.left.saturating_sub(ticks);
        if state.left > 0 {
            return None;
        }
        self.event(state, sample)
    }

    /// Does what is due. It is a function of its own because most ticks do not call it.
    #[cold]
    #[inline(never)]
    fn event(&self, state: &mut BalanceState, sample: &Sample) -> Option<Stop> {
        let mut balanced = true;
        (state.event, state.left) = match state.event {
            Event::Begin => {
                (state.before, state.past) = (None, [REST; PAST]);
                state.begin(sample);
                (Event::First, self.quarter)
            }
            // Simpson's rule: the mean is (0 + 4 + 2 + 4 + 1) / 12 of the displacements.
            Event::First => {
                state.moved(sample, 4);
                (Event::Second, self.quarter)
            }
            Event::Second => {
                state.moved(sample, 2);
                (Event::Third, self.quarter)
            }
            Event::Third => {
                state.moved(sample, 4);
                (Event::Fourth, self.quarter)
            }
            Event::Fourth => {
                let [large, small] = state.moved(sample, 1);
                let [sum_large, sum_small] = state.sums.map(|sum| sum as f32 / 12.0);
                state.block = Block {
                    direction: state.direction.unwrap_or(0),
                    end: [state.charge, large as f32, small as f32],
                    mean: [state.area * self.per_window, sum_large, sum_small],
                };
                state.begin(sample);
                (Event::Judge, 1)
            }
            Event::Judge => {
                if let Some(before) = state.before {
                    state.now = self.terms(&before, &state.block);
                    state.remainder = Self::remainder(state);
                    balanced = state.remainder.meets(Self::friction(state));
                }
                (Event::Compare, 1)
            }
            Event::Compare => {
                balanced = state.before.is_none() || self.follows(state);
                (Event::LearnDamping, 1)
            }
            Event::LearnDamping => {
                if state.before.is_some() {
                    self.learn_damping(state);
                }
                (Event::LearnFriction, self.later)
            }
            Event::LearnFriction => {
                if state.before.is_some() {
                    self.learn_friction(state);
                    state.past.copy_within(..PAST - 1, 1);
                    state.past[0] = state.now;
                }
                state.before = Some(state.block);
                (Event::First, self.quarter - 3 - self.later)
            }
        };
        (!balanced).then_some(Stop::TorqueBalance)
    }
}

impl BalanceState {
    /// The part of [`Balance::check`] that is due in every tick.
    #[inline]
    pub fn add(&mut self, sample: &Sample) {
        self.charge += sample.current.get();
        self.area += self.charge;
    }

    /// Begins a new window after this number of ticks, at least 1, and gives up the present one, for
    /// example because it misses ticks.
    pub const fn begin_after(&mut self, ticks: u32) {
        self.left = if ticks == 0 { 1 } else { ticks };
        self.event = Event::Begin;
    }

    /// Begins a window at this sample.
    const fn begin(&mut self, sample: &Sample) {
        (self.large, self.small) = (sample.count, sample.coupled);
        (self.charge, self.area, self.sums) = (0.0, 0.0, [0; 2]);
        (self.quarters, self.direction) = (0, None);
    }

    /// Adds the displacements since the begin of the window, which are returned, to their sums.
    fn moved(&mut self, sample: &Sample, weight: i32) -> [i32; 2] {
        let moved = [sample.count - self.large, sample.coupled - self.small].map(|counts| counts.0);
        for (sum, counts) in self.sums.iter_mut().zip(moved) {
            *sum = sum.wrapping_add(counts.wrapping_mul(weight));
        }
        let quarter = moved[0].wrapping_sub(self.quarters);
        let direction = if quarter >= TURNS {
            1
        } else if quarter <= -TURNS {
            -1
        } else {
            0
        };
        self.direction = match self.direction {
            Some(before) if before != direction => Some(0),
            _ => Some(direction),
        };
        self.quarters = moved[0];
        moved
    }
}
