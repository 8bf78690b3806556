//! What Rust computes.

use bench_image::CLOCK;
use estimator_catalogue::{CType, ROWS, Row, design};
use estimator_core::{
    AccelerationEstimator, Confidence, CoupledMotor, DesignError, Hertz, Sample, VelocityEstimator,
};

/// Values per update: velocity, variance, acceleration, damping ratio.
pub const VALUES: usize = 4;

/// A variant of a row with the parameters of the bench image.
pub struct Case {
    /// Its type in C.
    pub c: CType,
    /// Control rate, Hz.
    pub rate_hz: u32,
    /// Values of the row's parameters.
    pub values: fn() -> Vec<f64>,
    /// What the estimator reports after each sample but the first, [`VALUES`] per sample.
    pub run: fn(&[Sample]) -> Vec<f32>,
}

/// A rate for variants that suit every rate.
const ANY_RATE: u32 = 1000;

const fn rate(hertz: f64) -> u32 {
    if hertz > 0.0 { hertz as u32 } else { ANY_RATE }
}

const fn row(name: &str) -> &'static Row {
    let mut k = 0;
    while k < ROWS.len() {
        if same(ROWS[k].name, name) {
            return &ROWS[k];
        }
        k += 1;
    }
    panic!("no such row")
}

const fn same(a: &str, b: &str) -> bool {
    let (a, b) = (a.as_bytes(), b.as_bytes());
    let mut k = 0;
    while k < a.len() && k < b.len() && a[k] == b[k] {
        k += 1;
    }
    k == a.len() && k == b.len()
}

fn run<E: VelocityEstimator>(
    estimator: &E,
    samples: &[Sample],
    more: impl Fn(&E::State) -> [f32; VALUES - 1],
) -> Vec<f32> {
    let mut state = estimator.start(&samples[0]);
    let mut values = Vec::with_capacity(VALUES * samples.len());
    for sample in &samples[1..] {
        values.push(estimator.update(&mut state, sample).0);
        values.extend(more(&state));
    }
    values
}

macro_rules! reports {
    (Nothing, $estimator:ident, $state:ident) => {
        [0.0; 3]
    };
    (Acceleration, $estimator:ident, $state:ident) => {
        [
            $estimator.variance($state).0,
            $estimator.acceleration($state).0,
            0.0,
        ]
    };
    (Damping, $estimator:ident, $state:ident) => {
        [
            $estimator.variance($state).0,
            0.0,
            $estimator.parameter_errors($state).damping_ratio(),
        ]
    };
    ($variance:ident, $estimator:ident, $state:ident) => {
        [$estimator.variance($state).0, 0.0, 0.0]
    };
}

macro_rules! cases {
    ($(
        $id:ident, $name:literal, $reports:ident,
        ($($parameter:ident: $range:tt),*),
        ($($variant:ident: $hertz:literal, $capacity:literal;)*),
        { $($fact:tt)* },
        |$c:ident, $motor:ident, $rate:ident, $clock:ident, $p:ident, $N:ident| $type:ty => $make:expr;
    )*) => {
        $(
            mod $id {
                use super::*;
                use estimator_core as $c;

                #[allow(unused_variables, reason = "a row may have no parameter")]
                fn values_of(hertz: f64, capacity: usize) -> Vec<f64> {
                    let rate = Hertz(f64::from(rate(hertz)));
                    vec![$(tuned::value_for($name, rate, capacity, stringify!($parameter)),)*]
                }

                $(
                    pub(super) mod $variant {
                        use super::*;

                        #[allow(dead_code, reason = "not every design has a window or a table")]
                        const $N: usize = $capacity;

                        fn values() -> Vec<f64> {
                            values_of($hertz, $capacity)
                        }

                        #[allow(unused_variables, reason = "not every design uses everything")]
                        fn run(samples: &[Sample]) -> Vec<f32> {
                            let $p = design::$id::Parameters::from_values(&values());
                            let ($rate, $clock) = (Hertz(f64::from(rate($hertz))), CLOCK);
                            let $motor = &CoupledMotor::DCX35L;
                            let design: Result<$type, DesignError> = $make;
                            let estimator = design.expect("the bench image has it");
                            crate::reference::run(&estimator, samples, |state| {
                                reports!($reports, estimator, state)
                            })
                        }

                        pub(super) const CASE: Case = Case {
                            c: CType { row: row($name), capacity: $capacity },
                            rate_hz: rate($hertz),
                            values,
                            run,
                        };
                    }
                )*

                pub(super) const ALL: &[Case] = &[$($variant::CASE),*];
            }
        )*

        /// The cases of each row.
        pub const CASES: &[&[Case]] = &[$($id::ALL),*];
    };
}

estimator_catalogue::estimators!(cases);
