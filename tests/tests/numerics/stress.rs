//! `cargo stress`, short enough for every test run.

use estimator_catalogue::{Parameter, ROWS, Settling};
use measured::Row;
use measured::tables::{STRESS, STRESS_PARAMETERS};
use stress::findings::Findings;
use stress::tested::{TestedEstimator, at};
use stress::{sensitivity, signals, table, trial};

const TICKS: u64 = 1_000_000;

fn run(tested_estimators: &[TestedEstimator], seed: u64) -> Vec<Findings> {
    tested_estimators
        .iter()
        .map(|tested| trial::run(tested, seed, TICKS))
        .collect()
}

#[test]
fn every_estimator_passes_the_stress_course() {
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

/// The table has every estimator, none failed, and no figure of a run as short as this is far
/// beyond that of a longer one.
#[test]
fn measured_figures_are_those_of_these_estimators() {
    let mut rows = STRESS.read().unwrap();
    for rate in [1000.0, 10_000.0] {
        for (tested, found) in at(rate).iter().zip(run(&at(rate), 16)) {
            let name = &tested.name;
            let own =
                |row: &Row| row.text("estimator") == Ok(name) && row.number("rate_hz") == Ok(rate);
            let own = rows.iter().position(own);
            let row =
                rows.swap_remove(own.unwrap_or_else(|| panic!("{name} at {rate} Hz: no row")));
            let figure = |column: &str| row.number(column).unwrap();
            assert_eq!(figure("faults"), 0.0, "{name}: faults");
            assert!(
                figure("ticks") >= found.ticks as f64,
                "{name}: too few ticks"
            );
            assert_eq!(
                figure("settles_ticks"),
                f64::from(tested.bounds.settles_ticks)
            );
            let recovery = f64::from(found.recovery_ticks);
            assert!(
                recovery <= 1.1 * figure("recovery_ticks") + 2.0,
                "{name}: {recovery} ticks"
            );
            if tested.bounds.deviation_rad_s.is_finite() {
                let deviation = found.deviation_rad_s;
                assert!(
                    deviation <= 2.0 * figure("deviation_rad_s"),
                    "{name}: {deviation} rad/s"
                );
            }
        }
    }
    assert!(rows.is_empty(), "rows too many: {rows:?}");
}

/// Whether the law of the row of this name switches by the sign of an error.
fn switches(name: &str) -> bool {
    let switches = |row: &estimator_catalogue::Row| {
        matches!(
            row.settling,
            Settling::Switching(_) | Settling::Chattering(_)
        )
    };
    ROWS.iter().any(|row| row.name == name && switches(row))
}

#[test]
fn extreme_parameters_are_stable_or_refused_by_name() {
    let all = sensitivity::all();
    // Refusals are those of the table. The deviation is one of two digits.
    let same = |column: &str, then: f64, now: f64| match column {
        "relative_deviation" => (then - now).abs() <= 0.1 * then,
        _ => then.to_bits() == now.to_bits(),
    };
    let checked = STRESS_PARAMETERS.check(&[], &table::sensitivity(&all), same);
    checked.unwrap_or_else(|error| panic!("{error}"));
    for outcome in all {
        let name = &outcome.estimator;
        assert!(outcome.broken.is_empty(), "{name}: {:#?}", outcome.broken);
        let refused: u32 = outcome.refused.values().sum();
        assert!(
            refused > 0 && refused < outcome.tried,
            "{name}: {outcome:?}"
        );
        // With a current that is all noise the motor filter's pole goes to -1, and the rounding of
        // its gain shows; observers, banks and switching laws decide. Stable is all that they have to be
        // there.
        let stable = ["kalman-motor", "observer", "adaptive", "imm"];
        // Soon after a start in motion the covariance of `kalman-triple` decreases from its prior with a loss of
        // digits.
        let bound = if name == "kalman-triple" { 1e-4 } else { 1e-5 };
        if !stable.iter().any(|one| name.starts_with(one)) && !switches(name) {
            assert!(outcome.relative_deviation < bound, "{name}: {outcome:?}");
        }
    }
}

/// On what a device can show f32 is as good as f64: the same error against the truth.
#[test]
fn f32_error_is_negligible_on_the_signals_of_a_device() {
    for (rate, seed) in [(1000.0, 14), (10_000.0, 15)] {
        let scenarios = signals::at(rate, seed);
        for tested in at(rate) {
            let found = signals::difference(&tested, &scenarios);
            assert!(found.added_error().abs() < 1e-2, "{found:?}");
            // Without time stamps an observer decides at every count whether the prediction agrees;
            // without the handle or the current it decides that between two edges too. A bank decides
            // at every tick which filters it runs. A switching law decides by the sign of an error.
            let decides = ROWS.iter().any(|row| {
                let observer = row.parameters.iter().any(Parameter::is_torque);
                let bank = row.name.starts_with("imm");
                let edges = row.needs.edge && row.needs.coupled;
                row.name == found.estimator && (bank || observer && !edges)
            });
            let decides = decides || switches(&found.estimator);
            if !decides {
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
fn twin_computes_in_f64() {
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
