//! A figure of several panels, each with curves on its own axes.

use super::super::canvas::{Anchor, Canvas, Key, LABEL, Svg, TITLE, WIDTH, figure, legend_height};
use super::super::palette::{BAND, INK, MUTED};
use super::super::plot::{Axis, Plot};
use super::super::style::Style;

/// Sizes, px.
const LEFT: f64 = 68.0;
const GAP: f64 = 62.0;
const HEADING: f64 = 26.0;
const BELOW: f64 = 42.0;

/// A curve; its points come in order of x.
pub(super) struct Curve {
    pub(super) style: Style,
    pub(super) width: f64,
    pub(super) points: Vec<(f64, f64)>,
}

impl Curve {
    pub(super) fn new(style: impl Into<Style>, points: Vec<(f64, f64)>) -> Self {
        Self {
            style: style.into(),
            width: 1.6,
            points,
        }
    }
}

/// Green area of a panel.
pub(super) enum Green {
    /// From one x to another.
    Across([f64; 2]),
    /// From one y to another.
    Up([f64; 2]),
    /// Between two curves: x, low, high.
    Around(Vec<(f64, f64, f64)>),
}

/// One panel.
pub(super) struct Panel<'a> {
    pub(super) heading: String,
    pub(super) x: Axis,
    pub(super) y: Axis,
    /// About how many ticks; of no effect on a log axis.
    pub(super) ticks: [usize; 2],
    pub(super) x_title: &'a str,
    pub(super) y_title: &'a str,
    pub(super) green: Green,
    pub(super) curves: Vec<Curve>,
}

/// Panels in `columns`, row by row, each `height` px high.
pub(super) fn panels(
    title: &str,
    keys: &[Key],
    columns: usize,
    height: f64,
    panels: &[Panel],
) -> Result<Svg, String> {
    let rows = panels.len().div_ceil(columns);
    let head = 34.0 + legend_height(keys, LEFT);
    let row_height = HEADING + height + BELOW;
    let width = (WIDTH - LEFT - 16.0 - (columns - 1) as f64 * GAP) / columns as f64;
    figure(head + rows as f64 * row_height, title, |canvas| {
        canvas.text(title, (LEFT, 16.0), Anchor::Left, TITLE, INK)?;
        canvas.legend(keys, (LEFT, 40.0))?;
        for (i, panel) in panels.iter().enumerate() {
            let left = LEFT + (i % columns) as f64 * (width + GAP);
            let top = head + (i / columns) as f64 * row_height + HEADING;
            let plot = Plot {
                left,
                top,
                right: left + width,
                bottom: top + height,
                x: panel.x,
                y: panel.y,
            };
            panel.draw(canvas, &plot)?;
            let is_first = i % columns == 0;
            if is_first || panel.y_title != panels[i - 1].y_title {
                let middle = (left - LEFT + 14.0, top + 0.5 * height);
                canvas.text(panel.y_title, middle, Anchor::Upwards, LABEL, INK)?;
            }
        }
        Ok(())
    })
}

impl Panel<'_> {
    fn draw(&self, canvas: &Canvas, plot: &Plot) -> Result<(), String> {
        let at = (plot.left, plot.top - 12.0);
        canvas.text(&self.heading, at, Anchor::Left, 12.5, INK)?;
        let inside = |[low, high]: [f64; 2], axis: &Axis| {
            let parts = [low, high].map(|v| axis.part(v).clamp(0.0, 1.0));
            (parts[1] > parts[0]).then_some(parts)
        };
        let (width, height) = (plot.right - plot.left, plot.bottom - plot.top);
        match &self.green {
            Green::Across(band) => {
                if let Some(parts) = inside(*band, &plot.x) {
                    let [left, right] = parts.map(|part| plot.left + part * width);
                    canvas.rectangle([(left, plot.top), (right, plot.bottom)], BAND)?;
                }
            }
            Green::Up(band) => {
                if let Some(parts) = inside(*band, &plot.y) {
                    let [low, high] = parts.map(|part| plot.bottom - part * height);
                    canvas.rectangle([(plot.left, high), (plot.right, low)], BAND)?;
                }
            }
            Green::Around(points) => plot.band(canvas, points.iter().copied(), BAND)?,
        }
        plot.grid(canvas, self.ticks[0], self.ticks[1])?;
        for curve in &self.curves {
            let points = curve.points.iter().copied();
            plot.curve(canvas, points, curve.style, curve.width)?;
        }
        plot.edges(canvas)?;
        self.ends(canvas, plot)?;
        plot.x_title(canvas, self.x_title)
    }

    /// A log axis that begins or ends between decades: its ends, where there is room.
    fn ends(&self, canvas: &Canvas, plot: &Plot) -> Result<(), String> {
        if !plot.x.is_log() {
            return Ok(());
        }
        let ticks: Vec<f64> = plot
            .x
            .ticks(0)
            .iter()
            .map(|t| plot.at((*t, 1.0)).0)
            .collect();
        for end in [plot.x.low, plot.x.high] {
            let (x, _) = plot.at((end, plot.y.low));
            if ticks.iter().all(|tick| (tick - x).abs() >= 34.0) {
                let at = (x, plot.bottom + 10.0);
                canvas.text(&format!("{end:.0}"), at, Anchor::Centre, LABEL, MUTED)?;
            }
        }
        Ok(())
    }
}
