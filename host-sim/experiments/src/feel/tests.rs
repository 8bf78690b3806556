//! Tests of the runs that several cases share.

use std::sync::atomic::{AtomicUsize, Ordering};

use super::*;

const RATE_HZ: f64 = 1000.0;

fn case(scene: SceneKind, estimator: &str) -> Case {
    Case {
        scene,
        rate_hz: RATE_HZ,
        estimator: Some(Kind::named(estimator).unwrap()),
    }
}

fn settings(without: &[Without]) -> Settings {
    Settings {
        device: Device::default(),
        parameters: Parameters::default(),
        handle: Kind::named("kalman-triple-steady").unwrap(),
        seed: 1,
        seconds: 0.4,
        without: without.to_vec(),
    }
}

#[test]
fn run_without_the_estimation_error_is_shared_by_the_estimators_of_a_scene() {
    let settings = settings(&[Without::Dac, Without::EstimationError, Without::Everything]);
    let cases = [
        case(SceneKind::FreeAir, "pll"),
        case(SceneKind::FreeAir, "finite-difference"),
        case(SceneKind::Viscous, "pll"),
    ];
    // Each case has four jobs, of which the second one shares two with the first one.
    assert_eq!(runs(&cases, &settings), 10);
    let done = AtomicUsize::new(0);
    let count = || {
        done.fetch_add(1, Ordering::Relaxed);
    };
    let felt = feel(&cases, &settings, &count).unwrap();
    assert_eq!(done.into_inner(), 10);
    for (case, felt) in cases.iter().zip(&felt) {
        let alone = |without| run(case, without, &settings).unwrap().0;
        assert_eq!(felt.parasitic, alone(None));
        for (without, parasitic) in &felt.without {
            assert_eq!(*parasitic, alone(Some(*without)), "{}", without.name());
        }
    }
    // The estimators and the scenes differ where no run is shared.
    assert_ne!(felt[0].parasitic, felt[1].parasitic);
    assert_ne!(felt[0].without[0].1, felt[1].without[0].1);
    assert_ne!(felt[0].without[1].1, felt[2].without[1].1);
}

#[test]
fn rows_and_table_have_both_estimators_and_both_shares() {
    let settings = settings(&[]);
    let case = case(SceneKind::FreeAir, "pll");
    let mut felt = feel(&[case], &settings, &|| ()).unwrap();
    let attribution = felt[0].attribution.as_mut().unwrap();
    for part in &mut attribution.parts {
        (part.share, part.tactile_share) = (Some(0.125), Some(0.375));
    }
    let rows = rows::causes(&felt, &settings);
    assert_eq!(rows.len(), CAUSES);
    for row in &rows {
        let names = (row.of.controlled_by, row.of.handle_estimator);
        assert_eq!(names, ("pll", "kalman-triple-steady"));
    }
    let text = table::table(&felt, &settings, 1000);
    let line = text.lines().find(|line| line.contains("inertia")).unwrap();
    let cells: Vec<_> = line.split_whitespace().collect();
    assert_eq!((cells[2], cells[4]), ("12.5", "37.5"), "{text}");
}
