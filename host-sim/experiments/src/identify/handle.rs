//! Identification of a free handle.

use super::equations::{Equations, FRICTION, HAND, SLIP};
use super::fit::{Equation, Estimate, Fit};
use super::quantity::{GRAM_CM2, Known, MILLI_NM, MILLI_NM_PER_A, Quantity};
use simulation::device::Device;

/// The equations of a recording with a free handle.
///
/// # Errors
/// The reason for which the recording does not identify the handle.
pub(super) fn free(equations: Equations) -> Result<Vec<Equation>, &'static str> {
    let Some(fit) = Fit::new(&equations.usable) else {
        return Err("it hardly moves");
    };
    let pulls = |column: usize| {
        let pull = fit.estimate(|ratios, _| ratios[column]);
        pull.value.abs() > 2.0 * pull.half
    };
    let explained = fit.unexplained < super::MOST_UNEXPLAINED * fit.driven;
    if pulls(HAND) || pulls(HAND + 1) || !explained {
        return Err("it is held");
    }
    let mut usable = equations.usable;
    for equation in &mut usable {
        // The damper's column stays: an eccentric disc distorts the short arc of the large motor, and
        // with it b/J from that motor's velocity. The sum of both columns is b/J from the handle's
        // velocity.
        equation.others.remove(HAND - 1);
        equation.halved.remove(HAND);
    }
    Ok(usable)
}

/// The constants of a free handle. Their scale is the damping identified from the large shaft.
pub(super) fn quantities(
    free: &[Equation],
    turns: bool,
    large: &Fit,
    device: &Device,
    known: Known,
) -> Option<Vec<Quantity>> {
    let fit = Fit::new(free)?;
    let damping = large.estimate(|ratios, _| ratios[SLIP] * known.inertia(ratios));
    let scaled = |f: &dyn Fn(&[f64]) -> f64| {
        let ratio = fit.estimate(|ratios, _| f(ratios) / (ratios[SLIP] + ratios[HAND]));
        let parts = [ratio.half * damping.value, ratio.value * damping.half];
        Estimate {
            value: ratio.value * damping.value,
            half: parts[0].hypot(parts[1]),
            by_counts: ratio.by_counts,
        }
    };
    let mut friction = Quantity::new(
        "small.coulomb_nm",
        MILLI_NM,
        device.stages.small.coulomb_friction,
        scaled(&|ratios| ratios[FRICTION]),
        0.0,
        "record slow motion in both directions",
    );
    if !turns {
        friction.reject(
            "friction varies over a turn; record at least three turns of the handle".to_owned(),
        );
    }
    Some(vec![
        Quantity::new(
            "small.torque_constant_nm_per_a",
            MILLI_NM_PER_A,
            device.stages.small.torque_constant,
            scaled(&|ratios| ratios[0]),
            0.0,
            "record more strokes of the small motor",
        ),
        Quantity::new(
            "small.inertia_kg_m2",
            GRAM_CM2,
            device.stages.small.inertia,
            scaled(&|_| 1.0),
            0.0,
            "record more strokes of both motors",
        ),
        friction,
    ])
}
