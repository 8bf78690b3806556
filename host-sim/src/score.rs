//! How well an estimate follows the truth, in the terms of the hand that feels it.
//!
//! One definition, used by the table, the report, the JSON and the tests:
//!
//! ```text
//! tolerance(w) = k |w| + F_shd D / (2 b)            what a fingertip cannot tell from w, rad/s
//! distance     = max(0, |estimate - w| - tolerance(w))
//! ```
//!
//! Everything before the first [`SKIP_S`] seconds is ignored: estimators start from rest and
//! their first samples say nothing about them.

use serde::Serialize;

mod delay;
mod transient;
mod truth;

pub use truth::Truth;

/// Start of every trace that no score looks at, s.
pub const SKIP_S: f64 = 0.1;

/// The band in which a fingertip is most sensitive to vibration, Hz.
pub const TACTILE_BAND_HZ: [f64; 2] = [50.0, 500.0];

/// What a hand cannot tell from the true velocity, and what a velocity error is worth in force.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Interval {
    /// Weber fraction: the part of the velocity's size that goes unnoticed, without unit.
    pub weber: f64,
    /// Half width of the interval at zero velocity, rad/s.
    pub floor_rad_s: f64,
    /// Parasitic force at the fingertip for an error of 1 rad/s, mN.
    pub force_mn_per_rad_s: f64,
}

impl Interval {
    /// From the Weber fraction `weber`, the force threshold at the fingertip `threshold_n` (N),
    /// the handle's diameter `diameter_m` (m) and the coupler's damping (N.m.s/rad).
    ///
    /// ```
    /// # use host_sim::score::Interval;
    /// let paper = Interval::new(0.05, 0.010, 0.070, 0.96e-3);
    /// assert!((paper.tolerance(0.0) - 0.3646).abs() < 1e-4);
    /// assert!((paper.force_mn_per_rad_s - 27.43).abs() < 1e-2);
    /// ```
    #[must_use]
    pub fn new(weber: f64, threshold_n: f64, diameter_m: f64, damping: f64) -> Self {
        Self {
            weber,
            floor_rad_s: threshold_n * diameter_m / (2.0 * damping),
            force_mn_per_rad_s: 2.0e3 * damping / diameter_m,
        }
    }

    /// Half width of the interval around the velocity `omega` (rad/s), rad/s.
    #[must_use]
    pub fn tolerance(&self, omega: f64) -> f64 {
        self.weber * omega.abs() + self.floor_rad_s
    }
}

/// Which scores to compute; the others are `None` and take no time.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Wanted {
    /// [`Score::rms_rad_s`].
    pub rms: bool,
    /// [`Score::max_rad_s`].
    pub max: bool,
    /// [`Score::distance_rad_s`].
    pub distance: bool,
    /// [`Score::distance_transient_rad_s`].
    pub distance_transient: bool,
    /// [`Score::outside`].
    pub outside: bool,
    /// [`Score::delay_ms`].
    pub delay: bool,
    /// [`Score::noise_rad_s`].
    pub noise: bool,
    /// [`Score::chatter_rad_s`].
    pub chatter: bool,
    /// [`Score::force_mn`].
    pub force: bool,
}

impl Wanted {
    /// Every score.
    pub const ALL: Self = Self {
        rms: true,
        max: true,
        distance: true,
        distance_transient: true,
        outside: true,
        delay: true,
        noise: true,
        chatter: true,
        force: true,
    };

    /// No score: the start for `Wanted { rms: true, ..Wanted::NONE }`.
    pub const NONE: Self = Self {
        rms: false,
        max: false,
        distance: false,
        distance_transient: false,
        outside: false,
        delay: false,
        noise: false,
        chatter: false,
        force: false,
    };

    /// Wants the score called `name`, as in [`Score`] and the JSON; one in % is its own kind.
    ///
    /// # Errors
    /// If there is no score of that name; the message lists them.
    pub fn add(&mut self, name: &str) -> Result<(), String> {
        let flag = match name {
            "rms_rad_s" | "rms_pct" => &mut self.rms,
            "max_rad_s" => &mut self.max,
            "distance_rad_s" | "distance_pct" => &mut self.distance,
            "distance_transient_rad_s" | "distance_transient_pct" => &mut self.distance_transient,
            "outside" => &mut self.outside,
            "delay_ms" => &mut self.delay,
            "noise_rad_s" => &mut self.noise,
            "chatter_rad_s" => &mut self.chatter,
            "force_mn" => &mut self.force,
            _ => {
                return Err(format!(
                    "no score '{name}'; there are rms_rad_s, max_rad_s, distance_rad_s, \
                     distance_transient_rad_s, outside, delay_ms, noise_rad_s, chatter_rad_s, \
                     force_mn"
                ));
            }
        };
        *flag = true;
        Ok(())
    }
}

impl Default for Wanted {
    fn default() -> Self {
        Self::ALL
    }
}

/// The scores of one estimate; `None` is not wanted or not defined on this trace.
///
/// An estimate that contains NaN or an infinity cannot be good: its errors, distances and force
/// are infinite, the bad samples count as outside, and delay, noise and chatter are `None`.
/// JSON has no infinity, so serde writes `null` there; `non_finite` says why.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Score {
    /// Root mean square of the error, rad/s.
    pub rms_rad_s: Option<f64>,
    /// Largest error, rad/s.
    pub max_rad_s: Option<f64>,
    /// Mean distance outside the haptic interval, rad/s.
    pub distance_rad_s: Option<f64>,
    /// The same over transient samples alone, rad/s; `None` where there is no transient.
    pub distance_transient_rad_s: Option<f64>,
    /// Share of samples outside the interval, 0 to 1.
    pub outside: Option<f64>,
    /// Shift of the truth that minimises the RMS error, ms; positive where the estimate lags,
    /// `None` where the truth does not move or no shift below [`SKIP_S`] is best.
    pub delay_ms: Option<f64>,
    /// RMS of the error inside [`TACTILE_BAND_HZ`], rad/s; `None` below 0.25 s of samples.
    pub noise_rad_s: Option<f64>,
    /// Total variation beyond the truth's, per sample, rad/s.
    pub chatter_rad_s: Option<f64>,
    /// The RMS error as parasitic force at the fingertip, mN.
    pub force_mn: Option<f64>,
    /// How many of the scored samples are NaN or infinite.
    pub non_finite: usize,
}

/// Scores as a share of another estimator's on the same samples.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Percent {
    /// Mean distance, %.
    pub distance_pct: Option<f64>,
    /// Mean distance in transients, %.
    pub distance_transient_pct: Option<f64>,
    /// RMS error, %.
    pub rms_pct: Option<f64>,
}

/// `score` in % of `reference` (by convention finite difference on the same trace); `None` where
/// either is missing or the reference is 0 or not finite.
#[must_use]
pub fn percent_of(score: &Score, reference: &Score) -> Percent {
    let share = |of: Option<f64>, whole: Option<f64>| match (of, whole) {
        (Some(of), Some(whole)) if whole > 0.0 && whole.is_finite() => Some(100.0 * of / whole),
        _ => None,
    };
    Percent {
        distance_pct: share(score.distance_rad_s, reference.distance_rad_s),
        distance_transient_pct: share(
            score.distance_transient_rad_s,
            reference.distance_transient_rad_s,
        ),
        rms_pct: share(score.rms_rad_s, reference.rms_rad_s),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tolerance_is_the_floor_at_rest_and_grows_with_either_direction() {
        let interval = Interval::new(0.05, 0.010, 0.070, 0.96e-3);
        assert!((interval.tolerance(0.0) - 0.364_583_3).abs() < 1e-6);
        assert!((interval.tolerance(10.0) - 0.864_583_3).abs() < 1e-6);
        assert!((interval.tolerance(-10.0) - 0.864_583_3).abs() < 1e-6);
        // An error of exactly the floor is the force threshold, 10 mN.
        assert!((interval.floor_rad_s * interval.force_mn_per_rad_s - 10.0).abs() < 1e-9);
    }

    #[test]
    fn percent_is_of_the_reference_and_none_without_one() {
        let score = Score {
            rms_rad_s: Some(0.5),
            distance_rad_s: Some(0.1),
            distance_transient_rad_s: Some(0.3),
            ..Score::default()
        };
        let reference = Score {
            rms_rad_s: Some(2.0),
            distance_rad_s: Some(0.0),
            ..Score::default()
        };
        let percent = percent_of(&score, &reference);
        assert_eq!(percent.rms_pct, Some(25.0));
        assert_eq!(percent.distance_pct, None, "the reference is 0");
        assert_eq!(percent.distance_transient_pct, None, "there is none");
    }

    #[test]
    fn json_names_are_the_contract() {
        let json = serde_json::to_value(Score {
            max_rad_s: Some(f64::INFINITY),
            non_finite: 3,
            ..Score::default()
        })
        .unwrap();
        for name in [
            "rms_rad_s",
            "max_rad_s",
            "distance_rad_s",
            "distance_transient_rad_s",
            "outside",
            "delay_ms",
            "noise_rad_s",
            "chatter_rad_s",
            "force_mn",
        ] {
            assert!(json[name].is_null() && json.get(name).is_some(), "{name}");
        }
        assert_eq!(json["non_finite"], 3);
    }
}
