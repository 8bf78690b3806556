//! Table of the rows of `sensitivity`: one line per estimator, one column per wrong constant.

use std::fmt::Write as _;

use super::SensitivityRow;
use crate::distinct::distinct;
use crate::table::layout::{self, Column};
use catalogue::constant_error::ConstantError;
use terminal::wording::wrapped;

/// Scenarios in which the motor moves. Rest and creep do not excite the parameters.
pub const MOVING: [&str; 6] = ["step", "permanent", "track", "free-air", "wall", "texture"];

/// Mean RMS error in % of finite difference: one table per rate, one line per estimator, in lines
/// of `width` characters.
///
/// Columns: correct constants over all scenarios and over the moving ones ([`MOVING`]); each
/// constant with its largest error, over the moving scenarios; the largest of these; the share of
/// samples outside the haptic interval in moving scenarios with correct constants and in the worst
/// case. A run in which finite difference has no error is in no mean of percentages; notes name it, and say why
/// there is no moving scenario.
#[must_use]
pub fn table(rows: &[SensitivityRow], width: usize) -> String {
    let mut text = String::new();
    for (i, at_rate) in rows_by_rate(rows).iter().enumerate() {
        if i > 0 {
            text.push('\n');
        }
        // Writing to a string cannot fail.
        let _ = writeln!(
            text,
            "{} Hz, RMS in % of finite difference",
            at_rate[0].rate_hz
        );
        let names = names(at_rate);
        let each: Vec<Errors> = names
            .iter()
            .map(|name| {
                let of = |row: &&&SensitivityRow| row.estimator == *name;
                Errors::of(&at_rate.iter().filter(of).copied().collect::<Vec<_>>())
            })
            .collect();
        let column = |head: &str, unit, of: &dyn Fn(&Errors) -> f64| {
            Column::numbers(head, unit, each.iter().map(|errors| number(of(errors))))
        };
        let mut columns = vec![
            column("right", "all, %", &|of| of.right),
            column("right", "moving, %", &|of| of.moving),
        ];
        for (i, constant_error) in ConstantError::extremes().iter().enumerate() {
            let head = format!(
                "{} {:+.0} %",
                constant_error.constant.symbol(),
                100.0 * constant_error.error
            );
            columns.push(column(&head, "%", &|of| of.wrong[i]));
        }
        columns.push(column("worst", "%", &|of| of.worst));
        columns.push(column("outside", "right, %", &|of| of.outside));
        columns.push(column("outside", "worst, %", &|of| of.outside_worst));
        let names = names.iter().map(|name| (*name).to_owned());
        text += &layout::table(&Column::text("assumed:", "", names), &columns, width);
        text += &notes(at_rate);
    }
    text
}

/// The lines below the table of one rate.
fn notes(rows: &[&SensitivityRow]) -> String {
    let resting = rows.iter().filter(|row| percentage(row).is_none());
    let resting = distinct(resting.map(|row| row.scenario));
    let mut text = String::new();
    if !resting.is_empty() {
        let note = format!(
            "Finite difference has no error in {}: not in the means of percentages.",
            resting.join(", ")
        );
        text += &(wrapped(&note, 0) + "\n");
    }
    if !rows.iter().any(|row| MOVING.contains(&row.scenario)) {
        let note = format!(
            "-: all columns but the first are means over the scenarios {}, of which none is run.",
            MOVING.join(", ")
        );
        text += &(wrapped(&note, 0) + "\n");
    }
    text
}

/// The errors of one estimator, %; NaN without a row.
struct Errors {
    right: f64,
    moving: f64,
    /// Error for each of [`ConstantError::extremes`].
    wrong: Vec<f64>,
    worst: f64,
    outside: f64,
    outside_worst: f64,
}

impl Errors {
    fn of(rows: &[&SensitivityRow]) -> Self {
        let moving: Vec<&SensitivityRow> = rows
            .iter()
            .copied()
            .filter(|row| MOVING.contains(&row.scenario))
            .collect();
        let right = |rows: &[&SensitivityRow]| mean(rows, |row| row.constant.is_none(), percentage);
        let outside = |only: &dyn Fn(&SensitivityRow) -> bool| {
            100.0 * mean(&moving, only, |row| Some(row.outside))
        };
        let mut errors = Self {
            right: right(rows),
            moving: right(&moving),
            wrong: Vec::new(),
            worst: right(&moving),
            outside: outside(&|row| row.constant.is_none()),
            outside_worst: outside(&|row| row.constant.is_none()),
        };
        for constant_error in ConstantError::extremes() {
            let is = |row: &SensitivityRow| {
                row.constant == Some(constant_error.constant.as_str())
                    && row.error == constant_error.error
            };
            let value = mean(&moving, is, percentage);
            errors.wrong.push(value);
            errors.worst = errors.worst.max(value);
            errors.outside_worst = errors.outside_worst.max(outside(&is));
        }
        errors
    }
}

/// The error in % of finite difference; `None` where that one has none.
#[must_use]
pub fn percentage(row: &SensitivityRow) -> Option<f64> {
    (row.rms_pct.is_finite() || !row.rms_rad_s.is_finite()).then_some(row.rms_pct)
}

fn number(value: f64) -> String {
    if value.is_nan() {
        "-".to_owned()
    } else {
        format!("{value:.2}")
    }
}

/// Mean over the rows that have a value; NaN without one.
fn mean(
    rows: &[&SensitivityRow],
    only: impl Fn(&SensitivityRow) -> bool,
    value: impl Fn(&SensitivityRow) -> Option<f64>,
) -> f64 {
    let (mut sum, mut count) = (0.0, 0.0);
    let values = rows.iter().filter(|row| only(row));
    for value in values.filter_map(|row| value(row)) {
        sum += value;
        count += 1.0;
    }
    sum / count
}

/// Names of the estimators, in order of appearance.
#[must_use]
pub fn names<'a>(rows: &[&'a SensitivityRow]) -> Vec<&'a str> {
    distinct(rows.iter().map(|row| row.estimator))
}

/// The rows of each rate, in order of appearance.
#[must_use]
pub fn rows_by_rate(rows: &[SensitivityRow]) -> Vec<Vec<&SensitivityRow>> {
    let mut rates: Vec<Vec<&SensitivityRow>> = Vec::new();
    for row in rows {
        match rates.iter_mut().find(|of| of[0].rate_hz == row.rate_hz) {
            Some(of) => of.push(row),
            None => rates.push(vec![row]),
        }
    }
    rates
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A run with the right constants.
    fn right(scenario: &'static str, rms_pct: f64) -> SensitivityRow {
        SensitivityRow {
            estimator: "low-pass",
            scenario,
            rate_hz: 1000.0,
            seed: 1,
            constant: None,
            error: 0.0,
            rms_rad_s: 1.0,
            rms_pct,
            outside: 0.0,
        }
    }

    #[test]
    fn error_without_a_reference_is_in_no_mean_and_has_a_note() {
        let text = table(&[right("hold", f64::INFINITY), right("step", 20.0)], 1000);
        let [.., line, note] = text.lines().collect::<Vec<_>>()[..] else {
            panic!("{text}");
        };
        let cells: Vec<_> = line.split_whitespace().collect();
        assert_eq!(cells[..3], ["low-pass", "20.00", "20.00"], "{text}");
        assert_eq!(
            note,
            "Finite difference has no error in hold: not in the means of percentages."
        );
    }

    #[test]
    fn means_without_a_moving_scenario_have_a_note() {
        let row = |scenario| right(scenario, 20.0);
        let note = "-: all columns but the first are means over the scenarios step, permanent, track, \
                    free-air, wall, texture, of which none is run. ";
        let text = table(&[row("heating")], 1000).replace('\n', " ");
        assert!(text.ends_with(note), "{text}");
        assert!(!table(&[row("heating"), row("step")], 1000).contains("-:"));
    }

    #[test]
    fn each_wrong_constant_has_its_column_and_the_worst_share_is_of_all() {
        let mut rows = vec![right("step", 10.0)];
        let mut expected = vec!["low-pass".to_owned(), "10.00".into(), "10.00".into()];
        for (k, wrong) in (1..).zip(ConstantError::extremes()) {
            rows.push(SensitivityRow {
                constant: Some(wrong.constant.as_str()),
                error: wrong.error,
                outside: 0.01 * f64::from(k),
                ..right("step", 10.0 + f64::from(k))
            });
            expected.push(format!("1{k}.00"));
        }
        // Half of the largest error has no column.
        rows.push(SensitivityRow {
            error: 0.5 * rows[1].error,
            ..rows[1].clone()
        });
        let number = ConstantError::extremes().len();
        assert!(number < 10);
        let worst = [
            format!("1{number}.00"),
            "0.00".into(),
            format!("{number}.00"),
        ];
        expected.extend(worst);
        let text = table(&rows, 1000);
        let line = text.lines().last().unwrap();
        let cells: Vec<_> = line.split_whitespace().collect();
        assert_eq!(cells, expected, "{text}");
    }

    #[test]
    fn the_worst_is_of_moving_scenarios_only() {
        let row = |scenario, constant, error, rms_pct| SensitivityRow {
            estimator: "pll",
            scenario,
            rate_hz: 1000.0,
            seed: 1,
            constant,
            error,
            rms_rad_s: 1.0,
            rms_pct,
            outside: 0.5,
        };
        let rows = [
            row("step", None, 0.0, 10.0),
            row("creep", None, 0.0, 30.0),
            row("step", Some("friction"), 0.5, 40.0),
            row("creep", Some("friction"), 0.5, 900.0),
        ];
        let text = table(&rows, 1000);
        let line = text.lines().last().unwrap();
        let cells: Vec<_> = line.split_whitespace().collect();
        assert_eq!(cells[..3], ["pll", "20.00", "10.00"]);
        // The worst, and the shares outside.
        assert_eq!(cells[cells.len() - 3..], ["40.00", "50.00", "50.00"]);
    }
}
