//! One sentence that summarises the comparison.

use super::ReportInput;
use super::grid::{Group, groups};
use super::palette::Palette;
use super::text::{plant, rate, share};
use catalogue::estimators::DIFFERENCE;

/// The best estimator of each rate by its time inside the haptic interval; `None` if no case has
/// this score.
///
/// The summary is about the plant with friction if it was run: it is the harder and the real one.
pub(super) fn verdict(report: &ReportInput, palette: &Palette) -> Option<String> {
    let groups = groups(report);
    let friction = groups.iter().any(|group| group.friction);
    let clauses: Vec<String> = groups
        .iter()
        .filter(|group| group.friction == friction)
        .filter_map(|group| clause(group, palette))
        .collect();
    (!clauses.is_empty()).then(|| {
        let plant = plant(friction);
        let clauses = clauses.join("; ");
        format!("Best estimator by time inside the haptic interval, plant {plant}: {clauses}.")
    })
}

fn clause(group: &Group, palette: &Palette) -> Option<String> {
    let inside = |name| {
        group
            .inside(name)
            .map(|(inside, scenarios)| (name, inside, scenarios))
    };
    let mut ranked: Vec<_> = palette.names().filter_map(inside).collect();
    ranked.sort_by(|a, b| b.1.total_cmp(&a.1));
    let (best, often, scenarios) = *ranked.first()?;
    let over = match scenarios {
        1 => "in one scenario".into(),
        n => format!("on average over {n} scenarios"),
    };
    let mut text = format!(
        "at {} {best} with {} {over}",
        rate(group.rate_hz),
        share(often)
    );
    if let Some((_, often, _)) = ranked
        .iter()
        .find(|r| r.0 == DIFFERENCE && best != DIFFERENCE)
    {
        text += &format!(" (finite difference: {})", share(*often));
    }
    Some(text)
}

#[cfg(test)]
mod tests {
    use super::super::{CaseReport, EstimatorRow};
    use super::*;
    use scoring::score::Score;

    fn case(scenario: &str, friction: bool, outside: &[(&str, f64)]) -> CaseReport {
        let row = |&(name, outside): &(&str, f64)| EstimatorRow {
            estimator: name.into(),
            score: Score {
                outside: Some(outside),
                ..Score::default()
            },
            ..EstimatorRow::default()
        };
        CaseReport {
            scenario: scenario.into(),
            rate_hz: 1000.0,
            friction,
            rows: outside.iter().map(row).collect(),
            ..CaseReport::default()
        }
    }

    fn of(cases: Vec<CaseReport>) -> Option<String> {
        let report = ReportInput {
            cases,
            ..ReportInput::default()
        };
        verdict(&report, &Palette::new(&report))
    }

    #[test]
    fn best_and_finite_difference_are_named_with_the_number_of_scenarios() {
        let said = of(vec![
            case("step", false, &[("finite-difference", 0.0), ("pll", 0.9)]),
            case("step", true, &[("finite-difference", 0.6), ("pll", 0.1)]),
            case("track", true, &[("finite-difference", 0.4), ("pll", 0.3)]),
        ]);
        assert_eq!(
            said.unwrap(),
            "Best estimator by time inside the haptic interval, plant with friction: at 1 kHz pll \
             with 80\u{a0}% on average over 2 scenarios (finite difference: 50\u{a0}%)."
        );
    }

    #[test]
    fn winning_finite_difference_is_named_once_and_no_score_has_no_verdict() {
        let said = of(vec![case(
            "step",
            false,
            &[("finite-difference", 0.2), ("pll", 0.3)],
        )]);
        assert_eq!(said.unwrap().matches("finite").count(), 1);
        assert_eq!(of(vec![case("step", false, &[])]), None);
    }
}
