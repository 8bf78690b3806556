//! Tables of the results for a terminal.

use std::fmt::Write as _;

use super::pool::{Over, block, blocks, on, pool};
use super::rest::{MOTION_RAD_S, REST_RAD_S, REST_S};
use super::run::{Row, Score};
use super::sources::Role;
use crate::distinct::distinct;
use crate::table::layout::{self, Column};
use crate::table::number;
use terminal::wording::wrapped;

/// A column of the details: heading, unit, value.
type Field = (&'static str, &'static str, fn(&Score) -> Option<f64>);

const FIELDS: [Field; 6] = [
    ("rms", "rad/s", |score| score.rms_rad_s),
    ("rms", "% of FD", |score| score.rms_pct),
    ("99 %", "rad/s", |score| score.p99_rad_s),
    ("99 %", "% of FD", |score| score.p99_pct),
    ("delay", "ms", |score| score.delay_ms),
    ("moves", "% of rest", |score| share(score.moving_at_rest)),
];

fn share(share: Option<f64>) -> Option<f64> {
    share.map(|share| 100.0 * share)
}

/// For each resolution and rate: the pooled scores, then the RMS error on each recording. With
/// `details` also every score on each recording. Lines have at most `width` characters.
#[must_use]
pub fn table(rows: &[Row], estimators: &[&'static str], details: bool, width: usize) -> String {
    let mut text = String::new();
    let names = Column::text(
        "",
        "estimator",
        estimators.iter().map(|name| (*name).to_owned()),
    );
    let pooled = pool(rows, estimators);
    for (counts_per_rev, rate_hz) in blocks(rows) {
        let block = || block(rows, counts_per_rev, rate_hz);
        let recordings = distinct(block().map(|row| (row.recording.as_str(), row.role)));
        let choosing = recordings
            .iter()
            .filter(|(_, role)| *role == Role::Chooses)
            .count();
        // Writing to a string cannot fail.
        let _ = writeln!(
            text,
            "{counts_per_rev} counts/rev at {rate_hz} Hz: means over {} recordings",
            recordings.len()
        );
        let legend = format!(
            "Constants were chosen with {choosing} of them, the other {} judge. FD: finite difference. \
             moves: share of estimates above {MOTION_RAD_S} rad/s at rest, which is {REST_S} s of at most \
             {REST_RAD_S} rad/s. of: recordings with the signals that the estimator reads.",
            recordings.len() - choosing
        );
        let _ = writeln!(text, "{}", wrapped(&legend, 0));
        let of = |over: Over, estimator: &str| {
            pooled.iter().find(|pooled| {
                pooled.over == over
                    && pooled.estimator == estimator
                    && pooled.counts_per_rev == counts_per_rev
                    && pooled.rate_hz == rate_hz
            })
        };
        let column = |head: &str, unit: &str, over: Over, field: fn(&Score) -> Option<f64>| {
            let cells = estimators
                .iter()
                .map(|name| number(of(over, name).and_then(|pooled| field(&pooled.score))));
            Column::numbers(head, unit, cells)
        };
        let counted = estimators.iter().map(|name| {
            of(Over::All, name).map_or_else(String::new, |pooled| pooled.recordings.to_string())
        });
        let pct: fn(&Score) -> Option<f64> = |score| score.rms_pct;
        let columns = [
            column("rms", "% of FD", Over::All, pct),
            column("chosen", "% of FD", Over::Chooses, pct),
            column("judging", "% of FD", Over::Judges, pct),
            column("99 %", "% of FD", Over::All, |score| score.p99_pct),
            column("delay", "ms", Over::All, |score| score.delay_ms),
            column("moves", "%", Over::All, |score| share(score.moving_at_rest)),
            Column::numbers("of", "", counted),
        ];
        text += &layout::table(&names, &columns, width);
        text += "\nRMS error on each recording, % of finite difference\n";
        let cells = |recording: &str, field: fn(&Score) -> Option<f64>| -> Vec<String> {
            let score = |name: &&str| on(block(), recording, name);
            let value = |name| number(score(name).as_ref().and_then(field));
            estimators.iter().map(value).collect()
        };
        let columns = recordings.iter().map(|(name, role)| {
            let head = if *role == Role::Chooses {
                "chosen"
            } else {
                "judging"
            };
            Column::numbers(name, head, cells(name, pct).into_iter())
        });
        text += &layout::table(&names, &columns.collect::<Vec<_>>(), width);
        for (recording, _) in recordings.iter().filter(|_| details) {
            let _ = writeln!(text, "\n{recording} at {rate_hz} Hz");
            let columns = FIELDS.map(|(head, unit, field)| {
                Column::numbers(head, unit, cells(recording, field).into_iter())
            });
            text += &layout::table(&names, &columns, width);
        }
        text.push('\n');
    }
    text
}
