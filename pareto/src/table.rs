//! The rows as a table and as CSV.

use std::fmt::Write;

use crate::golden::Golden;
use crate::measure::Row;

/// Where the table stands.
pub const GOLDEN: Golden = Golden {
    begin: "<!-- pareto: written by cargo pareto -->",
    end: "<!-- end of pareto -->",
};

const HEAD: &str = "\
| estimator | mean, `3` | most, `3` | at rest, `3` | mean, `s` | most, `s` | cycles, `3` | code, `3` | state | RMS, 1 kHz | RMS, 10 kHz | front | kHz |
|---|---|---|---|---|---|---|---|---|---|---|---|---|
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
            "| {} | {:.0} | {} | {:.0} | {:.0} | {} | {:.0} | {} | {} | {slow_rate:.3} | {fast_rate:.3} | {front} | {:.1} |",
            row.name,
            fast.mean,
            fast.most,
            fast.at_rest,
            small.mean,
            small.most,
            row.cycles(),
            fast.code,
            row.state,
            1e-3 * row.highest_rate_hz,
        )
        .expect("a string takes all");
    }
    table
}

/// Everything as CSV.
#[must_use]
pub fn csv(rows: &[Row]) -> String {
    let mut csv = "estimator,peer,level,mean,most,at_rest,cycles_per_instruction,code,state,rms_1khz_rad_s,rms_10khz_rad_s,highest_rate_hz\n".to_owned();
    for row in rows {
        for (level, cost) in ["3", "s"].iter().zip(&row.cost) {
            writeln!(
                csv,
                "\"{}\",{},{level},{},{},{},{},{},{},{},{},{}",
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
                row.highest_rate_hz,
            )
            .expect("a string takes all");
        }
    }
    csv
}
