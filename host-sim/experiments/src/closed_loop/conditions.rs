//! What a closed-loop run has besides the device, the hand and the controller.

use drivers::{DacScale, FULL_SCALES};
use estimator_core::Amps;
use haptic_control::Currents;
use simulation::plant::Grip;

use super::{Faulty, Oracle};

/// Velocities that the controller has without error, in the place of estimates.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Exact {
    /// None.
    #[default]
    Neither,
    /// That of the large motor.
    Large,
    /// Those of both motors, and the acceleration of the handle.
    Both,
}

/// Conditions of a run. The default is a run without faults, with the estimator of the loop, and with
/// currents that are not rounded.
#[derive(Clone, Copy, Debug, Default)]
pub struct Conditions<'a> {
    /// Fault of an encoder and the tick from which it lasts.
    pub fault: Option<(usize, Faulty)>,
    /// Converters that round the currents; `None` for exact currents.
    pub dac: Option<Dac>,
    /// Velocities that the controller has without error.
    pub exact: Exact,
    /// What commands the small motor in the place of the controller, in a scene with the small motor and a
    /// run without late ticks.
    pub oracle: Option<Oracle>,
    /// The grips of the loop's hand, one per tick, as [`Hand::grips`](super::Hand::grips) gives them. The
    /// run computes them itself without them, and where they are fewer than its ticks.
    pub grips: Option<&'a [Grip]>,
}

/// The digital-to-analogue converters of the reference board, one for each amplifier, not calibrated.
/// A current takes the nearest of 4095 values from minus to plus full scale,
/// [`FULL_SCALES`](drivers::FULL_SCALES).
#[derive(Clone, Copy, Debug)]
pub struct Dac {
    scales: [DacScale; 2],
}

impl Dac {
    /// The converters of the reference board.
    ///
    /// # Errors
    /// One line if a full scale is not above zero.
    pub fn board() -> Result<Self, String> {
        let scale = |full| DacScale::new(full).ok_or("full scale of a DAC: must be above 0 A");
        let [large, small] = FULL_SCALES.map(scale);
        Ok(Self {
            scales: [large?, small?],
        })
    }

    /// Both currents after rounding, large then small, A.
    ///
    /// ```
    /// use experiments::closed_loop::Dac;
    /// use estimator_core::Amps;
    /// use haptic_control::Currents;
    /// let asked = Currents { large: Amps::new(-6.0), small: Amps::new(0.5) };
    /// let (large, small) = Dac::board().unwrap().currents(&asked);
    /// // The small amplifier has 2047 steps up to 1.5 A, and 0.5 A are 682.3 steps.
    /// assert!((large + 6.0).abs() < 1e-6 && (small - 1.5 * 682.0 / 2047.0).abs() < 1e-6);
    /// ```
    #[must_use]
    pub fn currents(&self, asked: &Currents) -> (f64, f64) {
        let [large, small] = &self.scales;
        let [large_full, small_full] = FULL_SCALES;
        (
            rounded(large, large_full, asked.large),
            rounded(small, small_full, asked.small),
        )
    }
}

/// The current that a converter with this full scale puts out for a commanded one, A.
fn rounded(scale: &DacScale, full: Amps, current: Amps) -> f64 {
    let zero = f64::from(scale.exact_code(Amps::ZERO));
    let steps = f64::from(scale.exact_code(full)) - zero;
    (f64::from(scale.code(current).get()) - zero) / steps * f64::from(full.get())
}
