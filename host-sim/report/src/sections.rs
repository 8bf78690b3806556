//! What the page shows, in order: each section a heading, its figures and what to look for.

use std::f64::consts::TAU;
use std::ops::Range;

use super::grid::{Group, groups};
use super::palette::Palette;
use super::text::{number, plant, rate};
use super::{
    CaseReport, ReportInput, Traces, cost, distances, felt, heating, problem, score_tables,
    sensitivity, spectra, tables, velocity, windows,
};
use experiments::sensitivity::table::rows_by_rate;

/// One part of the page; without a body it is left out.
pub(super) struct Section {
    /// Anchor, for the navigation.
    pub(super) id: &'static str,
    pub(super) title: &'static str,
    /// HTML.
    pub(super) body: String,
}

const STEP: &str = "One step of the large motor\u{2019}s current, the handle held. A good colour \
    stays inside the green: trailing behind the step is delay, jumping out of the green where \
    the truth is smooth is noise. \u{201c}Off scale\u{201d} says how many of the panel\u{2019}s \
    samples lie beyond its axis.";
const STEADY: &str = "Constant speed: whatever moves here is noise, and whatever sits beside the \
    black line is bias. A good estimate is a flat line inside the green.";
const DISTANCE: &str = "How far, on average over all samples after the first 0.1 s, the estimate \
    lies outside the interval; 0 (no bar) means that a fingertip would never notice. The axis is \
    logarithmic and begins at an arbitrary value: compare where bars end, one gridline is a \
    factor of ten.";
const SPECTRA: &str = "Where in frequency each estimator is wrong. To the left lie delay and \
    bias, to the right quantisation noise; what lies in the green band is felt as vibration and \
    as roughness. Lower is better.";
const COST: &str = "Down and to the left is better; the grey line joins those that nothing beats in \
    both. Instructions are the means that cargo pareto counted on the emulated board (benchmarks.md; \
    FOAW: that of the window nearest to the one used here); estimators without a measured cost are \
    not shown. The black lines are a particle filter with the exact likelihood of a count. In \
    stochastic it has the true model: what lies on it cannot be improved. Elsewhere it takes the \
    ripple of friction and torque for noise, and is no bound.";
const BELIEFS: &str = "RMS error in scenarios step and track of estimators that believe in one wrong \
    constant of the device, against how wrong it is. Those without a model of the motor are flat; \
    those that learn stay low. All scenarios: host-sim sensitivity.";
const HEATING: &str = "Damping of the coupler while it loses 30 % in 60 s, black, and what the \
    estimators that learn it take it for, from current and counts alone.";
const SCORES: &str = "The best of each scenario is bold on green: the smallest value, of the delay \
    the smallest in size. \u{201c}% of FD\u{201d} is relative to finite difference on the same \
    samples. Distance is outside the haptic interval, force is the RMS error felt at the fingertip, a \
    negative delay leads. Within is the share of samples whose error is below two of the standard \
    deviations that the estimator reports; about 95 % is right, and no value is the best. A click on \
    a heading sorts each scenario by that column.";
const DEVICE: &str = "The constants that the scores depend on. The paper's Table II omits the \
    four counts a line in its first two rows and has them in the others, so both readings stand \
    here; this device counts all four edges.";

/// Every section that has something to show.
pub(super) fn sections(report: &ReportInput, palette: &Palette) -> Result<Vec<Section>, String> {
    let groups = groups(report);
    let section = |id, title, body| Section { id, title, body };
    let all = [
        section(
            "inside",
            "Who stays inside",
            score_tables::inside(&groups, palette),
        ),
        section("problem", "The problem", the_problem(report, palette)?),
        section(
            "step",
            "Step response",
            time(report, palette, &STEP_RESPONSE)?,
        ),
        section(
            "steady",
            "Permanent regime",
            time(report, palette, &PERMANENT)?,
        ),
        section(
            "distance",
            "Distance from the interval",
            distance(&groups, palette)?,
        ),
        section("spectra", "Error spectra", errors(report, palette)?),
        section(
            "cost",
            "Run time and error",
            costs(report, &groups, palette)?,
        ),
        section("beliefs", "Wrong beliefs", beliefs(report, palette)?),
        section(
            "heating",
            "A coupler that warms up",
            warming(report, palette)?,
        ),
        section("scores", "Scores", scores(&groups, palette)),
    ];
    let device = [section(
        "device",
        "Device",
        format!(
            "<div class=\"side\">{}{}</div>{}",
            tables::constants(&report.device),
            tables::count_worth(&report.device),
            words(DEVICE)
        ),
    )];
    let felt = felt::sections(report, palette)?;
    Ok(all
        .into_iter()
        .chain(felt)
        .chain(device)
        .filter(|section| !section.body.is_empty())
        .collect())
}

fn costs(report: &ReportInput, groups: &[Group], palette: &Palette) -> Result<String, String> {
    let mut html = String::new();
    for group in groups.iter().filter(|group| group.friction) {
        let svg = cost::panels(group, &report.limits, palette)?;
        html += &svg.map(|svg| framed(&svg)).unwrap_or_default();
    }
    if !html.is_empty() {
        html += &words(COST);
    }
    Ok(html)
}

fn beliefs(report: &ReportInput, palette: &Palette) -> Result<String, String> {
    let mut html = String::new();
    for rows in rows_by_rate(&report.beliefs) {
        html += &framed(&sensitivity::chart(&rows, palette)?);
    }
    if !html.is_empty() {
        html += &words(BELIEFS);
    }
    Ok(html)
}

fn warming(report: &ReportInput, palette: &Palette) -> Result<String, String> {
    let mut body = String::new();
    for case in report.cases.iter().chain(&report.warming) {
        let Some(damping) = &case.damping else {
            continue;
        };
        if !damping.learned.is_empty() {
            body += &framed(&heating::chart(case, damping, palette)?);
        }
    }
    if !body.is_empty() {
        body += &words(HEATING);
    }
    Ok(body)
}

pub(super) fn words(text: &str) -> String {
    format!("<p class=\"look\">{text}</p>\n")
}

pub(super) fn framed(svg: &str) -> String {
    format!("<figure>{svg}</figure>\n")
}

/// The cases of one scenario that have signals: with friction if there are any, the first seed,
/// by rising rate; of more than two rates the lowest and the highest.
fn drawn<'a>(report: &'a ReportInput, scenario: &str) -> Vec<&'a CaseReport> {
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

fn the_problem(report: &ReportInput, palette: &Palette) -> Result<String, String> {
    for scenario in ["step", "track"] {
        let cases = drawn(report, scenario);
        let Some(case) = cases.first() else { continue };
        let Some(traces) = &case.traces else { continue };
        let estimators = &traces.estimates;
        let Some(at) = estimators
            .iter()
            .position(|(name, _)| name == "finite-difference")
        else {
            continue;
        };
        let Some(window) = windows::around_step(traces, 0.05, 0.20) else {
            continue;
        };
        let title = format!(
            "Finite difference at {}, scenario {scenario}, plant {} (the paper's figure 1)",
            rate(case.rate_hz),
            plant(case.friction)
        );
        let interval = report.device.interval();
        let svg = problem::figure_one(&title, traces, window, at, &interval, palette)?;
        return Ok(framed(&svg) + &words(&count_in_words(report, case.rate_hz)));
    }
    Ok(String::new())
}

/// What one count is to a finite difference, and to a fingertip.
fn count_in_words(report: &ReportInput, rate_hz: f64) -> String {
    let device = &report.device;
    let interval = device.interval();
    let step = TAU * rate_hz / f64::from(device.counts_per_rev.max(1));
    format!(
        "The large motor\u{2019}s encoder moves in whole counts. At {} one count more or less \
         within a tick is {}\u{a0}rad/s to a finite difference, or {}\u{a0}mN at the fingertip, which \
         notices {}\u{a0}mN. So the estimate (grey) jumps while the motion (black) is smooth; what \
         leaves the haptic interval (green) is torque on the handle that should not be there.",
        rate(rate_hz),
        number(step),
        number(step * interval.force_mn_per_rad_s),
        number(1e3 * device.threshold_n),
    )
}

/// Samples to show, and the one at which time is 0.
type Window = (Range<usize>, usize);

/// A figure over time.
struct OverTime {
    number: u32,
    what: &'static str,
    scenario: &'static str,
    words: &'static str,
    window: fn(&Traces) -> Option<Window>,
}

const STEP_RESPONSE: OverTime = OverTime {
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

const PERMANENT: OverTime = OverTime {
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

fn time(report: &ReportInput, palette: &Palette, shown: &OverTime) -> Result<String, String> {
    let mut html = String::new();
    for case in drawn(report, shown.scenario) {
        let Some(traces) = &case.traces else { continue };
        let Some((window, origin)) = (shown.window)(traces) else {
            continue;
        };
        if traces.estimates.is_empty() {
            continue;
        }
        let title = format!(
            "{} at {}, plant {} (the paper's figure {})",
            shown.what,
            rate(case.rate_hz),
            plant(case.friction),
            shown.number
        );
        let origin_s = traces.time(origin);
        let interval = report.device.interval();
        html += &framed(&velocity::panels(
            &title, traces, window, origin_s, &interval, palette,
        )?);
    }
    if !html.is_empty() {
        html += &words(shown.words);
    }
    Ok(html)
}

fn distance(groups: &[Group], palette: &Palette) -> Result<String, String> {
    let mut html = String::new();
    for of_rate in groups.chunk_by(|a, b| a.rate_hz == b.rate_hz) {
        let title = format!(
            "Mean distance outside the haptic interval at {} (the paper's figure 8)",
            rate(of_rate[0].rate_hz)
        );
        let of_rate: Vec<&Group> = of_rate.iter().collect();
        if let Some(svg) = distances::bars(&title, &of_rate, palette)? {
            html += &framed(&svg);
        }
    }
    if !html.is_empty() {
        html += &words(DISTANCE);
    }
    Ok(html)
}

fn errors(report: &ReportInput, palette: &Palette) -> Result<String, String> {
    for scenario in ["track", "free-air", "step", "permanent"] {
        let cases = drawn(report, scenario);
        let Some(first) = cases.first() else { continue };
        let plant = plant(first.friction);
        let title = format!("Spectrum of the velocity error, scenario {scenario}, plant {plant}");
        if let Some(svg) = spectra::spectra(&title, &cases, palette)? {
            return Ok(framed(&svg) + &words(SPECTRA));
        }
    }
    Ok(String::new())
}

fn scores(groups: &[Group], palette: &Palette) -> String {
    let with_rows = groups
        .iter()
        .filter(|group| group.scenarios.iter().any(|s| !s.rows.is_empty()));
    let html: String = with_rows
        .map(|group| score_tables::scores(group, palette))
        .collect();
    if html.is_empty() {
        html
    } else {
        words(SCORES) + &html
    }
}
