//! Kalman filters.

/// The rows of this file, added to those before them: see [`estimators!`](crate::estimators).
#[doc(hidden)]
#[macro_export]
macro_rules! kalman_rows {
    // Lists that rows share.
    ($each:ident $rates:tt $before:tt $($families:ident)*) => {
        $crate::kalman_rows! {
            $each $rates $before [$($families)*]
            motor_noise (current_noise: CURRENT_NOISE, literal: LITERAL)
        }
    };
    (
        $each:ident $rates:tt [$($before:tt)*] [$($families:ident)*]
        motor_noise $motor_noise:tt
    ) => {
        $crate::joined! { $each $rates [
            $($before)*
            kalman_triple, "kalman-triple", Acceleration,
            (jerk: JERK),
            $rates,
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
                summary: "Kalman filter on a triple integrator, preset table of gains from the start until they are steady",
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
            $rates,
            {
                summary: "Kalman filter on a triple integrator, preset steady gain",
                needs: Signals::COUNT,
                settling: Settling::TripleIntegrator,
                colour: Colour::GREEN,
                dash: Dash::Mixed,
                goals: &[],
            },
            |c, motor, rate, clock, p, N| c::SteadyKalmanTriple =>
                $crate::then!(c::Model::triple_integrator(motor.motor.counts_per_rev, rate, p.jerk), |model| c::SteadyKalman::new(&model));
            kalman_motor, "kalman-motor", LateCurrent,
            $motor_noise,
            $rates,
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
            $motor_noise,
            $rates,
            {
                summary: "Kalman filter on the motor model with known current, preset steady gain",
                needs: Signals::COUNT_AND_CURRENT,
                settling: Settling::MotorModel,
                colour: Colour::VERMILION,
                dash: Dash::Dotted,
                goals: &[],
            },
            |c, motor, rate, clock, p, N| c::SteadyKalmanMotor =>
                $crate::then!(c::Model::motor(&motor.motor, rate, p.current_noise), |model| c::SteadyKalman::new(&model));
        ] $($families)* }
    };
}
