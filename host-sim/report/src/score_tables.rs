//! Tables of the scores; the best value of each column is marked.

use maud::{Markup, html};

use super::grid::{Group, Scenario};
use super::palette::Palette;
use super::text::{number, plant, rate, share};
use scoring::score::{Better, Field, Form, Score};

/// Share of samples inside the interval: estimators down, rate and plant across.
///
/// `None` if no case has this score.
pub(super) fn inside(groups: &[Group], palette: &Palette) -> Option<Markup> {
    let inside_of = |group: &Group| -> Vec<Option<f64>> {
        let inside = palette.names().map(|name| group.inside(name));
        inside
            .map(|found| found.map(|(inside, _)| inside))
            .collect()
    };
    let columns: Vec<(&Group, Vec<Option<f64>>)> = groups
        .iter()
        .map(|group| (group, inside_of(group)))
        .filter(|(_, shares)| shares.iter().any(Option::is_some))
        .collect();
    let best = |shares: &[Option<f64>]| shares.iter().copied().flatten().reduce(f64::max);
    (!columns.is_empty()).then(|| html! {
        div.scroll {
            table.scores {
                caption { "Share of samples inside the haptic interval, mean over scenarios" }
                thead {
                    tr {
                        th { "estimator" }
                        @for (group, _) in &columns {
                            th { (rate(group.rate_hz)) small { (plant(group.friction)) } }
                        }
                    }
                }
                tbody {
                    @for (i, name) in palette.names().enumerate() {
                        tr {
                            th scope="row" { (label(name, palette)) }
                            @for (_, shares) in &columns {
                                @match shares[i] {
                                    Some(inside) => {
                                        (cell(&share(inside), inside, Some(inside) == best(shares)))
                                    }
                                    None => { td {} }
                                }
                            }
                        }
                    }
                }
            }
        }
    })
}

/// One table for a rate and plant, scenarios as its blocks.
pub(super) fn scores(group: &Group, palette: &Palette) -> Markup {
    let rows = || group.scenarios.iter().flat_map(|scenario| &scenario.rows);
    let shown: Vec<&Field<Score>> = Score::FIELDS
        .iter()
        .filter(|field| rows().any(|row| (field.of)(&row.score).is_some()))
        .collect();
    html! {
        div.scroll {
            table.scores.sortable {
                caption { (rate(group.rate_hz)) ", plant " (plant(group.friction)) }
                thead {
                    tr {
                        th { "estimator" }
                        @for field in &shown { (head(field)) }
                    }
                }
                @for scenario in &group.scenarios { (block(scenario, &shown, palette)) }
            }
        }
    }
}

/// The heading of a column that can be sorted by.
pub(super) fn head<T>(field: &Field<T>) -> Markup {
    html! {
        th aria-sort="none" title=(field.sentence()) {
            button type="button" { (field.head) small { (field.unit) } }
        }
    }
}

/// The heading of a block, over a column of names and `columns` of values.
pub(super) fn block_head(name: &str, columns: usize) -> Markup {
    html! { tr.scenario { th colspan=(columns + 1) scope="rowgroup" { (name) } } }
}

/// The cell of a value, marked where it is the best of `competing`: with one value alone, or all
/// alike, there is no best.
pub(super) fn score_cell<T>(
    field: &Field<T>,
    value: Option<f64>,
    competing: impl Iterator<Item = f64> + Clone,
    competes: bool,
) -> Markup {
    let Some(value) = value else {
        return no_value();
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

fn block(scenario: &Scenario, shown: &[&Field<Score>], palette: &Palette) -> Markup {
    let rows = &scenario.rows;
    html! {
        tbody {
            (block_head(scenario.name, shown.len()))
            @for row in rows {
                tr {
                    th scope="row" {
                        (label(&row.estimator, palette))
                        @if row.score.non_finite > 0 {
                            " " em.bad { (row.score.non_finite) " samples not finite" }
                        }
                    }
                    @for field in shown {
                        @let competing = rows.iter().filter_map(|row| (field.of)(&row.score));
                        (score_cell(field, (field.of)(&row.score), competing, true))
                    }
                }
            }
        }
    }
}

/// The cell of a value that the page's script sorts by.
pub(super) fn cell(text: &str, sort_by: f64, best: bool) -> Markup {
    // An infinity sorts last in JavaScript as well.
    let sort_by = match sort_by.is_finite() {
        true => format!("{sort_by:e}"),
        false => "Infinity".to_owned(),
    };
    html! { td class=[best.then_some("best")] data-v=(sort_by) { (text) } }
}

/// The cell of a value that was not computed.
pub(super) fn no_value() -> Markup {
    html! { td.none { "\u{2013}" } }
}

/// Swatch and name of an estimator.
pub(super) fn label(estimator: &str, palette: &Palette) -> Markup {
    html! {
        i style={ "background:" (palette.style(estimator).css()) } {}
        (estimator)
    }
}

#[cfg(test)]
mod tests {
    use super::super::{CaseReport, EstimatorRow, ReportInput, grid};
    use super::*;

    fn table(rows: &[(&str, Score)]) -> String {
        let rows = rows.iter().map(|(name, score)| EstimatorRow {
            estimator: (*name).to_string(),
            score: *score,
            ..EstimatorRow::default()
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
        scores(&grid::groups(&report)[0], &Palette::new(&report)).into_string()
    }

    fn delay(ms: f64) -> Score {
        Score {
            delay_ms: Some(ms),
            ..Score::default()
        }
    }

    #[test]
    fn smallest_magnitude_is_best_and_empty_columns_are_left_out() {
        let html = table(&[("a", delay(-0.5)), ("b", delay(0.25)), ("c", delay(-0.2))]);
        assert_eq!(html.matches("class=\"best\"").count(), 1);
        assert!(
            html.contains("class=\"best\" data-v=\"2e-1\">\u{2212}0.200<"),
            "{html}"
        );
        assert!(html.contains("delay") && !html.contains("chatter"));
    }

    #[test]
    fn largest_share_below_the_threshold_is_best_among_those_that_compete() {
        use experiments::transparency::Parasitic;
        let mut fields = Parasitic::FIELDS.iter();
        let field = fields.find(|field| field.better == Better::Larger).unwrap();
        let is_best = |value, competes| {
            let all = [0.25, 0.75].into_iter();
            let cell = score_cell(field, Some(value), all, competes).into_string();
            assert!(cell.contains(&share(value)), "{cell}");
            cell.contains("best")
        };
        assert_eq!([is_best(0.25, true), is_best(0.75, true)], [false, true]);
        assert!(!is_best(0.75, false));
    }

    #[test]
    fn heading_has_the_unit_and_the_definition() {
        let field = Score::field("delay_ms").unwrap();
        let html = head(field).into_string();
        assert!(html.contains("<small>ms</small>"), "{html}");
        let caption = "<caption>1 kHz, plant without friction</caption>";
        assert!(table(&[("pll", delay(1.0))]).contains(caption));
        assert!(
            html.contains("title=\"Shift of the truth that minimises the RMS error, ms"),
            "{html}"
        );
    }

    #[test]
    fn share_inside_is_what_is_not_outside_and_the_largest_is_best() {
        let row = |name: &str, outside| EstimatorRow {
            estimator: name.to_owned(),
            score: Score {
                outside: Some(outside),
                ..Score::default()
            },
            ..EstimatorRow::default()
        };
        let case = |friction, rows| CaseReport {
            scenario: "step".to_owned(),
            rate_hz: 1000.0,
            friction,
            rows,
            ..CaseReport::default()
        };
        let report = ReportInput {
            cases: vec![
                case(false, vec![row("pll", 0.25), row("imm", 0.5)]),
                case(true, vec![row("pll", 0.75), row("imm", 0.5)]),
            ],
            ..ReportInput::default()
        };
        let html = inside(&grid::groups(&report), &Palette::new(&report))
            .unwrap()
            .into_string();
        let heads = ["without", "with"]
            .map(|plant| format!("<th>1 kHz<small>{plant} friction</small></th>"));
        assert!(html.contains(&heads.concat()), "{html}");
        let cells: Vec<_> = html
            .split("<td")
            .skip(1)
            .map(|cell| {
                (
                    cell.contains("class=\"best\""),
                    cell.split(['>', '<']).nth(1).unwrap(),
                )
            })
            .collect();
        let expected = [
            (true, "75\u{a0}%"),
            (false, "25\u{a0}%"),
            (false, "50\u{a0}%"),
            (true, "50\u{a0}%"),
        ];
        assert_eq!(cells, expected);
    }

    #[test]
    fn single_or_equal_values_have_no_best() {
        assert!(!table(&[("a", delay(0.5))]).contains("best"));
        assert!(!table(&[("a", delay(0.5)), ("b", delay(0.5))]).contains("best"));
    }

    #[test]
    fn non_finite_estimate_is_reported_and_not_best() {
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
