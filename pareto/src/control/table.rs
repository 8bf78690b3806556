//! The tasks as a table and as CSV.

use std::fmt::Write as _;

use super::Task;
use crate::golden::Golden;

/// Where the table stands.
pub const GOLDEN: Golden = Golden {
    begin: "<!-- control: written by cargo pareto -->",
    end: "<!-- end of control -->",
};

const HEAD: &str = "\
| scene | large motor by | instructions, mean | most | cycles, mean | most | kHz, instructions, mean | most | kHz, cycles, mean | most |
|---|---|---|---|---|---|---|---|---|---|
";

/// The table in Markdown.
#[must_use]
pub fn markdown(tasks: &[Task]) -> String {
    let mut table = HEAD.to_owned();
    for task in tasks {
        let (mean, most) = task.instructions;
        let (cycles, cycles_most) = task.cycles;
        let [a, b, c, d] = task.highest_rates_hz().map(|hertz| 1e-3 * hertz);
        // Writing to a string cannot fail.
        let _ = writeln!(
            table,
            "| {} | {} | {mean:.0} | {most} | {cycles:.0} | {cycles_most} | {a:.1} | {b:.1} | {c:.1} | {d:.1} |",
            task.scene, task.estimator
        );
    }
    table
}

/// Everything as CSV.
#[must_use]
pub fn csv(tasks: &[Task]) -> String {
    let mut csv = "scene,estimator,instructions_mean,instructions_most,cycles_mean,cycles_most,\
         rate_instructions_mean_hz,rate_instructions_most_hz,rate_cycles_mean_hz,\
         rate_cycles_most_hz\n"
        .to_owned();
    for task in tasks {
        let (mean, most) = task.instructions;
        let (cycles, cycles_most) = task.cycles;
        let [a, b, c, d] = task.highest_rates_hz();
        let _ = writeln!(
            csv,
            "{},\"{}\",{mean},{most},{cycles},{cycles_most},{a},{b},{c},{d}",
            task.scene, task.estimator
        );
    }
    csv
}
