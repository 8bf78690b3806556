//! Builds every row of the catalogue from parameters that are known at run time.

use estimator_catalogue::{AssumesConstantPeriod as _, Row, Varying, WINDOW_LIMIT, design};
use estimator_core::{DesignError, Hertz, LateCurrent, Scale};
use simulation::trace::EDGE_CLOCK_HZ;

use super::erased::{Estimator, accelerating, confident, erased, learner};
use super::run::Over;
use super::{Setup, Values};

pub(super) type Build = fn(&Setup, &Values) -> Result<Estimator, DesignError>;

/// Length of the host's gain table, ticks: sufficient for the presets at 100 kHz. The firmware has
/// shorter tables.
const TABLE: usize = 4096;

/// Length of the window or of the gain table of a row.
pub(super) const fn capacity(row: &Row) -> usize {
    if row.settling.is_window() {
        WINDOW_LIMIT
    } else {
        TABLE
    }
}

/// The estimator behind one type, with what it reports.
macro_rules! reporting {
    (Nothing, $estimator:ident, $scale:ident, $over:ident, $p:ident) => {
        erased($estimator, $scale, $over)
    };
    (Deviation, $estimator:ident, $scale:ident, $over:ident, $p:ident) => {
        confident($estimator, $scale, $over)
    };
    (Acceleration, $estimator:ident, $scale:ident, $over:ident, $p:ident) => {
        accelerating($estimator, $scale, $over)
    };
    (Damping, $estimator:ident, $scale:ident, $over:ident, $p:ident) => {
        learner($estimator, $scale, $over, |estimator, state| {
            estimator.parameter_errors(state).damping_ratio()
        })
    };
    (LateCurrent, $estimator:ident, $scale:ident, $over:ident, $p:ident) => {
        match $p.literal != 0.0 {
            true => confident(LateCurrent($estimator), $scale, Over::NONE),
            false => confident($estimator, $scale, $over),
        }
    };
}

macro_rules! kinds {
    ($(
        $id:ident, $name:literal, $reports:ident,
        ($($parameter:ident: $range:tt),*),
        ($($variant:tt)*),
        { $($fact:tt)* },
        |$c:ident, $motor:ident, $rate:ident, $clock:ident, $p:ident, $N:ident| $type:ty => $make:expr;
    )*) => {
        $(
            #[allow(dead_code, unused_variables, reason = "not every design uses everything")]
            fn $id(setup: &Setup, values: &Values) -> Result<Estimator, DesignError> {
                use estimator_core as $c;
                const $N: usize = capacity(&design::$id::ROW);
                let $p = design::$id::Parameters::from_values(values);
                let motor = setup.stages.coupled_motor();
                let ($motor, $rate, $clock) = (&motor, setup.rate, Hertz(EDGE_CLOCK_HZ));
                let estimator: $type = $make?;
                let scale = Scale::new(setup.stages.large.counts_per_rev, setup.rate)?;
                let over = Over {
                    update: Varying::<$type>::UPDATE_OVER,
                    variance: Varying::<$type>::VARIANCE_OVER,
                };
                Ok(reporting!($reports, estimator, scale, over, $p))
            }
        )*

        /// The builders, in the order of the rows.
        pub(super) static BUILDERS: &[Build] = &[$($id),*];
    };
}

estimator_catalogue::estimators!(kinds);
