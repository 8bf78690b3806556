//! Commanded force and force at the fingertip over time, a figure for each scene.

use std::ops::Range;

use super::super::canvas::{Key, Svg};
use super::super::palette::{MUTED, Palette, TRUTH};
use super::super::plot::Axis;
use super::super::text::{number, plant, rate};
use super::charts::{Curve, Green, Panel, panels};
use super::{ClosedLoop, best, find, uses_velocity};
use catalogue::estimators::DIFFERENCE;
use catalogue::parameters::PlantKind;
use experiments::transparency::{Outcome, REFERENCE, Run, Signals};
use scoring::score::skipped;

/// One figure for each scene but `off`, in the order of the scenes.
pub(super) fn figures(
    closed: &ClosedLoop,
    palette: &Palette,
    threshold_mn: f64,
) -> Result<Vec<Svg>, String> {
    let mut scenes: Vec<&str> = Vec::new();
    for outcome in &closed.outcomes {
        let scene = outcome.case.scene.name();
        if scene != "off" && !scenes.contains(&scene) {
            scenes.push(scene);
        }
    }
    let mut svgs = Vec::new();
    for scene in scenes {
        svgs.extend(figure(scene, &closed.of(scene), palette, threshold_mn)?);
    }
    Ok(svgs)
}

fn figure(
    scene: &str,
    outcomes: &[&Outcome],
    palette: &Palette,
    threshold_mn: f64,
) -> Result<Option<Svg>, String> {
    let shown: Vec<(f64, Vec<&Run>)> = (outcomes.iter())
        .map(|outcome| (outcome.case.rate_hz, chosen(outcome)))
        .filter(|(_, runs)| !runs.is_empty())
        .collect();
    let Some((first_hz, runs)) = shown.first() else {
        return Ok(None);
    };
    let span_s = if scene == "texture" { 0.04 } else { 0.4 };
    // The window of the reference at the lowest rate serves all, in seconds.
    let signals = runs.last().and_then(|run| run.signals.as_ref());
    let Some(at_s) = signals.and_then(|signals| busiest(signals, *first_hz, span_s)) else {
        return Ok(None);
    };
    let columns = if uses_velocity(outcomes[0]) {
        runs.len()
    } else {
        shown.len()
    };
    let window = |rate_hz: f64| -> Range<usize> {
        let [from, to] = [at_s, at_s + span_s].map(|t| (t * rate_hz).round() as usize);
        from..to + 1
    };
    let mut low_high = [f64::INFINITY, f64::NEG_INFINITY];
    for (rate_hz, runs) in &shown {
        for signals in runs.iter().filter_map(|run| run.signals.as_ref()) {
            let Some(wanted) = signals.wanted_mn.get(window(*rate_hz)) else {
                return Ok(None);
            };
            for &w in wanted {
                low_high[0] = low_high[0].min(f64::from(w));
                low_high[1] = low_high[1].max(f64::from(w));
            }
        }
    }
    let room = (0.3 * (low_high[1] - low_high[0])).max(4.0 * threshold_mn);
    let y = Axis::linear([low_high[0] - room, low_high[1] + room]);
    let mut all = Vec::new();
    for (rate_hz, runs) in &shown {
        for run in runs {
            let Some(signals) = &run.signals else {
                continue;
            };
            let mut panel = panel(
                run,
                signals,
                window(*rate_hz),
                *rate_hz,
                threshold_mn,
                palette,
            );
            panel.y = y;
            all.push(panel);
        }
    }
    let keys = [
        Key::Line(TRUTH.into(), "commanded force"),
        Key::Band("threshold of a fingertip"),
        Key::Line(MUTED.into(), "felt, in the colour of the velocity source"),
    ];
    let plant = plant(outcomes[0].case.plant == PlantKind::Friction);
    let title = format!("Commanded and felt force at the fingertip, scene {scene}, plant {plant}");
    panels(&title, &keys, columns, 150.0, &all).map(Some)
}

/// Runs with signals of finite difference, of the best other estimator and of the reference encoder.
fn chosen(outcome: &Outcome) -> Vec<&Run> {
    let difference = find(outcome, DIFFERENCE);
    let best = best(outcome, |name| name != DIFFERENCE);
    let mut runs: Vec<&Run> = Vec::new();
    for run in [difference, best, find(outcome, REFERENCE)]
        .into_iter()
        .flatten()
    {
        if run.signals.is_some() && !runs.iter().any(|r| r.controlled_by == run.controlled_by) {
            runs.push(run);
        }
    }
    runs
}

/// Start of the window in which the commanded force covers the widest range, s.
fn busiest(signals: &Signals, rate_hz: f64, span_s: f64) -> Option<f64> {
    let span = (span_s * rate_hz).round() as usize;
    let first = skipped(rate_hz);
    let last = signals.wanted_mn.len().checked_sub(span + 2)?;
    let range = |from: usize| {
        let window = &signals.wanted_mn[from..=from + span];
        let low = window.iter().copied().fold(f32::INFINITY, f32::min);
        window.iter().copied().fold(f32::NEG_INFINITY, f32::max) - low
    };
    let starts = (first..=last).step_by(span.div_ceil(4).max(1));
    let best = starts.max_by(|&a, &b| range(a).total_cmp(&range(b)).then(b.cmp(&a)))?;
    Some(best as f64 / rate_hz)
}

fn panel<'a>(
    run: &Run,
    signals: &Signals,
    window: Range<usize>,
    rate_hz: f64,
    threshold_mn: f64,
    palette: &Palette,
) -> Panel<'a> {
    let start = window.start;
    let time = |k: usize| 1e3 * (k - start) as f64 / rate_hz;
    let series = |of: &[f32]| -> Vec<(f64, f64)> {
        window
            .clone()
            .map(|k| (time(k), f64::from(of[k])))
            .collect()
    };
    let wanted = series(&signals.wanted_mn);
    let around = wanted
        .iter()
        .map(|&(t, w)| (t, w - threshold_mn, w + threshold_mn));
    let colour = match run.controlled_by {
        "any" => MUTED.into(),
        name => palette.style(name),
    };
    let rms = run
        .parasitic
        .parasitic_mn_rms
        .map_or_else(String::new, number);
    Panel {
        heading: format!("{}, {}: {rms}\u{a0}mN", run.controlled_by, rate(rate_hz)),
        x: Axis::linear([0.0, time(window.end - 1)]),
        y: Axis::linear([0.0, 1.0]),
        ticks: [4, 5],
        x_title: "time, ms",
        y_title: "force, mN",
        green: Green::Around(around.collect()),
        curves: vec![
            Curve::new(TRUTH, wanted.clone()),
            Curve {
                width: 1.3,
                ..Curve::new(colour, series(&signals.felt_mn))
            },
        ],
    }
}

#[cfg(test)]
mod tests {
    use super::super::tests::{outcome, run};
    use super::*;
    use haptic_control::SceneKind;

    #[test]
    fn runs_are_those_of_finite_difference_the_best_other_one_and_the_reference() {
        let runs = vec![
            run("pll", 9.0, 0.5),
            run("low-pass", 7.0, 0.5),
            run("finite-difference", 5.0, 0.5),
            run(REFERENCE, 1.0, 0.5),
        ];
        let outcome = outcome(SceneKind::Wall, 1e3, runs);
        let names: Vec<_> = chosen(&outcome)
            .iter()
            .map(|run| run.controlled_by)
            .collect();
        assert_eq!(names, ["finite-difference", "low-pass", REFERENCE]);
    }

    /// 2 s at 1 kHz: a small force that rises slowly, and a push from 1.2 to 1.3 s.
    #[test]
    fn window_has_the_widest_range_of_the_command() {
        let force = |k: i32| {
            if (1200..1300).contains(&k) {
                -300.0
            } else {
                0.01 * k as f32
            }
        };
        let signals = Signals {
            wanted_mn: (0..2000).map(force).collect(),
            ..Signals::default()
        };
        let at_s = busiest(&signals, 1e3, 0.4).unwrap();
        assert!((0.8..1.3).contains(&at_s), "{at_s}");
        // Shorter than the window.
        assert_eq!(busiest(&signals, 1e3, 2.0), None);
        let run = run("pll", 1.0, 0.5);
        let signals = Signals {
            felt_mn: signals.wanted_mn.iter().map(|mn| mn + 1.0).collect(),
            ..signals
        };
        let palette = Palette::of(["pll"].into_iter());
        let panel = panel(&run, &signals, 1100..1301, 1e3, 10.0, &palette);
        let [wanted, felt] = &panel.curves[..] else {
            panic!("two curves");
        };
        assert_eq!((wanted.points.len(), wanted.points[0]), (201, (0.0, 11.0)));
        assert_eq!(
            (wanted.points[150], felt.points[150]),
            ((150.0, -300.0), (150.0, -299.0))
        );
    }
}
