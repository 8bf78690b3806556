//! The ranking as text.

use std::fmt::Write as _;
use std::path::Path;

use catalogue::estimators::{DIFFERENCE, Kind};
use recordings::log::short_name;
use terminal::wording::wrapped;

use super::{Outcome, Ranked, Recommendation};
use crate::table::layout::{Column, table as side_by_side};
use crate::table::number;

/// Number of estimators in the short table.
const SHORT: usize = 8;

/// The signals that an estimator reads besides the counts.
#[must_use]
pub fn reads(kind: &Kind) -> Vec<&'static str> {
    let needs = kind.needs;
    let signals = [
        (needs.current, "current"),
        (needs.coupled, "counts_small"),
        (needs.edge, "edge_tick"),
    ];
    let read = signals.iter().filter(|(needed, _)| *needed);
    read.map(|(_, name)| *name).collect()
}

/// The table of the ranking in lines of `width` characters. Without `all` it has the first ones, those
/// that are recommended, and finite difference.
#[must_use]
pub fn table(recommendation: &Recommendation, all: bool, width: usize) -> String {
    let ranked = &recommendation.ranked;
    let shown = |(i, row): &(usize, &Ranked)| {
        all || *i < SHORT || row.recommended.is_some() || row.estimator == DIFFERENCE
    };
    let shown: Vec<&Ranked> = ranked
        .iter()
        .enumerate()
        .filter(shown)
        .map(|(_, row)| row)
        .collect();
    let numbers = |head: &str, unit: &str, of: &dyn Fn(&Ranked) -> Option<f64>| {
        Column::numbers(head, unit, shown.iter().map(|row| number(of(row))))
    };
    let names = shown.iter().map(|row| match row.recommended {
        Some(why) => format!("{} ({why})", row.estimator),
        None => row.estimator.to_owned(),
    });
    let mut columns = vec![
        numbers("rms", "% of FD", &|row| Some(row.rms_pct)),
        numbers("rms", "rad/s", &|row| Some(row.rms_rad_s)),
        numbers("99 %", "rad/s", &|row| Some(row.p99_rad_s)),
        numbers("delay", "ms", &|row| row.delay_ms),
        numbers("sd", "rad/s", &|row| row.sd_rad_s),
        numbers("mean", "instr.", &|row| Some(row.cost?.mean)),
        numbers("most", "instr.", &|row| Some(row.cost?.most)),
    ];
    let reads = shown.iter().map(|row| match row.reads.as_slice() {
        [] => "counts".to_owned(),
        signals => format!("counts, {}", signals.join(", ")),
    });
    columns.push(Column::text("reads", "", reads));
    let outcomes = &recommendation.outcomes;
    if outcomes.len() > 1 {
        columns.extend(outcomes.iter().enumerate().map(|(i, outcome)| {
            numbers(&outcome.file(), "% of FD", &|row| Some(row.logs[i].rms_pct))
        }));
    }
    side_by_side(&Column::text("", "estimator", names), &columns, width)
}

impl Outcome<'_> {
    /// The name of the recording's file, for tables and figures.
    #[must_use]
    pub fn file(&self) -> String {
        short_name(Path::new(self.name))
    }
}

/// What to use, and the lines of Rust, each line within `width` characters except those of Rust.
#[must_use]
pub fn lines(recommendation: &Recommendation, budget: f64) -> String {
    let mut text = String::new();
    let named = |why: &str| {
        recommendation
            .ranked
            .iter()
            .find(|row| row.recommended == Some(why))
    };
    let cost = |row: &Ranked| match row.cost {
        Some(cost) => format!(
            "{} instructions per update on a Cortex-M4, at most {}",
            cost.mean, cost.most
        ),
        None => "instructions per update not measured".to_owned(),
    };
    let sentence = |row: &Ranked, what: &str| {
        let error = format!(
            "error to expect {} rad/s RMS, 1 % of the samples above {} rad/s, {} % of finite difference",
            number(Some(row.rms_rad_s)),
            number(Some(row.p99_rad_s)),
            number(Some(row.rms_pct))
        );
        wrapped(
            &format!("{what}: {}; {error}; {}", row.estimator, cost(row)),
            2,
        )
    };
    // Writing to a string cannot fail.
    if let Some(best) = named("best") {
        let _ = writeln!(text, "{}", sentence(best, "Most accurate"));
        let cheap = named("cheap");
        if let Some(cheap) = cheap {
            let what = format!("Most accurate within {budget} instructions");
            let _ = writeln!(text, "{}", sentence(cheap, &what));
        }
        for row in [Some(best), cheap].into_iter().flatten() {
            let file = row.estimator.replace('-', "_");
            let _ = write!(
                text,
                "\n// {file}.rs, a module with estimator-core\n{}",
                row.rust
            );
        }
    }
    text
}
