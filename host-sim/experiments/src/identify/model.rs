//! Comparison of the identified model with the recordings.

use super::equations::{FRICTION, OFFSET, SLIP};
use super::fit::Fit;
use super::motion::Motion;
use recordings::recording::Recording;
use simulation::device::Device;

/// Measured and modelled velocity of the large motor over one recording, rad/s.
#[derive(Clone, Debug)]
pub struct ModelComparison {
    /// Name of the recording.
    pub name: String,
    /// Time of each value, s.
    pub t: Vec<f64>,
    /// Measured velocity: displacement of the counts over [`SPAN_S`], divided by that time.
    pub measured: Vec<f64>,
    /// Velocity of the model over the same time; its inputs are current and handle.
    pub model: Vec<f64>,
}

/// Time over which velocities are averaged, s: a count of 4096 is 0.2 rad/s.
pub const SPAN_S: f64 = 8e-3;

/// Rows per second that are kept for figures.
const KEPT_HZ: f64 = 1000.0;

/// Runs the model over each recording from the first sample on. After an uneven step of the clock it
/// restarts with the measured velocity.
///
/// The model does not contain the effects that are periodic in the angle; they are part of the
/// difference.
pub(super) fn compare(
    recordings: &[(String, Recording)],
    device: &Device,
    fit: &Fit,
) -> Vec<ModelComparison> {
    let one = |(name, recording): &(String, Recording)| {
        let trace = &recording.trace;
        let period_s = trace.period_s();
        let large = Motion::new(
            &trace.counts_large,
            device.stages.large.counts_per_rev,
            period_s,
        );
        let handle = trace
            .counts_small
            .as_ref()
            .map(|counts| Motion::new(counts, device.stages.small.counts_per_rev, period_s));
        let side = ((0.5 * SPAN_S * trace.rate_hz).round() as usize).max(1);
        let velocity = |angle: &[f64], k: usize| {
            let (from, to) = (k.saturating_sub(side), (k + side).min(angle.len() - 1));
            (angle[to] - angle[from]) / ((to - from) as f64 * period_s)
        };
        let breaks = super::breaks(&recording.t, period_s);
        let current = trace.current.as_deref().unwrap_or_default();
        let mut angle = vec![0.0; large.angle.len()];
        let mut omega = velocity(&large.angle, 0);
        for k in 1..angle.len() {
            if breaks[k] != breaks[k - 1] {
                omega = velocity(&large.angle, k);
            }
            let handle = handle.as_ref().map_or(0.0, |h| velocity(&h.angle, k - 1));
            let drive = fit.coefficients[0] * current[k - 1]
                + fit.coefficients[SLIP] * handle
                + fit.coefficients[OFFSET];
            let before = omega;
            omega = step(
                omega,
                drive,
                fit.coefficients[SLIP],
                fit.coefficients[FRICTION],
                period_s,
            );
            angle[k] = angle[k - 1] + 0.5 * (before + omega) * period_s;
        }
        let every = (trace.rate_hz / KEPT_HZ).round().max(1.0) as usize;
        let kept = || (side..angle.len().saturating_sub(side)).step_by(every);
        ModelComparison {
            name: name.clone(),
            t: kept().map(|k| recording.t[k]).collect(),
            measured: kept().map(|k| velocity(&large.angle, k)).collect(),
            model: kept().map(|k| velocity(&angle, k)).collect(),
        }
    };
    recordings.iter().map(one).collect()
}

/// Exact solution of `dω/dt = drive - damping ω - friction sign ω` over one period, piecewise between
/// the zeros of ω, where the rotor stops if the drive is not above friction.
fn step(omega: f64, drive: f64, damping: f64, friction: f64, period_s: f64) -> f64 {
    let way = if omega != 0.0 { omega } else { drive };
    let net = drive - friction.abs().copysign(way);
    if omega == 0.0 && net * way <= 0.0 {
        return 0.0;
    }
    let decay = (-damping * period_s).exp();
    let gained = match damping.abs() * period_s > 1e-9 {
        true => net * (1.0 - decay) / damping,
        false => net * period_s,
    };
    let end = decay * omega + gained;
    // A rotor at rest has no zero to pass, nor has a velocity that overflows to NaN.
    let passes_zero = end * omega < 0.0;
    if !passes_zero {
        return end;
    }
    // The rest of the period starts from rest.
    let stopped = -damping * omega / net;
    let until = match damping.abs() * period_s > 1e-9 {
        true => stopped.ln_1p() / damping,
        false => -omega / net,
    };
    step(0.0, drive, damping, friction, period_s - until)
}

#[cfg(test)]
mod tests {
    use super::step;

    #[test]
    fn friction_stops_the_rotor_holds_it_and_is_overcome() {
        assert_eq!(step(0.0, 2.0, 1.0, 2.0, 1e-3), 0.0);
        assert_eq!(step(1e-4, 0.0, 1.0, 2.0, 1e-3), 0.0);
        let left = step(0.0, -3.0, 0.0, 2.0, 1e-3);
        assert!((left + 1e-3).abs() < 1e-12, "{left}");
        // Converges to the velocity at which damping and friction balance the drive.
        let settled = (0..20_000).fold(0.0, |omega, _| step(omega, 10.0, 4.0, 2.0, 1e-3));
        assert!((settled - 2.0).abs() < 1e-9, "{settled}");
        // A reversal: 0.5 ms to stop at 5 a second, the rest at 1 a second.
        let turned = step(2.5e-3, -3.0, 0.0, 2.0, 1e-3);
        assert!((turned + 0.5e-3).abs() < 1e-9, "{turned}");
        // A coefficient without a meaning: e^800 is no number.
        assert!(step(1.0, -1e9, -8e5, 0.0, 1e-3).is_nan());
        // e^700 times the drive overflows, from rest too.
        assert_eq!(step(0.0, 1e9, -7e5, 0.0, 1e-3), f64::INFINITY);
        // Reversals with damping, against a solution in a hundred thousand steps.
        for (omega, period_s) in [(20.0, 10e-3), (20.0, 5e-3), (2.0, 1e-3), (-20.0, 5e-3)] {
            let (drive, damping, friction) = (-4000.0_f64.copysign(omega), 83.5, 352.0);
            let turned = step(omega, drive, damping, friction, period_s);
            let small_s = period_s / 1e5;
            let expected = (0..100_000).fold(omega, |omega: f64, _| {
                omega + small_s * (drive - damping * omega - friction.copysign(omega))
            });
            assert!(turned * omega < 0.0, "{turned}");
            assert!(
                (turned / expected - 1.0).abs() < 1e-3,
                "{turned} {expected}"
            );
        }
    }
}
