//! A column of a table of scores, and the macro that declares a structure of scores with its columns.

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
