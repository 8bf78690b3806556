//! What a board has learned of its device against what was identified.

use haptic_control::{DualStage, Motor};

use crate::telemetry::LearnedLine;
use simulation::device::Device;

/// Further apart than this, something is no longer as it was.
const TOLERANCE: f64 = 0.1;

/// A line for each constant: what the image of the default device has learned it to be, what
/// `device` says, and whether the two agree within a tenth.
///
/// An image learns constants per inertia; the coupler's damping itself is told by the quotient of
/// two, from which the inertia cancels.
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
            false => ": no longer what it was",
        };
        format!(
            "health: {name}: learned {learned:.4e}, identified {identified:.4e}, {:+.1} %{verdict}",
            100.0 * off
        )
    };
    pairs.into_iter().map(line).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_was_learned_is_compared_with_what_was_identified() {
        let learned = LearnedLine {
            damping: -0.2,
            friction: 0.05,
            torque_constant: 0.0,
        };
        let said = lines(&learned, &Device::default());
        assert!(said[0].contains("-20.0 %: no longer"), "{said:?}");
        assert!(
            said[2].ends_with("+5.0 %") && said[3].ends_with("+0.0 %"),
            "{said:?}"
        );
        // A device identified to be just that is in health.
        let mut found = Device::default();
        found.stages.damping *= 0.8;
        found.stages.large.coulomb_friction *= 1.05;
        assert!(
            lines(&learned, &found)
                .iter()
                .all(|line| !line.contains("no longer"))
        );
        // An inertia that is off shows in what is per inertia, and not in b.
        found.stages.large.inertia *= 1.3;
        let said = lines(&learned, &found);
        assert!(
            said[0].ends_with("+0.0 %") && said[1].contains("+30.0 %: no"),
            "{said:?}"
        );
    }
}
