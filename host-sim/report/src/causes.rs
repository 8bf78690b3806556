//! Stacked bars of the parasitic force by cause: whole, and from 50 to 500 Hz.

use super::canvas::{
    Anchor, Canvas, Key, LABEL, Svg, TITLE, WIDTH, figure, legend_height, text_width,
};
use super::palette::{GRID, INK, MUTED, cause_style};
use super::plot::{Axis, Plot};
use super::text::{number, tactile_band};
use experiments::transparency::{Attribution, Cause, Part};

/// Sizes, px.
const ROW: f64 = 13.0;
const BAR: f64 = 8.0;
const HEADING: f64 = 20.0;
const GAP: f64 = 64.0;
/// Room for the number beside a bar.
const NUMBER: f64 = 34.0;
/// Narrowest part of a bar that is drawn.
const LEAST: f64 = 0.25;

/// Explanation of the bars.
pub(super) const EXPLANATION: &str = "Each bar is the RMS parasitic force of a run, divided among its \
    causes: a part has the length of the cause\u{2019}s share of the mean square, times the RMS. The \
    shares add up to 1. The share of a cause that opposes the others is negative and lies left of zero; \
    the black mark is the RMS. The line is the threshold of a fingertip. Left the whole force, right its \
    components that a fingertip feels as roughness. Inertia and friction are those of the handle and the \
    small motor; slip is what the velocity loop leaves of the coupler\u{2019}s torque; sampling is the \
    command that has not acted yet at the tick.";

/// One bar.
pub(super) struct Bar<'a> {
    pub(super) label: &'a str,
    pub(super) attribution: &'a Attribution,
}

/// Bars below a heading.
pub(super) struct Block<'a> {
    pub(super) heading: String,
    pub(super) bars: Vec<Bar<'a>>,
}

/// What a panel shows of an attribution.
struct Panel {
    title: String,
    whole: fn(&Attribution) -> Option<f64>,
    share: fn(&Part) -> Option<f64>,
}

/// Forces of the parts of a bar, mN, in the order of the causes.
fn parts(panel: &Panel, attribution: &Attribution) -> Vec<(Cause, f64)> {
    let whole = (panel.whole)(attribution).unwrap_or(0.0);
    let each = Cause::ALL.into_iter().zip(&attribution.parts);
    each.map(|(cause, part)| (cause, whole * (panel.share)(part).unwrap_or(0.0)))
        .collect()
}

/// The stacked bars of one scene; `None` without a bar.
pub(super) fn stacked(
    title: &str,
    blocks: &[Block],
    threshold_mn: f64,
) -> Result<Option<Svg>, String> {
    let all = || blocks.iter().flat_map(|block| &block.bars);
    if all().next().is_none() {
        return Ok(None);
    }
    let panels = [
        Panel {
            title: "parasitic force, mN RMS".to_owned(),
            whole: |found| Some(found.rms_mn),
            share: |part| part.share,
        },
        Panel {
            title: format!("{}, mN RMS", tactile_band()),
            whole: |found| found.tactile_mn,
            share: |part| part.tactile_share,
        },
    ];
    let keys: Vec<Key> = (Cause::ALL.into_iter())
        .map(|cause| Key::Line(cause_style(cause), cause.name()))
        .chain([Key::Line(INK.into(), "threshold of a fingertip")])
        .collect();
    let widest = all().map(|bar| text_width(bar.label, LABEL));
    let left = widest.fold(0.0, f64::max) + 16.0;
    let top = 34.0 + legend_height(&keys, left) + 10.0;
    let height = |block: &Block| HEADING + ROW * block.bars.len() as f64;
    let bottom = top + blocks.iter().map(height).sum::<f64>() + 4.0;
    let width = (WIDTH - left - 24.0 - GAP) / 2.0;
    let svg = figure(bottom + 40.0, title, |canvas| {
        canvas.text(title, (left, 16.0), Anchor::Left, TITLE, INK)?;
        canvas.legend(&keys, (left, 40.0))?;
        for (i, panel) in panels.iter().enumerate() {
            let mut ends = [0.0_f64, 1.05 * threshold_mn];
            for bar in all() {
                let parts = parts(panel, bar.attribution);
                let sum =
                    |sign: f64| -> f64 { parts.iter().map(|(_, mn)| (sign * mn).max(0.0)).sum() };
                ends = [ends[0].min(-sum(-1.0)), ends[1].max(sum(1.0))];
            }
            let left = left + i as f64 * (width + GAP);
            let plot = Plot {
                left,
                top,
                right: left + width - NUMBER,
                bottom,
                x: Axis::linear(ends),
                y: Axis::linear([0.0, 1.0]),
            };
            for tick in plot.x.ticks(5) {
                let (x, _) = plot.at((tick, 0.0));
                canvas.line(&[(x, top), (x, bottom)], GRID, 1.0)?;
                let at = (x, bottom + 10.0);
                canvas.text(&plot.x.label(tick), at, Anchor::Centre, LABEL, MUTED)?;
            }
            let mut y = top;
            for block in blocks {
                let at = (left, y + 0.5 * HEADING);
                canvas.text(&block.heading, at, Anchor::Left, 12.0, INK)?;
                y += HEADING;
                for bar in &block.bars {
                    if i == 0 {
                        let at = (left - 8.0, y + 0.5 * ROW);
                        canvas.text(bar.label, at, Anchor::Right, LABEL, INK)?;
                    }
                    draw(canvas, &plot, y + 0.5 * ROW, panel, bar.attribution)?;
                    y += ROW;
                }
            }
            for (mn, width) in [(0.0, 1.0), (threshold_mn, 1.6)] {
                let (x, _) = plot.at((mn, 0.0));
                canvas.line(&[(x, top), (x, bottom)], INK, width)?;
            }
            plot.x_title(canvas, &panel.title)?;
        }
        Ok(())
    })?;
    Ok(Some(svg))
}

fn draw(
    canvas: &Canvas,
    plot: &Plot,
    y: f64,
    panel: &Panel,
    attribution: &Attribution,
) -> Result<(), String> {
    let Some(whole) = (panel.whole)(attribution) else {
        return Ok(());
    };
    let x = |mn: f64| plot.at((mn, 0.0)).0;
    // Sum of the positive parts, and of the negative ones.
    let mut ends = [0.0, 0.0];
    for (cause, mn) in parts(panel, attribution) {
        let end = &mut ends[usize::from(mn < 0.0)];
        let (from, to) = (x(*end), x(*end + mn));
        *end += mn;
        if (to - from).abs() >= LEAST {
            let corners = [(from.min(to), y - 0.5 * BAR), (from.max(to), y + 0.5 * BAR)];
            canvas.rectangle(corners, cause_style(cause))?;
        }
    }
    let mark = x(whole);
    canvas.line(&[(mark, y - 0.5 * ROW), (mark, y + 0.5 * ROW)], INK, 1.6)?;
    let at = (x(ends[0]).max(mark) + 5.0, y);
    canvas.text(&number(whole), at, Anchor::Left, LABEL, MUTED)
}

#[cfg(test)]
mod tests {
    use super::*;
    use experiments::transparency::attribution::CAUSES;

    /// Friction 1.2 of the mean square, slip -0.2; the tactile band has inertia alone.
    fn attribution() -> Attribution {
        let mut parts = [Part::default(); CAUSES];
        for (cause, part) in Cause::ALL.iter().zip(&mut parts) {
            part.share = match cause {
                Cause::Friction => Some(1.2),
                Cause::Slip => Some(-0.2),
                _ => Some(0.0),
            };
            part.tactile_share = Some(if *cause == Cause::Inertia { 1.0 } else { 0.0 });
        }
        Attribution {
            rms_mn: 20.0,
            tactile_mn: Some(5.0),
            parts,
        }
    }

    #[test]
    fn bar_has_its_parts_on_both_sides_of_zero_and_its_rms() {
        let attribution = attribution();
        let bar = Bar {
            label: "a < b",
            attribution: &attribution,
        };
        let blocks = [Block {
            heading: "1 kHz".to_owned(),
            bars: vec![bar],
        }];
        let svg = stacked("Scene", &blocks, 10.0).unwrap().unwrap().0;
        let rectangles = |cause| {
            let super::super::style::Style { colour, .. } = cause_style(cause);
            let hex = format!("#{:02X}{:02X}{:02X}", colour.0, colour.1, colour.2);
            let tags = svg.split("<rect").filter_map(|rest| rest.split('>').next());
            let widths = tags.filter(move |tag| tag.contains(&hex));
            let width = |rect: &str| -> f64 {
                let from = rect.split("width=\"").nth(1).unwrap();
                from.split('"').next().unwrap().parse().unwrap()
            };
            widths.map(width).collect::<Vec<_>>()
        };
        let [friction, slip, inertia] =
            [Cause::Friction, Cause::Slip, Cause::Inertia].map(rectangles);
        assert_eq!(
            (friction.len(), slip.len(), inertia.len()),
            (1, 1, 1),
            "{svg}"
        );
        // 24 mN and 4 mN on one scale; corners are rounded to a quarter of a pixel.
        assert!(
            (friction[0] / slip[0] - 6.0).abs() < 0.2,
            "{friction:?} {slip:?}"
        );
        assert!(
            svg.contains(">\n20.0\n") && svg.contains(">\n5.00\n"),
            "{svg}"
        );
        assert!(svg.contains("a &lt; b") && svg.contains("50 to 500 Hz"));
        assert!(stacked("Scene", &[], 10.0).unwrap().is_none());
    }
}
