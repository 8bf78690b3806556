//! Score tables for a terminal.

use std::fmt::Write as _;

use crate::distinct::distinct;
use scoring::evaluation::Row;
use scoring::score::{Field, Over, Score};

pub mod layout;

use layout::{Column, table};
use terminal::wording::wrapped;

/// Table of the scores `asked`, by default of all usual scores that a row has: one table per rate,
/// plant and scenario, in lines of `width` characters.
#[must_use]
pub fn details(rows: &[Row], asked: &[&Field<Score>], width: usize) -> String {
    let mut text = String::new();
    for case in rows.chunk_by(same_case) {
        let Row {
            scenario,
            rate_hz,
            plant,
            ..
        } = &case[0];
        let _ = writeln!(text, "{scenario} at {rate_hz} Hz, plant {}", plant.phrase());
        let scores = || case.iter().map(|row| &row.score);
        let columns: Vec<_> = columns(Score::FIELDS, asked, scores()).collect();
        text += &table(&estimators(case), &columns, width);
    }
    text
}

/// The columns of the requested `fields`, by default of all usual ones that a row has.
pub fn columns<'a, T: Default + 'a>(
    fields: &'static [Field<T>],
    asked: &'a [&Field<T>],
    rows: impl Iterator<Item = &'a T> + Clone + 'a,
) -> impl Iterator<Item = Column> + 'a {
    let shown = {
        let rows = rows.clone();
        move |field: &&Field<T>| match asked {
            [] => field.usual && rows.clone().any(|row| (field.of)(row).is_some()),
            asked => asked.iter().any(|of| of.name == field.name),
        }
    };
    fields.iter().filter(shown).map(move |field| {
        let cells = rows.clone().map(|row| number(field.shown(row)));
        Column::numbers(field.head, field.unit, cells)
    })
}

/// Table of the scores `asked`, by default of the mean distance outside the haptic interval in % of
/// finite difference: one table per rate, plant and score, with one line per estimator and one column
/// per scenario. The last column is the mean or the largest value over the scenarios. For the
/// distance in % it is the ratio of the mean distance to that of finite difference.
#[must_use]
pub fn overview(rows: &[Row], asked: &[&'static Field<Score>], width: usize) -> String {
    let usual: Vec<_> = Score::FIELDS
        .iter()
        .filter(|field| field.name == DISTANCE_PCT)
        .collect();
    let fields = match asked {
        [] => &usual,
        asked => asked,
    };
    let mut text = String::new();
    for block in rows.chunk_by(|a, b| a.rate_hz == b.rate_hz && a.plant == b.plant) {
        let cases: Vec<_> = block.chunk_by(same_case).collect();
        for field in fields {
            let _ = writeln!(
                text,
                "{} Hz, plant {}: {}\n{}",
                block[0].rate_hz,
                block[0].plant.phrase(),
                field.name,
                wrapped(&field.sentence(), 0)
            );
            let mut columns: Vec<_> = cases
                .iter()
                .map(|case| {
                    let cells = case.iter().map(|row| number(field.shown(&row.score)));
                    Column::numbers(&case[0].scenario, "", cells)
                })
                .collect();
            let over = (0..cases[0].len()).map(|i| {
                let scores = cases.iter().map(|case| &case[i].score);
                number(over_scenarios(field, scores))
            });
            columns.push(Column::numbers(over_name(field), "", over));
            text += &table(&estimators(cases[0]), &columns, width);
            text.push('\n');
        }
    }
    text
}

const DISTANCE_PCT: &str = "distance_pct";

fn over_name(field: &Field<Score>) -> &'static str {
    match field.over {
        _ if field.name == DISTANCE_PCT => "pooled",
        Over::Mean => "mean",
        Over::Largest => "largest",
    }
}

fn over_scenarios<'a>(
    field: &Field<Score>,
    scores: impl Iterator<Item = &'a Score>,
) -> Option<f64> {
    match field.name {
        DISTANCE_PCT => pooled_pct(scores),
        _ => field.over(scores).map(|value| field.in_unit(value)),
    }
}

fn estimators(rows: &[Row]) -> Column {
    let names = rows.iter().map(|row| row.estimator.to_owned());
    Column::text("", "estimator", names)
}

/// Mean distance of one estimator over several cases of equal length, in % of finite difference.
#[must_use]
pub(crate) fn pooled_pct<'a>(scores: impl Iterator<Item = &'a Score>) -> Option<f64> {
    let (mut of, mut whole) = (0.0, 0.0);
    for score in scores {
        of += score.distance_rad_s?;
        // The percentage is missing if finite difference never leaves the interval: its distance is 0.
        whole += score.difference_distance_rad_s.unwrap_or(0.0);
    }
    (whole > 0.0).then(|| 100.0 * of / whole)
}

fn same_case(a: &Row, b: &Row) -> bool {
    a.scenario == b.scenario && a.rate_hz == b.rate_hz && a.plant == b.plant && a.seed == b.seed
}

/// A line on the scenarios in which `what`, which an error is divided by, has no error; none without a
/// scenario.
pub(crate) fn no_percentage<'a>(scenarios: impl Iterator<Item = &'a str>, what: &str) -> String {
    let names = distinct(scenarios);
    if names.is_empty() {
        return String::new();
    }
    wrapped(
        &format!("-: {what} has no error in {}.", names.join(", ")),
        0,
    ) + "\n"
}

/// About three significant digits, or a dash without a value.
pub fn number(value: Option<f64>) -> String {
    match value {
        None => "-".to_owned(),
        Some(0.0) => "0".to_owned(),
        Some(value) if value.abs() >= 1000.0 => format!("{value:.0}"),
        Some(value) if value.abs() >= 100.0 => format!("{value:.1}"),
        Some(value) if value.abs() >= 10.0 => format!("{value:.2}"),
        Some(value) if value.abs() >= 0.001 => format!("{value:.3}"),
        Some(value) => format!("{value:.1e}"),
    }
}

#[cfg(test)]
mod tests {
    use super::number;

    #[test]
    fn numbers_keep_three_digits() {
        let shown = [
            None,
            Some(0.0),
            Some(1234.5),
            Some(-12.345),
            Some(0.5),
            Some(2e-5),
        ];
        assert_eq!(
            shown.map(number),
            ["-", "0", "1234", "-12.35", "0.500", "2.0e-5"].map(String::from)
        );
    }
}
