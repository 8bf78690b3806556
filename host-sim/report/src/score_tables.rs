//! The scores in numbers, the best of each column marked.

use std::fmt::Write as _;

use super::grid::{Group, Scenario};
use super::palette::Palette;
use super::text::{escape, number, plant, rate, share};
use scoring::score::{Better, Field, Form, Score};

/// Share of samples inside the interval: estimators down, rate and plant across.
///
/// Empty if no case says.
pub(super) fn inside(groups: &[Group], palette: &Palette) -> String {
    let groups: Vec<&Group> = groups
        .iter()
        .filter(|group| palette.names().any(|name| group.inside(name).is_some()))
        .collect();
    if groups.is_empty() {
        return String::new();
    }
    let mut html = String::from(
        "<div class=\"scroll\"><table class=\"scores\"><caption>Time inside the haptic interval, \
         mean over scenarios</caption>\n<thead><tr><th>estimator</th>",
    );
    for group in &groups {
        let (rate, plant) = (rate(group.rate_hz), plant(group.friction));
        let _ = write!(html, "<th>{rate}<small>{plant}</small></th>");
    }
    html += "</tr></thead><tbody>\n";
    let best = groups.iter().map(|group| {
        let inside = palette.names().filter_map(|name| group.inside(name));
        inside.map(|(inside, _)| inside).reduce(f64::max)
    });
    let best: Vec<_> = best.collect();
    for name in palette.names() {
        let _ = write!(html, "<tr><th scope=\"row\">{}</th>", label(name, palette));
        for (group, best) in groups.iter().zip(&best) {
            html += &match group.inside(name) {
                Some((inside, _)) => cell(&share(inside), inside, Some(inside) == *best),
                None => "<td></td>".into(),
            };
        }
        html += "</tr>\n";
    }
    html + "</tbody></table></div>\n"
}

/// One table for a rate and plant, scenarios as its blocks.
pub(super) fn scores(group: &Group, palette: &Palette) -> String {
    let mut html = format!(
        "<div class=\"scroll\"><table class=\"scores sortable\"><caption>{}, plant {}</caption>\n\
         <thead><tr><th>estimator</th>",
        rate(group.rate_hz),
        plant(group.friction)
    );
    let rows = || group.scenarios.iter().flat_map(|scenario| &scenario.rows);
    let shown: Vec<&Field<Score>> = Score::FIELDS
        .iter()
        .filter(|field| rows().any(|row| (field.of)(&row.score).is_some()))
        .collect();
    for field in &shown {
        html += &head(field);
    }
    html += "</tr></thead>\n";
    for scenario in &group.scenarios {
        html += &block(scenario, &shown, palette);
    }
    html + "</table></div>\n"
}

/// The heading of a column that can be sorted by.
pub(super) fn head<T>(field: &Field<T>) -> String {
    format!(
        "<th aria-sort=\"none\" title=\"{}\"><button type=\"button\">{}<small>{}</small></button></th>",
        escape(&field.sentence()),
        field.head,
        field.unit
    )
}

/// The cell of a value, marked where it is the best of `competing`: with one value alone, or all
/// alike, there is no best.
pub(super) fn score_cell<T>(
    field: &Field<T>,
    value: Option<f64>,
    competing: impl Iterator<Item = f64> + Clone,
    competes: bool,
) -> String {
    let Some(value) = value else {
        return "<td class=\"none\">\u{2013}</td>".into();
    };
    let rank = |value: f64| match field.better {
        Better::Smaller => Some(value.abs()),
        Better::Larger => Some(-value),
        Better::Neither => None,
    };
    let ranks = competing.filter_map(rank);
    let least = ranks.clone().reduce(f64::min);
    let differ = ranks.clone().any(|rank| Some(rank) > least);
    let text = match field.form {
        Form::Number => number(value),
        Form::Share => share(value),
    };
    cell(
        &text,
        value.abs(),
        competes && differ && rank(value) == least,
    )
}

fn block(scenario: &Scenario, shown: &[&Field<Score>], palette: &Palette) -> String {
    let mut html = format!(
        "<tbody><tr class=\"scenario\"><th colspan=\"{}\" scope=\"rowgroup\">{}</th></tr>\n",
        shown.len() + 1,
        escape(scenario.name)
    );
    for row in &scenario.rows {
        let mut name = label(&row.estimator, palette);
        if row.score.non_finite > 0 {
            let n = row.score.non_finite;
            let _ = write!(name, " <em class=\"bad\">{n} samples not finite</em>");
        }
        let _ = write!(html, "<tr><th scope=\"row\">{name}</th>");
        for field in shown {
            let competing = scenario
                .rows
                .iter()
                .filter_map(|row| (field.of)(&row.score));
            html += &score_cell(field, (field.of)(&row.score), competing, true);
        }
        html += "</tr>\n";
    }
    html + "</tbody>\n"
}

pub(super) fn cell(text: &str, sort_by: f64, best: bool) -> String {
    let best = if best { " class=\"best\"" } else { "" };
    // An infinity sorts last in JavaScript as well.
    let sort_by = if sort_by.is_finite() {
        format!("{sort_by:e}")
    } else {
        "Infinity".into()
    };
    format!("<td{best} data-v=\"{sort_by}\">{text}</td>")
}

pub(super) fn label(estimator: &str, palette: &Palette) -> String {
    format!(
        "<i style=\"background:{}\"></i>{}",
        palette.style(estimator).css(),
        escape(estimator)
    )
}

#[cfg(test)]
mod tests {
    use super::super::{CaseReport, ReportInput, Row, grid};
    use super::*;

    fn table(rows: &[(&str, Score)]) -> String {
        let rows = rows.iter().map(|(name, score)| Row {
            estimator: (*name).to_string(),
            score: *score,
            ..Row::default()
        });
        let report = ReportInput {
            cases: vec![CaseReport {
                scenario: "step".into(),
                rate_hz: 1000.0,
                rows: rows.collect(),
                ..CaseReport::default()
            }],
            ..ReportInput::default()
        };
        scores(&grid::groups(&report)[0], &Palette::new(&report))
    }

    fn delay(ms: f64) -> Score {
        Score {
            delay_ms: Some(ms),
            ..Score::default()
        }
    }

    #[test]
    fn the_best_is_the_smallest_in_size_and_only_columns_with_scores_are_there() {
        let html = table(&[("a", delay(-0.5)), ("b", delay(0.25)), ("c", delay(-0.2))]);
        assert_eq!(html.matches("class=\"best\"").count(), 1);
        assert!(
            html.contains("class=\"best\" data-v=\"2e-1\">\u{2212}0.200<"),
            "{html}"
        );
        assert!(html.contains("delay") && !html.contains("chatter"));
    }

    #[test]
    fn alone_or_all_alike_nobody_is_best() {
        assert!(!table(&[("a", delay(0.5))]).contains("best"));
        assert!(!table(&[("a", delay(0.5)), ("b", delay(0.5))]).contains("best"));
    }

    #[test]
    fn an_estimate_that_is_not_finite_says_so_and_is_not_best() {
        let bad = Score {
            rms_rad_s: Some(f64::INFINITY),
            non_finite: 7,
            ..Score::default()
        };
        let good = Score {
            rms_rad_s: Some(1.5),
            ..Score::default()
        };
        let html = table(&[("a<b", bad), ("c", good)]);
        assert!(html.contains("7 samples not finite") && html.contains("\u{221e}"));
        assert!(html.contains("a&lt;b") && html.contains("class=\"best\" data-v=\"1.5e0\">1.50"));
    }
}
