//! What counts and current determine without any known constant.

use super::equations::{FRICTION, OFFSET, SLIP};
use super::fit::{Estimate, Fit};

/// A ratio of the device's constants, or the delay of the torque.
#[derive(Clone, Copy, Debug)]
pub struct Ratio {
    /// What it is.
    pub name: &'static str,
    /// Unit, SI.
    pub unit: &'static str,
    /// Value and interval.
    pub estimate: Estimate,
}

/// The ratios of a fit. `one_way` is the direction of a shaft that does not reverse: friction then
/// shows only together with a constant torque.
pub(super) fn all(fit: &Fit, one_way: Option<f64>) -> Vec<Ratio> {
    let ratio = |name, unit, of: &dyn Fn(&[f64], f64) -> f64| Ratio {
        name,
        unit,
        estimate: fit.estimate(of),
    };
    let mut ratios = vec![
        ratio("torque constant / inertia", "rad/s2/A", &|c, _| c[0]),
        ratio("damping / inertia", "1/s", &|c, _| c[SLIP]),
    ];
    match one_way {
        Some(way) => ratios.push(ratio(
            "friction less constant torque, / inertia",
            "rad/s2",
            &|c, _| c[FRICTION] - way * c[OFFSET],
        )),
        None => ratios.extend([
            ratio("friction / inertia", "rad/s2", &|c, _| c[FRICTION]),
            ratio("constant torque / inertia", "rad/s2", &|c, _| c[OFFSET]),
        ]),
    }
    ratios.push(ratio("delay of the torque", "s", &|_, lag_s| lag_s));
    ratios
}
