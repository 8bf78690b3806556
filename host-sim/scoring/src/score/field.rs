//! A column of a table of scores, and the macro that declares a structure of scores with its
//! columns.

use super::Wanted;

/// Format of a value in a table.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Form {
    /// A number with three digits, in the field's unit.
    Number,
    /// A share from 0 to 1, printed in %.
    Share,
}

/// Rule that merges the values of several seeds or scenarios into one.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Over {
    /// The mean of the values.
    Mean,
    /// The largest value.
    Largest,
}

/// Which value of a column is marked as the best.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Better {
    /// The value of the smallest magnitude.
    Smaller,
    /// The largest value.
    Larger,
    /// No value is marked, because the score does not rank estimators.
    Neither,
}

/// One column of a table of scores.
#[derive(Debug)]
pub struct Field<T> {
    /// Name in the JSON, the CSV and for `--score`.
    pub name: &'static str,
    /// Definition of the score: the lines of the field's documentation.
    pub about: &'static [&'static str],
    /// Heading of the column.
    pub head: &'static str,
    /// Unit, below the heading.
    pub unit: &'static str,
    /// Format of a value.
    pub form: Form,
    /// Rule that merges several values.
    pub over: Over,
    /// Which value is the best.
    pub better: Better,
    /// Whether tables show the column by default.
    pub usual: bool,
    /// Reads the value from a row.
    pub of: fn(&T) -> Option<f64>,
    /// Writes the value into a row.
    pub set: fn(&mut T, Option<f64>),
    /// The flag of the computation that the value needs; `None` if it is always computed.
    pub takes: Option<fn(&mut Wanted) -> &mut bool>,
}

impl<T> Field<T> {
    /// The merged value of several rows; `None` if no row has a value.
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

    /// The first sentence of the definition, up to a semicolon or a colon.
    #[must_use]
    pub fn sentence(&self) -> String {
        let text = self.about.join("");
        // A unit such as N.m.s/rad has full stops inside.
        let ends = [";", ":", ". "].map(|end| text.find(end));
        let end = ends.into_iter().flatten().min();
        let end = end.unwrap_or(text.trim_end_matches('.').len());
        text[..end].trim().replace('`', "")
    }

    /// The value of a row in the unit of the table, in which a share is in %.
    #[must_use]
    pub fn shown(&self, row: &T) -> Option<f64> {
        (self.of)(row).map(|value| self.in_unit(value))
    }

    /// Converts a value of the JSON to the unit of the table.
    #[must_use]
    pub fn in_unit(&self, value: f64) -> f64 {
        match self.form {
            Form::Number => value,
            Form::Share => 100.0 * value,
        }
    }
}

/// A row whose fields merge those of `rows`.
pub(super) fn merged<'a, T: Default + 'a>(
    fields: &[Field<T>],
    rows: impl Iterator<Item = &'a T>,
) -> T {
    let rows: Vec<&T> = rows.collect();
    let mut merged = T::default();
    for field in fields {
        (field.set)(&mut merged, field.over(rows.iter().copied()));
    }
    merged
}

/// Declares a structure of scores and its columns `FIELDS`, one line per score. A line has the
/// heading, the unit, the [`Form`], the rule [`Over`], the best value [`Better`], whether tables
/// show the score by default, and the flag of an optional computation. The caller imports
/// `serde::Serialize`.
///
/// [`Form`]: crate::score::Form
/// [`Over`]: crate::score::Over
/// [`Better`]: crate::score::Better
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
