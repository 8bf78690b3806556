//! The page of `zwidth`: stiffness against damping, the chart of Colgate and Brown.

use super::canvas::{Anchor, Canvas, Key, LABEL, Svg, TITLE, WIDTH, figure, legend_height};
use super::page::Printout;
use super::palette::{INK, Palette};
use super::plot::{Axis, Plot};
use super::style::Style;
use super::text::rate;
use experiments::distinct::distinct;
use experiments::zwidth::rows::ZwidthRow;

const TOP: f64 = 58.0;
const PANEL: f64 = 260.0;
const LEFT: f64 = 62.0;
const GAP: f64 = 52.0;

/// The page of bounds: a figure for each encoder, then the printed table.
///
/// # Errors
/// If a figure cannot be drawn.
pub fn zwidth(rows: &[ZwidthRow], printout: &Printout) -> Result<String, String> {
    let palette = Palette::of(rows.iter().map(|row| row.estimator));
    let mut figures = Vec::new();
    for lines in distinct(rows.iter().map(|row| row.lines)) {
        let of: Vec<&ZwidthRow> = rows.iter().filter(|row| row.lines == lines).collect();
        figures.push(chart(&of, lines, &palette)?);
    }
    let intro = "A virtual wall whose stiffness and damping lie below the curve is passive and free of \
        limit cycles in simulation, with a light grip, with a hand and with a handle thrown at it. \
        The right end of a curve is the strongest damping without stiffness. Each panel has its own \
        scales.";
    Ok(printout.page("Z-width", intro, &figures))
}

fn chart(rows: &[&ZwidthRow], lines: u32, palette: &Palette) -> Result<Svg, String> {
    let rates = distinct(rows.iter().map(|row| row.rate_hz));
    let names = distinct(rows.iter().map(|row| row.estimator));
    let keys: Vec<Key> = names
        .iter()
        .map(|name| Key::Line(palette.style(name), name))
        .collect();
    // Three panels a row.
    let columns = rates.len().min(3);
    let width = (WIDTH - LEFT - 14.0 - GAP * (columns - 1) as f64) / columns as f64;
    let panel_rows = rates.len().div_ceil(columns);
    let row_height = PANEL + 66.0;
    let bottom = TOP + row_height * panel_rows as f64;
    let height = bottom + legend_height(&keys, LEFT);
    let title = format!("Z-width, large encoder of {lines} lines");
    figure(height, &title, |canvas| {
        canvas.text(&title, (LEFT, 16.0), Anchor::Left, TITLE, INK)?;
        for (i, &rate_hz) in rates.iter().enumerate() {
            let left = LEFT + (width + GAP) * (i % columns) as f64;
            let top = TOP + row_height * (i / columns) as f64;
            let of: Vec<&ZwidthRow> = rows
                .iter()
                .copied()
                .filter(|row| row.rate_hz == rate_hz)
                .collect();
            let plot = Plot {
                left,
                top,
                right: left + width,
                bottom: top + PANEL,
                x: axis(of.iter().map(|row| 1e3 * row.damping_nms_per_rad)),
                y: axis(of.iter().map(|row| row.stiffness_nm_per_rad)),
            };
            plot.grid(canvas, 4, 6)?;
            canvas.text(&rate(rate_hz), (left, top - 14.0), Anchor::Left, LABEL, INK)?;
            plot.x_title(canvas, "damping B, mN\u{b7}m\u{b7}s/rad")?;
            if i % columns == 0 {
                let at = (16.0, top + 0.5 * PANEL);
                canvas.text("stiffness K, N\u{b7}m/rad", at, Anchor::Upwards, LABEL, INK)?;
            }
            for name in &names {
                let curve = of.iter().filter(|row| row.estimator == *name);
                let points: Vec<_> = curve
                    .map(|row| (1e3 * row.damping_nms_per_rad, row.stiffness_nm_per_rad))
                    .collect();
                draw(canvas, &plot, &points, palette.style(name))?;
            }
            plot.edges(canvas)?;
        }
        canvas.legend(&keys, (LEFT, bottom))
    })
}

/// From zero to a little more than the largest value.
fn axis(values: impl Iterator<Item = f64>) -> Axis {
    Axis::linear([0.0, 1.06 * values.fold(0.0, f64::max)])
}

fn draw(canvas: &Canvas, plot: &Plot, points: &[(f64, f64)], style: Style) -> Result<(), String> {
    plot.curve(canvas, points.iter().copied(), style, 2.0)?;
    for &point in points {
        let (x, y) = plot.at(point);
        canvas.rectangle([(x - 2.5, y - 2.5), (x + 2.5, y + 2.5)], style)?;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn row(lines: u32, rate_hz: f64, damping: f64, stiffness: f64) -> ZwidthRow {
        ZwidthRow {
            estimator: "pll",
            handle_estimator: "pll",
            rate_hz,
            lines,
            seed: 1,
            bound: "stiffness",
            stiffness_nm_per_rad: stiffness,
            damping_nms_per_rad: damping,
            at_cap: false,
            fault: None,
            touch: None,
        }
    }

    #[test]
    fn marks_have_the_damping_across_and_the_stiffness_upwards() {
        let rows = [row(256, 1e3, 1e-3, 0.5), row(256, 1e3, 4e-3, 2.0)];
        let palette = Palette::of(["pll"].into_iter());
        let colour = palette.style("pll").colour;
        let svg = chart(&rows.each_ref().map(|row| row), 256, &palette)
            .unwrap()
            .0;
        let marks = crate::canvas::tests::rectangles(&svg, colour);
        let width = WIDTH - LEFT - 14.0;
        for part in [0.25, 1.0] {
            // The axes end 6 % beyond the largest value. A mark may have stripes.
            let at = [
                LEFT + width * part / 1.06,
                TOP + PANEL - PANEL * part / 1.06,
            ];
            let is_mark = |mark: &&[f64; 4]| (mark[1] + 0.5 * mark[3] - at[1]).abs() < 0.5;
            let of_mark = marks.iter().filter(is_mark);
            let left = of_mark.clone().fold(WIDTH, |x, mark| x.min(mark[0]));
            let right = of_mark.fold(0.0_f64, |x, mark| x.max(mark[0] + mark[2]));
            assert!((0.5 * (left + right) - at[0]).abs() < 0.5, "{marks:?}");
        }
    }

    #[test]
    fn each_encoder_has_a_figure_and_each_rate_a_panel() {
        let mut rows = Vec::new();
        for (lines, rate_hz) in [(256, 1e3), (256, 1e4), (1024, 1e3)] {
            rows.push(row(lines, rate_hz, 0.0, 0.3));
            rows.push(row(lines, rate_hz, 1e-3, 0.0));
        }
        let printout = Printout {
            command: "host-sim zwidth",
            device: "a & b",
            table: "K < B",
        };
        let page = zwidth(&rows, &printout).unwrap();
        let figures: Vec<_> = super::super::figures(&page).collect();
        assert_eq!(figures.len(), 2);
        let panels = |svg: &str| svg.matches("damping B,").count();
        assert_eq!((panels(figures[0]), panels(figures[1])), (2, 1));
        assert!(page.contains("K &lt; B") && page.contains("a &amp; b"));
        // Without a bound the frame is empty, which is not an error.
        assert!(zwidth(&[row(256, 1e3, 0.0, 0.0)], &Printout::default()).is_ok());
    }
}
