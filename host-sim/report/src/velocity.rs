//! Velocity over time: a panel for each estimator, with the truth and its haptic interval.

use std::ops::Range;

use super::Traces;
use super::canvas::{
    Anchor, Canvas, Key, LABEL, Svg, TITLE, WIDTH, figure, legend_height, text_width,
};
use super::palette::{INK, MUTED, Palette, TRUTH};
use super::plot::{Axis, Plot};
use super::text::share;
use scoring::score::HapticInterval;

const COLUMNS: usize = 3;
/// Sizes, px.
const LEFT: f64 = 62.0;
const GAP: f64 = 38.0;
const PANEL: f64 = 150.0;
const PANEL_TITLE: f64 = 24.0;
const BELOW: f64 = 22.0;
/// Above this share of samples off scale, the truth is drawn over the estimate instead of under it.
const HIDES_TRUTH: f64 = 0.05;

/// One panel for each estimator over `window`, all with the same axes.
///
/// Time is in ms from `origin_s`. Curves are cut at the axes, and the heading of a panel gives the
/// share of samples off scale.
pub(super) fn panels(
    title: &str,
    traces: &Traces,
    window: Range<usize>,
    origin_s: f64,
    interval: &HapticInterval,
    palette: &Palette,
) -> Result<Svg, String> {
    let drawn = traces.estimates.len();
    let (columns, rows) = (COLUMNS.min(drawn.max(1)), drawn.div_ceil(COLUMNS).max(1));
    let keys = [
        Key::Line(TRUTH.into(), "true velocity"),
        Key::Band("haptic interval: differences that a fingertip does not feel"),
    ];
    let head = 34.0 + legend_height(&keys, LEFT) + 4.0;
    let row_height = PANEL_TITLE + PANEL + BELOW;
    let height = head + rows as f64 * row_height + 22.0;
    let axis_x = [window.start, window.end - 1].map(|i| 1e3 * (traces.time(i) - origin_s));
    let axis_y = vertical(&traces.truth[window.clone()], interval);
    let width = (WIDTH - LEFT - 12.0 - (columns - 1) as f64 * GAP) / columns as f64;

    figure(height, title, |canvas| {
        canvas.text(title, (LEFT, 16.0), Anchor::Left, TITLE, INK)?;
        canvas.legend(&keys, (LEFT, 40.0))?;
        for (i, (name, estimate)) in traces.estimates.iter().enumerate() {
            let left = LEFT + (i % columns) as f64 * (width + GAP);
            let top = head + (i / columns) as f64 * row_height + PANEL_TITLE;
            let plot = Plot {
                left,
                top,
                right: left + width,
                bottom: top + PANEL,
                x: Axis::linear(axis_x),
                y: Axis::linear(axis_y),
            };
            plot.grid(canvas, 5, 5)?;
            truth(canvas, &plot, traces, window.clone(), origin_s, interval)?;
            let points = window.clone().map(|at| {
                let time = 1e3 * (traces.time(at) - origin_s);
                (time, f64::from(estimate[at]))
            });
            plot.curve(canvas, points, palette.style(name), 1.6)?;
            let off = off_scale(&estimate[window.clone()], axis_y);
            if off > HIDES_TRUTH {
                let points = window.clone().map(|at| {
                    let time = 1e3 * (traces.time(at) - origin_s);
                    (time, traces.truth[at])
                });
                plot.curve(canvas, points, TRUTH, 1.6)?;
            }
            plot.edges(canvas)?;
            heading(canvas, &plot, name, palette, off)?;
            let is_lowest = i + columns >= drawn;
            if is_lowest {
                plot.x_title(canvas, "time, ms")?;
            }
            if i % columns == 0 {
                let middle = 0.5 * (plot.top + plot.bottom);
                let at = (14.0, middle);
                canvas.text("velocity, rad/s", at, Anchor::Upwards, LABEL, INK)?;
            }
        }
        Ok(())
    })
}

/// Haptic interval and truth of a window; time in ms from `origin_s`.
pub(super) fn truth(
    canvas: &Canvas,
    plot: &Plot,
    traces: &Traces,
    window: Range<usize>,
    origin_s: f64,
    interval: &HapticInterval,
) -> Result<(), String> {
    let time = |at: usize| 1e3 * (traces.time(at) - origin_s);
    let band = window.clone().map(|at| {
        let w = traces.truth[at];
        let tolerance = interval.tolerance(w);
        (time(at), w - tolerance, w + tolerance)
    });
    plot.interval(canvas, band)?;
    let points = window.map(|at| (time(at), traces.truth[at]));
    plot.curve(canvas, points, TRUTH, 1.6)
}

/// Range of the axis: the haptic interval, and beyond it three times its half width at rest or a
/// quarter of its range.
fn vertical(truth: &[f64], interval: &HapticInterval) -> [f64; 2] {
    let ends = truth
        .iter()
        .fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], &w| {
            let tolerance = interval.tolerance(w);
            [low.min(w - tolerance), high.max(w + tolerance)]
        });
    let pad = (0.25 * (ends[1] - ends[0])).max(3.0 * interval.floor_rad_s);
    [ends[0] - pad, ends[1] + pad]
}

/// Share of estimates outside the axis, 0 to 1.
fn off_scale(estimates: &[f32], [low, high]: [f64; 2]) -> f64 {
    let off = estimates
        .iter()
        .filter(|&&e| !(low..=high).contains(&f64::from(e)));
    off.count() as f64 / estimates.len().max(1) as f64
}

/// The estimator's name beside its colour, and the share of samples off scale.
fn heading(
    canvas: &Canvas,
    plot: &Plot,
    name: &str,
    palette: &Palette,
    off: f64,
) -> Result<(), String> {
    let y = plot.top - 11.0;
    let colour = palette.style(name);
    canvas.rectangle([(plot.left, y - 4.5), (plot.left + 9.0, y + 4.5)], colour)?;
    canvas.text(name, (plot.left + 15.0, y), Anchor::Left, 12.5, INK)?;
    if off > 0.0 {
        let note = format!("{} off scale", share(off));
        let room = plot.right - plot.left - 15.0 - text_width(name, 12.5);
        let (note, size) = if text_width(&note, LABEL) < room {
            (note, LABEL)
        } else {
            (format!("{} off", share(off)), LABEL)
        };
        canvas.text(&note, (plot.right, y), Anchor::Right, size, MUTED)?;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn axis_includes_the_whole_interval() {
        let interval = HapticInterval::new(0.05, 0.010, 0.070, 0.96e-3);
        let [low, high] = vertical(&[-2.0, 20.0], &interval);
        assert!(low < -2.0 - interval.tolerance(2.0) - 1.0);
        assert!(high > 20.0 + interval.tolerance(20.0) + 1.0);
    }

    #[test]
    fn samples_off_scale_include_nan() {
        assert!((off_scale(&[0.0, 1.0, 2.5, f32::NAN], [-1.0, 2.0]) - 0.5).abs() < 1e-12);
    }
}
