//! Axes: position of a value in a frame, grid and labels.

use super::canvas::{Anchor, Canvas, LABEL};
use super::curve;
use super::palette::{BAND, BAND_EDGE, GRID, INK, MUTED};
use super::style::{Dash, Style, length};
use super::text::number;
use plotters::style::RGBColor;

/// Smallest length of an axis, of its largest value: a thousand roundings of its ticks are shorter.
const RESOLVED: f64 = 1e-12;

/// Length of the longest curve with dashes, px. A longer one fills its frame: no dash is seen, and each is an
/// element of the image.
const LONGEST_DASHED: f64 = 20_000.0;

/// Most further ticks that are tried for an axis that would have fewer than two.
const FURTHER: usize = 20;

/// One axis, from its low to its high end.
#[derive(Clone, Copy)]
pub(super) struct Axis {
    pub(super) low: f64,
    pub(super) high: f64,
    log: bool,
}

impl Axis {
    /// Even divisions; `high` is moved away from `low` if they are equal, or so near that numbers
    /// between them do not differ.
    pub(super) fn linear([low, high]: [f64; 2]) -> Self {
        let resolved = RESOLVED * low.abs().max(high.abs());
        let high = if high - low > resolved {
            high
        } else {
            low + resolved.max(1.0)
        };
        Self {
            low,
            high,
            log: false,
        }
    }

    /// Whole decades around positive values.
    pub(super) fn log([low, high]: [f64; 2]) -> Self {
        let low = 10_f64.powf(low.log10().floor());
        let high = 10_f64.powf(high.log10().ceil());
        let high = if high > low { high } else { 10.0 * low };
        Self {
            low,
            high,
            log: true,
        }
    }

    /// A log axis with exactly these ends.
    pub(super) fn log_exact([low, high]: [f64; 2]) -> Self {
        Self {
            low,
            high,
            log: true,
        }
    }

    /// Whether the axis is logarithmic.
    pub(super) fn is_log(&self) -> bool {
        self.log
    }

    /// Position of a value: 0 at the low end, 1 at the high end; far below 0 for a value on a log
    /// axis that is not positive.
    pub(super) fn part(&self, value: f64) -> f64 {
        if self.log {
            let span = (self.high / self.low).ln();
            (value.max(f64::MIN_POSITIVE) / self.low).ln() / span
        } else {
            (value - self.low) / (self.high - self.low)
        }
    }

    /// About `wanted` round values within the axis, none for 0; the decades on a log axis.
    pub(super) fn ticks(&self, wanted: usize) -> Vec<f64> {
        if self.log {
            let first = (self.low.log10() - 1e-9).ceil() as i32;
            let last = (self.high.log10() + 1e-9).floor() as i32;
            let decades: Vec<_> = (first..=last)
                .map(|exponent| 10_f64.powi(exponent))
                .collect();
            return match decades.len() {
                0 | 1 => self.within_a_decade(),
                _ => decades,
            };
        }
        // One label alone is no scale.
        (wanted..wanted + FURTHER)
            .map(|wanted| self.even(wanted))
            .find(|ticks| wanted == 0 || ticks.len() > 1)
            .unwrap_or_else(|| vec![self.low, self.high])
    }

    /// The ends, and the round values between them.
    fn within_a_decade(&self) -> Vec<f64> {
        let decade = 10_f64.powf(self.low.log10().floor());
        let round = [1.0, 2.0, 5.0, 10.0, 20.0, 50.0].map(|m| m * decade);
        let inside = |tick: &f64| (1.1 * self.low..0.91 * self.high).contains(tick);
        let inside = round.into_iter().filter(inside);
        std::iter::once(self.low)
            .chain(inside)
            .chain([self.high])
            .collect()
    }

    /// About `wanted` round values.
    fn even(&self, wanted: usize) -> Vec<f64> {
        if wanted == 0 {
            return Vec::new();
        }
        let rough = (self.high - self.low) / wanted as f64;
        let decade = 10_f64.powf(rough.log10().floor());
        let step = [1.0, 2.0, 5.0, 10.0]
            .map(|m| m * decade)
            .into_iter()
            .find(|step| *step >= 0.999 * rough)
            .unwrap_or(10.0 * decade);
        let first = (self.low / step - 1e-9).ceil() as i64;
        let last = (self.high / step + 1e-9).floor() as i64;
        (first..=last).map(|i| i as f64 * step).collect()
    }

    pub(super) fn label(&self, value: f64) -> String {
        if self.log {
            return number_of_decade(value);
        }
        // Ticks are round: print no more digits than they have.
        let text = format!("{value:.4}");
        let text = text.trim_end_matches('0').trim_end_matches('.');
        match text.strip_prefix('-') {
            Some("0") => "0".into(),
            Some(size) => format!("\u{2212}{size}"),
            None => text.into(),
        }
    }
}

fn number_of_decade(value: f64) -> String {
    if (0.000_99..1.0).contains(&value) {
        format!("{value}")
    } else if (1.0..99_999.0).contains(&value) {
        format!("{value:.0}")
    } else {
        number(value)
    }
}

/// A frame with two axes.
pub(super) struct Plot {
    pub(super) left: f64,
    pub(super) top: f64,
    pub(super) right: f64,
    pub(super) bottom: f64,
    pub(super) x: Axis,
    pub(super) y: Axis,
}

impl Plot {
    /// Position of a value, px.
    pub(super) fn at(&self, (x, y): (f64, f64)) -> (f64, f64) {
        (
            self.left + self.x.part(x) * (self.right - self.left),
            self.bottom - self.y.part(y) * (self.bottom - self.top),
        )
    }

    /// Grid lines; labels below and to the left.
    pub(super) fn grid(
        &self,
        canvas: &Canvas,
        x_ticks: usize,
        y_ticks: usize,
    ) -> Result<(), String> {
        for x in self.x.ticks(x_ticks) {
            let (px, _) = self.at((x, self.y.low));
            canvas.line(&[(px, self.top), (px, self.bottom)], GRID, 1.0)?;
            let label = self.x.label(x);
            canvas.text(
                &label,
                (px, self.bottom + 10.0),
                Anchor::Centre,
                LABEL,
                MUTED,
            )?;
        }
        for y in self.y.ticks(y_ticks) {
            let (_, py) = self.at((self.x.low, y));
            canvas.line(&[(self.left, py), (self.right, py)], GRID, 1.0)?;
            let label = self.y.label(y);
            canvas.text(&label, (self.left - 6.0, py), Anchor::Right, LABEL, MUTED)?;
        }
        Ok(())
    }

    /// The left and lower edge, over what was drawn inside.
    pub(super) fn edges(&self, canvas: &Canvas) -> Result<(), String> {
        let edge = [
            (self.left, self.top),
            (self.left, self.bottom),
            (self.right, self.bottom),
        ];
        canvas.line(&edge, MUTED, 1.0)
    }

    /// Title of the x axis, below its labels.
    pub(super) fn x_title(&self, canvas: &Canvas, title: &str) -> Result<(), String> {
        let middle = 0.5 * (self.left + self.right);
        canvas.text(
            title,
            (middle, self.bottom + 27.0),
            Anchor::Centre,
            LABEL,
            INK,
        )
    }

    /// A curve with rising x, reduced to its visible points and cut at the frame.
    pub(super) fn curve(
        &self,
        canvas: &Canvas,
        points: impl Iterator<Item = (f64, f64)>,
        style: impl Into<Style>,
        width: f64,
    ) -> Result<(), String> {
        let style = style.into();
        let columns = (self.right - self.left) as usize;
        let places = points.map(|point| self.at(point));
        let places = curve::reduce(places, [self.left, self.right], columns);
        let pieces = curve::clip(&places, [self.top, self.bottom]);
        let long = pieces.iter().map(|piece| length(piece)).sum::<f64>() > LONGEST_DASHED;
        let dash = if long { Dash::Solid } else { style.dash };
        for piece in pieces {
            canvas.line(&piece, Style { dash, ..style }, width)?;
        }
        Ok(())
    }

    /// The area between two curves, cut at the frame.
    pub(super) fn band(
        &self,
        canvas: &Canvas,
        points: impl Iterator<Item = (f64, f64, f64)> + Clone,
        colour: RGBColor,
    ) -> Result<(), String> {
        let columns = 0.5 * (self.right - self.left);
        let ends = [self.left, self.right];
        let inside = |(x, y): (f64, f64)| (x, y.clamp(self.top, self.bottom));
        let lows = points.clone().map(|(x, low, _)| inside(self.at((x, low))));
        let highs = points.map(|(x, _, high)| inside(self.at((x, high))));
        let mut outline = curve::reduce(lows, ends, columns as usize);
        let back = curve::reduce(highs, ends, columns as usize);
        outline.extend(back.into_iter().rev());
        canvas.polygon(&outline, colour)
    }

    /// The haptic interval: the area between two curves with its edges.
    pub(super) fn interval(
        &self,
        canvas: &Canvas,
        points: impl Iterator<Item = (f64, f64, f64)> + Clone,
    ) -> Result<(), String> {
        self.band(canvas, points.clone(), BAND)?;
        let low = points.clone().map(|(x, low, _)| (x, low));
        let high = points.map(|(x, _, high)| (x, high));
        self.curve(canvas, low, BAND_EDGE, 0.75)?;
        self.curve(canvas, high, BAND_EDGE, 0.75)
    }
}

#[cfg(test)]
mod tests {
    use super::super::canvas::figure;
    use super::*;
    use maud::Render as _;

    #[test]
    fn ticks_are_round_and_inside_the_axis() {
        assert_eq!(Axis::linear([-0.3, 10.2]).ticks(5), [0.0, 5.0, 10.0]);
        assert_eq!(
            Axis::linear([-40.0, 60.0]).ticks(5),
            [-40.0, -20.0, 0.0, 20.0, 40.0, 60.0]
        );
        assert!(Axis::linear([0.0, 3.0]).ticks(0).is_empty());
        let decades = Axis::log([0.003, 20.0]).ticks(0);
        assert_eq!(decades.len(), 6);
        assert!((decades[0] - 1e-3).abs() < 1e-12 && decades[5] == 100.0);
        assert_eq!(Axis::log_exact([4.0, 500.0]).ticks(0), [10.0, 100.0]);
    }

    #[test]
    fn axis_has_at_least_two_labels() {
        for low in (-40..=40).map(|i| 0.05 * f64::from(i)) {
            for span in (1..=60).map(|i| 0.03 * f64::from(i)) {
                let axis = Axis::linear([low, low + span]);
                for wanted in 1..9 {
                    let ticks = axis.ticks(wanted);
                    assert!(ticks.len() > 1, "{low} {span} {wanted}: {ticks:?}");
                    let inside = |t: &f64| (-1e-6..=1.0 + 1e-6).contains(&axis.part(*t));
                    assert!(ticks.iter().all(inside) && ticks.len() <= wanted + 5);
                }
                let log = Axis::log_exact([span, 2.5 * span]).ticks(0);
                assert!(log.len() > 1 && log.is_sorted_by(|a, b| a < b), "{log:?}");
            }
        }
    }

    #[test]
    fn axis_of_equal_or_huge_values_has_labels() {
        for value in [0.0, 1.0, 1e15, 1e16, 1.7e18, 1e30, 1e300, f64::MAX] {
            for ends in [
                [value, value],
                [-value, -value],
                [-value, value],
                [0.0, value],
            ] {
                let axis = Axis::linear(ends);
                let ticks = axis.ticks(5);
                assert!((2..=10).contains(&ticks.len()), "{ends:?}: {ticks:?}");
                assert!(ticks.is_sorted_by(|a, b| a < b), "{ends:?}: {ticks:?}");
            }
        }
        // Three seconds of a clock from 1970 keep their ends.
        assert_eq!(Axis::linear([1.7e9, 1.7e9 + 3.0]).high, 1.7e9 + 3.0);
    }

    #[test]
    fn curve_that_fills_its_frame_has_no_dashes() {
        let lines = |swings: usize| {
            let plot = Plot {
                left: 0.0,
                top: 0.0,
                right: 400.0,
                bottom: 100.0,
                x: Axis::linear([0.0, swings as f64]),
                y: Axis::linear([0.0, 1.0]),
            };
            let style = Style {
                dash: Dash::Dashed,
                ..INK.into()
            };
            let points = (0..=swings).map(|k| (k as f64, (k % 2) as f64));
            let svg = figure(100.0, "t", |canvas| plot.curve(canvas, points, style, 1.0));
            let svg = svg.unwrap().render().into_string();
            svg.matches("<polyline").count()
        };
        // Each swing has 100 px and more: 10 px for a dash and a gap.
        assert!((1000..2000).contains(&lines(150)), "{}", lines(150));
        assert_eq!(lines(200), 1);
    }

    #[test]
    fn labels_have_the_digits_of_their_ticks() {
        let axis = Axis::linear([-1.0, 1.0]);
        assert_eq!(axis.label(-0.25), "\u{2212}0.25");
        assert_eq!(axis.label(-0.0), "0");
        assert_eq!(axis.label(0.30000000000000004), "0.3");
        let log = Axis::log([1e-4, 1e4]);
        let labels: Vec<_> = log.ticks(0).into_iter().map(|t| log.label(t)).collect();
        assert_eq!(labels[0], "1e-4");
        assert_eq!(labels[2..5], ["0.01", "0.1", "1"]);
        assert_eq!(labels[8], "10000");
    }

    #[test]
    fn ends_of_the_axes_are_the_edges_of_the_frame() {
        let plot = Plot {
            left: 50.0,
            top: 10.0,
            right: 250.0,
            bottom: 110.0,
            x: Axis::log([1.0, 100.0]),
            y: Axis::linear([-1.0, 3.0]),
        };
        let near = |a: (f64, f64), b: (f64, f64)| (a.0 - b.0).abs() + (a.1 - b.1).abs() < 1e-9;
        assert!(near(plot.at((1.0, -1.0)), (50.0, 110.0)));
        assert!(near(plot.at((10.0, 1.0)), (150.0, 60.0)));
        assert!(near(plot.at((100.0, 3.0)), (250.0, 10.0)));
        assert!(plot.at((0.0, 0.0)).0.is_finite());
    }
}
