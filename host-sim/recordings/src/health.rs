//! Comparison of the parameters that a board has learned with the identified ones.

use haptic_control::{DualStage, Motor};

use crate::telemetry::LearnedLine;
use simulation::device::Device;

/// Largest relative difference of unchanged parameters.
const TOLERANCE: f64 = 0.1;

/// One line per constant: the learned value of an image for the default device, the value of
/// `device`, and whether they agree within a tenth. A friction of 0 has no line: no difference is
/// relative to it.
///
/// An image learns constants per inertia. The coupler's damping is the quotient of two of them, in
/// which the inertia cancels.
#[must_use]
pub fn lines(learned: &LearnedLine, device: &Device) -> Vec<String> {
    let DualStage { large, damping, .. } = &DualStage::DEFAULT;
    let Motor {
        inertia,
        torque_constant,
        coulomb_friction,
        ..
    } = large;
    let found = &device.stages.large;
    let by_inertia = 1.0 / found.inertia;
    let identified = device.stages.damping;
    let kt = 1.0 + learned.torque_constant;
    let pairs = [
        (
            "damping b, N.m.s/rad",
            damping * (1.0 + learned.damping) / kt * found.torque_constant / torque_constant,
            identified,
        ),
        (
            "b / J, 1/s",
            damping / inertia * (1.0 + learned.damping),
            identified * by_inertia,
        ),
        (
            "friction / J, rad/s^2",
            coulomb_friction / inertia * (1.0 + learned.friction),
            found.coulomb_friction * by_inertia,
        ),
        (
            "Kt / J, rad/s^2/A",
            torque_constant / inertia * kt,
            found.torque_constant * by_inertia,
        ),
    ];
    let line = |(name, learned, identified): (&str, f64, f64)| {
        let off = learned / identified - 1.0;
        let verdict = match off.abs() <= TOLERANCE {
            true => "",
            false => ": changed since the identification",
        };
        format!(
            "health: {name}: learned {learned:.4e}, identified {identified:.4e}, {:+.1} %{verdict}",
            100.0 * off
        )
    };
    let comparable = pairs.into_iter().filter(|pair| pair.2 > 0.0);
    comparable.map(line).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn friction_of_zero_has_no_line() {
        let learned = LearnedLine {
            damping: 0.0,
            friction: 0.05,
            torque_constant: 0.0,
        };
        let mut device = Device::default();
        device.stages.large.coulomb_friction = 0.0;
        let said = lines(&learned, &device);
        assert_eq!(said.len(), 3, "{said:?}");
        assert!(said.iter().all(|line| !line.contains("inf")), "{said:?}");
    }

    #[test]
    fn learned_parameters_are_compared_with_identified_ones() {
        let learned = LearnedLine {
            damping: -0.2,
            friction: 0.05,
            torque_constant: 0.0,
        };
        let said = lines(&learned, &Device::default());
        assert!(said[0].contains("-20.0 %: changed"), "{said:?}");
        assert!(
            said[2].ends_with("+5.0 %") && said[3].ends_with("+0.0 %"),
            "{said:?}"
        );
        // More than a tenth is a change.
        for (damping, changed) in [
            (0.099, false),
            (0.101, true),
            (-0.099, false),
            (-0.101, true),
        ] {
            let learned = LearnedLine { damping, ..learned };
            let said = lines(&learned, &Device::default());
            assert_eq!(said[0].contains("changed"), changed, "{said:?}");
        }
        // No difference from the device with the learned constants.
        let mut found = Device::default();
        found.stages.damping *= 0.8;
        found.stages.large.coulomb_friction *= 1.05;
        assert!(
            lines(&learned, &found)
                .iter()
                .all(|line| !line.contains("changed"))
        );
        // b is the quotient of b / J and Kt / J, times the identified Kt.
        let mut other = found.clone();
        other.stages.large.torque_constant *= 1.3;
        let said = lines(&learned, &other);
        assert!(said[0].contains("+30.0 %: changed"), "{said:?}");
        let stronger = LearnedLine {
            torque_constant: 0.3,
            ..learned
        };
        let said = lines(&stronger, &other);
        assert!(
            said[0].ends_with("+0.0 %") && said[3].ends_with("+0.0 %"),
            "{said:?}"
        );
        // An error of the inertia changes the constants per inertia, but not b.
        found.stages.large.inertia *= 1.3;
        let said = lines(&learned, &found);
        assert!(
            said[0].ends_with("+0.0 %") && said[1].contains("+30.0 %: changed"),
            "{said:?}"
        );
    }
}
