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

#[cfg(test)]
mod tests {
    use super::super::canvas::tests::{points, rectangles};
    use super::super::grid::groups;
    use super::super::{CaseReport, EstimatorRow, ReportInput};
    use super::*;
    use scoring::score::Score;

    fn case(scenario: &str, friction: bool, distances: &[(&str, f64)]) -> CaseReport {
        let row = |&(name, distance): &(&str, f64)| EstimatorRow {
            estimator: name.to_owned(),
            score: Score {
                distance_rad_s: Some(distance),
                ..Score::default()
            },
            ..EstimatorRow::default()
        };
        CaseReport {
            scenario: scenario.to_owned(),
            rate_hz: 1000.0,
            friction,
            rows: distances.iter().map(row).collect(),
            ..CaseReport::default()
        }
    }

    fn drawn(cases: Vec<CaseReport>) -> Option<String> {
        let report = ReportInput {
            cases,
            ..ReportInput::default()
        };
        let groups = groups(&report);
        let groups: Vec<_> = groups.iter().collect();
        let svg = bars("title", &groups, &Palette::new(&report)).unwrap();
        svg.map(|svg| svg.0)
    }

    /// Left end, top, right end and bottom of what is drawn in the colour of an estimator below the legend; the bar
    /// may have stripes.
    fn bar(svg: &str, name: &str, row: usize) -> [f64; 4] {
        let colour = Palette::of(std::iter::once(name)).style(name).colour;
        let mut rows: Vec<[f64; 4]> = Vec::new();
        for [left, top, width, height] in rectangles(svg, colour) {
            let (right, bottom) = (left + width, top + height);
            match rows.last_mut() {
                Some(last) if last[1] == top => last[2] = right,
                _ => rows.push([left, top, right, bottom]),
            }
        }
        rows[row]
    }

    /// On a logarithmic axis a factor of ten is everywhere as long.
    #[test]
    fn bars_are_logarithmic_and_stand_below_each_other() {
        let svg = drawn(vec![
            case("step", true, &[("pll", 0.02), ("imm", 0.2)]),
            case("track", true, &[("pll", 0.2), ("imm", 2.0)]),
        ]);
        let svg = svg.unwrap();
        let [first, second] = [0, 1].map(|row| bar(&svg, "pll", row));
        let [third, fourth] = [0, 1].map(|row| bar(&svg, "imm", row));
        let decade = second[2] - first[2];
        assert!(decade > 100.0, "{decade}");
        // A stripe may end a little before the end of its bar.
        assert!((third[2] - second[2]).abs() < 3.0, "{third:?} {second:?}");
        assert!((fourth[2] - third[2] - decade).abs() < 3.0, "{fourth:?}");
        // The estimators of a scenario, and then the next scenario with its distance.
        assert!((third[1] - first[1] - BAR).abs() < 0.5, "{third:?}");
        let row_height = 2.0 * BAR + BETWEEN;
        assert!(
            (second[1] - first[1] - row_height).abs() < 0.5,
            "{second:?}"
        );
        assert!(!svg.contains("all 0") && !svg.contains("not run"));
        // In the middle between the lines of their scenario.
        let lines = points(&svg, "polyline", GRID).into_iter();
        let across = lines.filter(|line| line[0].1 == line[line.len() - 1].1);
        let tops: Vec<f64> = across.map(|line| line[0].1).collect();
        assert_eq!(tops.len(), 2);
        let (above, below) = (first[1] - tops[0], tops[1] - third[3]);
        assert!((above - below).abs() < 0.5, "{above} {below}");
    }

    #[test]
    fn scenario_without_a_distance_or_a_run_says_so() {
        let svg = drawn(vec![
            case("step", true, &[("pll", 0.01), ("imm", 0.0)]),
            case("hold", true, &[("pll", 0.0), ("imm", 0.0)]),
            case("step", false, &[("pll", 0.01)]),
        ]);
        let svg = svg.unwrap();
        let times = |text: &str| svg.matches(text).count();
        assert_eq!((times("all 0"), times("not run")), (1, 1));
        assert!(svg.contains("plant without friction") && svg.contains("plant with friction"));
        assert!(drawn(vec![case("step", true, &[])]).is_none());
    }
}
