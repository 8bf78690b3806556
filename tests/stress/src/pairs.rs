//! Every row of the catalogue as an estimator of the core beside its f64 twin.

use estimator_catalogue::{Row, design};
use estimator_core as core;
use estimator_twin as twin;

use crate::course::EDGE_CLOCK_HZ;
use crate::pair::{Asks, Both, Pair, asks};

/// A pair, or the name of the error with which both precisions refuse the design.
pub type Refusable = Result<Box<dyn Pair>, String>;

/// Inputs of a design.
pub(crate) struct Request<'a> {
    /// Control rate, Hz.
    pub(crate) rate_hz: f64,
    /// Counts per revolution of the large encoder.
    pub(crate) counts_per_rev: u32,
    /// Clock of the edge time stamps, Hz.
    pub(crate) clock_hz: f64,
    /// Length of a window or a gain table.
    pub(crate) capacity: usize,
    /// Value of a parameter by its name.
    pub(crate) value: &'a dyn Fn(&str) -> f64,
}

/// A design in both precisions, or the error that they agree in.
pub(crate) type Design = fn(&Request<'_>) -> Refusable;

/// A row with its designs in both precisions.
pub(crate) struct Entry {
    /// The row.
    pub(crate) row: &'static Row,
    /// The design, or the error that both precisions agree in.
    pub(crate) design: Design,
}

/// Windows that are tried, intervals.
pub(crate) const WINDOWS: [usize; 2] = [15, 64];

/// Length of the gain tables, ticks.
pub(crate) const TABLE: usize = 1024;

impl Entry {
    /// The entry of the row called `name`.
    pub(crate) fn named(name: &str) -> Option<&'static Self> {
        ALL.iter().find(|entry| entry.row.name == name)
    }

    /// Capacities that a run of the row tries.
    pub(crate) fn capacities(&self) -> &'static [usize] {
        if self.row.settling.is_window() {
            &WINDOWS
        } else {
            &[TABLE]
        }
    }
}

/// The longest capacity of a row.
const fn longest(row: &Row) -> usize {
    if row.settling.is_window() {
        WINDOWS[1]
    } else {
        TABLE
    }
}

/// Both precisions as a pair, or the name of their common error.
///
/// # Panics
/// If only one of them refuses the design, or their messages differ.
pub(crate) fn both<C, T>(
    core: Result<C, core::DesignError>,
    twin: Result<T, twin::DesignError>,
    asks: Asks<C>,
) -> Refusable
where
    C: core::VelocityEstimator + 'static,
    T: twin::VelocityEstimator + 'static,
{
    match (core, twin) {
        (Ok(core), Ok(twin)) => Ok(Box::new(Both {
            core,
            twin,
            asks,
            states: None,
        })),
        (Err(core), Err(twin)) => {
            assert_eq!(core.message(), twin.message());
            Err(core.parameter().to_owned())
        }
        (core, twin) => panic!("refused by one alone: {:?}, {:?}", core.err(), twin.err()),
    }
}

/// A design of the row in one precision: `$c` is the crate.
macro_rules! one {
    ($crate_of:ident, $c:ident, $motor:ident, $rate:ident, $clock:ident, $request:ident,
     $type:ty, $make:expr) => {{
        use $crate_of as $c;
        let motor = $c::CoupledMotor {
            motor: $c::MotorModel {
                counts_per_rev: $request.counts_per_rev,
                ..$c::MotorModel::DCX35L
            },
            ..$c::CoupledMotor::DCX35L
        };
        let $motor = &motor;
        let ($rate, $clock) = ($c::Hertz($request.rate_hz), $c::Hertz($request.clock_hz));
        let design: Result<$type, $c::DesignError> = $make;
        design
    }};
}

macro_rules! pairs {
    ($(
        $id:ident, $name:literal, $reports:ident,
        ($($parameter:ident: $range:tt),*),
        ($($variant:tt)*),
        { $($fact:tt)* },
        |$c:ident, $motor:ident, $rate:ident, $clock:ident, $p:ident, $N:ident| $type:ty => $make:expr;
    )*) => {
        $(
            #[allow(unused_variables, reason = "not every design uses everything")]
            fn $id<const $N: usize>(request: &Request<'_>) -> Refusable {
                let $p = design::$id::Parameters {
                    $($parameter: (request.value)(stringify!($parameter)),)*
                };
                both(
                    one!(core, $c, $motor, $rate, $clock, request, $type, $make),
                    one!(twin, $c, $motor, $rate, $clock, request, $type, $make),
                    {
                        use core as $c;
                        asks!($type)
                    },
                )
            }
        )*

        /// All rows.
        pub(crate) static ALL: &[Entry] = &[$(
            Entry {
                row: &design::$id::ROW,
                design: |request| match request.capacity {
                    15 => $id::<15>(request),
                    _ => $id::<{ longest(&design::$id::ROW) }>(request),
                },
            }
        ),*];
    };
}

estimator_catalogue::estimators!(pairs);

/// The gain table of the motor model: the core offers it to others, and no row has it.
pub(crate) fn kalman_motor_table(request: &Request<'_>) -> Refusable {
    let noise = (request.value)("current_noise");
    macro_rules! table {
        ($c:ident) => {{
            let device = $c::MotorModel {
                counts_per_rev: request.counts_per_rev,
                ..$c::MotorModel::DCX35L
            };
            $c::Model::motor(&device, $c::Hertz(request.rate_hz), noise)
                .and_then(|model| $c::TableKalmanMotor::<TABLE>::new(&model))
        }};
    }
    both(
        table!(core),
        table!(twin),
        asks!(core::TableKalmanMotor<TABLE>),
    )
}

/// The motor model with the paper's eq. 15 taken literally: the row has it behind a parameter.
pub(crate) fn late_kalman_motor(request: &Request<'_>) -> Refusable {
    let noise = (request.value)("current_noise");
    macro_rules! late {
        ($c:ident) => {
            $c::Model::motor(&$c::MotorModel::DCX35L, $c::Hertz(request.rate_hz), noise)
                .and_then(|model| $c::SteadyKalman::new(&model))
                .map($c::LateCurrent)
        };
    }
    both(
        late!(core),
        late!(twin),
        asks!(core::LateCurrent<core::SteadyKalmanMotor>),
    )
}

/// A request at the edge clock and the encoder of the default device.
pub(crate) fn request<'a>(
    rate_hz: f64,
    capacity: usize,
    value: &'a dyn Fn(&str) -> f64,
) -> Request<'a> {
    Request {
        rate_hz,
        counts_per_rev: core::MotorModel::DCX35L.counts_per_rev,
        clock_hz: EDGE_CLOCK_HZ,
        capacity,
        value,
    }
}
