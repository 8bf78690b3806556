//! Means over phases and recordings.

use serde::Serialize;

use super::run::{Row, Score};
use super::sources::Role;
use crate::distinct::distinct;

/// Which recordings are pooled.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Over {
    /// All.
    All,
    /// Those with which constants were chosen.
    Chooses,
    /// Those with which no constant was chosen.
    Judges,
}

impl Over {
    /// All groups, in the order of the tables.
    pub const EACH: [Self; 3] = [Self::All, Self::Chooses, Self::Judges];

    fn has(self, role: Role) -> bool {
        match self {
            Self::All => true,
            Self::Chooses => role == Role::Chooses,
            Self::Judges => role == Role::Judges,
        }
    }
}

/// Mean scores of one estimator over recordings: an object of the JSON output.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Pooled {
    /// Which recordings.
    pub over: Over,
    /// Resolution of the coarsened recordings, counts per revolution.
    pub counts_per_rev: u32,
    /// Rate, Hz.
    pub rate_hz: f64,
    /// Estimator.
    pub estimator: &'static str,
    /// Number of recordings on which the estimator ran.
    pub recordings: usize,
    /// Number of recordings that lack a signal which the estimator reads.
    pub left_out: usize,
    /// Means over the recordings, of each the mean over its phases.
    #[serde(flatten)]
    pub score: Score,
}

/// The rows of one table: those of the coarsened recordings at this resolution and rate, and those of
/// the coarse recordings at this rate.
pub fn block(
    rows: &[Row],
    counts_per_rev: u32,
    rate_hz: f64,
) -> impl Iterator<Item = &Row> + Clone {
    rows.iter().filter(move |row| {
        row.rate_hz == rate_hz && (row.phase.is_none() || row.counts_per_rev == counts_per_rev)
    })
}

/// Resolutions and rates of `rows`, in order of appearance. Coarse recordings have none of their own,
/// unless there are no others.
#[must_use]
pub fn blocks(rows: &[Row]) -> Vec<(u32, f64)> {
    let coarsened = rows.iter().filter(|row| row.phase.is_some());
    let found = distinct(coarsened.map(|row| (row.counts_per_rev, row.rate_hz)));
    match found.is_empty() {
        true => distinct(rows.iter().map(|row| (row.counts_per_rev, row.rate_hz))),
        false => found,
    }
}

/// The mean of each score over the values that are there.
#[must_use]
pub fn mean(scores: &[Score]) -> Score {
    let of = |field: fn(&Score) -> Option<f64>| {
        let values: Vec<f64> = scores.iter().filter_map(field).collect();
        (!values.is_empty()).then(|| values.iter().sum::<f64>() / values.len() as f64)
    };
    Score {
        rms_rad_s: of(|score| score.rms_rad_s),
        rms_pct: of(|score| score.rms_pct),
        p99_rad_s: of(|score| score.p99_rad_s),
        p99_pct: of(|score| score.p99_pct),
        delay_ms: of(|score| score.delay_ms),
        moving_at_rest: of(|score| score.moving_at_rest),
    }
}

/// Scores of one estimator on one recording of a block: the mean over the phases; `None` if it did
/// not run.
pub fn on<'a>(
    block: impl Iterator<Item = &'a Row>,
    recording: &str,
    estimator: &str,
) -> Option<Score> {
    let of = |row: &&Row| row.recording == recording && row.estimator == estimator;
    let scores: Vec<Score> = block.filter(of).map(|row| row.score).collect();
    (!scores.is_empty()).then(|| mean(&scores))
}

/// Means over the recordings of every block, in the order of `estimators`.
#[must_use]
pub fn pool(rows: &[Row], estimators: &[&'static str]) -> Vec<Pooled> {
    let mut pooled = Vec::new();
    for (counts_per_rev, rate_hz) in blocks(rows) {
        let block = || block(rows, counts_per_rev, rate_hz);
        for over in Over::EACH {
            let members = block().filter(|row| over.has(row.role));
            let recordings = distinct(members.map(|row| row.recording.as_str()));
            if recordings.is_empty() {
                continue;
            }
            for &estimator in estimators {
                let scores = recordings
                    .iter()
                    .filter_map(|name| on(block(), name, estimator));
                let scores: Vec<Score> = scores.collect();
                pooled.push(Pooled {
                    over,
                    counts_per_rev,
                    rate_hz,
                    estimator,
                    recordings: scores.len(),
                    left_out: recordings.len() - scores.len(),
                    score: mean(&scores),
                });
            }
        }
    }
    pooled
}

#[cfg(test)]
mod tests {
    use super::*;

    fn row(
        recording: &str,
        role: Role,
        phase: Option<f64>,
        estimator: &'static str,
        pct: f64,
    ) -> Row {
        Row {
            recording: recording.to_owned(),
            role,
            counts_per_rev: if phase.is_some() { 4096 } else { 90 },
            rate_hz: 1000.0,
            phase,
            estimator,
            score: Score {
                rms_pct: Some(pct),
                moving_at_rest: (recording == "a").then_some(0.5),
                ..Score::default()
            },
        }
    }

    #[test]
    fn every_recording_has_the_same_weight_whatever_the_number_of_its_phases() {
        use Role::{Chooses, Judges};
        let rows = [
            row("a", Chooses, Some(0.1), "pll", 10.0),
            row("a", Chooses, Some(0.2), "pll", 30.0),
            row("b", Judges, Some(0.1), "pll", 50.0),
            row("b", Judges, Some(0.1), "m-over-t", 7.0),
            row("hall", Judges, None, "pll", 80.0),
        ];
        let pooled = pool(&rows, &["pll", "m-over-t"]);
        let of = |over, estimator| {
            let found = pooled
                .iter()
                .find(|p| p.over == over && p.estimator == estimator);
            let found = found.unwrap();
            (found.score.rms_pct, found.recordings, found.left_out)
        };
        assert_eq!(of(Over::All, "pll"), (Some(50.0), 3, 0));
        assert_eq!(of(Over::Chooses, "pll"), (Some(20.0), 1, 0));
        assert_eq!(of(Over::Judges, "pll"), (Some(65.0), 2, 0));
        assert_eq!(of(Over::All, "m-over-t"), (Some(7.0), 1, 2));
        assert_eq!(of(Over::Chooses, "m-over-t"), (None, 0, 1));
        // Of recordings without rest there is nothing to pool.
        assert_eq!(pooled[0].score.moving_at_rest, Some(0.5));
        assert_eq!(blocks(&rows), [(4096, 1000.0)]);
    }
}
