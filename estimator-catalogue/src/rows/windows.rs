//! Differences of counts, filtered or over a window.

/// The rows of this file, added to those before them: see [`estimators!`](crate::estimators).
#[doc(hidden)]
#[macro_export]
macro_rules! window_rows {
    // Lists that rows share.
    ($each:ident $rates:tt $before:tt $($families:ident)*) => {
        $crate::window_rows! {
            $each $rates $before [$($families)*]
            foaw (n: WINDOW, d: NOISE_BOUND)
            windows (n_15: 0.0, 15; n_64: 0.0, 64;)
        }
    };
    (
        $each:ident $rates:tt [$($before:tt)*] [$($families:ident)*]
        foaw $foaw:tt windows $windows:tt
    ) => {
        $crate::joined! { $each $rates [
            $($before)*
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
            $rates,
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
            $foaw,
            $windows,
            {
                summary: "slope through both ends of the longest straight window",
                needs: Signals::COUNT,
                settling: Settling::Window,
                colour: Colour::SKY,
                dash: Dash::Solid,
                goals: &[Goal { capacity: 15, mean: 210.0, longest: 280.0 }, Goal { capacity: 64, mean: 600.0, longest: 1160.0 }],
            },
            |c, motor, rate, clock, p, N| c::Foaw<N, c::EndFit> =>
                c::Foaw::new(p.n as usize, p.d as u16);
            foaw_best_fit, "foaw-best-fit", Deviation,
            $foaw,
            $windows,
            {
                summary: "least-squares slope of the longest straight window (eq. 6)",
                needs: Signals::COUNT,
                settling: Settling::Window,
                colour: Colour::BLUE,
                dash: Dash::Solid,
                goals: &[Goal { capacity: 15, mean: 450.0, longest: 550.0 }, Goal { capacity: 64, mean: 1600.0, longest: 2500.0 }],
            },
            |c, motor, rate, clock, p, N| c::Foaw<N, c::BestFit> =>
                c::Foaw::new(p.n as usize, p.d as u16);
            savitzky_golay, "savitzky-golay", Nothing,
            (n: {
                meaning: "number of intervals in the window",
                scaling: Scaling::Intervals(Powers::THREE_POLES),
                ..Parameter::WINDOW
            }),
            $windows,
            {
                summary: "slope at the newest count of the least-squares parabola through a fixed window",
                needs: Signals::COUNT,
                settling: Settling::Window,
                colour: Colour::BLUE,
                dash: Dash::Dashed,
                goals: &[],
            },
            |c, motor, rate, clock, p, N| c::SavitzkyGolay<N> =>
                c::SavitzkyGolay::new(p.n as usize);
            algebraic, "algebraic", Nothing,
            (n: {
                meaning: "number of intervals in the window",
                scaling: Scaling::Intervals(Powers::THREE_POLES),
                ..Parameter::WINDOW
            }),
            $windows,
            {
                summary: "algebraic differentiator: a line through the weighted differences of a fixed window",
                needs: Signals::COUNT,
                settling: Settling::Window,
                colour: Colour::BLUE,
                dash: Dash::Mixed,
                goals: &[],
            },
            |c, motor, rate, clock, p, N| c::Algebraic<N, 1, 2> =>
                c::Algebraic::new(p.n as usize);
            robust_exact, "robust-exact", Nothing,
            (acceleration: ACCELERATION, n: {
                meaning: "largest number of intervals in the window; a longer one costs run time alone",
                search: Search::Fixed(WINDOW_LIMIT as f64),
                scaling: Scaling::Unscaled,
                ..Parameter::WINDOW
            }),
            (at_1k: 1000.0, 64; at_10k: 10_000.0, 64;),
            {
                summary: "optimal robust exact differentiator: a window as long as the noise in it asks for",
                needs: Signals::COUNT,
                settling: Settling::Window,
                colour: Colour::SKY,
                dash: Dash::Dashed,
                goals: &[],
            },
            |c, motor, rate, clock, p, N| c::RobustExact<N> =>
                c::RobustExact::new(motor.motor.counts_per_rev, rate, p.acceleration, p.n as usize);
        ] $($families)* }
    };
}
