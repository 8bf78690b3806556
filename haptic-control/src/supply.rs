//! Voltage of the amplifiers' supply: whether it is in its range.

use estimator_core::{Hertz, Skip};

use crate::units::Volts;

/// Check of the readings u of the supply voltage against a range.
///
/// A reading is outside if it is below the range, above it, or not a number. The readings outside, less
/// those inside, are counted from 0 to N:
///
/// ```text
/// n = min(n + 1, N)    u outside
/// n = max(n - 1, 0)    u inside
/// ```
///
/// The supply is outside from n = N on until n = 0. N readings are 3 ms, at least one reading: one noisy
/// reading changes nothing, and a supply that leaves the range is found at the third reading of 1 kHz. A new
/// [`SupplyState`] is outside, so that a device is not armed before its supply has been seen.
///
/// Below the range an amplifier limits its voltage or switches off, and its motor lacks torque. Above it,
/// motors that brake have charged the supply: a supply that takes no current back holds the kinetic energy of
/// the shafts in its capacitors.
///
/// ```
/// use estimator_core::Hertz;
/// use haptic_control::{Supply, SupplyFinding, SupplyState, Volts};
/// const SUPPLY: Supply = Supply::new(Supply::RANGE_24_V, Hertz(1e3));
/// let mut state = SupplyState::START;
/// for _ in 0..3 {
///     assert!(state.is_outside());
///     SUPPLY.update(&mut state, Volts(24.0));
/// }
/// assert!(!state.is_outside());
/// for _ in 0..2 {
///     SUPPLY.update(&mut state, Volts(29.0));
///     assert!(!state.is_outside());
/// }
/// SUPPLY.update(&mut state, Volts(29.0));
/// assert!(state.is_outside());
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Supply {
    /// Lowest and highest voltage inside, V.
    range: [f32; 2],
    /// The number N of readings.
    patience: u8,
}

/// State of a [`Supply`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SupplyState {
    /// Readings outside, less those inside. `u8::MAX` before the first reading.
    count: u8,
    is_outside: bool,
}

/// What [`Findings`](crate::Findings) has of the supply: a [`SupplyState`], or [`Skip`] where no voltage is
/// measured.
pub trait SupplyFinding {
    /// Whether the supply is outside of its range.
    fn is_outside(&self) -> bool;
}

/// Time of readings outside until the supply is, s.
const PATIENCE_S: f64 = 0.003;

impl Supply {
    /// Range of a supply of 24 V: 15 % less and 20 % more, as IEC 61131-2 states it for equipment of 24 V
    /// direct current. V.
    pub const RANGE_24_V: [f32; 2] = [20.4, 28.8];

    /// The check of readings at this rate, 1 Hz to 80 kHz, against the lowest and the highest voltage of a
    /// range, both of which are inside.
    #[must_use]
    pub const fn new(range: [f32; 2], rate: Hertz) -> Self {
        let readings = (PATIENCE_S * rate.0 + 0.5) as u8;
        Self {
            range,
            patience: if readings == 0 { 1 } else { readings },
        }
    }

    /// Takes a reading.
    pub fn update(&self, state: &mut SupplyState, voltage: Volts) {
        let [low, high] = self.range;
        let inside = voltage.0 >= low && voltage.0 <= high;
        state.count = match inside {
            true => state.count.min(self.patience) - u8::from(state.count > 0),
            false => state.count.saturating_add(1).min(self.patience),
        };
        if state.count == 0 {
            state.is_outside = false;
        } else if state.count == self.patience {
            state.is_outside = true;
        }
    }
}

impl SupplyState {
    /// No reading yet: outside.
    pub const START: Self = Self {
        count: u8::MAX,
        is_outside: true,
    };
}

impl SupplyFinding for SupplyState {
    fn is_outside(&self) -> bool {
        self.is_outside
    }
}

/// No voltage is measured, and no code asks for it.
impl SupplyFinding for Skip {
    fn is_outside(&self) -> bool {
        false
    }
}
