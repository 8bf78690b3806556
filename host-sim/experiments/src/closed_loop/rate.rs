//! Control rates of a closed loop.

use haptic_control::LoopPoles;
use simulation::simulate::{RATES_HZ, ticks};

/// Lowest control rate, Hz: that at which the velocity loop can be designed.
pub const LOWEST_RATE_HZ: f64 = LoopPoles::DEFAULT.lowest_rate().0;

/// Number of ticks of a run in closed loop.
///
/// # Errors
/// One line that names a rate or a duration out of range, and the range.
pub fn loop_ticks(rate_hz: f64, seconds: f64) -> Result<usize, String> {
    if !(LOWEST_RATE_HZ..=RATES_HZ.1).contains(&rate_hz) {
        return Err(format!(
            "--rate {rate_hz}: a closed loop needs a control rate of {LOWEST_RATE_HZ} to {} Hz",
            RATES_HZ.1
        ));
    }
    ticks(rate_hz, seconds)
}

#[cfg(test)]
mod tests {
    use super::*;
    use estimator_core::Hertz;
    use haptic_control::{DualStage, Rig};

    #[test]
    fn lowest_rate_is_that_of_the_design() {
        let designed = |hz| Rig::new(&DualStage::DEFAULT, Hertz(hz), LoopPoles::DEFAULT).is_ok();
        assert!(designed(LOWEST_RATE_HZ) && loop_ticks(LOWEST_RATE_HZ, 1.0).is_ok());
        for hz in [LOWEST_RATE_HZ - 1e-9, f64::NAN] {
            let said = loop_ticks(hz, 1.0).unwrap_err();
            assert!(
                !designed(hz) && said.contains("of 600 to 100000 Hz"),
                "{said}"
            );
        }
    }
}
