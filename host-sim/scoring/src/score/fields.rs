//! The list of scores. The structure, JSON, CSV, tables, `--score`, averages over seeds and the
//! table of docs/theory/scores.md follow from it.

use serde::Serialize;

use super::field::{Field, merged};
use crate::score_fields;
use terminal::wording::unknown;

/// Declares the flags of the computations that can be left out.
macro_rules! wanted {
    ($($name:ident),+ $(,)?) => {
        /// Selection of the scores to compute. The other scores are `None` and take no time. The
        /// list of [`Score`] names the flag of each score.
        #[allow(missing_docs, reason = "a flag is documented by the scores that name it")]
        #[derive(Clone, Copy, Debug, PartialEq, Eq)]
        pub struct Wanted {
            $(pub $name: bool,)+
        }

        impl Wanted {
            /// All scores.
            pub const ALL: Self = Self { $($name: true),+ };

            /// No score, the base of a selection such as `Wanted { rms: true, ..Wanted::NONE }`.
            pub const NONE: Self = Self { $($name: false),+ };
        }
    };
}

wanted! {
    rms, max, p99, distance, distance_transient, outside, delay, noise, chatter, force, within, learned,
}

impl Default for Wanted {
    fn default() -> Self {
        Self::ALL
    }
}

score_fields! {
    /// The scores of one estimate. A score is `None` if it is not selected or not defined on this
    /// trace.
    ///
    /// If an estimate contains NaN or an infinity, its errors, distances and force are infinite,
    /// the samples that are not finite count as outside, and delay, noise and chatter are `None`.
    /// JSON has no infinity: serde writes `null`, and `non_finite` is above 0.
    pub struct Score {
        /// Root mean square of the error, rad/s.
        rms_rad_s: "rms", "rad/s", Number, Mean, Smaller, true, rms;
        /// Largest magnitude of the error, rad/s.
        max_rad_s: "largest", "rad/s", Number, Largest, Smaller, true, max;
        /// 99th percentile of the error's magnitude, rad/s: 1 % of the samples exceed it.
        p99_rad_s: "99 %", "rad/s", Number, Mean, Smaller, false, p99;
        /// Mean distance outside the haptic interval, rad/s: mean over all samples of
        /// `max(0, |error| - tolerance)`.
        distance_rad_s: "distance", "rad/s", Number, Mean, Smaller, true, distance;
        /// Mean distance over transient samples alone, rad/s. A transient lasts from an instant at
        /// which the magnitude of the acceleration, a central difference over ±2 ms of the true
        /// velocity, is above 100 rad/s², to 20 ms later. `None` if the trace has no transient.
        distance_transient_rad_s: "transient", "rad/s", Number, Mean, Smaller, false, distance_transient;
        /// Mean distance outside the haptic interval, % of that of finite difference on the same
        /// samples.
        distance_pct: "distance", "% of FD", Number, Mean, Smaller, true, distance;
        /// Mean distance over transient samples, % of that of finite difference on the same
        /// samples.
        distance_transient_pct: "transient", "% of FD", Number, Mean, Smaller, true, distance_transient;
        /// Root mean square of the error, % of that of finite difference on the same samples.
        rms_pct: "rms", "% of FD", Number, Mean, Smaller, true, rms;
        /// Share of samples outside the haptic interval, 0 to 1.
        outside: "outside", "%", Share, Mean, Smaller, true, outside;
        /// Shift of the truth that minimises the RMS error, ms, refined below one sample by a
        /// parabola. The delay is positive if the estimate lags. `None` if the truth does not move
        /// or if no shift below 0.1 s is best.
        delay_ms: "delay", "ms", Number, Mean, Smaller, true, delay;
        /// RMS of the error from 50 to 500 Hz, at most to half the sample rate, rad/s. In this band
        /// the fingertip is most sensitive. `None` if the trace is shorter than 0.35 s, or the rate
        /// is 100 Hz or less.
        noise_rad_s: "noise", "rad/s", Number, Mean, Smaller, true, noise;
        /// Total variation of the estimate less that of the truth, per sample, rad/s; at least 0.
        chatter_rad_s: "chatter", "rad/s", Number, Mean, Smaller, true, chatter;
        /// The RMS error as parasitic force at the fingertip, mN: `2 b RMS / D`.
        force_mn: "force", "mN", Number, Mean, Smaller, true, force;
        /// Share of samples whose error is within two of the standard deviations that the estimator
        /// reports, 0 to 1: 0.95 if the standard deviation is correct and the error Gaussian.
        /// `None` if the estimator reports no standard deviation.
        within_2_sigma: "within", "2 sd, %", Share, Mean, Neither, true, within;
        /// Mean distance of finite difference on the same samples, rad/s: the 100 % of
        /// `distance_pct`.
        difference_distance_rad_s: "FD dist.", "rad/s", Number, Mean, Neither, false, distance;
        /// Damping b that the estimator learned, mean of the run's last tenth, N.m.s/rad. `None` if
        /// the estimator does not learn the damping.
        learned_damping_nms_per_rad: "learned b", "N.m.s/rad", Number, Mean, Neither, false, learned;
        /// RMS error of the learned damping after the first 3 s, % of the true damping.
        learned_damping_pct: "error of b", "%", Number, Mean, Smaller, false, learned;
        +
        /// Number of scored samples that are NaN or infinite.
        non_finite: usize;
    }
}

impl Score {
    /// The field of this name.
    ///
    /// # Errors
    /// If there is no field of that name; the message lists the names.
    pub fn field(name: &str) -> Result<&'static Field<Self>, String> {
        let known = || Self::FIELDS.iter().map(|field| field.name);
        let field = Self::FIELDS.iter().find(|field| field.name == name);
        field.ok_or_else(|| unknown("score", name, known()))
    }

    /// The scores of `rows`, merged: the mean of each score, the largest of the largest errors and
    /// the sum of the samples that are not finite.
    #[must_use]
    pub fn mean<'a>(rows: impl Iterator<Item = &'a Self>) -> Self {
        let rows: Vec<_> = rows.collect();
        Self {
            non_finite: rows.iter().map(|row| row.non_finite).sum(),
            ..merged(Self::FIELDS, rows.iter().copied())
        }
    }

    /// Adds the scores relative to the `reference`, by convention the finite difference on the same
    /// trace. A percentage is `None` if either score is missing or if the reference is 0 or not
    /// finite.
    #[must_use]
    pub fn relative_to(mut self, reference: &Self) -> Self {
        let percent = |of: Option<f64>, whole: Option<f64>| match (of, whole) {
            (Some(of), Some(whole)) if whole > 0.0 && whole.is_finite() => Some(100.0 * of / whole),
            _ => None,
        };
        self.distance_pct = percent(self.distance_rad_s, reference.distance_rad_s);
        self.distance_transient_pct = percent(
            self.distance_transient_rad_s,
            reference.distance_transient_rad_s,
        );
        self.rms_pct = percent(self.rms_rad_s, reference.rms_rad_s);
        self.difference_distance_rad_s = reference.distance_rad_s;
        self
    }
}

impl Wanted {
    /// Selects the score of this name, as in [`Score`] and the JSON.
    ///
    /// # Errors
    /// If there is no score of that name; the message lists them.
    pub fn add(&mut self, name: &str) -> Result<&'static Field<Score>, String> {
        let field = Score::field(name)?;
        if let Some(takes) = field.takes {
            *takes(self) = true;
        }
        Ok(field)
    }
}

#[cfg(test)]
mod tests {
    use crate::score::Score;

    #[test]
    fn sentence_keeps_the_full_stops_of_a_unit() {
        let sentence = |name| {
            let field = Score::FIELDS.iter().find(|field| field.name == name);
            field.expect("a score").sentence()
        };
        assert_eq!(
            sentence("rms_rad_s"),
            "Root mean square of the error, rad/s"
        );
        let damping = sentence("learned_damping_nms_per_rad");
        assert!(damping.ends_with("last tenth, N.m.s/rad"), "{damping}");
    }

    #[test]
    fn tables_show_a_share_in_percent_and_other_values_as_they_are() {
        let row = Score {
            outside: Some(0.25),
            delay_ms: Some(0.25),
            ..Score::default()
        };
        let shown = |name: &str| Score::field(name).unwrap().shown(&row);
        assert_eq!(shown("outside"), Some(25.0));
        assert_eq!(shown("delay_ms"), Some(0.25));
        assert_eq!(shown("noise_rad_s"), None);
    }
}
