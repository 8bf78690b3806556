//! The tasks as a table and as CSV.

use std::fmt::Write as _;

use super::Task;

/// The cells of the table.
#[must_use]
pub fn cells(tasks: &[Task]) -> Vec<Vec<String>> {
    let row = |task: &Task| {
        let (mean, most) = task.instructions;
        let (cycles, cycles_most) = task.cycles;
        let rates = task.highest_rates_hz();
        let mut cells = vec![
            task.scene.clone(),
            task.estimator.to_owned(),
            format!("{mean:.0}"),
            most.to_string(),
            format!("{cycles:.0}"),
            cycles_most.to_string(),
        ];
        cells.extend(rates.map(|hertz| format!("{:.1}", 1e-3 * hertz)));
        cells
    };
    tasks.iter().map(row).collect()
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
