//! The rows of `sensitivity` as a table: estimators down, beliefs across.

use std::fmt::Write as _;

use super::Row;
use crate::belief::Belief;

/// Scenarios in which the motor moves: at rest and in creep there is nothing to learn from.
pub const MOVING: [&str; 6] = ["step", "permanent", "track", "free-air", "wall", "texture"];

/// Mean RMS error, in % of finite difference, one row an estimator, at each rate: with what is
/// believed being right, over all scenarios; over those that move; and over those with each
/// constant wrong by the most that is tried. Last the share of samples of moving scenarios
/// outside the haptic interval, right and at the worst.
#[must_use]
pub fn table(rows: &[Row]) -> String {
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
        let _ = write!(text, "{:<22}{:>8}{:>8}", "believed:", "right", "moving");
        for belief in Belief::extremes() {
            let head = format!(
                "{}{:+.0}%",
                short(belief.constant.as_str()),
                100.0 * belief.error
            );
            let _ = write!(text, "{head:>8}");
        }
        let _ = writeln!(text, "{:>8}{:>9}{:>9}", "worst", "out %", "worst");
        for name in names(at_rate) {
            let of = |row: &&&Row| row.estimator == name;
            let mine: Vec<&Row> = at_rate.iter().filter(of).copied().collect();
            let _ = writeln!(text, "{}", line(name, &mine));
        }
    }
    text
}

fn line(name: &str, rows: &[&Row]) -> String {
    let moving: Vec<&Row> = rows
        .iter()
        .copied()
        .filter(|row| MOVING.contains(&row.scenario))
        .collect();
    let right = |rows: &[&Row]| mean(rows, |row| row.constant.is_none(), |row| row.rms_pct);
    let mut text = format!(
        "{name:<22}{}{}",
        number(right(rows)),
        number(right(&moving))
    );
    let mut worst = right(&moving);
    let outside = |only: &dyn Fn(&Row) -> bool| 100.0 * mean(&moving, only, |row| row.outside);
    let outside_right = outside(&|row| row.constant.is_none());
    let mut outside_worst = outside_right;
    for belief in Belief::extremes() {
        let is =
            |row: &Row| row.constant == Some(belief.constant.as_str()) && row.error == belief.error;
        let value = mean(&moving, is, |row| row.rms_pct);
        text += &number(value);
        worst = worst.max(value);
        outside_worst = outside_worst.max(outside(&is));
    }
    text += &number(worst);
    text + &format!("{outside_right:>9.3}{outside_worst:>9.3}")
}

fn number(value: f64) -> String {
    if value.is_nan() {
        format!("{:>8}", "-")
    } else {
        format!("{value:>8.2}")
    }
}

/// NaN where there is no row.
fn mean(rows: &[&Row], only: impl Fn(&Row) -> bool, value: impl Fn(&Row) -> f64) -> f64 {
    let (mut sum, mut count) = (0.0, 0.0);
    for row in rows.iter().filter(|row| only(row)) {
        sum += value(row);
        count += 1.0;
    }
    sum / count
}

fn short(constant: &str) -> &str {
    match constant {
        "damping" => "b",
        "inertia" => "J",
        "torque-constant" => "Kt",
        _ => "Tc",
    }
}

/// Names of the estimators, in order of appearance.
#[must_use]
pub fn names<'a>(rows: &[&'a Row]) -> Vec<&'a str> {
    let mut names = Vec::new();
    for row in rows {
        if !names.contains(&row.estimator) {
            names.push(row.estimator);
        }
    }
    names
}

/// The rows of each rate, in order of appearance.
#[must_use]
pub fn rows_by_rate(rows: &[Row]) -> Vec<Vec<&Row>> {
    let mut rates: Vec<Vec<&Row>> = Vec::new();
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

    #[test]
    fn the_worst_is_of_moving_scenarios_only() {
        let row = |scenario, constant, error, rms_pct| Row {
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
        let text = table(&rows);
        let line = text.lines().last().unwrap();
        let cells: Vec<_> = line.split_whitespace().collect();
        assert_eq!(cells[..3], ["pll", "20.00", "10.00"]);
        // The worst, and the shares outside.
        assert_eq!(cells[cells.len() - 3..], ["40.00", "50.000", "50.000"]);
    }
}
