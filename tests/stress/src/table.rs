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

/// The same as a markdown table.
#[must_use]
pub fn markdown(all: &[Findings]) -> String {
    let mut text = String::from(
        "| estimator | rate, Hz | ticks | wraps of 2^32 | f32 against f64, rad/s | soon after a start | of the fastest velocity \
         | at rest after, ticks | by design | windows compared | faults |\n\
         |---|---:|---:|---:|---:|---:|---:|---:|---:|---:|---:|\n",
    );
    for found in all {
        let _ = writeln!(
            text,
            "| {} | {} | {:.1e} | {} | {:.1e} | {:.1e} | {:.1e} | {} | {} | {} | {} |",
            found.estimator,
            found.rate_hz,
            found.ticks as f64,
            found.wraps,
            found.deviation_rad_s,
            found.start_deviation_rad_s,
            found.relative_deviation,
            found.recovery_ticks,
            found.bounds.settles_ticks,
            found.windows_compared,
            found.fault_count,
        );
    }
    text
}

/// What f32 costs on a device's signals.
#[must_use]
pub fn signals(all: &[Difference]) -> String {
    let mut text = String::from(
        "| estimator | rate, Hz | largest, rad/s | RMS, rad/s | RMS error, rad/s | f32 adds |\n\
         |---|---:|---:|---:|---:|---:|\n",
    );
    for found in all {
        let _ = writeln!(
            text,
            "| {} | {} | {:.1e} | {:.1e} | {:.3} | {:.1e} |",
            found.estimator,
            found.rate_hz,
            found.largest_rad_s,
            found.rms_rad_s,
            found.error_rad_s[0],
            found.added_error(),
        );
    }
    text
}

/// What came of the parameters at the ends of their ranges.
#[must_use]
pub fn sensitivity(all: &[Outcome]) -> String {
    let mut text = String::from(
        "| estimator | designs | refused, by error | f32 against f64, of the fastest velocity | broken |\n\
         |---|---:|---|---:|---:|\n",
    );
    for outcome in all {
        let refused: Vec<String> = outcome
            .refused
            .iter()
            .map(|(error, count)| format!("{error} {count}"))
            .collect();
        let _ = writeln!(
            text,
            "| {} | {} | {} | {:.1e} | {} |",
            outcome.estimator,
            outcome.tried,
            refused.join(", "),
            outcome.relative_deviation,
            outcome.broken.len(),
        );
    }
    text
}

/// `text` with `table` between the markers of this name.
///
/// # Errors
/// One line if the markers are not there.
pub fn placed(text: &str, name: &str, table: &str) -> Result<String, String> {
    let begin = format!("<!-- {name}: written by cargo stress -->");
    let end = format!("<!-- end of {name} -->");
    let (before, rest) = text
        .split_once(&begin)
        .ok_or_else(|| format!("no \"{begin}\""))?;
    let (_, after) = rest
        .split_once(&end)
        .ok_or_else(|| format!("no \"{end}\""))?;
    Ok(format!("{before}{begin}\n\n{table}\n{end}{after}"))
}
