//! Time constants of a device against the step of its simulation.

use super::{Device, LONGEST_STEP_S};
use crate::decimal;

/// Largest rate of the plant, relative to one over the longest step, that the integration allows.
const FASTEST: f64 = 0.1;

/// A value that makes a motor settle fast.
struct Cause {
    key: &'static str,
    value: f64,
    /// Value of the default device.
    usual: f64,
    /// Usual unit, a thousandth of the SI unit.
    unit: &'static str,
}

impl Cause {
    /// How much faster a motor is by this value than with that of the default device. A smaller inertia and a larger
    /// value of another key make it faster.
    fn times_faster(&self) -> f64 {
        match self.is_inertia() {
            true => self.usual / self.value,
            false => self.value / self.usual,
        }
    }

    fn is_inertia(&self) -> bool {
        self.unit.is_empty()
    }
}

/// The plant's fixed step must be short against every time constant that it integrates. The message names the value
/// that is farthest from that of the default device.
pub(super) fn check_rates(device: &Device) -> Result<(), String> {
    let usual = Device::default();
    let inertia = |key, of: fn(&Device) -> f64| Cause {
        key,
        value: of(device),
        usual: of(&usual),
        unit: "",
    };
    let coupler = || Cause {
        key: "coupler.damping_nms_per_rad",
        value: device.stages.damping,
        usual: usual.stages.damping,
        unit: "mN.m.s/rad",
    };
    let (hand, usual_hand) = (&device.hand, &usual.hand);
    let large = inertia("large.inertia_kg_m2", |device| device.stages.large.inertia);
    let rate = device.stages.damping / large.value;
    check("the large motor", rate, [large, coupler()])?;
    let small = || inertia("small.inertia_kg_m2", |device| device.stages.small.inertia);
    let damper = Cause {
        key: "hand.damping_nms_per_rad",
        value: hand.damping_nms_per_rad,
        usual: usual_hand.damping_nms_per_rad,
        unit: "mN.m.s/rad",
    };
    let rate = (device.stages.damping + hand.damping_nms_per_rad) / small().value;
    check("the handle", rate, [small(), coupler(), damper])?;
    let spring = Cause {
        key: "hand.stiffness_nm_per_rad",
        value: hand.stiffness_nm_per_rad,
        usual: usual_hand.stiffness_nm_per_rad,
        unit: "mN.m/rad",
    };
    let rate = (hand.stiffness_nm_per_rad / small().value).sqrt();
    check("the handle", rate, [small(), spring])
}

fn check<const N: usize>(shaft: &str, rate: f64, causes: [Cause; N]) -> Result<(), String> {
    if rate * LONGEST_STEP_S <= FASTEST {
        return Ok(());
    }
    let by_cause = |a: &Cause, b: &Cause| a.times_faster().total_cmp(&b.times_faster());
    let Some(cause) = causes.into_iter().max_by(by_cause) else {
        return Ok(());
    };
    let value = decimal(cause.value);
    let remedy = match cause.is_inertia() {
        true => "give a larger inertia, or smaller damping and stiffness".to_owned(),
        false if cause.times_faster() < 100.0 => {
            "give a smaller value, or a larger inertia".to_owned()
        }
        false => format!("did you mean {value}e-3, which is {value} {}?", cause.unit),
    };
    Err(format!(
        "{} = {value}: too {}: {shaft} settles in {:.1e} s, but the simulation needs {:.0e} s or more; {remedy}",
        cause.key,
        if cause.is_inertia() { "small" } else { "large" },
        1.0 / rate,
        LONGEST_STEP_S / FASTEST
    ))
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
        // 11.6 times less inertia than the default device, and 10.4 times its damping.
        let error = checked(|device| device.stages.large.inertia = 0.99e-6).unwrap_err();
        assert!(
            error.starts_with("large.inertia_kg_m2 = 9.9e-7: too small"),
            "{error}"
        );
        assert!(
            error.contains("settles in 9.9e-5 s, but the simulation needs 1e-4 s"),
            "{error}"
        );
        assert_eq!(
            checked(|device| device.stages.small.inertia = 4.01e-6),
            Ok(())
        );
        // 1.3 times less inertia than the default device, 10.4 times its damping, 10 times that of its hand.
        let error = checked(|device| device.stages.small.inertia = 3.99e-6).unwrap_err();
        assert_eq!(
            error,
            "coupler.damping_nms_per_rad = 0.01: too large: the handle settles in 1.0e-4 s, but the simulation \
             needs 1e-4 s or more; give a smaller value, or a larger inertia"
        );
        // A stiff hand: 1e4 /s is the root of 1e5 N.m/rad over 1e-3 kg.m2.
        assert_eq!(
            checked(|device| device.hand.stiffness_nm_per_rad = 0.99e5),
            Ok(())
        );
        let error = checked(|device| device.hand.stiffness_nm_per_rad = 1.01e5).unwrap_err();
        assert!(
            error.starts_with("hand.stiffness_nm_per_rad = 101000: too large"),
            "{error}"
        );
    }

    #[test]
    fn damping_in_a_wrong_unit_is_named_with_its_line() {
        let text = "[large]\ninertia_kg_m2 = 1e-5\n[coupler]\ndamping_nms_per_rad = 0.96\n";
        assert_eq!(
            Device::from_toml_str_to_simulate(text).unwrap_err(),
            "line 4, coupler.damping_nms_per_rad = 0.96: too large: the large motor settles in 1.0e-5 s, but the \
             simulation needs 1e-4 s or more; did you mean 0.96e-3, which is 0.96 mN.m.s/rad?"
        );
        let error = Device::from_toml_str_to_simulate("hand.damping_nms_per_rad = 3").unwrap_err();
        assert!(
            error.starts_with("line 1, hand.damping_nms_per_rad = 3: too large: the handle")
                && error.ends_with("did you mean 3e-3, which is 3 mN.m.s/rad?"),
            "{error}"
        );
        let error = Device::from_toml_str_to_simulate("small.inertia_kg_m2 = 1e-9").unwrap_err();
        assert!(
            error.starts_with("line 1, small.inertia_kg_m2 = 1e-9: too small"),
            "{error}"
        );
    }

    /// A command that simulates nothing reads it.
    #[test]
    fn stiff_device_is_refused_only_where_it_is_simulated() {
        let text = "coupler.damping_nms_per_rad = 10";
        let device = Device::from_toml_str(text).unwrap();
        assert_eq!(device.check_values(), Ok(()));
        assert!(device.validate().is_err());
    }
}
