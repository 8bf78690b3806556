//! The page of `real`: ranking, error against resolution and rate, and the velocity in one second of
//! each recording.

pub(super) mod motion;
pub(super) mod ranking;

use super::canvas::{Anchor, Key, LABEL, Svg, TITLE, WIDTH, figure, legend_height};
use super::page::Printout;
use super::palette::{INK, Palette};
use super::plot::{Axis, Plot};
use super::text::rate;
use experiments::distinct::distinct;
use experiments::real::pool::on;
use experiments::real::run::{Outcome, Row};

/// Errors that the figures show, % of finite difference; a larger one leaves the frame.
const SHOWN_PCT: [f64; 2] = [1.0, 200.0];

const LEFT: f64 = 62.0;
const TOP: f64 = 48.0;
const PANEL: f64 = 300.0;

/// The page of `rows`, as the program scored them, with the signals of one run of each recording in
/// `kept`. Ranking and velocities are of the resolution and rate `shown`.
///
/// # Errors
/// If a figure cannot be drawn.
pub fn real(
    rows: &[Row],
    estimators: &[&'static str],
    shown: (u32, f64),
    kept: &[Outcome],
    printout: &Printout,
) -> Result<String, String> {
    let palette = Palette::of(estimators.iter().copied());
    let ranks = ranking::ranks(rows, estimators, shown);
    let title = format!(
        "Ranking at {} counts/rev and {}: RMS error by recording",
        shown.0,
        rate(shown.1)
    );
    let legend = "mark: a recording that judges; grey: one with which constants were chosen; bar: mean; a \
                  value beyond the frame stands at its edge";
    let mut figures = vec![ranking::chart(&ranks, &title, legend, &palette)?];
    let coarsened = || rows.iter().filter(|row| row.phase.is_some());
    let resolutions = distinct(coarsened().map(|row| row.counts_per_rev));
    let rates = distinct(coarsened().map(|row| row.rate_hz));
    let (counts_per_rev, rate_hz) = shown;
    if resolutions.len() > 1 {
        let at = resolutions.iter().map(|&counts| (counts, rate_hz));
        let curves = curves(rows, estimators, &at.collect::<Vec<_>>(), |(counts, _)| {
            counts.into()
        });
        let title = format!("Error against resolution at {}", rate(rate_hz));
        figures.extend(curves.chart(&title, "counts per revolution", &palette)?);
    }
    if rates.len() > 1 {
        let at = rates.iter().map(|&rate_hz| (counts_per_rev, rate_hz));
        let curves = curves(rows, estimators, &at.collect::<Vec<_>>(), |(_, rate_hz)| {
            rate_hz
        });
        let title = format!("Error against rate at {counts_per_rev} counts/rev");
        figures.extend(curves.chart(&title, "rate, Hz", &palette)?);
    }
    let drawn = ranking::drawn(&ranks);
    for outcome in kept {
        figures.extend(motion::chart(outcome, &drawn, &palette)?);
    }
    let intro = "Estimators on recordings of real devices whose velocity is known. The RMS error is in \
        % of finite difference on the same samples. Constants were chosen with some of the recordings; \
        the others judge.";
    Ok(printout.page("Real motion", intro, &figures))
}

/// Mean errors over the recordings that have all points.
struct Curves {
    recordings: usize,
    /// Estimator, and its error at each place, % of finite difference.
    lines: Vec<(&'static str, Vec<(f64, f64)>)>,
}

/// Errors over the resolutions and rates `at`, each at the place `place`.
fn curves(
    rows: &[Row],
    estimators: &[&'static str],
    at: &[(u32, f64)],
    place: impl Fn((u32, f64)) -> f64,
) -> Curves {
    let block = |(counts_per_rev, rate_hz): (u32, f64)| {
        let is = move |row: &&Row| {
            row.phase.is_some() && row.counts_per_rev == counts_per_rev && row.rate_hz == rate_hz
        };
        rows.iter().filter(is)
    };
    // A pool over other recordings at every point would not be a curve.
    let mut common = distinct(rows.iter().map(|row| row.recording.as_str()));
    common.retain(|name| {
        at.iter()
            .all(|&at| block(at).any(|row| row.recording == *name))
    });
    let line = |estimator: &&'static str| {
        let point = |&at: &(u32, f64)| {
            let errors = common
                .iter()
                .filter_map(|name| on(block(at), name, estimator)?.rms_pct);
            let errors: Vec<f64> = errors.collect();
            let mean = errors.iter().sum::<f64>() / errors.len() as f64;
            (!errors.is_empty()).then_some((place(at), mean))
        };
        (*estimator, at.iter().filter_map(point).collect::<Vec<_>>())
    };
    let mut lines: Vec<_> = estimators.iter().map(line).collect();
    for (_, points) in &mut lines {
        points.sort_by(|a, b| a.0.total_cmp(&b.0));
    }
    lines.retain(|(_, points)| points.iter().any(|(_, error)| *error <= SHOWN_PCT[1]));
    Curves {
        recordings: common.len(),
        lines,
    }
}

impl Curves {
    /// The figure; `None` without a recording that has all points.
    fn chart(&self, title: &str, x_title: &str, palette: &Palette) -> Result<Option<Svg>, String> {
        let xs = || {
            self.lines
                .iter()
                .flat_map(|(_, points)| points.iter().map(|point| point.0))
        };
        let ends = [xs().fold(f64::INFINITY, f64::min), xs().fold(0.0, f64::max)];
        if self.recordings == 0 || ends[0] >= ends[1] {
            return Ok(None);
        }
        let keys: Vec<Key> = (self.lines.iter())
            .map(|(name, _)| Key::Line(palette.style(name), name))
            .collect();
        let bottom = TOP + PANEL + 50.0;
        let title = format!("{title}, mean over {} recordings", self.recordings);
        let svg = figure(bottom + legend_height(&keys, LEFT), &title, |canvas| {
            canvas.text(&title, (LEFT, 16.0), Anchor::Left, TITLE, INK)?;
            let plot = Plot {
                left: LEFT,
                top: TOP,
                right: WIDTH - 20.0,
                bottom: TOP + PANEL,
                x: Axis::log_exact(ends),
                y: Axis::log_exact(SHOWN_PCT),
            };
            plot.grid(canvas, 6, 6)?;
            plot.x_title(canvas, x_title)?;
            let at = (16.0, TOP + 0.5 * PANEL);
            canvas.text("RMS error, % of FD", at, Anchor::Upwards, LABEL, INK)?;
            for (name, points) in &self.lines {
                plot.curve(canvas, points.iter().copied(), palette.style(name), 2.0)?;
            }
            plot.edges(canvas)?;
            canvas.legend(&keys, (LEFT, bottom))
        })?;
        Ok(Some(svg))
    }
}

#[cfg(test)]
mod tests;
