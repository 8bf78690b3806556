//! `cargo stress`, short enough for every test run.

use stress::contestants::{Contestant, at};
use stress::{sensitivity, table, trial};

const TICKS: u64 = 1_000_000;

fn run(contestants: &[Contestant], seed: u64) -> Vec<trial::Findings> {
    contestants
        .iter()
        .map(|contestant| trial::run(contestant, seed, TICKS, |_| ()))
        .collect()
}

#[test]
fn every_estimator_holds_over_a_hostile_course() {
    for (rate, seed) in [(1000.0, 11), (10_000.0, 12)] {
        let found = run(&at(rate), seed);
        assert!(
            found.iter().all(trial::Findings::passed),
            "\n{}",
            table::text(&found)
        );
        for one in &found {
            assert!(one.wraps > 1000, "{}: {} wraps", one.estimator, one.wraps);
        }
    }
}

#[test]
fn extreme_parameters_are_stable_or_refused_by_name() {
    for outcome in sensitivity::all() {
        let name = &outcome.estimator;
        assert!(outcome.broken.is_empty(), "{name}: {:#?}", outcome.broken);
        let refused: u32 = outcome.refused.values().sum();
        assert!(
            refused > 0 && refused < outcome.tried,
            "{name}: {outcome:?}"
        );
        // With a current that is all noise the motor filter's pole goes to -1, and the rounding of
        // its gain shows: stable is all it has to be there.
        if !name.starts_with("kalman-motor") {
            assert!(outcome.relative_deviation < 1e-5, "{name}: {outcome:?}");
        }
    }
}

/// The twin is what it says: the same results, but not the same rounding.
#[test]
fn the_twin_computes_in_f64() {
    let found = run(&at(1000.0), 13);
    for one in found
        .iter()
        .filter(|one| one.estimator != "finite-difference")
    {
        assert!(
            one.deviation_rad_s > 0.0,
            "{}: no rounding at all",
            one.estimator
        );
    }
}
