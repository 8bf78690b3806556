//! What a kind of estimator needs of a trace, and what its estimator reports.

use std::f64::consts::TAU;

use catalogue::estimators::{Estimator, Kind, Lack, Reports, Setup, sample};
use catalogue::parameters::{Parameters, PlantKind, Presets, read};
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

/// A coarser encoder and a lower rate both lower the bandwidth, here below the lowest one.
#[test]
fn scaled_value_at_the_end_of_its_range_is_named() {
    let pll = kind("pll");
    let lowest = pll.parameters[0].lowest;
    let layer = |bandwidth: f64| {
        let text = format!(
            "[[preset]]\nrate_hz = 1000\nplant = 'friction'\ncounts_per_rev = 4096\n\
             estimators = {{ pll = {{ bandwidth_hz = {bandwidth:?} }} }}\n"
        );
        Presets::parse(&text, "mine.toml").unwrap()
    };
    let mut parameters = Parameters::default();
    parameters.layer(layer(lowest));
    let at_ends = |parameters: &Parameters, rate_hz: f64, counts: u32| {
        let mut setup = Setup::default();
        setup.rate.0 = rate_hz;
        setup.stages.large.counts_per_rev = counts;
        parameters.at_range_ends(pll, &setup, PlantKind::Friction)
    };
    let name = ["bandwidth_hz"];
    assert_eq!(at_ends(&parameters, 1000.0, 4096), [""; 0]);
    assert_eq!(at_ends(&parameters, 1000.0, 64), name);
    assert_eq!(at_ends(&parameters, 100.0, 4096), name);
    assert_eq!(at_ends(&parameters, 10_000.0, 4096), [""; 0]);
    // A value of another file, or one that is set, comes first.
    let mut other = parameters.clone();
    other.layer(layer(100.0 * lowest));
    assert_eq!(at_ends(&other, 1000.0, 64), [""; 0]);
    parameters.set("pll.bandwidth_hz=20").unwrap();
    assert_eq!(at_ends(&parameters, 1000.0, 64), [""; 0]);
}

#[test]
fn spaces_around_the_parts_of_a_set_value_are_no_part_of_them() {
    let mut parameters = Parameters::default();
    parameters.set(" pll . bandwidth_hz = 20 ").unwrap();
    let values = parameters.values(kind("pll"), &Setup::default(), PlantKind::Friction);
    assert_eq!(values, [20.0]);
}

#[test]
fn most_counts_of_a_possible_design_are_named_with_the_command_for_a_log() {
    let mut compared = 0;
    for kind in Kind::all() {
        for (counts, rate_hz) in [(100_000, 100.0), (1_000_000, 100.0), (1_000_000, 1000.0)] {
            let at = |counts| {
                let mut setup = Setup::default();
                setup.rate.0 = rate_hz;
                setup.stages.large.counts_per_rev = counts;
                setup
            };
            let values = Parameters::default().values(kind, &at(counts), PlantKind::Friction);
            let Err(refused) = kind.build(&at(counts), &values) else {
                continue;
            };
            let Some(fewer) = kind.coarser(&at(counts), &values) else {
                continue;
            };
            let is_possible = |counts| kind.build(&at(counts), &values).is_ok();
            let halved: Vec<_> = (1..20).map(|k| counts >> k).collect();
            let first = halved.into_iter().find(|counts| is_possible(*counts));
            assert_eq!(Some(fewer), first, "{} {counts} {rate_hz}", kind.name);
            let said = format!(
                "; with {fewer} counts/rev it is possible, for a log by host-sim coarsen --fine-counts-per-rev {counts} \
                 --counts-per-rev {fewer} --rate {rate_hz}, or take another estimator, as imm"
            );
            assert!(refused.to_string().ends_with(&said), "{refused}");
            let why = kind.refusal(&at(counts), &values).unwrap();
            assert!(why.starts_with(&format!("at {rate_hz} Hz: ")), "{why}");
            assert_eq!(kind.refusal(&at(fewer), &values), None);
            compared += 1;
        }
    }
    assert!(compared > 0);
}

#[test]
fn unknown_parameter_is_answered_with_those_that_there_are() {
    let said = |name: &str| kind(name).parameter("gain").unwrap_err().to_string();
    assert_eq!(
        said("finite-difference"),
        "finite-difference has no parameter 'gain': it has none at all"
    );
    assert!(said("pll").starts_with("pll has no parameter 'gain'; there are bandwidth_hz"));
}
