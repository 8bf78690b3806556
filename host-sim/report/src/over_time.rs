//! Sections with velocities over time: step response and permanent regime.

use std::ops::Range;

use maud::Markup;

use super::palette::Palette;
use super::section::explained;
use super::text::{plant, rate};
use experiments::compare::interval;

use super::{CaseReport, ReportInput, Traces, velocity, windows};

const STEP: &str = "Response to one step of the large motor\u{2019}s current while the handle \
    is held. A good estimate (coloured) stays inside the haptic interval (green). A shift \
    behind the step is delay; a jump out of the green while the truth is smooth is noise. \
    \u{201c}Off scale\u{201d} is the share of the panel\u{2019}s samples beyond its axis.";
const STEADY: &str = "Velocity at constant speed: variation of the estimate is noise, an offset \
    from the black line is bias. A good estimate is a flat line inside the haptic interval \
    (green).";
/// The cases of one scenario that have signals: with friction if there are any, the first seed,
/// by rising rate; of more than two rates the lowest and the highest.
pub(super) fn drawn<'a>(report: &'a ReportInput, scenario: &str) -> Vec<&'a CaseReport> {
    let of = |friction| {
        let cases = report.cases.iter().filter(move |case| {
            case.scenario == scenario && case.friction == friction && case.traces.is_some()
        });
        let mut cases: Vec<_> = cases.collect();
        cases.sort_by(|a, b| a.rate_hz.total_cmp(&b.rate_hz));
        cases.dedup_by(|a, b| a.rate_hz == b.rate_hz);
        cases
    };
    let mut cases = of(true);
    if cases.is_empty() {
        cases = of(false);
    }
    if cases.len() > 2 {
        cases.drain(1..cases.len() - 1);
    }
    cases
}

/// Samples to show, and the one at which time is 0.
type Window = (Range<usize>, usize);

/// A figure over time.
pub(super) struct OverTime {
    number: u32,
    what: &'static str,
    scenario: &'static str,
    words: &'static str,
    window: fn(&Traces) -> Option<Window>,
}

pub(super) const STEP_RESPONSE: OverTime = OverTime {
    number: 6,
    what: "Step response",
    scenario: "step",
    words: STEP,
    window: |traces| {
        let before = (0.06 * traces.rate_hz).round() as usize;
        let window = windows::around_step(traces, 0.06, 0.06)?;
        let origin = window.start + before;
        Some((window, origin))
    },
};

pub(super) const PERMANENT: OverTime = OverTime {
    number: 7,
    what: "Permanent regime",
    scenario: "permanent",
    words: STEADY,
    window: |traces| {
        let window = windows::steady(traces, 0.1)?;
        let origin = window.start;
        Some((window, origin))
    },
};

impl OverTime {
    /// A figure a rate; `None` where no case of the scenario has signals.
    pub(super) fn section(
        &self,
        report: &ReportInput,
        palette: &Palette,
    ) -> Result<Option<Markup>, String> {
        let mut figures = Vec::new();
        for case in drawn(report, self.scenario) {
            let Some(traces) = &case.traces else { continue };
            let Some((window, origin)) = (self.window)(traces) else {
                continue;
            };
            if traces.estimates.is_empty() {
                continue;
            }
            let title = format!(
                "{} at {}, plant {} (the paper's figure {})",
                self.what,
                rate(case.rate_hz),
                plant(case.friction),
                self.number
            );
            let origin_s = traces.time(origin);
            let interval = interval(&report.device);
            figures.push(velocity::panels(
                &title, traces, window, origin_s, &interval, palette,
            )?);
        }
        Ok(explained(figures, self.words))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn case(rate_hz: f64, friction: bool, seed: u64) -> CaseReport {
        CaseReport {
            scenario: "step".to_owned(),
            rate_hz,
            friction,
            seed,
            traces: Some(Traces::default()),
            ..CaseReport::default()
        }
    }

    #[test]
    fn lowest_and_highest_rate_with_friction_are_drawn_with_their_first_seed() {
        let drawn_of = |cases: Vec<CaseReport>| {
            let report = ReportInput {
                cases,
                ..ReportInput::default()
            };
            let found = drawn(&report, "step").into_iter();
            found
                .map(|case| (case.rate_hz, case.friction, case.seed))
                .collect::<Vec<_>>()
        };
        let mut cases = vec![case(5e3, false, 1), case(5e3, false, 2)];
        assert_eq!(drawn_of(cases.clone()), [(5e3, false, 1)]);
        cases.extend([
            case(1e4, true, 3),
            case(1e3, true, 4),
            case(1e3, true, 5),
            case(5e3, true, 6),
        ]);
        assert_eq!(drawn_of(cases), [(1e3, true, 4), (1e4, true, 3)]);
        let without_signals = CaseReport {
            traces: None,
            ..case(1e3, true, 1)
        };
        assert_eq!(drawn_of(vec![without_signals]), []);
    }

    #[test]
    fn time_is_zero_where_the_step_begins() {
        let traces = Traces {
            rate_hz: 1000.0,
            truth: (0..1000).map(|k| if k < 500 { 0.0 } else { 5.0 }).collect(),
            estimates: Vec::new(),
        };
        let (window, origin) = (STEP_RESPONSE.window)(&traces).unwrap();
        // 60 ms on both sides.
        assert_eq!(window, origin - 60..origin + 61);
        assert!((496..=500).contains(&origin), "{origin}");
    }
}
