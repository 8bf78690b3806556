//! The choice among ranked estimators.

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
