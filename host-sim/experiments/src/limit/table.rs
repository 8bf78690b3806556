//! Table of the rows of `limit`: one line per estimator, one column per scenario.

use std::fmt::Write as _;

use terminal::wording::wrapped;

use super::{LimitRow, is_bound};
use crate::distinct::distinct;
use crate::table::layout::{self, Column};
use crate::table::no_percentage;

/// RMS error in % of finite difference, and in brackets relative to the particle filter with the
/// same signals; means over the seeds. One table per rate, in lines of `width` characters, and a note on the
/// scenarios in which the particle filter is no bound.
#[must_use]
pub fn table(rows: &[LimitRow], width: usize) -> String {
    let mut text = String::new();
    for rate_hz in distinct(rows.iter().map(|row| row.rate_hz)) {
        let of = |row: &&LimitRow| row.rate_hz == rate_hz;
        let block: Vec<&LimitRow> = rows.iter().filter(of).collect();
        let scenarios = distinct(block.iter().map(|row| row.scenario));
        // Writing to a string cannot fail.
        let _ = writeln!(
            text,
            "{rate_hz} Hz, RMS in % of finite difference (times the limit)"
        );
        let estimators = distinct(block.iter().map(|row| row.estimator));
        let columns: Vec<Column> = scenarios
            .iter()
            .map(|scenario| {
                let cells = estimators.iter().map(|estimator| {
                    let of =
                        |row: &&&LimitRow| row.estimator == *estimator && row.scenario == *scenario;
                    cell(block.iter().filter(of).copied())
                });
                Column::numbers(scenario, "", cells)
            })
            .collect();
        let names = estimators.iter().map(|name| (*name).to_owned());
        text += &layout::table(&Column::text("", "", names), &columns, width);
        let resting = block.iter().filter(|row| {
            let is_missing = !row.rms_pct.is_finite() || !row.over_limit.is_finite();
            is_missing && row.rms_rad_s.is_finite()
        });
        text += &no_percentage(
            resting.map(|row| row.scenario),
            "finite difference or the limit",
        );
    }
    text + &no_bound(distinct(rows.iter().map(|row| row.scenario)))
}

/// The note on those of `scenarios` in which the particle filter is no bound; empty if it is one in all.
fn no_bound(mut scenarios: Vec<&str>) -> String {
    scenarios.retain(|name| !name.parse().is_ok_and(is_bound));
    if scenarios.is_empty() {
        return String::new();
    }
    let note = format!(
        "note: limit is no bound in {}: the particle filter takes the ripple of friction and torque for a random \
         torque, so that an estimator can have a smaller error.",
        scenarios.join(", ")
    );
    wrapped(&note, 0) + "\n"
}

fn cell<'a>(rows: impl Iterator<Item = &'a LimitRow>) -> String {
    let (mut pct, mut over, mut count) = (0.0, 0.0, 0.0);
    for row in rows {
        pct += row.rms_pct;
        over += row.over_limit;
        count += 1.0;
    }
    let number = |sum: f64| match sum.is_finite() && count > 0.0 {
        true => format!("{:.2}", sum / count),
        false => "-".to_owned(),
    };
    match (number(pct), number(over)) {
        (pct, over) if pct == over && pct == "-" => pct,
        (pct, over) => format!("{pct} ({over})"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn error_without_a_reference_is_a_dash_with_a_note() {
        let row = |rms_rad_s, rms_pct, over_limit| LimitRow {
            estimator: "pll",
            scenario: "hold",
            rate_hz: 1000.0,
            seed: 1,
            rms_rad_s,
            rms_pct,
            over_limit,
            collapsed: 0.0,
        };
        let note = "-: finite difference or the limit has no error in hold.\n";
        for (row, cell) in [
            (row(0.0, f64::NAN, f64::NAN), "-"),
            (row(1.0, f64::INFINITY, 2.0), "- (2.00)"),
            (row(1.0, 50.0, f64::INFINITY), "50.00 (-)"),
        ] {
            let text = table(&[row], 80);
            assert!(text.contains(&format!(" {cell}\n{note}")), "{text}");
        }
        assert!(!table(&[row(1.0, 50.0, 2.0)], 80).contains("no error"));
    }

    #[test]
    fn seeds_are_averaged() {
        let row = |seed, rms_pct| LimitRow {
            estimator: "pll",
            scenario: "step",
            rate_hz: 1000.0,
            seed,
            rms_rad_s: 1.0,
            rms_pct,
            over_limit: rms_pct / 10.0,
            collapsed: 0.0,
        };
        let text = table(&[row(1, 20.0), row(2, 40.0)], 80);
        assert!(text.contains("30.00 (3.00)\n"), "{text}");
    }

    #[test]
    fn scenarios_without_a_bound_are_named() {
        let row = |scenario| LimitRow {
            estimator: "limit",
            scenario,
            rate_hz: 1000.0,
            seed: 1,
            rms_rad_s: 1.0,
            rms_pct: 10.0,
            over_limit: 1.0,
            collapsed: 0.0,
        };
        let note = "note: limit is no bound in step, track: ";
        let all = [row("stochastic"), row("step"), row("track"), row("step")];
        let text = table(&all, 80);
        assert_eq!(text.matches(note).count(), 1, "{text}");
        assert!(!table(&all[..1], 80).contains("note"));
    }
}
