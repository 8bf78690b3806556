//! Mean distance outside the haptic interval: a bar for each scenario and estimator, plants side by
//! side.

use super::bars::{BAR, BETWEEN, GAP};
use super::canvas::{
    Anchor, Canvas, Key, LABEL, Svg, TITLE, WIDTH, figure, legend_height, text_width,
};
use super::grid::Group;
use super::palette::{GRID, INK, MUTED, Palette};
use super::plot::{Axis, Plot};
use super::text::{number, plant};

/// Smallest lower end of the axis, rad/s; shorter distances do not matter.
const FLOOR_RAD_S: f64 = 1e-4;

/// Horizontal bars on a log axis, one panel for each plant; all `groups` have the same rate.
///
/// `None` if no case has a distance.
pub(super) fn bars(
    title: &str,
    groups: &[&Group],
    palette: &Palette,
) -> Result<Option<Svg>, String> {
    let names: Vec<&str> = palette.names().collect();
    let mut scenarios: Vec<&str> = Vec::new();
    let (mut low, mut high) = (f64::INFINITY, 0.0_f64);
    for scenario in groups.iter().flat_map(|group| &group.scenarios) {
        let distances = scenario
            .rows
            .iter()
            .filter_map(|row| row.score.distance_rad_s);
        let mut has_any = false;
        for distance in distances.filter(|d| d.is_finite()) {
            has_any = true;
            high = high.max(distance);
            if distance > 0.0 {
                low = low.min(distance);
            }
        }
        if has_any && !scenarios.contains(&scenario.name) {
            scenarios.push(scenario.name);
        }
    }
    if scenarios.is_empty() {
        return Ok(None);
    }
    let x = Axis::log([low.clamp(FLOOR_RAD_S, 0.1), high.clamp(1.0, 1e6)]);
    let keys: Vec<Key> = names
        .iter()
        .map(|name| Key::Line(palette.style(name), name))
        .collect();
    let row_height = BAR * names.len() as f64 + BETWEEN;
    let widest = scenarios.iter().map(|name| text_width(name, 12.0));
    let left = (widest.fold(0.0, f64::max) + 16.0).min(200.0);
    let head = 34.0 + legend_height(&keys, left);
    let top = head + 24.0;
    let bottom = top + row_height * scenarios.len() as f64;
    let width = (WIDTH - left - 24.0 - (groups.len() - 1) as f64 * GAP) / groups.len() as f64;
    figure(bottom + 40.0, title, |canvas| {
        canvas.text(title, (left, 16.0), Anchor::Left, TITLE, INK)?;
        canvas.legend(&keys, (left, 40.0))?;
        for (i, name) in scenarios.iter().enumerate() {
            let y = top + (i as f64 + 0.5) * row_height;
            canvas.text(name, (left - 10.0, y), Anchor::Right, 12.0, INK)?;
        }
        for (i, group) in groups.iter().enumerate() {
            let left = left + i as f64 * (width + GAP);
            let plot = Plot {
                left,
                top,
                right: left + width,
                bottom,
                x,
                y: Axis::linear([scenarios.len() as f64, 0.0]),
            };
            let plant = format!("plant {}", plant(group.friction));
            canvas.text(&plant, (left, top - 12.0), Anchor::Left, 12.5, INK)?;
            panel(canvas, &plot, group, &scenarios, palette)?;
        }
        Ok(())
    })
    .map(Some)
}

fn panel(
    canvas: &Canvas,
    plot: &Plot,
    group: &Group,
    scenarios: &[&str],
    palette: &Palette,
) -> Result<(), String> {
    for tick in plot.x.ticks(0) {
        let (x, _) = plot.at((tick, 0.0));
        canvas.line(&[(x, plot.top), (x, plot.bottom)], GRID, 1.0)?;
        let label = number_of(tick);
        canvas.text(&label, (x, plot.bottom + 10.0), Anchor::Centre, LABEL, INK)?;
    }
    let row_height = (plot.bottom - plot.top) / scenarios.len() as f64;
    for (i, name) in scenarios.iter().enumerate() {
        let top = plot.top + i as f64 * row_height;
        canvas.line(&[(plot.left, top), (plot.right, top)], GRID, 1.0)?;
        let Some(scenario) = group.scenarios.iter().find(|s| s.name == *name) else {
            let at = (plot.left + 8.0, top + 0.5 * row_height);
            canvas.text("not run", at, Anchor::Left, LABEL, MUTED)?;
            continue;
        };
        let mut distances = scenario
            .rows
            .iter()
            .filter_map(|row| row.score.distance_rad_s);
        if distances.all(|distance| distance == 0.0) {
            let at = (plot.left + 8.0, top + 0.5 * row_height);
            canvas.text("all 0", at, Anchor::Left, LABEL, MUTED)?;
            continue;
        }
        for (j, estimator) in palette.names().enumerate() {
            let row = scenario.rows.iter().find(|row| row.estimator == estimator);
            let Some(distance) = row.and_then(|row| row.score.distance_rad_s) else {
                continue;
            };
            if distance == 0.0 {
                continue;
            }
            let y = top + 0.5 * BETWEEN + j as f64 * BAR;
            let end = plot.x.part(distance).clamp(0.0, 1.0);
            let right = (plot.left + end * (plot.right - plot.left)).max(plot.left + 2.0);
            let corners = [(plot.left, y + 0.75), (right, y + BAR - 0.75)];
            canvas.rectangle(corners, palette.style(estimator))?;
        }
    }
    plot.edges(canvas)?;
    plot.x_title(canvas, "mean distance outside the interval, rad/s (log)")
}

fn number_of(tick: f64) -> String {
    if tick >= 1.0 {
        format!("{tick:.0}")
    } else if tick > 0.000_9 {
        format!("{}", (tick * 1e6).round() / 1e6)
    } else {
        number(tick)
    }
}
