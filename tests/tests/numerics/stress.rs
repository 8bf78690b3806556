//! `cargo stress`, short enough for every test run.

use stress::contestants::{Contestant, at};
use stress::findings::Findings;
use stress::{sensitivity, signals, table, trial};

const TICKS: u64 = 1_000_000;

fn run(contestants: &[Contestant], seed: u64) -> Vec<Findings> {
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
            found.iter().all(Findings::passed),
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
        // its gain shows; observers decide. Stable is all that they have to be there.
        let stable = ["kalman-motor", "observer", "adaptive"];
        if !stable.iter().any(|one| name.starts_with(one)) {
            assert!(outcome.relative_deviation < 1e-5, "{name}: {outcome:?}");
        }
    }
}

/// On what a device can show f32 is as good as f64: the same error against the truth.
#[test]
fn f32_costs_nothing_on_the_signals_of_a_device() {
    for (rate, seed) in [(1000.0, 14), (10_000.0, 15)] {
        let scenarios = signals::at(rate, seed);
        for contestant in at(rate) {
            let found = signals::difference(&contestant, &scenarios);
            assert!(found.added_error().abs() < 1e-2, "{found:?}");
            // Without time stamps an observer asks of every count whether it is in its cell.
            if !matches!(&*found.estimator, "observer" | "adaptive") {
                assert!(found.rms_rad_s < 1e-5, "{found:?}");
            }
            if found.estimator != "finite-difference" {
                assert!(found.rms_rad_s > 0.0, "no rounding at all: {found:?}");
            }
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
