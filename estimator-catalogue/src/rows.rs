//! All estimators.

use estimator_core::Signals;

use crate::parameter::Parameter;
use crate::row::{Colour, Dash, Goal, Reports, Row, Settling, Variant};

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
/// ([`design`](crate::design)), and `N` the length of a window or a table, a constant. The design is
/// a `Result<Type, c::DesignError>` and a constant expression.
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
        $each! {
            finite_difference, "finite-difference", Deviation,
            (),
            (any: 0.0, 0;),
            {
                summary: "displacement over the last period (eq. 4)",
                needs: Signals::COUNT,
                settling: Settling::AtOnce,
                colour: Colour::GREY,
                dash: Dash::Solid,
                goals: &[],
            },
            |c, motor, rate, clock, p, N| c::FiniteDifference =>
                Ok(c::FiniteDifference);
            low_pass, "low-pass", Nothing,
            (cutoff_hz: CUTOFF),
            (at_1k: 1000.0, 0; at_10k: 10_000.0, 0;),
            {
                summary: "first-order low-pass over the finite difference",
                needs: Signals::COUNT,
                settling: Settling::OnePole,
                colour: Colour::ORANGE,
                dash: Dash::Solid,
                goals: &[],
            },
            |c, motor, rate, clock, p, N| c::LowPass<c::FiniteDifference> =>
                c::LowPass::new(c::FiniteDifference, c::Hertz(p.cutoff_hz), rate);
            foaw_end_fit, "foaw-end-fit", Deviation,
            (n: WINDOW, d: NOISE_BOUND),
            (n_15: 0.0, 15; n_64: 0.0, 64;),
            {
                summary: "slope through both ends of the longest straight window",
                needs: Signals::COUNT,
                settling: Settling::EndFitWindow,
                colour: Colour::SKY,
                dash: Dash::Solid,
                goals: &[Goal { capacity: 15, mean: 210.0, longest: 280.0 }, Goal { capacity: 64, mean: 600.0, longest: 1160.0 }],
            },
            |c, motor, rate, clock, p, N| c::Foaw<N, c::EndFit> =>
                c::Foaw::new(p.n as usize, p.d as u16);
            foaw_best_fit, "foaw-best-fit", Deviation,
            (n: WINDOW, d: NOISE_BOUND),
            (n_15: 0.0, 15; n_64: 0.0, 64;),
            {
                summary: "least-squares slope of the longest straight window (eq. 6)",
                needs: Signals::COUNT,
                settling: Settling::BestFitWindow,
                colour: Colour::BLUE,
                dash: Dash::Solid,
                goals: &[Goal { capacity: 15, mean: 450.0, longest: 550.0 }, Goal { capacity: 64, mean: 1600.0, longest: 2500.0 }],
            },
            |c, motor, rate, clock, p, N| c::Foaw<N, c::BestFit> =>
                c::Foaw::new(p.n as usize, p.d as u16);
            kalman_triple, "kalman-triple", Acceleration,
            (jerk: JERK),
            (at_1k: 1000.0, 0; at_10k: 10_000.0, 0;),
            {
                summary: "Kalman filter on a triple integrator, full covariance (eqs. 9 to 12)",
                needs: Signals::COUNT,
                settling: Settling::TripleIntegrator,
                colour: Colour::GREEN,
                dash: Dash::Dotted,
                goals: &[Goal { capacity: 0, mean: 60.0, longest: f64::INFINITY }],
            },
            |c, motor, rate, clock, p, N| c::KalmanTriple =>
                $crate::then!(c::Model::triple_integrator(motor.motor.counts_per_rev, rate, p.jerk), |model| c::Kalman::new(&model));
            kalman_triple_table, "kalman-triple-table", Acceleration,
            (jerk: JERK),
            (at_1k: 1000.0, 24; at_10k: 10_000.0, 168;),
            {
                summary: "the same with a preset table of gains, from the start until they are steady",
                needs: Signals::COUNT,
                settling: Settling::TripleIntegrator,
                colour: Colour::GREEN,
                dash: Dash::Dashed,
                goals: &[Goal { capacity: 0, mean: 30.0, longest: 30.0 }],
            },
            |c, motor, rate, clock, p, N| c::TableKalmanTriple<N> =>
                $crate::then!(c::Model::triple_integrator(motor.motor.counts_per_rev, rate, p.jerk), |model| c::TableKalman::new(&model));
            kalman_triple_steady, "kalman-triple-steady", Acceleration,
            (jerk: JERK),
            (at_1k: 1000.0, 0; at_10k: 10_000.0, 0;),
            {
                summary: "the same with its preset steady gain alone",
                needs: Signals::COUNT,
                settling: Settling::TripleIntegrator,
                colour: Colour::GREEN,
                dash: Dash::Mixed,
                goals: &[],
            },
            |c, motor, rate, clock, p, N| c::SteadyKalmanTriple =>
                $crate::then!(c::Model::triple_integrator(motor.motor.counts_per_rev, rate, p.jerk), |model| c::SteadyKalman::new(&model));
            kalman_motor, "kalman-motor", LateCurrent,
            (current_noise: CURRENT_NOISE, literal: LITERAL),
            (at_1k: 1000.0, 0; at_10k: 10_000.0, 0;),
            {
                summary: "Kalman filter on the motor model with known current, full covariance (eqs. 14, 16)",
                needs: Signals::COUNT_AND_CURRENT,
                settling: Settling::MotorModel,
                colour: Colour::VERMILION,
                dash: Dash::Solid,
                goals: &[],
            },
            |c, motor, rate, clock, p, N| c::KalmanMotor =>
                $crate::then!(c::Model::motor(&motor.motor, rate, p.current_noise), |model| c::Kalman::new(&model));
            kalman_motor_steady, "kalman-motor-steady", LateCurrent,
            (current_noise: CURRENT_NOISE, literal: LITERAL),
            (at_1k: 1000.0, 0; at_10k: 10_000.0, 0;),
            {
                summary: "the same with its preset steady gain",
                needs: Signals::COUNT_AND_CURRENT,
                settling: Settling::MotorModel,
                colour: Colour::VERMILION,
                dash: Dash::Dotted,
                goals: &[],
            },
            |c, motor, rate, clock, p, N| c::SteadyKalmanMotor =>
                $crate::then!(c::Model::motor(&motor.motor, rate, p.current_noise), |model| c::SteadyKalman::new(&model));
            pll, "pll", Nothing,
            (bandwidth_hz: BANDWIDTH),
            (at_1k: 1000.0, 0; at_10k: 10_000.0, 0;),
            {
                summary: "critically damped tracking loop, as motor boards have it",
                needs: Signals::COUNT,
                settling: Settling::EqualPoles(2),
                colour: Colour::PINK,
                dash: Dash::Dotted,
                goals: &[],
            },
            |c, motor, rate, clock, p, N| c::Pll =>
                c::Pll::new(c::Hertz(p.bandwidth_hz), rate);
            alpha_beta_gamma, "alpha-beta-gamma", Nothing,
            (bandwidth_hz: BANDWIDTH),
            (at_1k: 1000.0, 0; at_10k: 10_000.0, 0;),
            {
                summary: "alpha-beta-gamma filter: a parabola through all counts, old ones fading",
                needs: Signals::COUNT,
                settling: Settling::EqualPoles(3),
                colour: Colour::PINK,
                dash: Dash::Dashed,
                goals: &[],
            },
            |c, motor, rate, clock, p, N| c::AlphaBetaGamma =>
                c::AlphaBetaGamma::new(c::Hertz(p.bandwidth_hz), rate);
            m_over_t, "m-over-t", Nothing,
            (),
            (at_1k: 1000.0, 0; at_10k: 10_000.0, 0;),
            {
                summary: "counts over the time between edges, at most one count over the time since the last",
                needs: EDGE,
                settling: Settling::OneCountOverTime,
                colour: Colour::OLIVE,
                dash: Dash::Mixed,
                goals: &[],
            },
            |c, motor, rate, clock, p, N| c::MOverT =>
                c::MOverT::new(clock, rate);
            observer, "observer", Deviation,
            (torque_noise: TORQUE_NOISE, load: DISTURBANCE, load_time: DISTURBANCE_TIME,
             friction_share: FRICTION_SHARE, boundary_noise: BOUNDARY_NOISE),
            (at_1k: 1000.0, 0; at_10k: 10_000.0, 0;),
            {
                summary: "observer with current, slip, friction and dead zone, scheduled gains",
                needs: COUNT_CURRENT_AND_SLIP,
                settling: Settling::Disturbance,
                colour: Colour::PURPLE,
                dash: Dash::Solid,
                goals: &[Goal { capacity: 0, mean: 90.0, longest: f64::INFINITY }],
            },
            |c, motor, rate, clock, p, N| c::CountObserver =>
                c::Observer::new(motor, rate, &$crate::uncertainty!(c, p));
            observer_edge, "observer-edge", Deviation,
            (torque_noise: TORQUE_NOISE, load: DISTURBANCE, load_time: DISTURBANCE_TIME,
             friction_share: FRICTION_SHARE, boundary_noise: DISC_NOISE),
            (at_1k: 1000.0, 0; at_10k: 10_000.0, 0;),
            {
                summary: "the same with edge time stamps",
                needs: COUNT_CURRENT_AND_SLIP.or(EDGE),
                settling: Settling::Disturbance,
                colour: Colour::NAVY,
                dash: Dash::Solid,
                goals: &[Goal { capacity: 0, mean: 130.0, longest: f64::INFINITY }],
            },
            |c, motor, rate, clock, p, N| c::EdgeObserver =>
                $crate::then!(c::Observer::new(motor, rate, &$crate::uncertainty!(c, p)), |known| known.with_edges(clock, rate));
            adaptive, "adaptive", Damping,
            (torque_noise: TORQUE_NOISE, load: DISTURBANCE, load_time: DISTURBANCE_TIME,
             friction_share: FRICTION_SHARE, boundary_noise: BOUNDARY_NOISE),
            (at_1k: 1000.0, 0; at_10k: 10_000.0, 0;),
            {
                summary: "observer that learns damping, friction and torque constant per inertia",
                needs: COUNT_CURRENT_AND_SLIP,
                settling: Settling::Adapted,
                colour: Colour::CRIMSON,
                dash: Dash::Dashed,
                goals: &[],
            },
            |c, motor, rate, clock, p, N| c::AdaptiveObserver =>
                $crate::then!(c::Observer::new(motor, rate, &$crate::uncertainty!(c, p)), |known| known.adaptive(motor.motor.counts_per_rev, rate));
            adaptive_edge, "adaptive-edge", Damping,
            (torque_noise: TORQUE_NOISE, load: DISTURBANCE, load_time: DISTURBANCE_TIME,
             friction_share: FRICTION_SHARE, boundary_noise: DISC_NOISE),
            (at_1k: 1000.0, 0; at_10k: 10_000.0, 0;),
            {
                summary: "the same with edge time stamps",
                needs: COUNT_CURRENT_AND_SLIP.or(EDGE),
                settling: Settling::Adapted,
                colour: Colour::PINE,
                dash: Dash::Mixed,
                goals: &[Goal { capacity: 0, mean: 300.0, longest: f64::INFINITY }],
            },
            |c, motor, rate, clock, p, N| c::AdaptiveEdgeObserver =>
                $crate::then!($crate::then!(c::Observer::new(motor, rate, &$crate::uncertainty!(c, p)), |known| known.with_edges(clock, rate)), |known| known.adaptive(motor.motor.counts_per_rev, rate));
            observer_soft, "observer-soft", Deviation,
            (torque_noise: TORQUE_NOISE, load: DISTURBANCE, load_time: DISTURBANCE_TIME,
             friction_share: FRICTION_SHARE, boundary_noise: BOUNDARY_NOISE),
            (at_1k: 1000.0, 0; at_10k: 10_000.0, 0;),
            {
                summary: "observer that also uses a count while the prediction agrees with it (truncated Gaussian)",
                needs: COUNT_CURRENT_AND_SLIP,
                settling: Settling::DisturbanceTruncated,
                colour: Colour::PURPLE,
                dash: Dash::Dashed,
                goals: &[Goal { capacity: 0, mean: 200.0, longest: f64::INFINITY }],
            },
            |c, motor, rate, clock, p, N| c::QuantisedObserver =>
                c::Observer::quantised(motor, rate, &$crate::uncertainty!(c, p));
            adaptive_soft, "adaptive-soft", Damping,
            (torque_noise: TORQUE_NOISE, load: DISTURBANCE, load_time: DISTURBANCE_TIME,
             friction_share: FRICTION_SHARE, boundary_noise: BOUNDARY_NOISE),
            (at_1k: 1000.0, 0; at_10k: 10_000.0, 0;),
            {
                summary: "the same, learning as adaptive",
                needs: COUNT_CURRENT_AND_SLIP,
                settling: Settling::Adapted,
                colour: Colour::CRIMSON,
                dash: Dash::Dotted,
                goals: &[Goal { capacity: 0, mean: 300.0, longest: f64::INFINITY }],
            },
            |c, motor, rate, clock, p, N| c::AdaptiveQuantisedObserver =>
                $crate::then!(c::Observer::quantised(motor, rate, &$crate::uncertainty!(c, p)), |known| known.adaptive(motor.motor.counts_per_rev, rate));
            observer_held, "observer-held", Deviation,
            (torque_noise: TORQUE_NOISE, load: DISTURBANCE, load_time: DISTURBANCE_TIME,
             friction_share: FRICTION_SHARE, boundary_noise: BOUNDARY_NOISE),
            (at_1k: 1000.0, 0; at_10k: 10_000.0, 0;),
            {
                summary: "observer without the small encoder",
                needs: Signals::COUNT_AND_CURRENT,
                settling: Settling::Disturbance,
                colour: Colour::PURPLE,
                dash: Dash::Mixed,
                goals: &[],
            },
            |c, motor, rate, clock, p, N| c::Observer<c::AmplifierCurrent, c::HeldShaft, c::CountUpdate, c::Fixed> =>
                $crate::then!(c::Observer::new(motor, rate, &$crate::uncertainty!(c, p)), |known| Ok(known.held()));
            observer_edge_held, "observer-edge-held", Deviation,
            (torque_noise: TORQUE_NOISE, load: DISTURBANCE, load_time: DISTURBANCE_TIME,
             friction_share: FRICTION_SHARE, boundary_noise: DISC_NOISE),
            (at_1k: 1000.0, 0; at_10k: 10_000.0, 0;),
            {
                summary: "observer-edge without the small encoder",
                needs: Signals::COUNT_AND_CURRENT.or(EDGE),
                settling: Settling::Disturbance,
                colour: Colour::NAVY,
                dash: Dash::Mixed,
                goals: &[],
            },
            |c, motor, rate, clock, p, N| c::Observer<c::AmplifierCurrent, c::HeldShaft, c::EdgeUpdate, c::Fixed> =>
                $crate::then!($crate::then!(c::Observer::new(motor, rate, &$crate::uncertainty!(c, p)), |known| known.with_edges(clock, rate)), |known| Ok(known.held()));
            observer_edge_blind, "observer-edge-blind", Deviation,
            (torque_noise: TORQUE_NOISE, load: DISTURBANCE_AND_MOTOR, load_time: DISTURBANCE_TIME,
             boundary_noise: DISC_NOISE),
            (at_1k: 1000.0, 0; at_10k: 10_000.0, 0;),
            {
                summary: "observer-edge without current and small encoder",
                needs: EDGE,
                settling: Settling::DisturbanceAlone,
                colour: Colour::NAVY,
                dash: Dash::Dashed,
                goals: &[],
            },
            |c, motor, rate, clock, p, N| c::Observer<c::NoCurrent, c::HeldShaft, c::EdgeUpdate, c::Fixed> =>
                c::Observer::blind(motor, rate, clock, &c::Uncertainty {
                    torque_noise: p.torque_noise,
                    disturbance: p.load,
                    disturbance_time: p.load_time,
                    friction_share: 0.0,
                    boundary_noise: p.boundary_noise,
                });
        }
    };
}

/// The observer's uncertainty from parameters of the same names.
#[doc(hidden)]
#[macro_export]
macro_rules! uncertainty {
    ($c:ident, $p:ident) => {
        $c::Uncertainty {
            torque_noise: $p.torque_noise,
            disturbance: $p.load,
            disturbance_time: $p.load_time,
            friction_share: $p.friction_share,
            boundary_noise: $p.boundary_noise,
        }
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

macro_rules! rows {
    ($(
        $id:ident, $name:literal, $reports:ident,
        ($($parameter:ident: $range:ident),*),
        ($($variant:ident: $rate:literal, $capacity:literal;)*),
        { $($fact:tt)* },
        |$($used:ident),*| $type:ty => $make:expr;
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
                        reports: Reports::$reports,
                        parameters: &[$(
                            Parameter { name: stringify!($parameter), ..Parameter::$range }
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

                    /// The parameters by name, in the units of the row.
                    #[derive(Clone, Copy, Debug, PartialEq)]
                    pub struct Parameters {
                        $(
                            #[doc = concat!("See `Parameter::", stringify!($range), "`.")]
                            pub $parameter: f64,
                        )*
                    }
                }
            )*
        }
    };
}

crate::estimators!(rows);
