//! The page of `robust`: verdicts, and distributions of the results against their limits.

use plotters::style::RGBColor;

use super::canvas::{Anchor, Canvas, Key, LABEL, Svg, TITLE, WIDTH, figure};
use super::page::Printout;
use super::palette::{GRID, INK, MUTED};
use experiments::robust::judge::{FELT_NM, HANDLE_RAD_S};
use experiments::robust::summary::{SceneSummary, Spread};

/// Okabe and Ito's green, orange and red for stable, stopped and violated.
const VERDICTS: [(RGBColor, &str); 3] = [
    (RGBColor(0x00, 0x9e, 0x73), "stable"),
    (RGBColor(0xe6, 0x9f, 0x00), "stopped in time"),
    (RGBColor(0xb0, 0x00, 0x20), "violated"),
];
const SPREAD: RGBColor = RGBColor(0x56, 0xb4, 0xe9);
const LIMIT: RGBColor = VERDICTS[2].0;

/// Sizes, px.
const LEFT: f64 = 110.0;
const TOP: f64 = 84.0;
const ROW: f64 = 30.0;
const GAP: f64 = 36.0;

/// One panel of distributions.
struct Panel<'a> {
    title: &'a str,
    of: fn(&SceneSummary) -> Option<Spread>,
    limit: fn(&SceneSummary) -> Option<f64>,
    factor: f64,
    axis: [f64; 2],
}

const PANELS: [Panel; 4] = [
    Panel {
        title: "handle speed, rad/s",
        of: |scene| Some(scene.handle_rad_s),
        limit: |_| Some(HANDLE_RAD_S),
        factor: 1.0,
        axis: [0.1, 100.0],
    },
    Panel {
        title: "torque felt, mN\u{b7}m",
        of: |scene| Some(scene.felt_nm),
        limit: |_| Some(FELT_NM),
        factor: 1e3,
        axis: [1.0, 1000.0],
    },
    Panel {
        title: "parasitic force, N",
        of: |scene| Some(scene.parasitic_n),
        limit: |_| None,
        factor: 1.0,
        axis: [0.01, 10.0],
    },
    Panel {
        title: "oscillation, RMS, mN\u{b7}m",
        of: |scene| scene.oscillation_nm,
        limit: |scene| Some(scene.oscillation_limit_nm),
        factor: 1e3,
        axis: [0.01, 100.0],
    },
];

/// The page: the figure, then the printed table.
///
/// # Errors
/// If the figure cannot be drawn.
pub fn robust(
    heading: &str,
    scenes: &[SceneSummary],
    printout: &Printout,
) -> Result<String, String> {
    let intro = format!(
        "{heading}. The controller is designed for the nominal device; each run simulates a device \
         that differs from it. The figure shows the verdicts and, over the runs, the largest speed, \
         torque and parasitic force and the remaining oscillation. A bar reaches from the 5th to the \
         95th percentile, its line is the median, the dot is the maximum. Red lines are limits. The \
         numbers below the verdicts count stable, stopped and violated runs."
    );
    Ok(printout.page("Robustness of the loop", &intro, &[chart(scenes)?]))
}

fn chart(scenes: &[SceneSummary]) -> Result<Svg, String> {
    let title = "Closed loop on devices that differ from the nominal one";
    let bottom = TOP + ROW * scenes.len() as f64;
    let share = (WIDTH - LEFT - 20.0 + GAP) / (PANELS.len() + 1) as f64;
    figure(bottom + 34.0, title, |canvas| {
        canvas.text(title, (LEFT, 16.0), Anchor::Left, TITLE, INK)?;
        let keys = VERDICTS.map(|(colour, name)| Key::Line(colour.into(), name));
        canvas.legend(&keys, (LEFT, 38.0))?;
        for (i, scene) in scenes.iter().enumerate() {
            let at = (LEFT - 10.0, TOP + ROW * (i as f64 + 0.5));
            canvas.text(&scene.scene, at, Anchor::Right, LABEL, INK)?;
        }
        verdicts(canvas, scenes, [LEFT, LEFT + share - GAP])?;
        for (i, panel) in PANELS.iter().enumerate() {
            let left = LEFT + share * (i + 1) as f64;
            panel.draw(canvas, scenes, [left, left + share - GAP])?;
        }
        Ok(())
    })
}

fn middle(i: usize) -> f64 {
    TOP + ROW * (i as f64 + 0.5)
}

/// Shares of the verdicts as bars, with their counts.
fn verdicts(
    canvas: &Canvas,
    scenes: &[SceneSummary],
    [left, right]: [f64; 2],
) -> Result<(), String> {
    canvas.text("verdicts", (left, TOP - 18.0), Anchor::Left, LABEL, INK)?;
    for (i, scene) in scenes.iter().enumerate() {
        let whole = scene.counts.iter().sum::<usize>().max(1) as f64;
        let y = middle(i) - 4.0;
        // Drawn from the right; each verdict has a visible width, and stable takes the remainder.
        let mut x = right;
        for (count, (colour, _)) in scene.counts.iter().zip(VERDICTS).rev() {
            let width = ((right - left) * *count as f64 / whole).max(2.0);
            let from = if colour == VERDICTS[0].0 {
                left
            } else {
                x - width
            };
            if *count > 0 {
                canvas.rectangle([(from, y - 5.0), (x, y + 5.0)], colour)?;
                x = from;
            }
        }
        let [stable, stopped, violated] = scene.counts;
        let counts = format!("{stable} / {stopped} / {violated}");
        canvas.text(&counts, (left, y + 12.0), Anchor::Left, 9.5, MUTED)?;
    }
    Ok(())
}

impl Panel<'_> {
    /// Where a value lies on the logarithmic axis: 0 at its left end or below, 1 at its right end or above.
    fn part(&self, value: f64) -> f64 {
        let [low, high] = self.axis;
        let part = (self.factor * value / low).max(1.0).ln() / (high / low).ln();
        part.min(1.0)
    }

    fn draw(
        &self,
        canvas: &Canvas,
        scenes: &[SceneSummary],
        [left, right]: [f64; 2],
    ) -> Result<(), String> {
        let [low, high] = self.axis;
        let place = |value: f64| left + self.part(value) * (right - left);
        canvas.text(self.title, (left, TOP - 18.0), Anchor::Left, LABEL, INK)?;
        let bottom = middle(scenes.len()) - 0.5 * ROW;
        let mut tick = low;
        while tick <= high * 1.001 {
            let x = place(tick / self.factor);
            canvas.line(&[(x, TOP), (x, bottom)], GRID, 1.0)?;
            let text = format!("{tick:.2}");
            let text = text.trim_end_matches('0').trim_end_matches('.');
            canvas.text(text, (x, bottom + 12.0), Anchor::Centre, 9.5, MUTED)?;
            tick *= 10.0;
        }
        for (i, scene) in scenes.iter().enumerate() {
            let y = middle(i);
            if let Some(limit) = (self.limit)(scene) {
                let x = place(limit);
                canvas.line(&[(x, y - 0.5 * ROW), (x, y + 0.5 * ROW)], LIMIT, 1.5)?;
            }
            let Some(spread) = (self.of)(scene) else {
                continue;
            };
            let [from, median, to, far] =
                [spread.low, spread.median, spread.high, spread.largest].map(place);
            canvas.line(&[(to, y), (far, y)], SPREAD, 1.0)?;
            canvas.rectangle([(from, y - 5.0), (to.max(from + 1.0), y + 5.0)], SPREAD)?;
            canvas.line(&[(median, y - 5.0), (median, y + 5.0)], INK, 1.5)?;
            canvas.rectangle([(far - 2.0, y - 2.0), (far + 2.0, y + 2.0)], INK)?;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::canvas::tests::rectangles;

    /// 7 of 10 runs are stable, 2 stopped, 1 violated.
    #[test]
    fn bars_have_the_shares_of_the_verdicts_and_reach_over_90_percent() {
        let spread = Spread {
            low: 1.0,
            median: 3.0,
            high: 10.0,
            largest: 30.0,
        };
        let scene = SceneSummary {
            scene: "wall".into(),
            oscillation_limit_nm: 1e-3,
            counts: [7, 2, 1],
            handle_rad_s: spread,
            large_rad_s: spread,
            felt_nm: spread,
            parasitic_n: spread,
            oscillation_nm: None,
        };
        let svg = chart(&[scene]).unwrap().0;
        let widths = VERDICTS.map(|(colour, _)| rectangles(&svg, colour)[0][2]);
        let whole: f64 = widths.iter().sum();
        for (width, share) in widths.iter().zip([0.7, 0.2, 0.1]) {
            assert!((width / whole - share).abs() < 0.01, "{widths:?}");
        }
        // The speed of the handle is the first panel, of three decades from 0.1 rad/s.
        let [left, _, width, _] = rectangles(&svg, SPREAD)[0];
        let share = (WIDTH - LEFT - 20.0 + GAP) / (PANELS.len() + 1) as f64;
        let decade = (share - GAP) / 3.0;
        assert!((left - (LEFT + share + decade)).abs() < 0.5, "{left}");
        assert!((width - decade).abs() < 0.5, "{width} {decade}");
    }

    #[test]
    fn torques_lie_on_axes_in_millinewtonmetres() {
        // 100 mN.m on 1 to 1000, 1 mN.m on 0.01 to 100, in decades.
        for (panel, value, part) in [(1, 0.1, 2.0 / 3.0), (3, 1e-3, 0.5), (0, 1.0, 1.0 / 3.0)] {
            let found = PANELS[panel].part(value);
            assert!(
                (found - part).abs() < 1e-12,
                "{}: {found}",
                PANELS[panel].title
            );
        }
        assert_eq!([0.0, 1e9].map(|value| PANELS[1].part(value)), [0.0, 1.0]);
    }
}
