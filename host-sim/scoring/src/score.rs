//! Scores of an estimate against the true velocity. The distance is the error beyond the haptic
//! interval, within which a fingertip does not notice it.
//!
//! ```text
//! tolerance(w) = k |w| + F_shd D / (2 b)            half width of the haptic interval, rad/s
//! distance     = max(0, |estimate - w| - tolerance(w))
//! ```
//!
//! The first [`SKIP_S`] seconds of a trace are not scored, because every estimator begins at rest, nor
//! are samples at which the truth is not known.

mod delay;
mod field;
mod fields;
mod scored;
mod sections;
mod transient;
mod truth;

pub use field::{Better, Field, Form, Over};
pub use fields::{Score, Wanted};
pub use scored::{rms_scored, scored, skipped};
pub use sections::Sections;
pub use transient::HALF_SPAN_S;
pub use truth::{Truth, is_within_2_sigma};

/// Duration at the start of a trace that is not scored, s.
pub const SKIP_S: f64 = 0.1;

/// Frequencies at which a fingertip is most sensitive to vibration, Hz.
pub const TACTILE_BAND_HZ: [f64; 2] = [50.0, 500.0];

/// The haptic interval around the true velocity, within which a fingertip notices no error, and the
/// parasitic force that an error causes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HapticInterval {
    /// Weber fraction: the largest unnoticed error as a fraction of the speed.
    pub weber: f64,
    /// Half width of the interval at zero velocity, rad/s.
    pub floor_rad_s: f64,
    /// Parasitic force at the fingertip for an error of 1 rad/s, mN.
    pub force_mn_per_rad_s: f64,
}

impl HapticInterval {
    /// The interval for the Weber fraction `weber`, the force threshold at the fingertip
    /// `threshold_n` (N), the handle's diameter `diameter_m` (m) and the coupler's damping
    /// (N.m.s/rad).
    ///
    /// ```
    /// # use scoring::score::HapticInterval;
    /// let paper = HapticInterval::new(0.05, 0.010, 0.070, 0.96e-3);
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tolerance_is_constant_plus_a_fraction_of_the_speed() {
        let interval = HapticInterval::new(0.05, 0.010, 0.070, 0.96e-3);
        assert!((interval.tolerance(0.0) - 0.364_583_3).abs() < 1e-6);
        assert!((interval.tolerance(10.0) - 0.864_583_3).abs() < 1e-6);
        assert!((interval.tolerance(-10.0) - 0.864_583_3).abs() < 1e-6);
        // An error of the half width at zero velocity causes the threshold force, 10 mN.
        assert!((interval.floor_rad_s * interval.force_mn_per_rad_s - 10.0).abs() < 1e-9);
    }

    #[test]
    fn percentages_are_relative_to_the_reference_and_none_without_it() {
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
        let percent = score.relative_to(&reference);
        assert_eq!(percent.rms_pct, Some(25.0));
        assert_eq!(percent.distance_pct, None, "the reference is 0");
        assert_eq!(
            percent.distance_transient_pct, None,
            "the reference has no transient"
        );
    }

    /// Names that the JSON and CSV output always has.
    const CONTRACT: [&str; 12] = [
        "rms_rad_s",
        "max_rad_s",
        "distance_rad_s",
        "distance_transient_rad_s",
        "distance_pct",
        "distance_transient_pct",
        "rms_pct",
        "outside",
        "delay_ms",
        "noise_rad_s",
        "chatter_rad_s",
        "force_mn",
    ];

    #[test]
    fn fields_include_the_contract_and_are_those_of_the_json() {
        let json = serde_json::to_value(Score {
            max_rad_s: Some(f64::INFINITY),
            non_finite: 3,
            ..Score::default()
        })
        .unwrap();
        let mut names: Vec<_> = Score::FIELDS.iter().map(|field| field.name).collect();
        for name in CONTRACT {
            assert!(names.contains(&name), "{name}");
            assert!(json[name].is_null() && json.get(name).is_some(), "{name}");
        }
        assert_eq!(json["non_finite"], 3);
        names.push("non_finite");
        names.sort_unstable();
        let mut keys: Vec<_> = json.as_object().unwrap().keys().collect();
        keys.sort_unstable();
        assert_eq!(keys, names);
    }

    #[test]
    fn scores_of_seeds_are_merged_to_mean_or_maximum() {
        let row = |value: f64| {
            let mut row = Score::default();
            for field in Score::FIELDS {
                (field.set)(&mut row, Some(value));
            }
            row.non_finite = 2;
            row
        };
        let rows = [row(1.0), Score::default(), row(5.0)];
        let mean = Score::mean(rows.iter());
        for field in Score::FIELDS {
            // Rows without a value do not count.
            let expected = match field.name {
                "max_rad_s" => 5.0,
                _ => 3.0,
            };
            assert_eq!((field.of)(&mean), Some(expected), "{}", field.name);
        }
        assert_eq!(mean.non_finite, 4);
        assert_eq!(Score::mean(rows[1..2].iter()), Score::default());
    }
}
