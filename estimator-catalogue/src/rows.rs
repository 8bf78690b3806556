//! All estimators: a file per family, in the order in which the command line shows them.

mod banks;
mod kalman;
mod observers;
mod tracking;
mod windows;

use estimator_core::Signals;

use crate::parameter::{Parameter, Search, WINDOW_LIMIT};
use crate::row::{Colour, Dash, Goal, Reports, Row, Settling, Variant};
use crate::scaling::{Powers, Scaling};

/// Passes all rows to the macro `$each`. A row is
///
/// ```text
/// id, "name", Reports,
/// (parameter: RANGE, ..),
/// (variant: rate in Hz, capacity; ..),
/// { facts },
/// |c, motor, rate, clock, p, N| Type => design;
/// ```
///
/// with `c` the crate `estimator-core` or its f64 twin, `motor` a `&c::CoupledMotor`, `rate` and
/// `clock` (of the edge time stamps) a `c::Hertz`, `p` the parameters by name
/// ([`design`](crate::design)), and `N` the length of a window or a table, a constant. The design
/// is a `Result<Type, c::DesignError>` and a constant expression. RANGE is a constant of
/// [`Parameter`](crate::Parameter), or the fields of a range that no other row has, in braces: `n:
/// { lowest: 2.0, ..Parameter::WINDOW }`.
///
/// ```
/// macro_rules! names {
///     ($(
///         $id:ident, $name:literal, $reports:ident, ($($parameter:tt)*), ($($variant:tt)*),
///         { $($fact:tt)* }, |$($use:ident),*| $type:ty => $make:expr;
///     )*) => { [$($name),*] };
/// }
/// assert_eq!(estimator_catalogue::estimators!(names)[0], "finite-difference");
/// ```
#[macro_export]
macro_rules! estimators {
    ($each:ident) => {
        $crate::joined! {
            $each (at_1k: 1000.0, 0; at_10k: 10_000.0, 0;) []
            window_rows kalman_rows tracking_rows bank_rows observer_rows
        }
    };
}

/// Passes the rows of the families, in this order, to `$each`. Each family adds its rows to those
/// in brackets. `$rates` are the variants of a design that depends on the control rate.
#[doc(hidden)]
#[macro_export]
macro_rules! joined {
    ($each:ident $rates:tt [$($rows:tt)*]) => {
        $each! { $($rows)* }
    };
    ($each:ident $rates:tt $before:tt $family:ident $($families:ident)*) => {
        $crate::$family! { $each $rates $before $($families)* }
    };
}

/// `Result::and_then` in a constant.
#[doc(hidden)]
#[macro_export]
macro_rules! then {
    ($first:expr, |$value:ident| $next:expr) => {
        match $first {
            Ok($value) => $next,
            Err(error) => Err(error),
        }
    };
}

const EDGE: Signals = Signals {
    edge: true,
    ..Signals::COUNT
};

const COUNT_CURRENT_AND_SLIP: Signals = Signals {
    coupled: true,
    ..Signals::COUNT_AND_CURRENT
};

/// The range of a parameter: a constant of [`Parameter`], or fields in braces.
macro_rules! range {
    ({ $($field:tt)* }) => {
        Parameter { $($field)* }
    };
    ($range:ident) => {
        Parameter::$range
    };
}

/// After inputs that no device produces, an adaptive observer can have a friction near zero. It then
/// comes to rest only after its disturbance torque has been corrected count by count. The time is above
/// the longest one of the stress test.
const ADAPTED: Settling = Settling::Within(6.0);

macro_rules! rows {
    ($(
        $id:ident, $name:literal, $reports:ident,
        ($($parameter:ident: $range:tt),*),
        ($($variant:ident: $rate:literal, $capacity:literal;)*),
        { $($fact:tt)* },
        |$c:ident, $motor:ident, $rates:ident, $clock:ident, $p:ident, $N:ident| $type:ty => $make:expr;
    )*) => {
        /// All rows, in the order in which the command line shows them.
        pub const ROWS: &[Row] = &[$(design::$id::ROW),*];

        /// A module per row, for the macros that expand the rows.
        pub mod design {
            $(
                #[doc = concat!("The row of `", $name, "`.")]
                pub mod $id {
                    use super::super::*;

                    /// The row.
                    pub const ROW: Row = Row {
                        name: $name,
                        id: stringify!($id),
                        varying_period: varying_period(),
                        reports: Reports::$reports,
                        rust_type: stringify!($type),
                        rust_design: stringify!($make),
                        parameters: &[$(
                            Parameter { name: stringify!($parameter), ..range!($range) }
                        ),*],
                        variants: &[$(
                            Variant {
                                id: stringify!($variant),
                                rate_hz: $rate,
                                capacity: $capacity,
                            }
                        ),*],
                        $($fact)*
                    };

                    const fn varying_period() -> bool {
                        #[allow(unused_imports, reason = "unused if all types take a varying period")]
                        use crate::varying::{AssumesConstantPeriod as _, Varying};
                        use estimator_core as $c;
                        // Any length: it is no matter of the trait.
                        #[allow(dead_code, reason = "not every type has a length")]
                        const $N: usize = 2;
                        Varying::<$type>::UPDATE_OVER.is_some()
                    }

                    /// The parameters by name, in the units of the row.
                    #[derive(Clone, Copy, Debug, PartialEq)]
                    pub struct Parameters {
                        $(
                            #[doc = concat!("Range: `", stringify!($range), "`.")]
                            pub $parameter: f64,
                        )*
                    }

                    impl Parameters {
                        /// The parameters from their values, in the order of the row; NaN, which every
                        /// design refuses, for a value that is missing.
                        #[must_use]
                        #[allow(unused_mut, unused_variables, reason = "a row may have no parameter")]
                        pub fn from_values(values: &[f64]) -> Self {
                            let mut values = values.iter().copied();
                            Self { $($parameter: values.next().unwrap_or(f64::NAN),)* }
                        }
                    }
                }
            )*
        }
    };
}

crate::estimators!(rows);
