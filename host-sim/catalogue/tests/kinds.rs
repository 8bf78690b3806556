//! What a kind of estimator needs of a trace, and what its estimator reports.

use std::f64::consts::TAU;

use catalogue::estimators::{Estimator, Kind, Lack, Reports, Setup, sample};
use catalogue::parameters::{Parameters, PlantKind, read};
use estimator_core::{Signals, VelocityEstimator as _};
use simulation::trace::{EdgeStamp, Trace};

const ROWS: usize = 400;

const ALL: Signals = Signals {
    current: true,
    coupled: true,
    edge: true,
};

/// A shaft that accelerates away from the handle, with these columns.
fn trace(current: bool, coupled: bool, edge: bool) -> Trace {
    let counts = (0..ROWS as u32).map(|k| k * k / 100);
    let stamp = |boundary| {
        Some(EdgeStamp {
            age_s: 1e-4,
            boundary,
        })
    };
    Trace {
        rate_hz: 1000.0,
        counts_large: counts.clone().collect(),
        counts_small: coupled.then(|| vec![0; ROWS]),
        current: current.then(|| vec![0.2; ROWS]),
        edges: edge.then(|| counts.map(stamp).collect()),
        ..Trace::default()
    }
}

fn kind(name: &str) -> &'static Kind {
    Kind::named(name).unwrap()
}

fn estimator(name: &str) -> Estimator {
    let setup = Setup::default();
    let values = Parameters::default().values(kind(name), &setup, PlantKind::Friction);
    kind(name).build(&setup, &values).unwrap()
}

fn reports(name: &str, trace: &Trace) -> Reports {
    estimator(name).resume(&mut None, trace, 0)
}

#[test]
fn first_column_that_a_trace_lacks_is_named() {
    let lack = |name: &str, trace: &Trace| kind(name).lack(trace);
    let column = |name| Some(Lack::Column(name));
    for (name, [current, coupled, edge], lacks) in [
        ("finite-difference", [false; 3], None),
        ("kalman-motor", [false, true, true], column("current")),
        ("kalman-motor", [true, false, false], None),
        ("observer", [false; 3], column("current")),
        ("observer", [false, true, true], column("current")),
        ("observer", [true, false, true], column("counts_small")),
        ("observer", [true, true, false], None),
        ("observer-edge", [true, true, false], column("edge_tick")),
        ("imm-edge", [true, true, false], column("edge_tick")),
        ("imm-edge", [false, false, true], None),
    ] {
        let trace = trace(current, coupled, edge);
        assert_eq!(
            lack(name, &trace),
            lacks,
            "{name} {current} {coupled} {edge}"
        );
    }
    let mut uneven = trace(true, true, true);
    uneven.periods = Some(vec![1.0; ROWS]);
    assert_eq!(lack("finite-difference", &uneven), None);
    assert_eq!(lack("pll", &uneven), Some(Lack::ConstantPeriod));
    // A column that is not there is named before the period.
    uneven.current = None;
    assert_eq!(lack("observer", &uneven), column("current"));
}

#[test]
fn observers_and_tunable_kinds_are_those_with_such_parameters() {
    for (name, is_observer, is_tunable) in [
        ("finite-difference", false, false),
        ("pll", false, true),
        ("observer", true, true),
    ] {
        assert_eq!(kind(name).is_observer(), is_observer, "{name}");
        assert_eq!(kind(name).is_tunable(), is_tunable, "{name}");
    }
}

#[test]
fn setup_without_friction_is_otherwise_the_same() {
    let setup = Setup::default();
    let without = setup.frictionless();
    assert_eq!(without.stages.large.coulomb_friction, 0.0);
    assert!(setup.stages.large.coulomb_friction > 0.0);
    assert_eq!(without.stages.large.inertia, setup.stages.large.inertia);
    assert_eq!(without.stages.damping, setup.stages.damping);
    assert_eq!(without.rate, setup.rate);
}

/// The standard deviation of a difference is one count over its period.
#[test]
fn deviation_of_a_difference_falls_with_its_period() {
    let mut trace = trace(false, false, false);
    let scale = TAU * trace.rate_hz / 4096.0;
    let constant = reports("finite-difference", &trace).deviation.unwrap();
    let periods: Vec<f32> = (0..ROWS).map(|k| 0.5 + (k % 4) as f32).collect();
    trace.periods = Some(periods.clone());
    let varying = reports("finite-difference", &trace).deviation.unwrap();
    for (k, period) in periods.into_iter().enumerate().skip(1) {
        let near = |deviation: f32, period: f32| {
            let exact = scale / f64::from(period);
            (f64::from(deviation) / exact - 1.0).abs() < 1e-6
        };
        assert!(near(constant[k], 1.0), "{} in row {k}", constant[k]);
        assert!(near(varying[k], period), "{} in row {k}", varying[k]);
    }
}

#[test]
fn learned_damping_is_reported_by_estimators_that_learn() {
    let trace = trace(true, true, true);
    for kind in Kind::all() {
        let name = kind.name;
        let learned = estimator(name).damping_ratio(&trace);
        assert_eq!(learned, reports(name, &trace).damping_ratio, "{name}");
        let learns = ["adaptive", "adaptive-edge", "adaptive-soft"].contains(&name);
        assert_eq!(learned.is_some(), learns, "{name}");
        let Some(learned) = learned else { continue };
        assert_eq!(learned.len(), ROWS);
        assert_eq!(learned[0], 1.0, "{name}");
        let last = learned[ROWS - 1];
        assert!(
            last != 1.0 && last > 0.0 && last.is_finite(),
            "{name}: {last}"
        );
    }
}

#[test]
fn states_are_equal_if_estimator_and_content_are() {
    let trace = trace(true, true, true);
    let (pll, low_pass) = (estimator("pll"), estimator("low-pass"));
    let mut state = pll.start(&sample(ALL, &trace, 0));
    let before = state.clone();
    assert!(before == state);
    assert!(low_pass.start(&sample(ALL, &trace, 0)) != state);
    pll.update(&mut state, &sample(ALL, &trace, 20));
    assert!(before != state);
}

#[test]
fn presets_file_gives_the_values_of_its_estimators() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("mine.toml");
    let write = |bandwidth: &str| {
        let text = format!(
            "[[preset]]\nrate_hz = 1000\nplant = 'friction'\ncounts_per_rev = 4096\n\
             estimators = {{ pll = {{ bandwidth_hz = {bandwidth} }} }}\n"
        );
        std::fs::write(&path, text).unwrap();
    };
    write("12.5");
    let mut parameters = Parameters::default();
    parameters.layer(read(&path).unwrap());
    let values = parameters.values(kind("pll"), &Setup::default(), PlantKind::Friction);
    assert_eq!(values, [12.5]);
    write("-1");
    let error = read(&path).unwrap_err().to_string();
    assert!(
        error.contains("mine.toml") && error.contains("bandwidth_hz"),
        "{error}"
    );
    let error = read(folder.path()).unwrap_err().to_string();
    assert!(error.contains(": cannot read: "), "{error}");
}
