//! What an update costs on the board: the table that `cargo pareto` measured.

use std::collections::BTreeMap;

/// The document that `cargo pareto` writes its table into.
const MEASURED: &str = include_str!("../../../docs/benchmarks.md");
const BEGIN: &str = "<!-- pareto: written by cargo pareto -->";
const END: &str = "<!-- end of pareto -->";

/// Instructions an update on a Cortex-M4F, mean of the traces, at `opt-level` 3; `None` of what was
/// not measured. FOAW costs as its window is long: the row whose n is nearest to `n`.
#[must_use]
pub fn instructions(estimator: &str, parameters: &BTreeMap<&'static str, f64>) -> Option<f64> {
    let n = parameters.get("n").copied().unwrap_or(1.0);
    let away = |row: &&(&str, Option<f64>, f64)| row.1.map_or(0.0, |of| (of / n).ln().abs());
    let rows: Vec<_> = rows().filter(|(name, ..)| *name == estimator).collect();
    let nearest = rows.iter().min_by(|a, b| away(a).total_cmp(&away(b)));
    nearest.map(|(_, _, mean)| *mean)
}

/// Name, window and mean of each row.
fn rows() -> impl Iterator<Item = (&'static str, Option<f64>, f64)> {
    let table = MEASURED.split_once(BEGIN).map_or("", |(_, rest)| rest);
    let table = table.split_once(END).map_or("", |(table, _)| table);
    table.lines().filter_map(|line| {
        let mut cells = line.strip_prefix('|')?.split('|').map(str::trim);
        let name = cells.next()?;
        let mean = cells.next()?.parse().ok()?;
        Some(match name.split_once(", n = ") {
            Some((name, n)) => (name, n.parse().ok(), mean),
            None => (name, None, mean),
        })
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_table_of_the_docs_is_read() {
        let none = BTreeMap::new();
        let cheap = instructions("finite-difference", &none).unwrap();
        let dear = instructions("adaptive-edge", &none).unwrap();
        assert!(cheap < 30.0 && dear > 5.0 * cheap, "{cheap} {dear}");
        let foaw = |n| instructions("foaw-end-fit", &BTreeMap::from([("n", n)])).unwrap();
        assert!(foaw(128.0) > 1.5 * foaw(10.0));
        assert_eq!(foaw(10.0), foaw(20.0));
        assert_eq!(instructions("observer-held", &none), None);
    }
}
