//! Sections of the page of a comparison, in order: figures and their explanation.

use std::f64::consts::TAU;

use maud::{Markup, html};

use super::canvas::Svg;
use super::grid::{Group, groups};
use super::over_time::{PERMANENT, STEP_RESPONSE, drawn};
use super::palette::Palette;
use super::section::{Section, explained, explanation};
use super::text::{number, plant, rate, share};
use super::{
    ReportInput, closed_loop, cost, damping, distances, quantisation, score_tables, sensitivity,
    spectra, tables, windows,
};
use catalogue::estimators::DIFFERENCE;
use experiments::compare::interval;
use experiments::sensitivity::table::rows_by_rate;
use scoring::score::SKIP_S;

const SPECTRA: &str = "Amplitude spectral density of the velocity error. Delay and bias lie at \
    low frequencies, quantisation noise at high frequencies. An error in the green band is felt \
    as vibration and roughness. Lower is better.";
const COST: &str = "RMS error against instructions per update. Lower and further to the left is \
    better. The grey line joins the estimators that no other estimator beats in both. cargo \
    pareto counted the instructions on the emulated board (mean of its traces; for FOAW, the \
    measured window nearest to the one used here). Estimators without a measured cost are not \
    shown. The black lines are the error of a particle filter with the exact likelihood of a \
    count. In scenario stochastic the filter has the true model: its error is the lower bound. \
    In the other scenarios it treats the ripple of friction and torque as noise, and its error \
    is no bound.";
const SENSITIVITY: &str = "RMS error of estimators whose model has one wrong constant, against \
    the error of that constant; mean of scenarios step and track. The error of estimators \
    without a motor model does not depend on it. Adaptive estimators identify constants during \
    the run and stay low. host-sim sensitivity shows all scenarios.";
const SCORES: &str = "Bold on green marks the best value of a scenario: the smallest one, for \
    the delay the one of smallest magnitude. \u{201c}% of FD\u{201d} is relative to finite \
    difference on the same samples. Distance is the distance outside the haptic interval. Force \
    is the RMS error as force at the fingertip. A negative delay means that the estimate leads. \
    Within is the share of samples whose error is below two of the standard deviations that the \
    estimator reports; about 95\u{a0}% is correct, so no value is marked. Click a heading to \
    sort each scenario by that column.";
const DEVICE: &str = "Constants that the scores depend on. In Table II, N is the number of lines per \
    revolution and T the sample time. The first two rows of the paper\u{2019}s Table II assume one \
    count per encoder line, its other rows four; both are given here. This device counts all four \
    edges of a line.";

/// Every section that has something to show.
pub(super) fn sections(report: &ReportInput, palette: &Palette) -> Result<Vec<Section>, String> {
    let groups = groups(report);
    let compared = [
        Section::new(
            "inside",
            "Inside the interval",
            score_tables::inside(&groups, palette),
        ),
        Section::new(
            "quantisation",
            "Encoder quantisation",
            quantisation_figure(report, palette)?,
        ),
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
            "Distance outside the interval",
            distance(&groups, palette)?,
        ),
        Section::new("spectra", "Error spectra", spectrum(report, palette)?),
        Section::new(
            "cost",
            "Run time and error",
            costs(report, &groups, palette)?,
        ),
        Section::new(
            "sensitivity",
            "Parameter errors",
            parameter_errors(report, palette)?,
        ),
        Section::new(
            "damping",
            "Identified damping",
            identified_damping(report, palette)?,
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

fn parameter_errors(report: &ReportInput, palette: &Palette) -> Result<Option<Markup>, String> {
    let rates = rows_by_rate(&report.parameter_errors);
    let figures = rates.iter().map(|rows| sensitivity::chart(rows, palette));
    let figures: Vec<Svg> = figures.collect::<Result<_, _>>()?;
    Ok(explained(figures, SENSITIVITY))
}

fn identified_damping(report: &ReportInput, palette: &Palette) -> Result<Option<Markup>, String> {
    let mut figures = Vec::new();
    for case in report.cases.iter().chain(&report.heating) {
        let Some(damping) = &case.damping else {
            continue;
        };
        if !damping.learned.is_empty() {
            figures.push(damping::chart(case, damping, palette)?);
        }
    }
    let text = format!(
        "Damping of the coupler while it loses {} in 60 s: true value (black) and values that the \
         adaptive estimators identify from current and counts.",
        share(report.device.fall_at_60_s)
    );
    Ok(explained(figures, &text))
}

fn quantisation_figure(report: &ReportInput, palette: &Palette) -> Result<Option<Markup>, String> {
    for scenario in ["step", "track"] {
        let cases = drawn(report, scenario);
        let Some(case) = cases.first() else { continue };
        let Some(traces) = &case.traces else { continue };
        let estimators = &traces.estimates;
        let Some(at) = estimators.iter().position(|(name, _)| name == DIFFERENCE) else {
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
        return Ok(explained(
            [svg],
            &quantisation_in_words(report, case.rate_hz),
        ));
    }
    Ok(None)
}

/// One count per tick as velocity and as force, and the effect on the estimate.
fn quantisation_in_words(report: &ReportInput, rate_hz: f64) -> String {
    let device = &report.device;
    let haptic = interval(device);
    let step = TAU * rate_hz / f64::from(device.stages.large.counts_per_rev);
    format!(
        "The encoder of the large motor measures whole counts. At {} one count per tick is \
         {}\u{a0}rad/s for a finite difference, or {}\u{a0}mN at the fingertip. The threshold of a \
         fingertip is {}\u{a0}mN. The estimate (grey) therefore jumps while the motion (black) is \
         smooth. An estimate outside the haptic interval (green) causes a torque on the handle that \
         can be felt.",
        rate(rate_hz),
        number(step),
        number(step * haptic.force_mn_per_rad_s),
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
    let text = format!(
        "Mean distance of the estimate outside the haptic interval, over all samples after the first \
         {SKIP_S} s. A distance of 0 (no bar) means that a fingertip never feels the error. The axis \
         is logarithmic and begins at an arbitrary value: compare the ends of the bars. One grid line \
         is a factor of ten."
    );
    Ok(explained(figures, &text))
}

fn spectrum(report: &ReportInput, palette: &Palette) -> Result<Option<Markup>, String> {
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
