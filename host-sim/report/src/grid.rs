//! Cases in groups of equal rate and plant, with all scenarios and estimators.

use super::{CaseReport, EstimatorRow, ReportInput};
use experiments::distinct::distinct;
use scoring::score::Score;

/// The cases of one rate and plant.
pub(super) struct Group<'a> {
    pub(super) rate_hz: f64,
    pub(super) friction: bool,
    /// In order of appearance.
    pub(super) scenarios: Vec<Scenario<'a>>,
}

/// One scenario. Rows of several seeds are merged into their mean, largest errors into the largest,
/// counts into the sum.
pub(super) struct Scenario<'a> {
    pub(super) name: &'a str,
    pub(super) rows: Vec<EstimatorRow>,
}

impl Group<'_> {
    /// Share of samples inside the haptic interval, mean over the scenarios that have this score,
    /// and their number.
    pub(super) fn inside(&self, estimator: &str) -> Option<(f64, usize)> {
        let outside: Vec<f64> = self
            .scenarios
            .iter()
            .flat_map(|scenario| &scenario.rows)
            .filter(|row| row.estimator == estimator)
            .filter_map(|row| row.score.outside)
            .collect();
        let n = outside.len();
        (n > 0).then(|| (1.0 - outside.iter().sum::<f64>() / n as f64, n))
    }
}

/// Groups by rising rate, the frictionless plant first.
pub(super) fn groups(report: &ReportInput) -> Vec<Group<'_>> {
    let mut cases: Vec<&CaseReport> = report.cases.iter().collect();
    cases.sort_by(|a, b| {
        let by_rate = a.rate_hz.total_cmp(&b.rate_hz);
        by_rate.then(a.friction.cmp(&b.friction))
    });
    cases
        .chunk_by(|a, b| a.rate_hz == b.rate_hz && a.friction == b.friction)
        .map(|cases| Group {
            rate_hz: cases[0].rate_hz,
            friction: cases[0].friction,
            scenarios: scenarios(cases),
        })
        .collect()
}

fn scenarios<'a>(cases: &[&'a CaseReport]) -> Vec<Scenario<'a>> {
    let mut found: Vec<(&str, Vec<&EstimatorRow>)> = Vec::new();
    for case in cases {
        match found.iter_mut().find(|(name, _)| *name == case.scenario) {
            Some((_, rows)) => rows.extend(&case.rows),
            None => found.push((&case.scenario, case.rows.iter().collect())),
        }
    }
    found
        .into_iter()
        .map(|(name, rows)| Scenario {
            name,
            rows: merge(&rows),
        })
        .collect()
}

/// One row for each estimator, in order of appearance.
fn merge(rows: &[&EstimatorRow]) -> Vec<EstimatorRow> {
    distinct(rows.iter().map(|row| row.estimator.as_str()))
        .into_iter()
        .map(|name| {
            mean(
                name,
                &rows
                    .iter()
                    .filter(|row| row.estimator == name)
                    .collect::<Vec<_>>(),
            )
        })
        .collect()
}

fn mean(name: &str, rows: &[&&EstimatorRow]) -> EstimatorRow {
    let instructions: Vec<f64> = rows.iter().filter_map(|row| row.instructions).collect();
    let n = instructions.len();
    EstimatorRow {
        estimator: name.into(),
        score: Score::mean(rows.iter().map(|row| &row.score)),
        instructions: (n > 0).then(|| instructions.iter().sum::<f64>() / n as f64),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn case(scenario: &str, rate_hz: f64, friction: bool, rms: &[(&str, f64)]) -> CaseReport {
        let row = |&(name, rms): &(&str, f64)| EstimatorRow {
            estimator: name.into(),
            score: Score {
                rms_rad_s: Some(rms),
                max_rad_s: Some(2.0 * rms),
                outside: Some(rms / 10.0),
                ..Score::default()
            },
            ..EstimatorRow::default()
        };
        CaseReport {
            scenario: scenario.into(),
            rate_hz,
            friction,
            rows: rms.iter().map(row).collect(),
            ..CaseReport::default()
        }
    }

    #[test]
    fn groups_are_sorted_by_rate_and_plant_and_scenarios_keep_their_order() {
        let report = ReportInput {
            cases: vec![
                case("step", 11_600.0, true, &[]),
                case("track", 1000.0, true, &[]),
                case("step", 1000.0, true, &[]),
                case("step", 1000.0, false, &[]),
            ],
            ..ReportInput::default()
        };
        let groups = groups(&report);
        let keys: Vec<_> = groups.iter().map(|g| (g.rate_hz, g.friction)).collect();
        assert_eq!(keys, [(1000.0, false), (1000.0, true), (11_600.0, true)]);
        let names: Vec<_> = groups[1].scenarios.iter().map(|s| s.name).collect();
        assert_eq!(names, ["track", "step"]);
    }

    #[test]
    fn seeds_are_averaged_and_largest_errors_stay_the_largest() {
        let report = ReportInput {
            cases: vec![
                case("step", 1000.0, true, &[("pll", 1.0), ("foaw", 5.0)]),
                case("step", 1000.0, true, &[("pll", 3.0)]),
                case("hold", 1000.0, true, &[("pll", 6.0)]),
            ],
            ..ReportInput::default()
        };
        let groups = groups(&report);
        let rows = &groups[0].scenarios[0].rows;
        assert_eq!(rows.len(), 2);
        assert_eq!(rows[0].score.rms_rad_s, Some(2.0));
        assert_eq!(rows[0].score.max_rad_s, Some(6.0));
        assert_eq!(rows[0].score.delay_ms, None);
        let (inside, scenarios) = groups[0].inside("pll").unwrap();
        assert!((inside - 0.6).abs() < 1e-12 && scenarios == 2);
        assert!(groups[0].inside("nobody").is_none());
    }
}
