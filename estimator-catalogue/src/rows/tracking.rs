//! Tracking loops, and the time between edges.

/// The rows of this file, added to those before them: see [`estimators!`](crate::estimators).
#[doc(hidden)]
#[macro_export]
macro_rules! tracking_rows {
    ($each:ident $rates:tt [$($before:tt)*] $($families:ident)*) => {
        $crate::joined! { $each $rates [
            $($before)*
            pll, "pll", Nothing,
            (bandwidth_hz: { scaling: Scaling::Bandwidth(Powers::TWO_POLES), ..Parameter::BANDWIDTH }),
            $rates,
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
            $rates,
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
            linear_eso, "linear-eso", Nothing,
            (bandwidth_hz: BANDWIDTH),
            $rates,
            {
                summary: "linear extended-state observer: alpha-beta-gamma with the known motor current",
                needs: Signals::COUNT_AND_CURRENT,
                settling: Settling::EqualPoles(3),
                colour: Colour::VERMILION,
                dash: Dash::Dashed,
                goals: &[],
            },
            |c, motor, rate, clock, p, N| c::LinearEso =>
                c::LinearEso::new(&motor.motor, rate, c::Hertz(p.bandwidth_hz));
            super_twisting, "super-twisting", Nothing,
            (acceleration: ACCELERATION),
            $rates,
            {
                summary: "super-twisting differentiator (Levant), implicit steps",
                needs: Signals::COUNT,
                // Twice what was seen after random counts.
                settling: Settling::Switching(3.0),
                colour: Colour::ORANGE,
                dash: Dash::Dashed,
                goals: &[],
            },
            |c, motor, rate, clock, p, N| c::SuperTwisting =>
                c::SuperTwisting::new(motor.motor.counts_per_rev, rate, p.acceleration);
            super_twisting_explicit, "super-twisting-explicit", Nothing,
            (acceleration: ACCELERATION),
            $rates,
            {
                summary: "super-twisting differentiator (Levant), explicit steps: chatters",
                needs: Signals::COUNT,
                // Twice what was seen after random counts.
                settling: Settling::Chattering(3.0),
                colour: Colour::PINK,
                dash: Dash::Mixed,
                goals: &[],
            },
            |c, motor, rate, clock, p, N| c::ExplicitSuperTwisting =>
                c::ExplicitSuperTwisting::new(motor.motor.counts_per_rev, rate, p.acceleration);
            tracking_differentiator, "tracking-differentiator", Nothing,
            (acceleration: ACCELERATION, filter_time: {
                name: "",
                unit: "s",
                meaning: "filter time of the linear region; below a tick it is a tick",
                lowest: 1e-6,
                highest: 100.0,
                whole: false,
                search: Search::Log(1e-4, 0.02),
                scaling: Scaling::Time(Powers::TWO_POLES),
            }),
            $rates,
            {
                summary: "tracking differentiator (Han): follows as fast as a bound on the acceleration allows",
                needs: Signals::COUNT,
                // Twice what was seen after random counts.
                settling: Settling::Switching(3.0),
                colour: Colour::SKY,
                dash: Dash::Mixed,
                goals: &[],
            },
            |c, motor, rate, clock, p, N| c::TrackingDifferentiator => c::TrackingDifferentiator::new(
                motor.motor.counts_per_rev, rate, p.acceleration, p.filter_time);
            m_over_t, "m-over-t", Nothing,
            (),
            $rates,
            {
                summary: "counts over the time between edges, at most one count over the time since the last",
                needs: EDGE,
                settling: Settling::CountsOverTime(1.0),
                colour: Colour::OLIVE,
                dash: Dash::Mixed,
                goals: &[],
            },
            |c, motor, rate, clock, p, N| c::MOverT =>
                c::MOverT::new(clock, rate);
            m_over_t_learned, "m-over-t-learned", Nothing,
            (),
            $rates,
            {
                summary: "m-over-t that learns the places of uneven boundaries, as of Hall sensors",
                needs: EDGE,
                settling: Settling::CountsOverTime(1.5),
                colour: Colour::NAVY,
                dash: Dash::Dotted,
                goals: &[],
            },
            |c, motor, rate, clock, p, N| c::LearnedMOverT<12> =>
                c::LearnedMOverT::new(clock, rate);
        ] $($families)* }
    };
}
