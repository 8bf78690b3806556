//! Share of time with a parasitic force below the threshold of a fingertip: a bar for each scene
//! and velocity source, rates side by side.

use super::super::bars::{BAR, BETWEEN, GAP};
use super::super::canvas::{
    Anchor, Canvas, Key, LABEL, Svg, TITLE, WIDTH, figure, legend_height, text_width,
};
use super::super::palette::{GRID, INK, MUTED, Palette};
use super::super::plot::{Axis, Plot};
use super::super::text::{rate, share};
use super::{ClosedLoop, find, uses_velocity};
use experiments::distinct::distinct;
use experiments::transparency::Outcome;

/// Sizes, px.
const LONE: f64 = 22.0;

/// Horizontal bars, one panel for each rate.
pub(super) fn shares(closed: &ClosedLoop, palette: &Palette) -> Result<Svg, String> {
    let title = "Time in which the parasitic force is below the fingertip\u{2019}s threshold";
    let names = closed.velocity_sources();
    let keys: Vec<Key> = (names.iter())
        .map(|name| Key::Line(palette.style(name), name))
        .chain([Key::Line(MUTED.into(), "any")])
        .collect();
    let mut scenes: Vec<(&str, f64)> = Vec::new();
    let rates = distinct(closed.outcomes.iter().map(|outcome| outcome.case.rate_hz));
    for outcome in &closed.outcomes {
        let scene = outcome.case.scene.name();
        if !scenes.iter().any(|(known, _)| *known == scene) {
            let bars = BAR * names.len() as f64 + BETWEEN;
            scenes.push((scene, if uses_velocity(outcome) { bars } else { LONE }));
        }
    }
    let widest = scenes.iter().map(|(scene, _)| text_width(scene, 12.0));
    let left = widest.fold(0.0, f64::max) + 16.0;
    let top = 34.0 + legend_height(&keys, left) + 24.0;
    let bottom = top + scenes.iter().map(|(_, height)| height).sum::<f64>();
    let width = (WIDTH - left - 24.0 - (rates.len() - 1) as f64 * GAP) / rates.len() as f64;
    figure(bottom + 40.0, title, |canvas| {
        canvas.text(title, (left, 16.0), Anchor::Left, TITLE, INK)?;
        canvas.legend(&keys, (left, 40.0))?;
        for (i, &rate_hz) in rates.iter().enumerate() {
            let left = left + i as f64 * (width + GAP);
            let plot = Plot {
                left,
                top,
                right: left + width,
                bottom,
                x: Axis::linear([0.0, 100.0]),
                y: Axis::linear([0.0, 1.0]),
            };
            canvas.text(&rate(rate_hz), (left, top - 12.0), Anchor::Left, 12.5, INK)?;
            for tick in plot.x.ticks(5) {
                let (x, _) = plot.at((tick, 0.0));
                canvas.line(&[(x, top), (x, bottom)], GRID, 1.0)?;
                let at = (x, bottom + 10.0);
                canvas.text(&format!("{tick:.0}"), at, Anchor::Centre, LABEL, MUTED)?;
            }
            let mut row_top = top;
            for &(scene, height) in &scenes {
                canvas.line(&[(left, row_top), (plot.right, row_top)], GRID, 1.0)?;
                if i == 0 {
                    let at = (left - 10.0, row_top + 0.5 * height);
                    canvas.text(scene, at, Anchor::Right, 12.0, INK)?;
                }
                let outcome = (closed.outcomes.iter())
                    .find(|o| o.case.rate_hz == rate_hz && o.case.scene.name() == scene);
                if let Some(outcome) = outcome {
                    bars(canvas, &plot, row_top, outcome, &names, palette)?;
                }
                row_top += height;
            }
            plot.edges(canvas)?;
            plot.x_title(canvas, "share of time, %")?;
        }
        Ok(())
    })
}

fn bars(
    canvas: &Canvas,
    plot: &Plot,
    top: f64,
    outcome: &Outcome,
    names: &[&str],
    palette: &Palette,
) -> Result<(), String> {
    if !uses_velocity(outcome) {
        let below = outcome
            .runs
            .first()
            .and_then(|run| run.parasitic.below_threshold);
        let below = below.unwrap_or(0.0);
        let y = top + 0.5 * LONE;
        let (right, _) = plot.at((100.0 * below, 0.0));
        let corners = [
            (plot.left, y - 0.5 * BAR),
            (right.max(plot.left + 2.0), y + 0.5 * BAR),
        ];
        canvas.rectangle(corners, MUTED)?;
        let at = (right + 8.0, y);
        return canvas.text(&share(below), at, Anchor::Left, LABEL, MUTED);
    }
    for (j, name) in names.iter().enumerate() {
        let below = find(outcome, name).and_then(|run| run.parasitic.below_threshold);
        let Some(below) = below else { continue };
        let y = top + 0.5 * BETWEEN + j as f64 * BAR;
        let (right, _) = plot.at((100.0 * below, 0.0));
        let corners = [
            (plot.left, y + 0.75),
            (right.max(plot.left + 2.0), y + BAR - 0.75),
        ];
        canvas.rectangle(corners, palette.style(name))?;
    }
    Ok(())
}
