//! Frequency response and margins of the designed velocity loop.

use std::f64::consts::TAU;

use estimator_core::Hertz;
use haptic_control::{DualStage, LoopPoles, Margins, RstDesign};
use rustfft::num_complex::Complex;

use terminal::failure::Failure;

/// Points of the response per decade, and its range below half the rate, decades.
const PER_DECADE: f64 = 80.0;
const DECADES: f64 = 5.0;

/// The velocity loop at one rate.
#[derive(Clone, Debug)]
pub struct Design {
    /// Control rate, Hz.
    pub rate_hz: f64,
    /// Margins, as the controller's design computed them.
    pub margins: Margins,
    /// Delay of the estimator that the design accounts for besides the modelled lags, s.
    pub estimator_delay_s: f64,
    /// Frequency, Hz, rising to half the rate, and the open-loop response `L = B R / (A S)` with
    /// the estimator's delay.
    pub open_loop: Vec<(f64, Complex<f64>)>,
}

impl Design {
    /// The loop of `device` at `rate_hz` with these poles.
    ///
    /// ```
    /// use haptic_control::{DualStage, LoopPoles};
    /// use experiments::transparency::Design;
    /// let design = Design::new(&DualStage::DEFAULT, 1000.0, LoopPoles::DEFAULT).unwrap();
    /// assert!(design.margins.modulus > 0.7);
    /// assert!(Design::new(&DualStage::DEFAULT, 100.0, LoopPoles::DEFAULT).is_err());
    /// ```
    ///
    /// # Errors
    /// [`Failure::Input`] where the loop cannot be designed.
    pub fn new(device: &DualStage, rate_hz: f64, poles: LoopPoles) -> Result<Self, Failure> {
        let design = RstDesign::new(device, Hertz(rate_hz), poles)
            .map_err(|error| Failure::Input(format!("control at {rate_hz} Hz: {error}")))?;
        let last = (PER_DECADE * DECADES) as i32;
        let open_loop = (-last..=0)
            .map(|i| 0.5 * rate_hz * 10_f64.powf(f64::from(i) / PER_DECADE))
            .map(|hz| (hz, open_loop(&design, rate_hz, poles.estimator_delay_s, hz)))
            .collect();
        Ok(Self {
            rate_hz,
            margins: design.margins,
            estimator_delay_s: poles.estimator_delay_s,
            open_loop,
        })
    }
}

/// `B R / (A S)` at `z = e^(j 2 pi f T)`, delayed by `delay_s`.
fn open_loop(design: &RstDesign, rate_hz: f64, delay_s: f64, hz: f64) -> Complex<f64> {
    let back = Complex::from_polar(1.0, -TAU * hz / rate_hz);
    let at = |c: &[f64; 3]| (back * c[2] + c[1]) * back + c[0];
    let late = Complex::from_polar(1.0, -TAU * hz * delay_s);
    late * at(&design.b) * at(&design.r) / (at(&design.a) * at(&design.s))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn response_has_the_margins_of_the_design() {
        for rate_hz in [1e3, 10e3, 11.6e3] {
            let design = Design::new(&DualStage::DEFAULT, rate_hz, LoopPoles::DEFAULT).unwrap();
            let open = || design.open_loop.iter().map(|(_, open)| open);
            let modulus = open().map(|l| (l + 1.0).norm()).fold(1.0, f64::min);
            let claimed = design.margins;
            assert!(
                (modulus - claimed.modulus).abs() < 5e-3,
                "{rate_hz}: {modulus}"
            );
            let crossing = design
                .open_loop
                .windows(2)
                .rfind(|pair| pair[0].1.norm() >= 1.0 && pair[1].1.norm() < 1.0);
            let (hz, at) = crossing.unwrap()[0];
            assert!(
                (hz / claimed.crossover_hz - 1.0).abs() < 0.1,
                "{rate_hz}: {hz}"
            );
            let phase = 180.0 + at.arg().to_degrees();
            assert!(
                (phase - claimed.phase_deg()).abs() < 5.0,
                "{rate_hz}: {phase}"
            );
            // The gain margin is where the curve meets the negative axis farthest out.
            let crossings = design.open_loop.windows(2).filter_map(|pair| {
                let [a, b] = [pair[0].1, pair[1].1];
                let re = a.re + (b.re - a.re) * a.im / (a.im - b.im);
                (a.im * b.im < 0.0 && re < 0.0).then_some(-1.0 / re)
            });
            let gain = crossings.fold(f64::INFINITY, f64::min);
            assert!(
                (gain / claimed.gain - 1.0).abs() < 0.02,
                "{rate_hz}: {gain}"
            );
        }
    }
}
