//! Error against run time, a panel for each scenario.

use super::canvas::{Anchor, Canvas, Key, LABEL, Svg, TITLE, WIDTH, figure, legend_height};
use super::grid::{Group, Scenario};
use super::palette::{INK, MUTED, Palette};
use super::plot::{Axis, Plot};
use super::text::{plant, rate};
use experiments::limit;

const LEFT: f64 = 62.0;
const TOP: f64 = 58.0;
const PANEL: f64 = 150.0;
const GAP: f64 = 46.0;
/// Room below a panel for labels, and the next one's heading.
const BELOW: f64 = 62.0;
const ACROSS: usize = 3;
/// Half the side of a mark, px.
const MARK: f64 = 3.5;

/// The panels of one rate on the plant with friction; `None` if no estimator has a measured cost.
/// `limits` are the errors of the particle filter on that plant.
pub(super) fn panels(
    group: &Group,
    limits: &[limit::LimitRow],
    palette: &Palette,
) -> Result<Option<Svg>, String> {
    let shown: Vec<&Scenario> = group
        .scenarios
        .iter()
        .filter(|scenario| points(scenario).next().is_some())
        .collect();
    if shown.is_empty() {
        return Ok(None);
    }
    let there: Vec<&str> = palette
        .names()
        .filter(|name| shown.iter().any(|s| points(s).any(|(of, ..)| of == *name)))
        .collect();
    let mut keys: Vec<Key> = there
        .iter()
        .map(|name| Key::Line(palette.style(name), name))
        .collect();
    let limit_of = |scenario: &Scenario| {
        let mut rows = limits
            .iter()
            .filter(|row| row.rate_hz == group.rate_hz && row.scenario == scenario.name);
        let mut rms = |name| {
            rows.find(|row| row.estimator == name)
                .map(|row| row.rms_rad_s)
        };
        [rms("limit"), rms("limit-edge")]
    };
    if shown.iter().any(|scenario| limit_of(scenario)[0].is_some()) {
        keys.push(Key::Line(
            INK.into(),
            "particle filter: counts (upper line), edge time stamps (lower line)",
        ));
    }
    let rows = shown.len().div_ceil(ACROSS);
    let bottom = TOP + (PANEL + BELOW) * rows as f64;
    let height = bottom + legend_height(&keys, LEFT);
    let title = format!(
        "Run time and error at {}, plant {}",
        rate(group.rate_hz),
        plant(group.friction)
    );
    let svg = figure(height, &title, |canvas| {
        canvas.text(&title, (LEFT, 16.0), Anchor::Left, TITLE, INK)?;
        let width = (WIDTH - LEFT - 14.0 - GAP * (ACROSS - 1) as f64) / ACROSS as f64;
        for (i, scenario) in shown.iter().enumerate() {
            let left = LEFT + (width + GAP) * (i % ACROSS) as f64;
            let top = TOP + (PANEL + BELOW) * (i / ACROSS) as f64;
            let frame = [left, top, left + width, top + PANEL];
            panel(canvas, scenario, limit_of(scenario), frame, palette)?;
            if i % ACROSS == 0 {
                let at = (14.0, top + 0.5 * PANEL);
                canvas.text("RMS error, rad/s", at, Anchor::Upwards, LABEL, INK)?;
            }
        }
        canvas.legend(&keys, (LEFT, bottom))
    });
    svg.map(Some)
}

/// Name, instructions and RMS error of the estimators that have both.
fn points<'a>(scenario: &'a Scenario) -> impl Iterator<Item = (&'a str, f64, f64)> {
    scenario.rows.iter().filter_map(|row| {
        let error = row.score.rms_rad_s.filter(|e| *e > 0.0 && e.is_finite())?;
        Some((row.estimator.as_str(), row.instructions?, error))
    })
}

/// The points (cost, error) that no other point beats in both, by rising cost.
fn front(mut points: Vec<(f64, f64)>) -> Vec<(f64, f64)> {
    points.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.total_cmp(&b.1)));
    let mut best = f64::INFINITY;
    points.retain(|(_, error)| {
        let better = *error < best;
        best = best.min(*error);
        better
    });
    points
}

fn panel(
    canvas: &Canvas,
    scenario: &Scenario,
    limits: [Option<f64>; 2],
    [left, top, right, bottom]: [f64; 4],
    palette: &Palette,
) -> Result<(), String> {
    let limits = || limits.into_iter().flatten();
    let errors = || points(scenario).map(|point| point.2).chain(limits());
    let costs = || points(scenario).map(|point| point.1);
    let ends = |values: &dyn Fn() -> Vec<f64>| {
        let values = values();
        let low = values.iter().copied().fold(f64::INFINITY, f64::min);
        [low / 1.3, 1.3 * values.iter().copied().fold(0.0, f64::max)]
    };
    let plot = Plot {
        left,
        top,
        right,
        bottom,
        x: Axis::log(ends(&|| costs().collect())),
        y: Axis::log(ends(&|| errors().collect())),
    };
    canvas.text(scenario.name, (left, top - 12.0), Anchor::Left, LABEL, INK)?;
    plot.grid(canvas, 4, 4)?;
    plot.x_title(canvas, "instructions per update")?;
    for limit in limits() {
        let line = [(plot.x.low, limit), (plot.x.high, limit)].map(|point| plot.at(point));
        canvas.line(&line, INK, 1.5)?;
    }
    // Steps: between two estimators no better one exists.
    let mut steps: Vec<(f64, f64)> = Vec::new();
    for point in front(points(scenario).map(|(_, c, e)| (c, e)).collect()) {
        let (x, y) = plot.at(point);
        let corner = steps.last().map(|(_, before)| (x, *before));
        steps.extend(corner);
        steps.push((x, y));
    }
    canvas.line(&steps, MUTED, 1.0)?;
    for (name, cost, error) in points(scenario) {
        let (x, y) = plot.at((cost, error));
        let corners = [(x - MARK, y - MARK), (x + MARK, y + MARK)];
        canvas.rectangle(corners, palette.style(name))?;
    }
    plot.edges(canvas)
}

#[cfg(test)]
mod tests {
    use super::super::{CaseReport, EstimatorRow, ReportInput};
    use super::*;
    use crate::grid::groups;
    use scoring::score::Score;

    #[test]
    fn front_has_the_points_that_no_other_beats() {
        let points = vec![
            (9.0, 3.0),
            (20.0, 4.0),
            (50.0, 1.0),
            (50.0, 2.0),
            (90.0, 1.0),
        ];
        assert_eq!(front(points), [(9.0, 3.0), (50.0, 1.0)]);
    }

    /// 10 to 1000 instructions and 0.01 to 10 rad/s around these values, in decades.
    #[test]
    fn marks_have_the_cost_across_and_the_error_upwards() {
        let row = |name: &str, instructions, rms| EstimatorRow {
            estimator: name.to_owned(),
            instructions: Some(instructions),
            score: Score {
                rms_rad_s: Some(rms),
                ..Score::default()
            },
        };
        let report = ReportInput {
            cases: vec![CaseReport {
                scenario: "step".to_owned(),
                rate_hz: 1000.0,
                friction: true,
                rows: vec![row("pll", 20.0, 1.0), row("observer", 200.0, 0.1)],
                ..CaseReport::default()
            }],
            ..ReportInput::default()
        };
        let palette = Palette::new(&report);
        let groups = groups(&report);
        let svg = panels(&groups[0], &[], &palette).unwrap().unwrap().0;
        let width = (WIDTH - LEFT - 14.0 - GAP * 2.0) / 3.0;
        for (name, cost, error) in [("pll", 20.0_f64, 1.0_f64), ("observer", 200.0, 0.1)] {
            let mark = crate::canvas::tests::rectangles(&svg, palette.style(name).colour)[0];
            let x = LEFT + width * (cost / 10.0).log10() / 2.0;
            let y = TOP + PANEL * (1.0 - (error / 0.01).log10() / 3.0);
            assert!((mark[0] + MARK - x).abs() < 0.5, "{name}: {mark:?}, {x}");
            assert!((mark[1] + MARK - y).abs() < 0.5, "{name}: {mark:?}, {y}");
        }
    }

    #[test]
    fn each_scenario_has_a_panel_and_the_particle_filter_if_it_ran() {
        let row = |name: &str, instructions, rms| EstimatorRow {
            estimator: name.to_owned(),
            instructions,
            score: Score {
                rms_rad_s: Some(rms),
                ..Score::default()
            },
        };
        let case = |scenario: &str, rows| CaseReport {
            scenario: scenario.to_owned(),
            rate_hz: 1000.0,
            friction: true,
            rows,
            ..CaseReport::default()
        };
        let report = ReportInput {
            cases: vec![
                case(
                    "step",
                    vec![
                        row("pll", Some(19.0), 1.0),
                        row("observer", Some(120.0), 0.1),
                    ],
                ),
                case("stochastic", vec![row("pll", Some(19.0), 1.0)]),
                case("track", vec![row("unmeasured", None, 1.0)]),
            ],
            ..ReportInput::default()
        };
        let limits = ["limit", "limit-edge"].map(|estimator| limit::LimitRow {
            estimator,
            scenario: "stochastic",
            rate_hz: 1000.0,
            seed: 1,
            rms_rad_s: 0.05,
            rms_pct: 5.0,
            over_limit: 1.0,
            collapsed: 0.0,
        });
        let groups = groups(&report);
        let palette = Palette::new(&report);
        let svg = panels(&groups[0], &limits, &palette).unwrap().unwrap().0;
        // In the second panel alone, across its width.
        let lines = crate::canvas::tests::points(&svg, "polyline", INK);
        let across = lines.iter().filter(|line| line[1].0 - line[0].0 > 100.0);
        let lefts: Vec<_> = across.map(|line| line[0].0).collect();
        let second = LEFT + (WIDTH - LEFT - 14.0 - GAP * 2.0) / 3.0 + GAP;
        assert_eq!(lefts.len(), 2);
        // 0.05 rad/s on an axis of the three decades from 0.01 rad/s, around 0.05 and 1 rad/s.
        let height = TOP + PANEL * (1.0 - 5.0_f64.log10() / 3.0);
        let is_limit = |line: &&Vec<(f64, f64)>| line.iter().all(|at| (at.1 - height).abs() < 0.5);
        assert_eq!(lines.iter().filter(is_limit).count(), 2, "{lines:?}");
        assert!(
            lefts.iter().all(|left| (left - second).abs() < 0.5),
            "{lefts:?}"
        );
        assert_eq!(svg.matches("instructions per update").count(), 2);
        assert!(svg.contains("particle filter: counts") && !svg.contains("unmeasured"));
        // Results of another rate are not drawn.
        for rate_hz in [500.0, 2000.0] {
            let others = limits.clone().map(|row| limit::LimitRow { rate_hz, ..row });
            let svg = panels(&groups[0], &others, &palette).unwrap().unwrap().0;
            assert!(!svg.contains("particle filter: counts"), "{rate_hz}");
        }
    }
}
