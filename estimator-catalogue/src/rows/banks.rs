//! Banks of filters without a parameter of the device.

/// The rows of this file, added to those before them: see [`estimators!`](crate::estimators).
#[doc(hidden)]
#[macro_export]
macro_rules! bank_rows {
    ($each:ident $rates:tt [$($before:tt)*] $($families:ident)*) => {
        $crate::joined! { $each $rates [
            $($before)*
            imm, "imm", Acceleration,
            (),
            $rates,
            {
                summary: "bank of three filters that finds its own process noise",
                needs: Signals::COUNT,
                settling: Settling::Within(0.3),
                colour: Colour::PINE,
                dash: Dash::Solid,
                goals: &[],
            },
            |c, motor, rate, clock, p, N| c::Imm =>
                c::ModelBank::new(rate);
            imm_edge, "imm-edge", Acceleration,
            (),
            $rates,
            {
                summary: "the same bank, which also uses edge time stamps",
                needs: EDGE,
                settling: Settling::Within(0.3),
                colour: Colour::SKY,
                dash: Dash::Dotted,
                goals: &[],
            },
            |c, motor, rate, clock, p, N| c::ImmEdge =>
                c::ModelBank::with_edges(clock, rate);
            imm_pair, "imm-pair", Acceleration,
            (),
            $rates,
            {
                summary: "bank of two filters: the cheap one",
                needs: Signals::COUNT,
                settling: Settling::Within(0.3),
                colour: Colour::BLUE,
                dash: Dash::Dotted,
                goals: &[],
            },
            |c, motor, rate, clock, p, N| c::ImmPair =>
                c::ModelBank::new(rate);
            imm_motor, "imm-motor", Acceleration,
            (),
            $rates,
            {
                summary: "bank that also learns the effect of the motor current",
                needs: Signals::COUNT_AND_CURRENT,
                settling: Settling::Within(0.3),
                colour: Colour::MAROON,
                dash: Dash::Dashed,
                goals: &[],
            },
            |c, motor, rate, clock, p, N| c::ImmMotor =>
                c::ImmMotor::learning(rate);
            imm_motor_edge, "imm-motor-edge", Acceleration,
            (),
            $rates,
            {
                summary: "the same bank, which also uses edge time stamps",
                needs: Signals::COUNT_AND_CURRENT.or(EDGE),
                settling: Settling::Within(0.3),
                colour: Colour::ORANGE,
                dash: Dash::Dotted,
                goals: &[],
            },
            |c, motor, rate, clock, p, N| c::ImmMotorEdge =>
                c::ImmMotorEdge::learning(clock, rate);
        ] $($families)* }
    };
}
