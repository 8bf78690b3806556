//! Damping of the coupler over time, true and identified.

use super::CaseReport;
use super::canvas::{Anchor, Key, LABEL, Svg, TITLE, WIDTH, figure, legend_height};
use super::palette::{INK, Palette};
use super::plot::{Axis, Plot};
use super::text::{plant, rate};
use experiments::compare::Damping;

const LEFT: f64 = 62.0;
const TOP: f64 = 46.0;
const PANEL: f64 = 240.0;

/// One panel: the truth in black, each estimator in its colour.
pub(super) fn chart(
    case: &CaseReport,
    damping: &Damping,
    palette: &Palette,
) -> Result<Svg, String> {
    let mut keys = vec![Key::Line(INK.into(), "true")];
    let names = damping.learned.iter().map(|(name, _)| *name);
    keys.extend(names.map(|name| Key::Line(palette.style(name), name)));
    let highest = damping.truth.iter().copied().fold(0.0, f64::max);
    let title = format!(
        "Damping in {} at {}, plant {}",
        case.scenario,
        rate(case.rate_hz),
        plant(case.friction)
    );
    let bottom = TOP + PANEL;
    let height = bottom + 56.0 + legend_height(&keys, LEFT);
    figure(height, &title, |canvas| {
        canvas.text(&title, (LEFT, 16.0), Anchor::Left, TITLE, INK)?;
        let seconds = damping.truth.len() as f64 * Damping::STEP_S;
        let plot = Plot {
            left: LEFT,
            top: TOP,
            right: WIDTH - 14.0,
            bottom,
            x: Axis::linear([0.0, seconds]),
            y: Axis::linear([0.5 * 1e3 * highest, 1.25 * 1e3 * highest]),
        };
        plot.grid(canvas, 6, 6)?;
        plot.x_title(canvas, "time, s")?;
        let at = (16.0, 0.5 * (TOP + bottom));
        let unit = "damping b, mN\u{b7}m\u{b7}s/rad";
        canvas.text(unit, at, Anchor::Upwards, LABEL, INK)?;
        let curve = |values: &[f64]| {
            let points = values.iter().enumerate();
            let points: Vec<_> = points
                .map(|(i, b)| (i as f64 * Damping::STEP_S, 1e3 * b))
                .collect();
            points.into_iter()
        };
        for (name, learned) in &damping.learned {
            plot.curve(canvas, curve(learned), palette.style(name), 1.5)?;
        }
        plot.curve(canvas, curve(&damping.truth), INK, 2.0)?;
        plot.edges(canvas)?;
        canvas.legend(&keys, (LEFT, bottom + 46.0))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn true_and_identified_damping_are_drawn_and_named() {
        let damping = Damping {
            truth: vec![1e-3, 0.9e-3, 0.8e-3],
            learned: vec![("adaptive", vec![1e-3, 0.95e-3, 0.8e-3])],
        };
        let palette = Palette::of(std::iter::once("adaptive"));
        let svg = chart(&CaseReport::default(), &damping, &palette).unwrap().0;
        assert!(svg.contains("true") && svg.contains("adaptive"));
        // The axis is from half to 1.25 times the highest value, which is at two thirds of its height.
        let y = |milli: f64| TOP + PANEL * (1.25 - milli) / 0.75;
        let x = |k: f64| LEFT + (WIDTH - 14.0 - LEFT) * k / 3.0;
        for (colour, values) in [
            (INK, [1.0, 0.9, 0.8]),
            (palette.style("adaptive").colour, [1.0, 0.95, 0.8]),
        ] {
            let lines = crate::canvas::tests::points(&svg, "polyline", colour);
            let points: Vec<_> = lines.into_iter().flatten().collect();
            for (k, value) in [0.0, 1.0, 2.0].into_iter().zip(values) {
                let is_near = |point: &&(f64, f64)| {
                    (point.0 - x(k)).abs() < 0.5 && (point.1 - y(value)).abs() < 0.5
                };
                assert!(
                    points.iter().any(|point| is_near(&point)),
                    "{value}: {points:?}"
                );
            }
        }
    }
}
