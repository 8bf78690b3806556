//! The page of `identify`: measured and simulated velocity, residual, and the confidence interval of
//! each constant.

use super::canvas::{Anchor, Key, LABEL, Svg, TITLE, WIDTH, figure, legend_height};
use super::page::Printout;
use super::palette::{BAND, INK, MUTED, TRUTH};
use super::plot::{Axis, Plot};
use super::text::number;
use experiments::identify::{Identification, ModelComparison, Quantity, SPAN_S};
use plotters::style::RGBColor;

const LEFT: f64 = 70.0;
const RIGHT: f64 = 14.0;
const TOP: f64 = 46.0;
const PANEL: f64 = 220.0;
const RESIDUAL: f64 = 130.0;
const ROW: f64 = 34.0;
/// Room for the keys of the device file.
const NAMES: f64 = 230.0;

const MODEL: RGBColor = RGBColor(0xd5, 0x5e, 0x00);

/// The page: a figure for each recording, one of the constants, then the printed table.
/// `count_rad_s` is one count over [`SPAN_S`], rad/s.
///
/// # Errors
/// If a figure cannot be drawn.
pub fn identify(
    found: &Identification,
    count_rad_s: f64,
    printout: &Printout,
) -> Result<String, String> {
    let motions = found.comparisons.iter();
    let motions = motions.map(|comparison| motion(comparison, count_rad_s));
    let figures: Vec<Svg> = motions
        .chain([constants(&found.quantities)])
        .collect::<Result<_, _>>()?;
    let intro = format!(
        "The identified model of the motor is simulated with the measured current and handle position, \
         without the measured motor position. Both velocities are displacements over {:.0} ms, \
         divided by that time; the green band is one count over that time. The components that repeat once a \
         turn are fitted, but this model does not contain them: they remain in the residual.",
        1e3 * SPAN_S
    );
    Ok(printout.page("Identification", &intro, &figures))
}

/// Velocities, and below them their difference.
fn motion(comparison: &ModelComparison, count_rad_s: f64) -> Result<Svg, String> {
    let residual: Vec<f64> = comparison
        .measured
        .iter()
        .zip(&comparison.model)
        .map(|(measured, model)| measured - model)
        .collect();
    let largest = |values: &[f64]| values.iter().fold(0.0_f64, |most, v| most.max(v.abs()));
    let rms = (residual.iter().map(|r| r * r).sum::<f64>() / residual.len().max(1) as f64).sqrt();
    let keys = [
        Key::Line(TRUTH.into(), "measured"),
        Key::Line(MODEL.into(), "model"),
        Key::Band("one count"),
    ];
    let below = TOP + PANEL + 34.0;
    let bottom = below + RESIDUAL;
    let height = bottom + 50.0 + legend_height(&keys, LEFT);
    let title = format!(
        "{}: velocity of the large motor; residual {rms:.2} rad/s RMS",
        comparison.name
    );
    let ends = [
        &comparison.t[..1],
        &comparison.t[comparison.t.len().saturating_sub(1)..],
    ]
    .concat();
    let [first, last] = ends[..] else {
        return Err(format!(
            "{}: the recording has no samples to draw",
            comparison.name
        ));
    };
    figure(height, &title, |canvas| {
        canvas.text(&title, (LEFT, 16.0), Anchor::Left, TITLE, INK)?;
        let span = 1.05 * largest(&comparison.measured).max(largest(&comparison.model));
        let plot = |top, height, span: f64| Plot {
            left: LEFT,
            top,
            right: WIDTH - RIGHT,
            bottom: top + height,
            x: Axis::linear([first, last]),
            y: Axis::linear([-span, span]),
        };
        let at = |values: &[f64]| -> Vec<(f64, f64)> {
            comparison
                .t
                .iter()
                .copied()
                .zip(values.iter().copied())
                .collect()
        };
        let upper = plot(TOP, PANEL, span);
        upper.grid(canvas, 6, 6)?;
        upper.curve(canvas, at(&comparison.measured).into_iter(), TRUTH, 2.0)?;
        upper.curve(canvas, at(&comparison.model).into_iter(), MODEL, 1.2)?;
        upper.edges(canvas)?;
        let lower = plot(below, RESIDUAL, 1.05 * largest(&residual).max(count_rad_s));
        lower.grid(canvas, 6, 4)?;
        let band = comparison.t.iter().map(|t| (*t, -count_rad_s, count_rad_s));
        lower.band(canvas, band, BAND)?;
        lower.curve(canvas, at(&residual).into_iter(), INK, 1.0)?;
        lower.edges(canvas)?;
        lower.x_title(canvas, "time, s")?;
        for (plot, name) in [(&upper, "velocity, rad/s"), (&lower, "residual, rad/s")] {
            let middle = 0.5 * (plot.top + plot.bottom);
            canvas.text(name, (16.0, middle), Anchor::Upwards, LABEL, INK)?;
        }
        canvas.legend(&keys, (LEFT, bottom + 42.0))
    })
}

/// Each constant that the device has so far, its value and the half-width of its interval, both relative to the
/// value so far: that of the device file, or its default.
fn relative(quantities: &[Quantity]) -> Vec<(&Quantity, f64, f64)> {
    let there = quantities.iter().filter(|quantity| quantity.file != 0.0);
    there
        .map(|q| (q, q.estimate.value / q.file, q.estimate.half / q.file.abs()))
        .collect()
}

/// The text in the place of the mark of a ratio beyond the axis, and the end of the axis at which it stands.
fn beyond(ratio: f64, axis: Axis) -> Option<(String, Anchor)> {
    let times = number(ratio);
    match ratio {
        _ if ratio < axis.low => Some((format!("\u{2190} {times} times"), Anchor::Left)),
        _ if ratio > axis.high => Some((format!("{times} times \u{2192}"), Anchor::Right)),
        _ => None,
    }
}

/// Each constant relative to its value so far, with its 95 % interval.
fn constants(quantities: &[Quantity]) -> Result<Svg, String> {
    let parts = relative(quantities);
    let accepted = || parts.iter().filter(|(q, ..)| q.rejected.is_none());
    let reach = accepted().map(|(_, part, half)| (part - 1.0).abs() + half);
    let span = (1.15 * reach.fold(0.05, f64::max)).min(1.0);
    let height = TOP + ROW * parts.len() as f64;
    let title = "Identified value relative to that of the device so far, with 95 % intervals";
    figure(height + 50.0, title, |canvas| {
        canvas.text(title, (LEFT, 16.0), Anchor::Left, TITLE, INK)?;
        let plot = Plot {
            left: NAMES,
            top: TOP,
            right: WIDTH - RIGHT,
            bottom: height,
            x: Axis::linear([1.0 - span, 1.0 + span]),
            y: Axis::linear([0.0, parts.len() as f64]),
        };
        plot.grid(canvas, 6, 0)?;
        canvas.line(
            &[plot.at((1.0, 0.0)), plot.at((1.0, plot.y.high))],
            INK,
            1.5,
        )?;
        for (i, (quantity, part, half)) in parts.iter().enumerate() {
            let y = TOP + ROW * (i as f64 + 0.5);
            let colour = if quantity.rejected.is_some() {
                MUTED
            } else {
                INK
            };
            canvas.text(
                quantity.key,
                (NAMES - 10.0, y),
                Anchor::Right,
                LABEL,
                colour,
            )?;
            if quantity.rejected.is_some() {
                let (x, _) = plot.at((1.0 - 0.95 * span, 0.0));
                canvas.text(
                    "not identifiable, see below",
                    (x, y),
                    Anchor::Left,
                    LABEL,
                    MUTED,
                )?;
                continue;
            }
            if let Some((text, anchor)) = beyond(*part, plot.x) {
                let ends = [plot.left + 8.0, plot.right - 8.0];
                let x = ends[usize::from(anchor == Anchor::Right)];
                canvas.text(&text, (x, y), anchor, LABEL, MODEL)?;
                continue;
            }
            let x = |value: f64| plot.at((value.clamp(plot.x.low, plot.x.high), 0.0)).0;
            let [low, at, high] = [part - half, *part, part + half].map(x);
            canvas.line(&[(low, y), (high, y)], MODEL, 2.0)?;
            for end in [low, high] {
                canvas.line(&[(end, y - 5.0), (end, y + 5.0)], MODEL, 2.0)?;
            }
            canvas.line(&[(at, y - 8.0), (at, y + 8.0)], INK, 2.5)?;
        }
        plot.edges(canvas)?;
        plot.x_title(
            canvas,
            "identified value / value in the device file, or its default",
        )
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use experiments::identify::{Estimate, Unit};

    #[test]
    fn ratio_beyond_the_axis_is_a_text_at_its_end() {
        let axis = Axis::linear([0.5, 1.5]);
        let text = |ratio| beyond(ratio, axis).map(|(text, _)| text);
        assert_eq!(text(0.5), None);
        assert_eq!(text(1.5), None);
        let (right, anchor) = beyond(16.3, axis).unwrap();
        assert!(right.starts_with("16.3 times") && anchor == Anchor::Right);
        let (left, anchor) = beyond(-2.0, axis).unwrap();
        assert!(
            left.ends_with("\u{2212}2.00 times") && anchor == Anchor::Left,
            "{left}"
        );
    }

    #[test]
    fn constants_are_relative_to_the_values_of_the_file() {
        let quantity = |file| Quantity {
            key: "large.coulomb_nm",
            estimate: Estimate {
                value: 3.0,
                half: 0.5,
                by_counts: false,
            },
            file,
            unit: Unit {
                name: "mN.m",
                per_si: 1e3,
                si: "N.m",
            },
            rejected: None,
            vague: false,
        };
        let all = [2.0, 0.0, -4.0].map(quantity);
        let found = relative(&all);
        let found: Vec<_> = found.iter().map(|(_, part, half)| [*part, *half]).collect();
        assert_eq!(found, [[1.5, 0.25], [-0.75, 0.125]]);
    }
}
