//! Rest, and estimates that report motion at rest.

use scoring::score::SKIP_S;

/// Largest true speed at rest, rad/s: a few standard deviations of the truth.
pub const REST_RAD_S: f64 = 0.02;

/// Time for which the true speed has to stay below [`REST_RAD_S`] before a sample counts as rest, s.
pub const REST_S: f64 = 0.3;

/// Largest estimated speed that is still reported as rest, rad/s.
pub const MOTION_RAD_S: f64 = 0.1;

/// Whether each sample is at rest: its true speed and those of [`REST_S`] before it are at most
/// [`REST_RAD_S`]. The start that no score looks at is not at rest.
pub(super) fn rest(omega: &[f64], rate_hz: f64) -> Vec<bool> {
    let [long, skip] = [REST_S, SKIP_S].map(|s| (s * rate_hz).round() as usize);
    let mut quiet = 0;
    let samples = omega.iter().enumerate().map(|(k, omega)| {
        quiet = if omega.abs() <= REST_RAD_S {
            quiet + 1
        } else {
            0
        };
        quiet > long && k >= skip
    });
    samples.collect()
}

/// Share of the samples at rest that an estimate reports as motion; `None` without rest.
pub(super) fn moving_at_rest(velocity: &[f32], rest: &[bool]) -> Option<f64> {
    let at_rest = || velocity.iter().zip(rest).filter(|(_, rest)| **rest);
    // An estimate that is not a number does not report rest.
    let moves = |(velocity, _): &(&f32, &bool)| {
        velocity.is_nan() || f64::from(velocity.abs()) > MOTION_RAD_S
    };
    let samples = at_rest().count();
    (samples > 0).then(|| at_rest().filter(moves).count() as f64 / samples as f64)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rest_begins_after_its_time_and_ends_with_motion() {
        // At 10 Hz: three samples after the first quiet one.
        let omega = [0.0, 0.01, -0.02, 0.0, 0.01, 0.03, 0.0, 0.0, 0.0, 0.0];
        let found = rest(&omega, 10.0);
        let at: Vec<_> = (0..omega.len()).filter(|&k| found[k]).collect();
        assert_eq!(at, [3, 4, 9]);
    }

    #[test]
    fn share_of_motion_at_rest_counts_only_samples_at_rest() {
        let velocity = [9.0, 0.0, -0.2, 0.05, f32::NAN];
        let rest = [false, true, true, true, true];
        assert_eq!(moving_at_rest(&velocity, &rest), Some(0.5));
        assert_eq!(moving_at_rest(&velocity, &[false; 5]), None);
    }
}
