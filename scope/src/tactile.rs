//! The roughness of the parasitic force while it comes.

use std::collections::VecDeque;

use scoring::score::TACTILE_BAND_HZ;
use scoring::spectrum::Welch;

use crate::desk::FRAMES_HZ;

/// Frames over which the RMS is computed, and between its values.
const FRAMES: usize = 1000;
const EVERY: u32 = 100;

/// RMS of the latest second of a force in the tactile band.
pub(crate) struct Tactile {
    force: VecDeque<f64>,
    rms: f64,
}

impl Tactile {
    pub(crate) const fn new() -> Self {
        Self {
            force: VecDeque::new(),
            rms: f64::NAN,
        }
    }

    /// Takes the force in frame number `seq`; returns the RMS, NaN in the first second. Both have the same
    /// unit.
    pub(crate) fn next(&mut self, force: f64, seq: u32) -> f64 {
        self.force.push_back(force);
        if self.force.len() > FRAMES {
            self.force.pop_front();
        }
        if seq.is_multiple_of(EVERY) && self.force.len() == FRAMES {
            let signal: Vec<f64> = self.force.iter().copied().collect();
            let density = Welch::new(FRAMES_HZ).density(&signal);
            let rms = density.and_then(|density| density.rms_within(TACTILE_BAND_HZ));
            self.rms = rms.unwrap_or(f64::NAN);
        }
        self.rms
    }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::TAU;

    use super::*;

    #[test]
    fn oscillation_in_the_band_counts_and_a_constant_force_does_not() {
        let of = |hz: f64| {
            let mut tactile = Tactile::new();
            let force = |k: u32| 50.0 + 8.0 * (TAU * hz * f64::from(k) / FRAMES_HZ).sin();
            let rms = (0..2000).map(|k| tactile.next(force(k), k));
            let rms: Vec<f64> = rms.collect();
            assert!(rms[998].is_nan());
            rms[1999]
        };
        let amplitude = of(120.0) * f64::sqrt(2.0);
        assert!((amplitude - 8.0).abs() < 0.1, "{amplitude}");
        assert!(of(10.0) < 0.1, "{}", of(10.0));
    }
}
