//! Effect of the encoder's quantisation on finite difference.

use std::ops::Range;

use super::canvas::{Anchor, Key, LABEL, Svg, TITLE, WIDTH, figure, legend_height};
use super::palette::{INK, Palette, TRUTH};
use super::plot::{Axis, Plot};
use super::{Traces, velocity};
use scoring::score::HapticInterval;

const LEFT: f64 = 62.0;

/// Truth, haptic interval and one estimate over `window` in one wide panel without values off
/// scale.
pub(super) fn figure_one(
    title: &str,
    traces: &Traces,
    window: Range<usize>,
    estimator: usize,
    interval: &HapticInterval,
    palette: &Palette,
) -> Result<Svg, String> {
    let (name, estimate) = &traces.estimates[estimator];
    let keys = [
        Key::Line(palette.style(name), name),
        Key::Line(TRUTH.into(), "true velocity"),
        Key::Band("haptic interval"),
    ];
    let head = 34.0 + legend_height(&keys, LEFT) + 6.0;
    let origin = traces.time(window.start);
    let time = |at: usize| 1e3 * (traces.time(at) - origin);
    let values = window.clone().flat_map(|at| {
        let (w, e) = (traces.truth[at], f64::from(estimate[at]));
        let tolerance = interval.tolerance(w);
        [
            w - tolerance,
            w + tolerance,
            if e.is_finite() { e } else { w },
        ]
    });
    let (low, high) = values.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), v| {
        (low.min(v), high.max(v))
    });
    let pad = 0.05 * (high - low);
    let plot = Plot {
        left: LEFT,
        top: head,
        right: WIDTH - 12.0,
        bottom: head + 260.0,
        x: Axis::linear([0.0, time(window.end - 1)]),
        y: Axis::linear([low - pad, high + pad]),
    };
    figure(plot.bottom + 40.0, title, |canvas| {
        canvas.text(title, (LEFT, 16.0), Anchor::Left, TITLE, INK)?;
        canvas.legend(&keys, (LEFT, 40.0))?;
        plot.grid(canvas, 10, 7)?;
        // The estimate below the truth, or it would hide it.
        velocity::truth(canvas, &plot, traces, window.clone(), origin, interval)?;
        let points = window.clone().map(|at| (time(at), f64::from(estimate[at])));
        plot.curve(canvas, points, palette.style(name), 1.4)?;
        let points = window.clone().map(|at| (time(at), traces.truth[at]));
        plot.curve(canvas, points, TRUTH, 1.8)?;
        plot.edges(canvas)?;
        plot.x_title(canvas, "time, ms")?;
        let middle = (14.0, 0.5 * (plot.top + plot.bottom));
        canvas.text("velocity, rad/s", middle, Anchor::Upwards, LABEL, INK)
    })
}

#[cfg(test)]
mod tests {
    use super::super::canvas::tests::points;
    use super::*;

    /// 0.1 s at 1 kHz, of which the figure shows 51 samples from 20 ms on.
    #[test]
    fn estimate_and_truth_are_drawn_over_the_whole_width() {
        let interval = HapticInterval::new(0.05, 0.010, 0.070, 0.96e-3);
        let traces = Traces {
            rate_hz: 1000.0,
            truth: vec![1.0; 100],
            estimates: vec![("finite-difference".to_owned(), vec![9.0; 100])],
        };
        let palette = Palette::of(["finite-difference"].into_iter());
        let svg = figure_one("title", &traces, 20..71, 0, &interval, &palette);
        let svg = svg.unwrap().0;
        let curve = |colour| {
            let mut lines = points(&svg, "polyline", colour).into_iter();
            let line = lines.find(|line| line[line.len() - 1].0 - line[0].0 > 100.0);
            let line = line.expect("a curve beside the line of the legend");
            let (first, last) = (line[0], line[line.len() - 1]);
            assert!((first.0 - LEFT).abs() < 0.5, "{first:?}");
            assert!((last.0 - (WIDTH - 12.0)).abs() < 0.5, "{last:?}");
            first.1
        };
        let estimate = curve(palette.style("finite-difference").colour);
        assert!(estimate < curve(TRUTH), "the estimate is faster");
    }
}
