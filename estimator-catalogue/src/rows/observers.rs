//! Observers of the motor with friction and slip.

/// The rows of this file, added to those before them: see [`estimators!`](crate::estimators).
#[doc(hidden)]
#[macro_export]
macro_rules! observer_rows {
    // Lists that rows share.
    ($each:ident $rates:tt $before:tt $($families:ident)*) => {
        $crate::observer_rows! {
            $each $rates $before [$($families)*]
            uncertainty [
                torque_noise: TORQUE_NOISE, load: DISTURBANCE,
                load_time: DISTURBANCE_TIME, friction_share: FRICTION_SHARE
            ]
        }
    };
    (
        $each:ident $rates:tt [$($before:tt)*] [$($families:ident)*]
        uncertainty [$($uncertainty:tt)*]
    ) => {
        $crate::joined! { $each $rates [
            $($before)*
            observer, "observer", Deviation,
            ($($uncertainty)*, boundary_noise: BOUNDARY_NOISE),
            $rates,
            {
                summary: "observer with current, slip and friction, corrected at the ends of the quantisation interval",
                needs: COUNT_CURRENT_AND_SLIP,
                settling: Settling::Disturbance,
                colour: Colour::PURPLE,
                dash: Dash::Solid,
                goals: &[Goal { capacity: 0, mean: 90.0, longest: f64::INFINITY }],
            },
            |c, motor, rate, clock, p, N| c::CountObserver =>
                c::Observer::new(motor, rate, &$crate::uncertainty!(c, p));
            observer_edge, "observer-edge", Deviation,
            ($($uncertainty)*, boundary_noise: DISC_NOISE),
            $rates,
            {
                summary: "observer that also uses edge time stamps",
                needs: COUNT_CURRENT_AND_SLIP.or(EDGE),
                settling: Settling::Disturbance,
                colour: Colour::NAVY,
                dash: Dash::Solid,
                goals: &[Goal { capacity: 0, mean: 130.0, longest: f64::INFINITY }],
            },
            |c, motor, rate, clock, p, N| c::EdgeObserver =>
                c::ObserverDesign::new(motor, rate, &$crate::uncertainty!(c, p)).with_edges(clock).build();
            adaptive, "adaptive", Damping,
            ($($uncertainty)*, boundary_noise: BOUNDARY_NOISE),
            $rates,
            {
                summary: "observer that adapts damping, friction and torque constant, each per inertia",
                needs: COUNT_CURRENT_AND_SLIP,
                settling: ADAPTED,
                colour: Colour::CRIMSON,
                dash: Dash::Dashed,
                goals: &[],
            },
            |c, motor, rate, clock, p, N| c::AdaptiveObserver =>
                c::ObserverDesign::new(motor, rate, &$crate::uncertainty!(c, p)).adaptive().build();
            adaptive_edge, "adaptive-edge", Damping,
            ($($uncertainty)*, boundary_noise: DISC_NOISE),
            $rates,
            {
                summary: "adaptive observer that also uses edge time stamps",
                needs: COUNT_CURRENT_AND_SLIP.or(EDGE),
                settling: ADAPTED,
                colour: Colour::PINE,
                dash: Dash::Mixed,
                goals: &[Goal { capacity: 0, mean: 300.0, longest: f64::INFINITY }],
            },
            |c, motor, rate, clock, p, N| c::AdaptiveEdgeObserver =>
                c::ObserverDesign::new(motor, rate, &$crate::uncertainty!(c, p)).with_edges(clock).adaptive().build();
            imm_adaptive, "imm-adaptive", Acceleration,
            ($($uncertainty)*, boundary_noise: BOUNDARY_NOISE),
            $rates,
            {
                summary: "bank that also follows adaptive, with a small probability for a wrong device",
                needs: COUNT_CURRENT_AND_SLIP,
                settling: Settling::Within(0.3),
                colour: Colour::PURPLE,
                dash: Dash::Dotted,
                goals: &[],
            },
            |c, motor, rate, clock, p, N| c::ImmAdaptive =>
                c::ImmAdaptive::following(c::ObserverDesign::new(motor, rate, &$crate::uncertainty!(c, p)).adaptive().build(), rate);
            imm_adaptive_edge, "imm-adaptive-edge", Acceleration,
            ($($uncertainty)*, boundary_noise: DISC_NOISE),
            $rates,
            {
                summary: "bank with edge time stamps that also follows adaptive-edge",
                needs: COUNT_CURRENT_AND_SLIP.or(EDGE),
                settling: Settling::Within(0.3),
                colour: Colour::BROWN,
                dash: Dash::Mixed,
                goals: &[],
            },
            |c, motor, rate, clock, p, N| c::ImmAdaptiveEdge =>
                c::ImmAdaptiveEdge::following(c::ObserverDesign::new(motor, rate, &$crate::uncertainty!(c, p)).with_edges(clock).adaptive().build(), clock, rate);
            observer_soft, "observer-soft", Deviation,
            ($($uncertainty)*, boundary_noise: BOUNDARY_NOISE),
            $rates,
            {
                summary: "observer with truncated-Gaussian correction: also uses a count that agrees with the prediction",
                needs: COUNT_CURRENT_AND_SLIP,
                settling: Settling::DisturbanceTruncated,
                colour: Colour::PURPLE,
                dash: Dash::Dashed,
                goals: &[Goal { capacity: 0, mean: 200.0, longest: f64::INFINITY }],
            },
            |c, motor, rate, clock, p, N| c::QuantisedObserver =>
                c::ObserverDesign::quantised(motor, rate, &$crate::uncertainty!(c, p)).build();
            adaptive_soft, "adaptive-soft", Damping,
            ($($uncertainty)*, boundary_noise: BOUNDARY_NOISE),
            $rates,
            {
                summary: "observer-soft that adapts damping, friction and torque constant, each per inertia",
                needs: COUNT_CURRENT_AND_SLIP,
                settling: ADAPTED,
                colour: Colour::CRIMSON,
                dash: Dash::Dotted,
                goals: &[Goal { capacity: 0, mean: 300.0, longest: f64::INFINITY }],
            },
            |c, motor, rate, clock, p, N| c::AdaptiveQuantisedObserver =>
                c::ObserverDesign::quantised(motor, rate, &$crate::uncertainty!(c, p)).adaptive().build();
            observer_held, "observer-held", Deviation,
            ($($uncertainty)*, boundary_noise: BOUNDARY_NOISE),
            $rates,
            {
                summary: "observer without the small encoder",
                needs: Signals::COUNT_AND_CURRENT,
                settling: Settling::Disturbance,
                colour: Colour::PURPLE,
                dash: Dash::Mixed,
                goals: &[],
            },
            |c, motor, rate, clock, p, N| c::Observer<c::AmplifierCurrent, c::HeldShaft, c::CountUpdate, c::Fixed> =>
                c::ObserverDesign::new(motor, rate, &$crate::uncertainty!(c, p)).held().build();
            observer_edge_held, "observer-edge-held", Deviation,
            ($($uncertainty)*, boundary_noise: DISC_NOISE),
            $rates,
            {
                summary: "observer-edge without the small encoder",
                needs: Signals::COUNT_AND_CURRENT.or(EDGE),
                settling: Settling::Disturbance,
                colour: Colour::NAVY,
                dash: Dash::Mixed,
                goals: &[],
            },
            |c, motor, rate, clock, p, N| c::Observer<c::AmplifierCurrent, c::HeldShaft, c::EdgeUpdate, c::Fixed> =>
                c::ObserverDesign::new(motor, rate, &$crate::uncertainty!(c, p)).with_edges(clock).held().build();
            adaptive_held, "adaptive-held", Deviation,
            ($($uncertainty)*, boundary_noise: BOUNDARY_NOISE),
            $rates,
            {
                summary: "observer-held that learns damping, friction and torque constant, from a model that may be wrong tenfold",
                needs: Signals::COUNT_AND_CURRENT,
                settling: ADAPTED,
                colour: Colour::MAROON,
                dash: Dash::Dotted,
                goals: &[],
            },
            |c, motor, rate, clock, p, N| c::AdaptiveHeldObserver =>
                c::ObserverDesign::new(motor, rate, &$crate::uncertainty!(c, p)).held().widely_adaptive().build();
            adaptive_edge_held, "adaptive-edge-held", Deviation,
            ($($uncertainty)*, boundary_noise: DISC_NOISE),
            $rates,
            {
                summary: "adaptive-held that also uses edge time stamps",
                needs: Signals::COUNT_AND_CURRENT.or(EDGE),
                settling: ADAPTED,
                colour: Colour::MAROON,
                dash: Dash::Mixed,
                goals: &[],
            },
            |c, motor, rate, clock, p, N| c::AdaptiveEdgeHeldObserver =>
                c::ObserverDesign::new(motor, rate, &$crate::uncertainty!(c, p)).with_edges(clock).held().widely_adaptive().build();
            observer_edge_blind, "observer-edge-blind", Deviation,
            (torque_noise: TORQUE_NOISE, load: DISTURBANCE_AND_MOTOR, load_time: DISTURBANCE_TIME,
             boundary_noise: DISC_NOISE),
            $rates,
            {
                summary: "observer-edge without current and small encoder",
                needs: EDGE,
                settling: Settling::DisturbanceAlone,
                colour: Colour::NAVY,
                dash: Dash::Dashed,
                goals: &[],
            },
            |c, motor, rate, clock, p, N| c::Observer<c::NoCurrent, c::HeldShaft, c::EdgeUpdate, c::Fixed> =>
                c::ObserverDesign::blind(motor, rate, clock, &c::Uncertainty {
                    torque_noise: p.torque_noise,
                    disturbance: p.load,
                    disturbance_time: p.load_time,
                    friction_share: 0.0,
                    boundary_noise: p.boundary_noise,
                }).build();
        ] $($families)* }
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
