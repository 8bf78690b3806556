//! The findings for a reader.

use std::fmt::Write as _;

use crate::findings::Findings;
use crate::sensitivity::Outcome;
use crate::signals::Difference;

/// One line an estimator, for a terminal.
#[must_use]
pub fn text(all: &[Findings]) -> String {
    let mut text = format!(
        "{:<24}{:>8}{:>9}{:>8}{:>12}{:>12}{:>11}{:>10}{:>10}{:>10}{:>8}\n{:<24}{:>8}{:>9}{:>8}{:>12}{:>12}{:>11}{:>10}{:>10}{:>10}{:>8}\n",
        "",
        "rate",
        "ticks",
        "wraps",
        "deviation",
        "at start",
        "relative",
        "recovery",
        "at most",
        "windows",
        "",
        "estimator",
        "Hz",
        "",
        "of 2^32",
        "rad/s",
        "rad/s",
        "of fastest",
        "ticks",
        "ticks",
        "compared",
        "faults"
    );
    for found in all {
        let _ = writeln!(
            text,
            "{:<24}{:>8}{:>9.1e}{:>8}{:>12.1e}{:>12.1e}{:>11.1e}{:>10}{:>10}{:>10.1e}{:>8}  {}",
            found.estimator,
            found.rate_hz,
            found.ticks as f64,
            found.wraps,
            found.deviation_rad_s,
            found.start_deviation_rad_s,
            found.relative_deviation,
            found.recovery_ticks,
            found.bounds.settles_ticks,
            found.windows_compared as f64,
            found.fault_count,
            if found.passed() { "ok" } else { "FAILED" },
        );
        for fault in &found.faults {
            let _ = writeln!(text, "    {fault}");
        }
    }
    text
}

/// The cells of [`measured::tables::STRESS`].
#[must_use]
pub fn cells(all: &[Findings]) -> Vec<Vec<String>> {
    let row = |found: &Findings| {
        vec![
            found.estimator.clone(),
            found.rate_hz.to_string(),
            format!("{:.1e}", found.ticks as f64),
            found.wraps.to_string(),
            format!("{:.1e}", found.deviation_rad_s),
            format!("{:.1e}", found.start_deviation_rad_s),
            format!("{:.1e}", found.relative_deviation),
            found.recovery_ticks.to_string(),
            found.bounds.settles_ticks.to_string(),
            found.windows_compared.to_string(),
            found.fault_count.to_string(),
        ]
    };
    all.iter().map(row).collect()
}

/// The cells of [`measured::tables::STRESS_SIGNALS`]: what f32 costs on a device's signals.
#[must_use]
pub fn signals(all: &[Difference]) -> Vec<Vec<String>> {
    let row = |found: &Difference| {
        vec![
            found.estimator.clone(),
            found.rate_hz.to_string(),
            format!("{:.1e}", found.largest_rad_s),
            format!("{:.1e}", found.rms_rad_s),
            format!("{:.3}", found.error_rad_s[0]),
            format!("{:.1e}", found.added_error()),
        ]
    };
    all.iter().map(row).collect()
}

/// The cells of [`measured::tables::STRESS_PARAMETERS`]: what came of the parameters at the ends of
/// their ranges.
#[must_use]
pub fn sensitivity(all: &[Outcome]) -> Vec<Vec<String>> {
    let row = |outcome: &Outcome| {
        let refused = outcome.refused.iter();
        let refused = refused.map(|(parameter, count)| format!("{parameter} {count}"));
        vec![
            outcome.estimator.clone(),
            outcome.tried.to_string(),
            refused.collect::<Vec<_>>().join(", "),
            format!("{:.1e}", outcome.relative_deviation),
            outcome.broken.len().to_string(),
        ]
    };
    all.iter().map(row).collect()
}
