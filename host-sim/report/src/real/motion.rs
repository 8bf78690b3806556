//! The velocity in one second of a recording.

use std::ops::Range;

use super::super::canvas::{Anchor, Key, LABEL, Svg, TITLE, WIDTH, figure, legend_height};
use super::super::palette::{INK, Palette, TRUTH};
use super::super::plot::{Axis, Plot};
use experiments::real::run::Outcome;
use scoring::evaluation::Estimate;
use scoring::percentile;

/// Length of the part that is drawn, s.
const SHOWN_S: f64 = 1.0;

/// Distance of two parts that are compared, s.
const STEP_S: f64 = 0.1;

const LEFT: f64 = 62.0;
const TOP: f64 = 34.0;
const PANEL: f64 = 220.0;

/// Share of the samples whose error is in the frame, if it is not too large.
const SHOWN: f64 = 0.95;

/// Largest room above and below the motion, of the size of the motion: a larger noise leaves the frame.
const ROOM: f64 = 3.0;

/// Room above and below a motion from `low` to `high` for errors of size `error`, rad/s.
fn margin([low, high]: [f64; 2], error: f64) -> f64 {
    let size = (high - low).max(low.abs()).max(high.abs());
    let least = (0.3 * (high - low)).max(0.4 * low.abs().max(high.abs()));
    error.min(ROOM * size).max(least).max(0.05)
}

/// First tick of the part of [`SHOWN_S`] in which the estimates have the largest errors where the truth is known,
/// each relative to its own error over the recording.
pub(super) fn hardest(signals: &Signals, estimates: &[&Estimate]) -> usize {
    let Signals {
        truth,
        known,
        rate_hz,
        ..
    } = *signals;
    let [length, step] = [SHOWN_S, STEP_S].map(|s| (s * rate_hz).round().max(1.0) as usize);
    let sum = |estimate: &Estimate, ticks: Range<usize>| -> f64 {
        let ticks = ticks.filter(|k| known.is_none_or(|known| known[*k]));
        let errors = ticks.map(|k| (f64::from(estimate.velocity[k]) - truth[k]).powi(2));
        errors.sum()
    };
    // Squared errors in pieces of a step. The first one is not scored.
    let mut pieces = vec![0.0; truth.len() / step];
    for estimate in estimates {
        let all = sum(estimate, step.min(truth.len())..truth.len());
        for (k, piece) in pieces.iter_mut().enumerate().filter(|_| all > 0.0) {
            *piece += sum(estimate, k * step..(k + 1) * step) / all;
        }
    }
    let sums = (1..pieces.len().max(2)).map(|first| {
        let part = pieces.iter().skip(first).take(length / step);
        // A shorter part at the end has a smaller sum.
        (first, part.sum::<f64>())
    });
    let best = sums.max_by(|a, b| a.1.total_cmp(&b.1).then(b.0.cmp(&a.0)));
    let first = step * best.map_or(0, |(first, _)| first);
    first.min(truth.len().saturating_sub(length + 1))
}

/// Truth and estimates in the hardest second; `None` without signals.
pub(super) fn chart(
    outcome: &Outcome,
    drawn: &[&'static str],
    palette: &Palette,
) -> Result<Option<Svg>, String> {
    let Some((trace, estimates)) = &outcome.signals else {
        return Ok(None);
    };
    let Some(truth) = &trace.true_omega else {
        return Ok(None);
    };
    let case = &outcome.case;
    let title = format!(
        "{} at {} counts/rev and {} Hz: the second with the largest errors",
        case.name, case.counts_per_rev, trace.rate_hz
    );
    let signals = Signals {
        truth,
        known: None,
        called: "truth",
        estimates,
        rate_hz: trace.rate_hz,
    };
    velocity(&title, &signals, drawn, palette).map(Some)
}

/// The velocities of one recording.
pub(in super::super) struct Signals<'a> {
    /// The velocity that the errors are against, rad/s.
    pub truth: &'a [f64],
    /// Whether it is known at each tick; `None` if at all of them.
    pub known: Option<&'a [bool]>,
    /// What the legend calls it.
    pub called: &'static str,
    /// The estimates.
    pub estimates: &'a [Estimate],
    /// Rate of all signals, Hz.
    pub rate_hz: f64,
}

/// Truth and the estimates `drawn` in the hardest second.
pub(in super::super) fn velocity(
    title: &str,
    signals: &Signals,
    drawn: &[&'static str],
    palette: &Palette,
) -> Result<Svg, String> {
    let Signals {
        truth,
        called,
        estimates,
        rate_hz,
        ..
    } = *signals;
    let mut drawn: Vec<&Estimate> = estimates
        .iter()
        .filter(|estimate| drawn.contains(&estimate.estimator))
        .collect();
    let first = hardest(signals, &drawn);
    let ticks = first..(first + (SHOWN_S * rate_hz) as usize + 1).min(truth.len());
    let part = &truth[ticks.clone()];
    let low = part.iter().copied().fold(f64::INFINITY, f64::min);
    let high = part.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    let error = |estimate: &Estimate, k: usize| f64::from(estimate.velocity[k]) - truth[k];
    let size = |estimate: &&Estimate| percentile(ticks.clone().map(|k| error(estimate, k)), SHOWN);
    // The line with the smallest error is on top.
    drawn.sort_by(|a, b| size(b).total_cmp(&size(a)));
    let margin = margin([low, high], drawn.first().map_or(0.0, size));
    let seconds = |tick: usize| tick as f64 / rate_hz;
    let mut keys = vec![Key::Line(TRUTH.into(), called)];
    keys.extend((drawn.iter()).map(|e| Key::Line(palette.style(e.estimator), e.estimator)));
    let bottom = TOP + PANEL + 46.0;
    figure(bottom + legend_height(&keys, LEFT), title, |canvas| {
        canvas.text(title, (LEFT, 16.0), Anchor::Left, TITLE, INK)?;
        let plot = Plot {
            left: LEFT,
            top: TOP,
            right: WIDTH - 20.0,
            bottom: TOP + PANEL,
            x: Axis::linear([seconds(ticks.start), seconds(ticks.end - 1)]),
            y: Axis::linear([low - margin, high + margin]),
        };
        plot.grid(canvas, 10, 5)?;
        plot.x_title(canvas, "time, s")?;
        let at = (16.0, TOP + 0.5 * PANEL);
        canvas.text("velocity, rad/s", at, Anchor::Upwards, LABEL, INK)?;
        for estimate in &drawn {
            let points = ticks
                .clone()
                .map(|k| (seconds(k), f64::from(estimate.velocity[k])));
            plot.curve(canvas, points, palette.style(estimate.estimator), 1.2)?;
        }
        plot.curve(
            canvas,
            ticks.clone().map(|k| (seconds(k), truth[k])),
            TRUTH,
            1.6,
        )?;
        plot.edges(canvas)?;
        canvas.legend(&keys, (LEFT, bottom))
    })
}

#[cfg(test)]
mod tests {
    use super::margin;

    #[test]
    fn room_around_a_motion_is_that_of_the_errors_within_bounds() {
        for (range, error, room) in [
            ([-2.0, 2.0], 3.0, 3.0),
            // At least 0.3 of the motion, 0.4 of its speed and 0.05 rad/s.
            ([-2.0, 2.0], 0.1, 1.2),
            ([10.0, 11.0], 0.1, 4.4),
            ([0.0, 0.0], 0.0, 0.05),
            // At most three times the motion, or its speed.
            ([-2.0, 2.0], 50.0, 12.0),
            ([10.0, 10.5], 50.0, 31.5),
            ([-2.0, 2.0], f64::INFINITY, 12.0),
        ] {
            let found = margin(range, error);
            assert!((found - room).abs() < 1e-12, "{range:?} {error}: {found}");
        }
    }
}
