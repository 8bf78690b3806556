//! The rows as a table and as CSV.

use std::fmt::Write;

use crate::image::Level;
use crate::measure::Row;

/// Another compiler may move instructions, cycles and bytes of code by a tenth or by 3, and a rate with them. The
/// bytes of a state and the errors, to the last digit of the table, are the same everywhere.
#[must_use]
pub fn same(column: &str, then: f64, now: f64) -> bool {
    if column == "state" || column.starts_with("rms_") {
        return then.to_bits() == now.to_bits();
    }
    (then - now).abs() <= (0.1 * then).max(if then < 3.0 { 0.0 } else { 3.0 })
}

/// The cells of the table.
#[must_use]
pub fn cells(rows: &[Row]) -> Vec<Vec<String>> {
    let row = |row: &Row| {
        let [fast, small] = &row.cost;
        let front = match row.front {
            [true, true] => "both",
            [true, false] => "1 kHz",
            [false, true] => "10 kHz",
            [false, false] => "",
        };
        let [slow_rate, fast_rate] = row.rms_rad_s;
        vec![
            row.name.clone(),
            format!("{:.0}", fast.mean),
            fast.most.to_string(),
            format!("{:.0}", fast.at_rest),
            format!("{:.0}", small.mean),
            small.most.to_string(),
            format!("{:.0}", row.cycles()),
            fast.code.to_string(),
            row.state.to_string(),
            format!("{slow_rate:.3}"),
            format!("{fast_rate:.3}"),
            front.to_owned(),
            format!("{:.1}", 1e-3 * row.highest_rate_hz),
        ]
    };
    rows.iter().map(row).collect()
}

/// The cells of the table of comparators.
#[must_use]
pub fn cost_cells(rows: &[Row]) -> Vec<Vec<String>> {
    let row = |row: &Row| {
        let [fast, small] = &row.cost;
        vec![
            row.name.clone(),
            format!("{:.0}", fast.mean),
            fast.most.to_string(),
            format!("{:.0}", fast.at_rest),
            format!("{:.0}", small.mean),
            format!("{:.0}", row.cycles()),
            fast.code.to_string(),
            row.state.to_string(),
        ]
    };
    rows.iter().map(row).collect()
}

/// Everything as CSV.
#[must_use]
pub fn csv(rows: &[Row]) -> String {
    let mut csv = "estimator,peer,level,mean,most,at_rest,cycles_per_instruction,code,state,rms_1khz_rad_s,rms_10khz_rad_s,highest_rate_hz\n".to_owned();
    for row in rows {
        for (level, cost) in Level::ALL.map(Level::name).iter().zip(&row.cost) {
            let cycles = cost.cycles_per_instruction;
            writeln!(
                csv,
                "\"{}\",{},{level},{},{},{},{},{},{},{},{},{}",
                row.name,
                row.peer,
                cost.mean,
                cost.most,
                cost.at_rest,
                cycles.map(|cycles| cycles.to_string()).unwrap_or_default(),
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

#[cfg(test)]
mod tests {
    use super::same;

    #[test]
    fn compiler_moves_instructions_and_no_state_or_error() {
        for column in ["mean_3", "most_s", "cycles_3", "code_3", "rate_khz"] {
            assert!(same(column, 100.0, 110.0) && !same(column, 100.0, 111.0));
            assert!(same(column, 4.0, 7.0) && !same(column, 4.0, 7.1));
        }
        assert!(same("state", 52.0, 52.0) && !same("state", 52.0, 51.0));
        for column in ["rms_1khz_rad_s", "rms_10khz_rad_s"] {
            assert!(same(column, 0.695, 0.695) && !same(column, 0.695, 0.696));
        }
    }
}
