//! What the page of a comparison shows, in order: each section a heading, its figures and what to
//! look for.

use std::f64::consts::TAU;

use maud::{Markup, html};

use super::canvas::Svg;
use super::grid::{Group, groups};
use super::over_time::{PERMANENT, STEP_RESPONSE, drawn};
use super::palette::Palette;
use super::section::{Section, explained, explanation};
use super::text::{number, plant, rate};
use super::{
    ReportInput, closed_loop, cost, damping, distances, quantisation, score_tables, sensitivity,
    spectra, tables, windows,
};
use experiments::compare::interval;
use experiments::sensitivity::table::rows_by_rate;

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
    let compared = [
        Section::new(
            "inside",
            "Who stays inside",
            score_tables::inside(&groups, palette),
        ),
        Section::new("problem", "The problem", the_problem(report, palette)?),
        Section::new(
            "step",
            "Step response",
            STEP_RESPONSE.section(report, palette)?,
        ),
        Section::new(
            "steady",
            "Permanent regime",
            PERMANENT.section(report, palette)?,
        ),
        Section::new(
            "distance",
            "Distance from the interval",
            distance(&groups, palette)?,
        ),
        Section::new("spectra", "Error spectra", errors(report, palette)?),
        Section::new(
            "cost",
            "Run time and error",
            costs(report, &groups, palette)?,
        ),
        Section::new("beliefs", "Wrong beliefs", beliefs(report, palette)?),
        Section::new(
            "heating",
            "A coupler that warms up",
            warming(report, palette)?,
        ),
        Section::new("scores", "Scores", scores(&groups, palette)),
    ];
    let compared = compared.into_iter().flatten();
    let device = Section::new("device", "Device", Some(device(report)));
    let closed_loop = closed_loop::sections(report, palette)?;
    Ok(compared.chain(closed_loop).chain(device).collect())
}

fn costs(
    report: &ReportInput,
    groups: &[Group],
    palette: &Palette,
) -> Result<Option<Markup>, String> {
    let with_friction = groups.iter().filter(|group| group.friction);
    let figures = with_friction.map(|group| cost::panels(group, &report.limits, palette));
    let figures: Vec<Option<Svg>> = figures.collect::<Result<_, _>>()?;
    Ok(explained(figures.into_iter().flatten(), COST))
}

fn beliefs(report: &ReportInput, palette: &Palette) -> Result<Option<Markup>, String> {
    let rates = rows_by_rate(&report.beliefs);
    let figures = rates.iter().map(|rows| sensitivity::chart(rows, palette));
    let figures: Vec<Svg> = figures.collect::<Result<_, _>>()?;
    Ok(explained(figures, BELIEFS))
}

fn warming(report: &ReportInput, palette: &Palette) -> Result<Option<Markup>, String> {
    let mut figures = Vec::new();
    for case in report.cases.iter().chain(&report.warming) {
        let Some(damping) = &case.damping else {
            continue;
        };
        if !damping.learned.is_empty() {
            figures.push(damping::chart(case, damping, palette)?);
        }
    }
    Ok(explained(figures, HEATING))
}

fn the_problem(report: &ReportInput, palette: &Palette) -> Result<Option<Markup>, String> {
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
        let interval = interval(&report.device);
        let svg = quantisation::figure_one(&title, traces, window, at, &interval, palette)?;
        return Ok(explained([svg], &count_in_words(report, case.rate_hz)));
    }
    Ok(None)
}

/// What one count is to a finite difference, and to a fingertip.
fn count_in_words(report: &ReportInput, rate_hz: f64) -> String {
    let device = &report.device;
    let interval = interval(device);
    let step = TAU * rate_hz / f64::from(device.stages.large.counts_per_rev);
    format!(
        "The large motor\u{2019}s encoder moves in whole counts. At {} one count more or less \
         within a tick is {}\u{a0}rad/s to a finite difference, or {}\u{a0}mN at the fingertip, which \
         notices {}\u{a0}mN. So the estimate (grey) jumps while the motion (black) is smooth; what \
         leaves the haptic interval (green) is torque on the handle that should not be there.",
        rate(rate_hz),
        number(step),
        number(step * interval.force_mn_per_rad_s),
        number(1e3 * device.interval.threshold_n),
    )
}

fn distance(groups: &[Group], palette: &Palette) -> Result<Option<Markup>, String> {
    let mut figures = Vec::new();
    for of_rate in groups.chunk_by(|a, b| a.rate_hz == b.rate_hz) {
        let title = format!(
            "Mean distance outside the haptic interval at {} (the paper's figure 8)",
            rate(of_rate[0].rate_hz)
        );
        let of_rate: Vec<&Group> = of_rate.iter().collect();
        figures.extend(distances::bars(&title, &of_rate, palette)?);
    }
    Ok(explained(figures, DISTANCE))
}

fn errors(report: &ReportInput, palette: &Palette) -> Result<Option<Markup>, String> {
    for scenario in ["track", "free-air", "step", "permanent"] {
        let cases = drawn(report, scenario);
        let Some(first) = cases.first() else { continue };
        let plant = plant(first.friction);
        let title = format!("Spectrum of the velocity error, scenario {scenario}, plant {plant}");
        if let Some(svg) = spectra::spectra(&title, &cases, palette)? {
            return Ok(explained([svg], SPECTRA));
        }
    }
    Ok(None)
}

fn scores(groups: &[Group], palette: &Palette) -> Option<Markup> {
    let with_rows: Vec<&Group> = groups
        .iter()
        .filter(|group| group.scenarios.iter().any(|s| !s.rows.is_empty()))
        .collect();
    (!with_rows.is_empty()).then(|| {
        html! {
            (explanation(SCORES))
            @for group in with_rows { (score_tables::scores(group, palette)) }
        }
    })
}

fn device(report: &ReportInput) -> Markup {
    html! {
        div.side {
            (tables::constants(&report.device_name, &report.device))
            (tables::count_worth(&report.device))
        }
        (explanation(DEVICE))
    }
}
