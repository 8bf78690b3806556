//! Parasitic force: force on the hand that the scene did not command.
//!
//! ```text
//! parasitic force = 2 (torque felt - torque wanted) / D        at the fingertip, mN
//! ```
//! Torque felt is the torque of the handle on the hand, `Kt_S i_S + b slip - J_S dw_S/dt -
//! friction_S`. The parasitic force therefore contains errors of the velocities in both stages, the
//! delay from sample to torque, friction of both motors that the feed-forward does not cancel,
//! ripple, and the handle's own inertia and friction, which no estimator can cancel. Torque wanted
//! is the scene's torque at the same tick, from the position and velocity of the controller. The
//! effect of a wrong position on the scene's torque is not parasitic by this definition.

use serde::Serialize;

use scoring::percentile;
use scoring::score::{TACTILE_BAND_HZ, skipped};
use scoring::score_fields;
use scoring::spectrum::Welch;
use simulation::device::Device;

/// Conversion of torque to force at the fingertip, and the fingertip's threshold.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Fingertip {
    /// Force of a torque of 1 N.m, mN: 2000 / D.
    pub mn_per_nm: f64,
    /// Smallest force that a fingertip notices, F_shd, mN.
    pub threshold_mn: f64,
}

impl Fingertip {
    /// The conversion for the device's handle.
    ///
    /// ```
    /// use simulation::device::Device;
    /// use experiments::transparency::Fingertip;
    /// let fingertip = Fingertip::new(&Device::default());
    /// // 1 mN.m on a handle of 70 mm.
    /// assert!((1e-3 * fingertip.mn_per_nm - 28.57).abs() < 0.01);
    /// assert_eq!(fingertip.threshold_mn, 10.0);
    /// ```
    #[must_use]
    pub fn new(device: &Device) -> Self {
        Self {
            mn_per_nm: 2e3 / device.handle.diameter_m,
            threshold_mn: 1e3 * device.interval.threshold_n,
        }
    }
}

score_fields! {
    /// Scores of a parasitic force after the first [`SKIP_S`](scoring::score::SKIP_S) seconds; `None` for a shorter
    /// series.
    /// A force that is not finite counts as infinite.
    pub struct Parasitic {
        /// Root mean square, mN.
        parasitic_mn_rms: "force", "rms, mN", Number, Mean, Smaller, true;
        /// 99th percentile of the magnitude over the ticks, mN.
        parasitic_mn_p99: "force", "99 %, mN", Number, Mean, Smaller, true;
        /// RMS of the components from 50 to 500 Hz, at most to half the sample rate, which are felt as
        /// roughness, mN; `None` for less than 0.35 s, or at 100 Hz or less.
        parasitic_mn_tactile: "50-500 Hz", "rms, mN", Number, Mean, Smaller, true;
        /// Share of the ticks whose magnitude is below the fingertip's threshold, 0 to 1.
        below_threshold: "unnoticed", "% of time", Share, Mean, Larger, true;
    }
}

impl Parasitic {
    /// Scores the series `force_mn` (mN), sampled at `rate_hz` from t = 0 on.
    ///
    /// ```
    /// use simulation::device::Device;
    /// use experiments::transparency::{Fingertip, Parasitic};
    /// let fingertip = Fingertip::new(&Device::default());
    /// // 0.1 s that is not scored, then 6 and 14 mN in turn.
    /// let force: Vec<f64> = (0..1100).map(|k| match k {
    ///     0..100 => 1e6,
    ///     _ if k % 2 == 0 => 6.0,
    ///     _ => -14.0,
    /// }).collect();
    /// let score = Parasitic::of(&force, 1000.0, &fingertip);
    /// assert_eq!(score.below_threshold, Some(0.5));
    /// assert_eq!(score.parasitic_mn_p99, Some(14.0));
    /// assert!((score.parasitic_mn_rms.unwrap() - 116_f64.sqrt()).abs() < 1e-9);
    /// ```
    #[must_use]
    pub fn of(force_mn: &[f64], rate_hz: f64, fingertip: &Fingertip) -> Self {
        let skip = skipped(rate_hz).min(force_mn.len());
        let scored = &force_mn[skip..];
        if scored.is_empty() {
            return Self::default();
        }
        let n = scored.len() as f64;
        let below = scored.iter().filter(|f| f.abs() < fingertip.threshold_mn);
        let below_threshold = Some(below.count() as f64 / n);
        if scored.iter().any(|f| !f.is_finite()) {
            return Self {
                parasitic_mn_rms: Some(f64::INFINITY),
                parasitic_mn_p99: Some(f64::INFINITY),
                parasitic_mn_tactile: None,
                below_threshold,
            };
        }
        let square: f64 = scored.iter().map(|f| f * f).sum();
        let tactile = Welch::new(rate_hz).density(scored);
        Self {
            parasitic_mn_rms: Some((square / n).sqrt()),
            parasitic_mn_p99: Some(percentile(scored.iter().copied(), 0.99)),
            parasitic_mn_tactile: tactile.and_then(|d| d.rms_within(TACTILE_BAND_HZ)),
            below_threshold,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::TAU;

    const FINGERTIP: Fingertip = Fingertip {
        mn_per_nm: 2e3 / 0.07,
        threshold_mn: 10.0,
    };

    #[test]
    fn one_of_100_ticks_exceeds_p99() {
        // 0.1 s that is not scored, then 1 to 100 mN in a scrambled order.
        let scored = (0..100).map(|k| f64::from((37 * k) % 100 + 1));
        let force: Vec<f64> = std::iter::repeat_n(500.0, 100).chain(scored).collect();
        let score = Parasitic::of(&force, 1e3, &FINGERTIP);
        assert_eq!(score.parasitic_mn_p99, Some(99.0));
        // 1 to 9 mN are below the threshold of 10 mN.
        assert_eq!(score.below_threshold, Some(0.09));
    }

    #[test]
    fn tactile_score_has_only_frequencies_from_50_to_500_hz() {
        let sine = |hz: f64| -> Vec<f64> {
            let at = |k: i32| 8.0 * (TAU * hz * f64::from(k) / 10e3).sin();
            (0..20_000).map(at).collect()
        };
        let tactile = |hz| Parasitic::of(&sine(hz), 10e3, &FINGERTIP).parasitic_mn_tactile;
        let inside = tactile(200.0).unwrap();
        assert!(
            (inside / (8.0 * 0.5_f64.sqrt()) - 1.0).abs() < 1e-3,
            "{inside}"
        );
        assert!(tactile(10.0).unwrap() < 0.01 && tactile(1200.0).unwrap() < 0.01);
        // A sine of 8 mN is below the threshold throughout.
        let score = Parasitic::of(&sine(200.0), 10e3, &FINGERTIP);
        assert_eq!(score.below_threshold, Some(1.0));
    }

    #[test]
    fn force_at_the_threshold_or_not_finite_is_not_below_it() {
        let share = |force: f64| Parasitic::of(&[force; 400], 1e3, &FINGERTIP).below_threshold;
        assert_eq!([share(9.99), share(-10.0)], [Some(1.0), Some(0.0)]);
        let mut force = vec![1.0; 200];
        force[150] = f64::NAN;
        let score = Parasitic::of(&force, 1e3, &FINGERTIP);
        assert_eq!(score.parasitic_mn_rms, Some(f64::INFINITY));
        assert_eq!(score.below_threshold, Some(0.99));
        assert_eq!(
            Parasitic::of(&force[..100], 1e3, &FINGERTIP),
            Parasitic::default()
        );
    }
}
