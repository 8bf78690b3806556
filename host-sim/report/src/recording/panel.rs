//! One panel of the figure: curves over time, and a band behind them.

use std::ops::Range;

use super::RecordingView;
use crate::canvas::{Anchor, Canvas, LABEL};
use crate::palette::INK;
use crate::plot::Plot;
use crate::style::Style;
use crate::text::share;

/// A step of `t` above this many periods is a gap, over which no curve is drawn.
const GAP_STEPS: f64 = 1.5;

/// One curve of a panel, with a value for each row of the recording.
pub(super) struct Curve {
    pub(super) name: String,
    pub(super) style: Style,
    pub(super) values: Vec<f64>,
    pub(super) width: f64,
    /// Whether the range of the axis includes all its values.
    pub(super) sizes: bool,
}

pub(super) struct Panel {
    pub(super) unit: &'static str,
    pub(super) curves: Vec<Curve>,
    /// Half the height of the interval at each row.
    pub(super) band: Option<Vec<f64>>,
}

impl Curve {
    pub(super) fn new(name: &str, style: impl Into<Style>, values: &[f64]) -> Self {
        Self {
            name: name.to_owned(),
            style: style.into(),
            values: values.to_vec(),
            width: 1.3,
            sizes: true,
        }
    }

    pub(super) fn wide(self) -> Self {
        Self { width: 1.8, ..self }
    }
}

impl Panel {
    pub(super) fn draw(
        &self,
        canvas: &Canvas,
        plot: &Plot,
        view: &RecordingView,
    ) -> Result<(), String> {
        let t = &view.recording.t;
        let segments = segments(view);
        if let Some(band) = &self.band {
            for rows in &segments {
                let edges = rows.clone().map(|row| (t[row], -band[row], band[row]));
                plot.interval(canvas, edges)?;
            }
        }
        plot.grid(canvas, 9, 4)?;
        for curve in &self.curves {
            for rows in &segments {
                let points = rows.clone().map(|row| (t[row], curve.values[row]));
                plot.curve(canvas, points, curve.style, curve.width)?;
            }
        }
        plot.edges(canvas)?;
        let middle = 0.5 * (plot.top + plot.bottom);
        canvas.text(self.unit, (14.0, middle), Anchor::Upwards, LABEL, INK)
    }

    /// Name of each curve for the legend, with the share of its samples outside `low` to `high`.
    pub(super) fn names(&self, view: &RecordingView, [low, high]: [f64; 2]) -> Vec<String> {
        let rows: Vec<usize> = segments(view).into_iter().flatten().collect();
        let name = |curve: &Curve| {
            let inside = |row: &&usize| (low..=high).contains(&curve.values[**row]);
            let outside = rows.len() - rows.iter().filter(inside).count();
            match outside {
                0 => curve.name.clone(),
                _ => {
                    let part = share(outside as f64 / rows.len() as f64);
                    format!("{}, {part} off scale", curve.name)
                }
            }
        };
        self.curves.iter().map(name).collect()
    }
}

/// Lowest and highest value in the window, with a margin.
pub(super) fn range(panel: &Panel, view: &RecordingView) -> [f64; 2] {
    let mut ends = [f64::INFINITY, f64::NEG_INFINITY];
    let mut see = |y: f64| ends = [ends[0].min(y), ends[1].max(y)];
    for rows in segments(view) {
        let values = panel.curves.iter().filter(|curve| curve.sizes);
        values
            .flat_map(|curve| &curve.values[rows.clone()])
            .for_each(|y| see(*y));
        for half in panel.band.iter().flat_map(|band| &band[rows.clone()]) {
            see(1.5 * half);
            see(-1.5 * half);
        }
    }
    // A constant value gets an axis with short labels.
    let span = ends[1] - ends[0];
    let pad = if span > 0.0 { 0.06 * span } else { 0.5 };
    [ends[0] - pad, ends[1] + pad]
}

/// Rows in the window, split at gaps.
pub(super) fn segments(view: &RecordingView) -> Vec<Range<usize>> {
    let t = &view.recording.t;
    let first = t.partition_point(|t| *t < view.window[0]);
    let last = t.partition_point(|t| *t <= view.window[1]);
    let gap = GAP_STEPS / view.recording.trace.rate_hz;
    let mut from = first;
    let mut segments = Vec::new();
    for at in first + 1..=last {
        if at == last || t[at] - t[at - 1] > gap {
            segments.push(from..at);
            from = at;
        }
    }
    segments
}
