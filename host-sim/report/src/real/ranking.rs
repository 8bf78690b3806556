//! Estimators by their mean error, with the error on each recording.

use super::super::canvas::{Anchor, LABEL, Svg, TITLE, WIDTH, figure};
use super::super::palette::{INK, MUTED, Palette};
use super::super::plot::{Axis, Plot};
use super::super::text::number;
use super::SHOWN_PCT;
use catalogue::estimators::Kind;
use experiments::distinct::distinct;
use experiments::real::pool::{block, on};
use experiments::real::run::Row;
use experiments::real::sources::Role;

/// Errors of one estimator, % of finite difference.
pub(in super::super) struct Rank {
    pub(in super::super) estimator: &'static str,
    /// Mean over the recordings on which it ran.
    pub(in super::super) mean: f64,
    /// Error on each recording.
    pub(in super::super) errors: Vec<(Role, f64)>,
}

/// The estimators that ran, the smallest mean error first.
pub(super) fn ranks(
    rows: &[Row],
    estimators: &[&'static str],
    (counts_per_rev, rate_hz): (u32, f64),
) -> Vec<Rank> {
    let block = || block(rows, counts_per_rev, rate_hz);
    let recordings = distinct(block().map(|row| (row.recording.as_str(), row.role)));
    let rank = |&estimator: &&'static str| {
        let error = |(name, role): &(&str, Role)| {
            let error = on(block(), name, estimator)?.rms_pct?;
            error.is_finite().then_some((*role, error))
        };
        let errors: Vec<_> = recordings.iter().filter_map(error).collect();
        let mean = errors.iter().map(|(_, error)| error).sum::<f64>() / errors.len() as f64;
        (!errors.is_empty()).then_some(Rank {
            estimator,
            mean,
            errors,
        })
    };
    let mut ranks: Vec<_> = estimators.iter().filter_map(rank).collect();
    ranks.sort_by(|a, b| a.mean.total_cmp(&b.mean));
    ranks
}

/// The estimators whose velocity is drawn: of those that read only counts, that read edges and that
/// read the current, the two best ones below finite difference. Estimators with the same error are
/// forms of one filter, of which one is drawn.
pub(super) fn drawn(ranks: &[Rank]) -> Vec<&'static str> {
    let class = |rank: &Rank| {
        let needs = Kind::named(rank.estimator).ok()?.needs;
        Some((needs.edge, needs.current))
    };
    let mut drawn: Vec<&Rank> = Vec::new();
    for rank in ranks.iter().filter(|rank| rank.mean < 100.0) {
        let alike = drawn.iter().filter(|other| class(other) == class(rank));
        let known = drawn
            .iter()
            .any(|other| (other.mean / rank.mean - 1.0).abs() < 1e-3);
        if alike.count() < 2 && !known {
            drawn.push(rank);
        }
    }
    drawn.into_iter().map(|rank| rank.estimator).collect()
}

const LEFT: f64 = 190.0;
const TOP: f64 = 52.0;
const LINE: f64 = 19.0;

/// One line per estimator: a mark per recording and a bar at the mean.
pub(in super::super) fn chart(
    ranks: &[Rank],
    title: &str,
    legend: &str,
    palette: &Palette,
) -> Result<Svg, String> {
    let bottom = TOP + LINE * ranks.len() as f64;
    figure(bottom + 44.0, title, |canvas| {
        canvas.text(title, (14.0, 16.0), Anchor::Left, TITLE, INK)?;
        canvas.text(legend, (14.0, 36.0), Anchor::Left, LABEL, MUTED)?;
        let plot = Plot {
            left: LEFT,
            top: TOP,
            right: WIDTH - 70.0,
            bottom,
            x: Axis::log_exact(SHOWN_PCT),
            y: Axis::linear([0.0, 1.0]),
        };
        plot.grid(canvas, 0, 0)?;
        plot.x_title(canvas, "RMS error, % of finite difference")?;
        let x = |error: f64| plot.at((error.clamp(SHOWN_PCT[0], SHOWN_PCT[1]), 0.0)).0;
        for (i, rank) in ranks.iter().enumerate() {
            let y = TOP + LINE * (i as f64 + 0.5);
            canvas.text(rank.estimator, (LEFT - 8.0, y), Anchor::Right, LABEL, INK)?;
            // Judging recordings are drawn over the others.
            for judges in [false, true] {
                let marks = rank
                    .errors
                    .iter()
                    .filter(|(role, _)| (*role == Role::Judges) == judges);
                let style = if judges {
                    palette.style(rank.estimator)
                } else {
                    MUTED.into()
                };
                for (_, error) in marks {
                    let x = x(*error);
                    canvas.rectangle([(x - 2.5, y - 2.5), (x + 2.5, y + 2.5)], style.colour)?;
                }
            }
            let x = x(rank.mean);
            canvas.line(&[(x, y - 7.0), (x, y + 7.0)], INK, 2.0)?;
            canvas.text(
                &number(rank.mean),
                (WIDTH - 60.0, y),
                Anchor::Left,
                LABEL,
                INK,
            )?;
        }
        plot.edges(canvas)
    })
}
