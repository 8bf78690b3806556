//! Time constants of a device against the step of its simulation.

use super::{Device, LONGEST_STEP_S};
use crate::decimal;

/// Largest rate of the plant, relative to one over the longest step, that the integration allows.
const FASTEST: f64 = 0.1;

/// The plant's fixed step must be short against every time constant that it integrates.
pub(super) fn check_rates(device: &Device) -> Result<(), String> {
    let damping = device.stages.damping;
    let slow_enough = |key: &str, inertia: f64, rate: f64| {
        if rate * LONGEST_STEP_S <= FASTEST {
            return Ok(());
        }
        Err(format!(
            "{key} = {}: too small: its dampers and springs settle in {:.1e} s, but the simulation needs \
             {:.0e} s or more; give a larger inertia, or smaller damping and stiffness",
            decimal(inertia),
            1.0 / rate,
            LONGEST_STEP_S / FASTEST
        ))
    };
    let large = device.stages.large.inertia;
    slow_enough("large.inertia_kg_m2", large, damping / large)?;
    let small = device.stages.small.inertia;
    let hand = &device.hand;
    let rate = ((damping + hand.damping_nms_per_rad) / small)
        .max((hand.stiffness_nm_per_rad / small).sqrt());
    slow_enough("small.inertia_kg_m2", small, rate)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A time constant has ten steps of 10 us or more.
    #[test]
    fn every_time_constant_has_ten_steps() {
        let checked = |change: fn(&mut Device)| {
            let mut device = Device::default();
            device.stages.damping = 0.01;
            device.hand.damping_nms_per_rad = 0.03;
            device.hand.stiffness_nm_per_rad = 2.0;
            device.stages.large.inertia = 1e-3;
            device.stages.small.inertia = 1e-3;
            change(&mut device);
            check_rates(&device)
        };
        assert_eq!(checked(|_| ()), Ok(()));
        // The large motor has the coupler alone, the handle coupler and hand: 0.01 / 1e-6 is 1e4 /s.
        assert_eq!(
            checked(|device| device.stages.large.inertia = 1.01e-6),
            Ok(())
        );
        let error = checked(|device| device.stages.large.inertia = 0.99e-6).unwrap_err();
        assert!(
            error.starts_with("large.inertia_kg_m2 = 9.9e-7: too small"),
            "{error}"
        );
        assert!(
            error.contains("settle in 9.9e-5 s, but the simulation needs 1e-4 s"),
            "{error}"
        );
        assert_eq!(
            checked(|device| device.stages.small.inertia = 4.01e-6),
            Ok(())
        );
        let error = checked(|device| device.stages.small.inertia = 3.99e-6).unwrap_err();
        assert!(error.starts_with("small.inertia_kg_m2 = "), "{error}");
        // A stiff hand: 1e4 /s is the root of 1e5 N.m/rad over 1e-3 kg.m2.
        assert_eq!(
            checked(|device| device.hand.stiffness_nm_per_rad = 0.99e5),
            Ok(())
        );
        assert!(checked(|device| device.hand.stiffness_nm_per_rad = 1.01e5).is_err());
    }
}
