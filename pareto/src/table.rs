//! The rows as a table, between markers in docs/benchmarks.md, as CSV.

use std::fmt::Write;

use crate::measure::Row;

/// Where the table of the docs begins.
pub const BEGIN: &str = "<!-- pareto: written by cargo pareto -->";
/// Where it ends.
pub const END: &str = "<!-- end of pareto -->";

const HEAD: &str = "\
| estimator | mean, `3` | most, `3` | at rest, `3` | mean, `s` | most, `s` | cycles, `3` | code, `3` | state | RMS, 1 kHz | RMS, 10 kHz | front |
|---|---|---|---|---|---|---|---|---|---|---|---|
";

/// The table in Markdown.
#[must_use]
pub fn markdown(rows: &[Row]) -> String {
    let mut table = HEAD.to_owned();
    for row in rows {
        let [fast, small] = &row.cost;
        let front = match row.front {
            [true, true] => "both",
            [true, false] => "1 kHz",
            [false, true] => "10 kHz",
            [false, false] => "",
        };
        let [slow_rate, fast_rate] = row.rms_rad_s;
        writeln!(
            table,
            "| {} | {:.0} | {} | {:.0} | {:.0} | {} | {:.0} | {} | {} | {slow_rate:.3} | {fast_rate:.3} | {front} |",
            row.name,
            fast.mean,
            fast.most,
            fast.at_rest,
            small.mean,
            small.most,
            row.cycles(),
            fast.code,
            row.state,
        )
        .expect("a string takes all");
    }
    table
}

/// Everything as CSV.
#[must_use]
pub fn csv(rows: &[Row]) -> String {
    let mut csv = "estimator,peer,level,mean,most,at_rest,cycles_per_instruction,code,state,rms_1khz_rad_s,rms_10khz_rad_s\n".to_owned();
    for row in rows {
        for (level, cost) in ["3", "s"].iter().zip(&row.cost) {
            writeln!(
                csv,
                "\"{}\",{},{level},{},{},{},{},{},{},{},{}",
                row.name,
                row.peer,
                cost.mean,
                cost.most,
                cost.at_rest,
                cost.cycles_per_instruction,
                cost.code,
                row.state,
                row.rms_rad_s[0],
                row.rms_rad_s[1],
            )
            .expect("a string takes all");
        }
    }
    csv
}

/// `text` with the table between its markers.
///
/// # Errors
/// One line if the markers are not there.
pub fn placed(text: &str, rows: &[Row]) -> Result<String, String> {
    let (before, rest) = text.split_once(BEGIN).ok_or("no beginning of the table")?;
    let (_, after) = rest.split_once(END).ok_or("no end of the table")?;
    Ok(format!(
        "{before}{BEGIN}\n\n{}\n{END}{after}",
        markdown(rows)
    ))
}

/// Every figure of the table in `text` that moved by more than a tenth (or 3).
///
/// # Errors
/// One line if the table is not there or has other rows.
pub fn moved(text: &str, rows: &[Row]) -> Result<Vec<String>, String> {
    let (_, rest) = text.split_once(BEGIN).ok_or("no beginning of the table")?;
    let (written, _) = rest.split_once(END).ok_or("no end of the table")?;
    let now = markdown(rows);
    let lines = |table: &str| -> Vec<String> {
        let rows = table.lines().filter(|line| line.starts_with('|'));
        rows.map(str::to_owned).collect()
    };
    let (written, now) = (lines(written), lines(&now));
    if written.len() != now.len() {
        return Err(format!(
            "{} rows written, {} measured",
            written.len(),
            now.len()
        ));
    }
    let mut moved = Vec::new();
    for (then, now) in written.iter().zip(&now) {
        let same = then.split('|').zip(now.split('|')).all(|(then, now)| {
            match (then.trim().parse::<f64>(), now.trim().parse::<f64>()) {
                // RMS errors are small and the same everywhere, counts may move a little.
                (Ok(then), Ok(now)) => {
                    (then - now).abs() <= (0.1 * then).max(if then < 3.0 { 0.0 } else { 3.0 })
                }
                _ => then.trim() == now.trim(),
            }
        });
        if !same {
            moved.push(format!("{then}\nbecame {now}"));
        }
    }
    Ok(moved)
}
