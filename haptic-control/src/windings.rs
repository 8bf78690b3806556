//! The heat of both windings, from the squares of their currents.

use estimator_core::Hertz;

use crate::device::{DualStage, Motor};
use crate::limits::Currents;
use crate::stop::Stop;

/// Thermal models of both windings.
///
/// The heat of a winding is `x += (i² - x) dt / (τ + dt)` in A², for the mean i² of 10 ms and the
/// thermal time constant τ of the winding. A heat above the square of the continuous current is an
/// overload. A constant current I from the cold thus takes `τ ln(1 / (1 - (I_c / I)²))` to an
/// overload, and none if it is at most I_c.
///
/// Copper does not cool when the device is armed. The state is therefore made once, at boot, and gets
/// the applied currents of every tick, in every mode. A reset forgets the heat.
///
/// ```
/// use estimator_core::{Amps, Hertz};
/// use haptic_control::{Currents, DualStage, Stop, Windings, WindingsState};
/// const WINDINGS: Windings = Windings::new(&DualStage::DEFAULT, Hertz(10e3));
/// let held = Currents { large: Amps::ZERO, small: Amps::new(1.5) };
/// let mut state = WindingsState::cold();
/// let ticks = (0..).take_while(|_| WINDINGS.check(&mut state, &held).is_none()).count();
/// assert_eq!(ticks / 10_000, 1); // 1.94 s
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Windings {
    /// Ticks of a slot, 10 ms, at least 1.
    slot: u32,
    /// Part of a slot in a tick.
    per_slot: f32,
    /// Large and small motor.
    windings: [Winding; 2],
}

#[derive(Clone, Copy, Debug, PartialEq)]
struct Winding {
    /// Share of the difference by which the heat changes in a slot.
    gain: f32,
    /// Largest heat, A².
    largest: f32,
}

/// State of [`Windings`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WindingsState {
    /// Ticks of the present slot so far.
    ticks: u32,
    /// Sums of the squared currents in the present slot, A².
    sums: [f32; 2],
    /// A².
    heat: [f32; 2],
    overload: Option<Stop>,
}

/// A longer slot costs time; in a shorter one the heat changes by too little for an f32.
const SLOT_S: f64 = 0.01;

impl WindingsState {
    /// Both windings have the temperature of their surroundings.
    #[must_use]
    pub const fn cold() -> Self {
        Self {
            ticks: 0,
            sums: [0.0; 2],
            heat: [0.0; 2],
            overload: None,
        }
    }

    /// [`Stop::Overload`] as long as a winding is too hot.
    #[must_use]
    pub const fn overload(&self) -> Option<Stop> {
        self.overload
    }
}

impl Winding {
    const fn new(motor: &Motor, slot_s: f64) -> Self {
        Self {
            gain: (slot_s / (motor.winding_time_constant + slot_s)) as f32,
            largest: (motor.continuous_current * motor.continuous_current) as f32,
        }
    }
}

impl Windings {
    /// The windings of a device, at a control rate.
    #[must_use]
    pub const fn new(device: &DualStage, rate: Hertz) -> Self {
        let rounded = (SLOT_S * rate.0 + 0.5) as u32;
        let slot = if rounded == 0 { 1 } else { rounded };
        let slot_s = slot as f64 / rate.0;
        Self {
            slot,
            per_slot: 1.0 / slot as f32,
            windings: [
                Winding::new(&device.large, slot_s),
                Winding::new(&device.small, slot_s),
            ],
        }
    }

    /// One tick, with the currents that were applied over the period that ends now.
    /// [`Stop::Overload`] as long as a winding is too hot.
    pub fn check(&self, state: &mut WindingsState, applied: &Currents) -> Option<Stop> {
        self.add(state, applied);
        self.pass(state, 1)
    }

    /// The part of [`Self::check`] that is due in every tick.
    #[inline]
    pub fn add(&self, state: &mut WindingsState, applied: &Currents) {
        let [large, small] = [applied.large.get(), applied.small.get()];
        state.sums[0] += large * large;
        state.sums[1] += small * small;
    }

    /// The rest of [`Self::check`], for the last of so many ticks. Ends a slot if it is over. A caller that
    /// has a schedule calls it once in so many ticks, of which a slot has a multiple.
    pub fn pass(&self, state: &mut WindingsState, ticks: u32) -> Option<Stop> {
        state.ticks += ticks;
        if state.ticks >= self.slot {
            self.slot(state);
        }
        state.overload
    }

    /// The end of a slot.
    fn slot(&self, state: &mut WindingsState) {
        state.overload = None;
        for (i, winding) in self.windings.iter().enumerate() {
            let mean = state.sums[i] * self.per_slot;
            state.heat[i] += (mean - state.heat[i]) * winding.gain;
            if !(state.heat[i] <= winding.largest) {
                state.overload = Some(Stop::Overload);
            }
        }
        state.ticks = 0;
        state.sums = [0.0; 2];
    }
}
