//! The scores of a row, declared once: structure, JSON, CSV, tables, `--score` and averages over
//! seeds follow from the list below.

use serde::Serialize;

use super::Wanted;

/// How a value is printed in a table.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Form {
    /// With three digits, in the field's unit.
    Number,
    /// A share from 0 to 1, in %.
    Share,
}

/// How several seeds or scenarios become one value.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Over {
    /// Their mean.
    Mean,
    /// The largest.
    Largest,
}

/// Which value of a column is marked as the best.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Better {
    /// The smallest in size.
    Smaller,
    /// The largest.
    Larger,
    /// None: the value describes and does not rank.
    Neither,
}

/// One column of a table of scores.
#[derive(Debug)]
pub struct Field<T> {
    /// Name in the JSON, the CSV and for `--score`.
    pub name: &'static str,
    /// What the score is: the documentation of the structure's field, a line each.
    pub about: &'static [&'static str],
    /// Heading of the column.
    pub head: &'static str,
    /// Unit, below the heading.
    pub unit: &'static str,
    /// How a value is printed.
    pub form: Form,
    /// How several values become one.
    pub over: Over,
    /// Which value is the best.
    pub better: Better,
    /// Whether tables show it without being asked to.
    pub usual: bool,
    /// The value of a row.
    pub of: fn(&T) -> Option<f64>,
    /// Puts a value into a row.
    pub set: fn(&mut T, Option<f64>),
    /// The computation that the value takes, where that can be left out.
    pub takes: Option<fn(&mut Wanted) -> &mut bool>,
}

impl<T> Field<T> {
    /// One value for several rows; `None` where no row has one.
    pub fn over<'a>(&self, rows: impl Iterator<Item = &'a T>) -> Option<f64>
    where
        T: 'a,
    {
        let values: Vec<f64> = rows.filter_map(self.of).collect();
        match self.over {
            Over::Largest => values.into_iter().reduce(f64::max),
            Over::Mean => {
                let n = values.len();
                (n > 0).then(|| values.into_iter().sum::<f64>() / n as f64)
            }
        }
    }

    /// The first sentence of what the score is, up to a semicolon or a colon.
    #[must_use]
    pub fn sentence(&self) -> String {
        let text = self.about.join("");
        // A unit such as N.m.s/rad has full stops inside.
        let ends = [";", ":", ". "].map(|end| text.find(end));
        let end = ends.into_iter().flatten().min();
        let end = end.unwrap_or(text.trim_end_matches('.').len());
        text[..end].trim().replace('`', "")
    }

    /// The value in the unit that a table prints: a share in %.
    #[must_use]
    pub fn shown(&self, row: &T) -> Option<f64> {
        (self.of)(row).map(|value| self.in_unit(value))
    }

    /// A value of the JSON in the unit that a table prints.
    #[must_use]
    pub fn in_unit(&self, value: f64) -> f64 {
        match self.form {
            Form::Number => value,
            Form::Share => 100.0 * value,
        }
    }
}

/// Every field of `rows` made one.
fn merged<'a, T: Default + 'a>(fields: &[Field<T>], rows: impl Iterator<Item = &'a T>) -> T {
    let rows: Vec<&T> = rows.collect();
    let mut merged = T::default();
    for field in fields {
        (field.set)(&mut merged, field.over(rows.iter().copied()));
    }
    merged
}

/// Declares a structure of scores and its `FIELDS`: a line a score, with heading, unit, form, how
/// several values become one, which value is the best, whether tables show it without being asked
/// to, and the computation that can be left out. The caller needs `serde::Serialize` in scope.
#[macro_export]
macro_rules! score_fields {
    (
        $(#[$about:meta])*
        pub struct $Name:ident {
            $(
                $(#[doc = $doc:literal])+
                $field:ident: $head:literal, $unit:literal, $form:ident, $over:ident, $better:ident,
                $usual:literal $(, $takes:ident)?;
            )+
            $( + $(#[$more_doc:meta])+ $more:ident: $More:ty; )*
        }
    ) => {
        $(#[$about])*
        #[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
        pub struct $Name {
            $( $(#[doc = $doc])+ pub $field: Option<f64>, )+
            $( $(#[$more_doc])+ pub $more: $More, )*
        }

        impl $Name {
            /// The columns, in the order of tables and files.
            pub const FIELDS: &[$crate::score::Field<Self>] = &[
                $( $crate::score::Field {
                    name: stringify!($field),
                    about: &[$($doc),+],
                    head: $head,
                    unit: $unit,
                    form: $crate::score::Form::$form,
                    over: $crate::score::Over::$over,
                    better: $crate::score::Better::$better,
                    usual: $usual,
                    of: |row| row.$field,
                    set: |row, value| row.$field = value,
                    takes: $crate::takes!($($takes)?),
                }, )+
            ];
        }
    };
}

#[doc(hidden)]
#[macro_export]
macro_rules! takes {
    () => {
        None
    };
    ($takes:ident) => {
        Some(|wanted| &mut wanted.$takes)
    };
}

score_fields! {
    /// The scores of one estimate; `None` is not wanted or not defined on this trace.
    ///
    /// An estimate that contains NaN or an infinity cannot be good: its errors, distances and force
    /// are infinite, the bad samples count as outside, and delay, noise and chatter are `None`.
    /// JSON has no infinity, so serde writes `null` there; `non_finite` says why.
    pub struct Score {
        /// Root mean square of the error, rad/s.
        rms_rad_s: "rms", "rad/s", Number, Mean, Smaller, true, rms;
        /// Largest error, rad/s.
        max_rad_s: "largest", "rad/s", Number, Largest, Smaller, true, max;
        /// Mean distance outside the haptic interval, rad/s.
        distance_rad_s: "distance", "rad/s", Number, Mean, Smaller, true, distance;
        /// Mean distance over transient samples alone, rad/s; `None` where there is no transient.
        distance_transient_rad_s: "transient", "rad/s", Number, Mean, Smaller, false, distance_transient;
        /// Mean distance outside the haptic interval, % of finite difference.
        distance_pct: "distance", "% of FD", Number, Mean, Smaller, true, distance;
        /// Mean distance in transients in % of finite difference.
        distance_transient_pct: "transient", "% of FD", Number, Mean, Smaller, true, distance_transient;
        /// RMS error in % of finite difference.
        rms_pct: "rms", "% of FD", Number, Mean, Smaller, true, rms;
        /// Share of samples outside the interval, 0 to 1.
        outside: "outside", "%", Share, Mean, Smaller, true, outside;
        /// Shift of the truth that minimises the RMS error, ms; positive where the estimate lags,
        /// `None` where the truth does not move or no shift below 0.1 s is best.
        delay_ms: "delay", "ms", Number, Mean, Smaller, true, delay;
        /// RMS of the error from 50 to 500 Hz, rad/s; `None` below 0.25 s of samples.
        noise_rad_s: "noise", "rad/s", Number, Mean, Smaller, true, noise;
        /// Total variation beyond the truth's, per sample, rad/s.
        chatter_rad_s: "chatter", "rad/s", Number, Mean, Smaller, true, chatter;
        /// The RMS error as parasitic force at the fingertip, mN.
        force_mn: "force", "mN", Number, Mean, Smaller, true, force;
        /// Share of samples whose error is within two of the standard deviations that the estimator
        /// reports, 0 to 1: 0.95 for a correct deviation of a Gaussian error; `None` for an estimator
        /// that reports none.
        within_2_sigma: "within", "2 sd, %", Share, Mean, Neither, true, within;
        /// Mean distance of finite difference on the same samples, rad/s: the 100 % of
        /// `distance_pct`.
        difference_distance_rad_s: "FD dist.", "rad/s", Number, Mean, Neither, false, distance;
        /// Damping b that the estimator learned, mean of the run's last tenth, N.m.s/rad; `None` for
        /// an estimator that learns none.
        learned_damping_nms_per_rad: "learned b", "N.m.s/rad", Number, Mean, Neither, false, learned;
        /// RMS error of the learned damping after the first 3 s, % of the true damping.
        learned_damping_pct: "error of b", "%", Number, Mean, Smaller, false, learned;
        +
        /// How many of the scored samples are NaN or infinite.
        non_finite: usize;
    }
}

impl Score {
    /// The field of this name.
    ///
    /// # Errors
    /// If there is no field of that name; the message lists the names.
    pub fn field(name: &str) -> Result<&'static Field<Self>, String> {
        Self::FIELDS
            .iter()
            .find(|field| field.name == name)
            .ok_or_else(|| {
                let names: Vec<_> = Self::FIELDS.iter().map(|field| field.name).collect();
                format!("no score '{name}'; there are {}", names.join(", "))
            })
    }

    /// The mean over `rows` (largest error: the largest; samples that are not finite: their sum).
    #[must_use]
    pub fn mean<'a>(rows: impl Iterator<Item = &'a Self>) -> Self {
        let rows: Vec<_> = rows.collect();
        Self {
            non_finite: rows.iter().map(|row| row.non_finite).sum(),
            ..merged(Self::FIELDS, rows.iter().copied())
        }
    }

    /// Adds what is relative to the `reference`, by convention finite difference on the same trace.
    /// A percentage is `None` where either score is missing or the reference is 0 or not finite.
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
    /// Wants the score called `name`, as in [`Score`] and the JSON.
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
}
