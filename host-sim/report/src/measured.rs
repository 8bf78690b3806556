//! Instructions per update on the board, from the table of `cargo pareto`.

use std::collections::BTreeMap;

use experiments::recommend::Cost;

/// The table that `cargo pareto` measured.
const MEASURED: &str = include_str!("../../../measured/pareto.csv");

/// Mean instructions per update on a Cortex-M4F, as [`cost`].
#[must_use]
pub fn instructions(estimator: &str, parameters: &BTreeMap<&'static str, f64>) -> Option<f64> {
    cost(estimator, parameters).map(|cost| cost.mean)
}

/// Instructions per update on a Cortex-M4F over the traces of `cargo pareto` at 1 and 10 kHz, at
/// `opt-level` 3; `None` for an estimator that was not measured. The cost of FOAW depends on its
/// window n: the row counts whose n is nearest by ratio.
#[must_use]
pub fn cost(estimator: &str, parameters: &BTreeMap<&'static str, f64>) -> Option<Cost> {
    let n = parameters.get("n").copied().unwrap_or(1.0);
    let away = |row: &(String, Option<f64>, Cost)| row.1.map_or(0.0, |of| (of / n).ln().abs());
    let rows = rows().into_iter().filter(|(name, ..)| name == estimator);
    let nearest = rows.min_by(|a, b| away(a).total_cmp(&away(b)));
    nearest.map(|(_, _, cost)| cost)
}

/// Name, window and cost of each row.
fn rows() -> Vec<(String, Option<f64>, Cost)> {
    let mut reader = csv::Reader::from_reader(MEASURED.as_bytes());
    let head = reader.headers().expect("a head").clone();
    let column = |name| {
        head.iter()
            .position(|one| one == name)
            .expect("a column of cargo pareto")
    };
    let (name, mean, most) = (column("estimator"), column("mean_3"), column("most_3"));
    let rows = reader.records().map(|row| {
        let row = row.expect("a row of cargo pareto");
        let number = |at: usize| row[at].parse().expect("a number of cargo pareto");
        let cost = Cost {
            mean: number(mean),
            most: number(most),
        };
        match row[name].split_once(", n = ") {
            Some((name, n)) => (name.to_owned(), n.parse().ok(), cost),
            None => (row[name].to_owned(), None, cost),
        }
    });
    rows.collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn mean_of_the_instructions_is_not_their_maximum() {
        for (name, _, cost) in rows() {
            assert!(cost.mean <= cost.most, "{name}");
        }
        let of_adaptive = cost("adaptive-edge", &BTreeMap::new()).unwrap();
        assert!(of_adaptive.mean < of_adaptive.most);
    }

    #[test]
    fn measured_table_is_read() {
        let none = BTreeMap::new();
        let cheap = instructions("finite-difference", &none).unwrap();
        let dear = instructions("adaptive-edge", &none).unwrap();
        assert!(cheap < 30.0 && dear > 5.0 * cheap, "{cheap} {dear}");
        let foaw = |n| instructions("foaw-end-fit", &BTreeMap::from([("n", n)])).unwrap();
        assert!(foaw(128.0) > 1.5 * foaw(10.0));
        assert_eq!(foaw(10.0), foaw(20.0));
        assert_eq!(instructions("nobody", &none), None);
    }
}
