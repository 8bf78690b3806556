//! The page of `sensitivity`: velocity error against errors of the model's constants.

use super::canvas::{Anchor, Key, LABEL, Svg, TITLE, WIDTH, figure, legend_height};
use super::page::Printout;
use super::palette::{INK, Palette};
use super::plot::{Axis, Plot};
use super::text::rate;
use catalogue::constant_error::Constant;
use experiments::sensitivity::SensitivityRow;
use experiments::sensitivity::table::{MOVING, names, percentage, rows_by_rate};

const TOP: f64 = 58.0;
const PANEL: f64 = 230.0;
const LEFT: f64 = 62.0;
const GAP: f64 = 52.0;

/// The page: a figure for each rate with a panel for each constant, then the printed table.
///
/// # Errors
/// If a figure cannot be drawn.
pub fn sensitivity(rows: &[SensitivityRow], printout: &Printout) -> Result<String, String> {
    let palette = Palette::of(rows.iter().map(|row| row.estimator));
    let charts = rows_by_rate(rows);
    let charts = charts.iter().map(|at_rate| chart(at_rate, &palette));
    let figures: Vec<Svg> = charts.collect::<Result<_, _>>()?;
    let intro = "RMS velocity error of estimators whose model has one wrong constant, in % of the error \
        of finite difference; mean of the scenarios in which the motor moves. The error of \
        estimators without a motor model does not depend on it.";
    Ok(printout.page("Sensitivity to parameter errors", intro, &figures))
}

/// Error of the constant and RMS error of the velocity, %.
type Curve = Vec<(f64, f64)>;

/// Mean over the scenarios in which the motor moves, at each error of `constant`, in order of the
/// error.
fn curve(rows: &[&SensitivityRow], name: &str, constant: Constant) -> Curve {
    let mut points: Vec<(f64, f64, f64)> = Vec::new();
    for row in rows {
        let shown = row.constant.is_none() || row.constant == Some(constant.as_str());
        if row.estimator != name || !shown || !MOVING.contains(&row.scenario) {
            continue;
        }
        let Some(y) = percentage(row) else { continue };
        let x = 100.0 * row.error;
        match points.iter_mut().find(|point| point.0 == x) {
            Some(point) => (point.1, point.2) = (point.1 + y, point.2 + 1.0),
            None => points.push((x, y, 1.0)),
        }
    }
    points.sort_by(|a, b| a.0.total_cmp(&b.0));
    points
        .iter()
        .map(|&(x, sum, count)| (x, sum / count))
        .collect()
}

/// A panel for each constant, from rows of one rate.
pub(super) fn chart(rows: &[&SensitivityRow], palette: &Palette) -> Result<Svg, String> {
    let names = names(rows);
    let keys: Vec<Key> = names
        .iter()
        .map(|name| Key::Line(palette.style(name), name))
        .collect();
    let curves: Vec<(Constant, Vec<Curve>)> = Constant::ALL
        .into_iter()
        .map(|constant| {
            let of = |name: &&str| curve(rows, name, constant);
            (constant, names.iter().map(of).collect())
        })
        .collect();
    let values = || {
        let all = curves.iter().flat_map(|(_, curves)| curves).flatten();
        all.map(|point| point.1)
            .filter(|y| y.is_finite() && *y > 0.0)
    };
    let low = values().fold(100.0, f64::min);
    let high = values().fold(100.0, f64::max);
    // Two panels a row.
    let width = (WIDTH - LEFT - 14.0 - GAP) / 2.0;
    let row_height = PANEL + 66.0;
    let bottom = TOP + 2.0 * row_height;
    let height = bottom + legend_height(&keys, LEFT);
    let title = format!(
        "Sensitivity to parameter errors at {}",
        rate(rows[0].rate_hz)
    );
    figure(height, &title, |canvas| {
        canvas.text(&title, (LEFT, 16.0), Anchor::Left, TITLE, INK)?;
        for (i, (constant, curves)) in curves.iter().enumerate() {
            let left = LEFT + (width + GAP) * (i % 2) as f64;
            let top = TOP + row_height * (i / 2) as f64;
            let span = 100.0 * constant.largest_error();
            let plot = Plot {
                left,
                top,
                right: left + width,
                bottom: top + PANEL,
                x: Axis::linear([-span, span]),
                y: Axis::log([low, high]),
            };
            plot.grid(canvas, 4, 6)?;
            plot.x_title(canvas, &format!("error of {}, %", constant.as_str()))?;
            if i % 2 == 0 {
                let at = (16.0, top + 0.5 * PANEL);
                canvas.text(
                    "RMS error, % of finite difference",
                    at,
                    Anchor::Upwards,
                    LABEL,
                    INK,
                )?;
            }
            for (name, points) in names.iter().zip(curves) {
                plot.curve(canvas, points.iter().copied(), palette.style(name), 2.0)?;
            }
            plot.edges(canvas)?;
        }
        canvas.legend(&keys, (LEFT, bottom))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn row(
        estimator: &'static str,
        constant: Option<&'static str>,
        error: f64,
        pct: f64,
    ) -> SensitivityRow {
        SensitivityRow {
            estimator,
            scenario: "step",
            rate_hz: 1000.0,
            seed: 1,
            constant,
            error,
            rms_rad_s: 1.0,
            rms_pct: pct,
            outside: 0.0,
        }
    }

    #[test]
    fn each_constant_has_a_panel_and_curves_include_the_true_value() {
        let rows = [
            row("pll", None, 0.0, 50.0),
            row("pll", Some("damping"), 0.3, 60.0),
            row("pll", Some("damping"), -0.3, 40.0),
            row("pll", Some("friction"), 0.5, 70.0),
        ];
        let all: Vec<&SensitivityRow> = rows.iter().collect();
        let points = curve(&all, "pll", Constant::Damping);
        assert_eq!(points, [(-30.0, 40.0), (0.0, 50.0), (30.0, 60.0)]);
        // The mean of the scenarios in which the motor moves, here two of three.
        let other = |scenario, pct| SensitivityRow {
            scenario,
            ..row("pll", Some("damping"), 0.3, pct)
        };
        let more = [other("track", 90.0), other("hold", 1000.0)];
        let with_more: Vec<_> = rows.iter().chain(&more).collect();
        assert_eq!(curve(&with_more, "pll", Constant::Damping)[2], (30.0, 75.0));
        let printout = Printout {
            command: "host-sim sensitivity",
            device: "a & b",
            table: "K < B",
        };
        let page = sensitivity(&rows, &printout).unwrap();
        assert_eq!(super::super::figures(&page).count(), 1);
        for constant in Constant::ALL {
            let title = format!("error of {}, %", constant.as_str());
            assert_eq!(page.matches(&title).count(), 1, "{title}");
        }
        assert!(page.contains("K &lt; B"));
    }
}
