//! The choice among ranked estimators.

use catalogue::estimators::DIFFERENCE;

use super::*;

fn ranked(estimator: &'static str, rms_pct: f64, most: Option<f64>) -> Ranked {
    Ranked {
        estimator,
        recommended: None,
        rms_pct,
        rms_rad_s: 0.0,
        p99_rad_s: 0.0,
        delay_ms: None,
        sd_rad_s: None,
        cost: most.map(|most| Cost { mean: 1.0, most }),
        reads: Vec::new(),
        parameters: BTreeMap::new(),
        rust: String::new(),
        logs: Vec::new(),
    }
}

#[test]
fn cheaper_of_equal_estimators_is_chosen_within_the_budget() {
    let all = [
        ranked("a", 10.0, None),
        ranked("b", 10.05, Some(400.0)),
        ranked("c", 10.08, Some(300.0)),
        ranked("d", 10.2, Some(50.0)),
        ranked("e", 30.0, Some(20.0)),
    ];
    let names = |budget: f64| chosen(&all, budget).map(|i| all[i].estimator);
    assert_eq!(names(f64::INFINITY), Some("c"));
    assert_eq!(names(100.0), Some("d"));
    assert_eq!(names(20.0), Some("e"));
    assert_eq!(names(10.0), None);
}

#[test]
fn short_table_has_the_first_eight_the_recommended_ones_and_finite_difference() {
    let names = [
        "a", "b", "c", "d", "e", "f", "g", "h", "ninth", "tenth", DIFFERENCE,
    ];
    let mut rows: Vec<_> = names.iter().map(|name| ranked(name, 10.0, None)).collect();
    rows[9].recommended = Some("cheap");
    let recommendation = Recommendation {
        ranked: rows,
        outcomes: Vec::new(),
        notes: Vec::new(),
    };
    for (all, others) in [(false, 0), (true, 1)] {
        let table = table(&recommendation, all, 200);
        let times = |name: &str| table.matches(name).count();
        let found = [times("tenth (cheap)"), times(DIFFERENCE), times("ninth")];
        assert_eq!(found, [1, 1, others], "{table}");
    }
}

#[test]
fn signals_besides_the_counts_are_named_as_columns() {
    for (name, columns) in [
        ("pll", &[][..]),
        ("m-over-t", &["edge_tick"]),
        ("kalman-motor", &["current"]),
        ("observer-edge", &["current", "counts_small", "edge_tick"]),
    ] {
        assert_eq!(reads(Kind::named(name).unwrap()), columns, "{name}");
    }
}
