//! Observers without the handle's encoder whose model is that of another device: the table of
//! docs/theory/adaptive-observer.md, on seeds outside the tuning set.

use std::path::Path;

use catalogue::estimators::{Kind, Setup};
use catalogue::parameters::{Parameters, PlantKind};
use experiments::compare::{Case, interval, setup_of, trace};
use experiments::real::cases::Recordings;
use experiments::real::run::{Settings, run};
use rayon::prelude::*;
use scoring::score::{Truth, Wanted};
use simulation::device::Device;
use simulation::scenario::ScenarioName;

const SCENARIOS: [ScenarioName; 8] = {
    use ScenarioName::{Creep, FreeAir, Hold, Permanent, Step, Texture, Track, Wall};
    [Step, Permanent, Track, FreeAir, Wall, Texture, Creep, Hold]
};

const SEEDS: [u64; 3] = [101, 102, 103];

const RATE_HZ: f64 = 1000.0;

/// Names of the observers without and with adaptation.
const PAIRS: [[&str; 2]; 2] = [
    ["observer-held", "adaptive-held"],
    ["observer-edge-held", "adaptive-edge-held"],
];

/// A model that is wrong, and the largest error that adaptation may leave, in parts of the error
/// without: from counts and with edges.
struct Wrong {
    name: &'static str,
    change: fn(&mut Setup),
    /// Whether the sign of the torque constant is wrong. The design refuses a negative one, so the sign
    /// of the current is changed.
    turned: bool,
    largest: [f64; 2],
}

const fn wrong(name: &'static str, largest: [f64; 2], change: fn(&mut Setup)) -> Wrong {
    Wrong {
        name,
        change,
        turned: false,
        largest,
    }
}

const ALL: [Wrong; 9] = [
    wrong("right", [1.03, 1.03], |_| {}),
    wrong("J 10", [0.3, 0.3], |it| it.stages.large.inertia *= 10.0),
    wrong("J 0.1", [0.5, 0.3], |it| it.stages.large.inertia *= 0.1),
    wrong("b 5", [0.3, 0.3], |it| it.stages.damping *= 5.0),
    wrong("Kt 3", [0.3, 0.3], |it| {
        it.stages.large.torque_constant *= 3.0;
    }),
    wrong("Kt 10", [0.3, 0.3], |it| {
        it.stages.large.torque_constant *= 10.0;
    }),
    Wrong {
        turned: true,
        ..wrong("Kt -1", [0.3, 0.3], |_| {})
    },
    wrong("Tc 0", [0.7, 0.5], |it| {
        it.stages.large.coulomb_friction = 0.0;
    }),
    wrong("Tc 3", [0.7, 0.7], |it| {
        it.stages.large.coulomb_friction *= 3.0;
    }),
];

/// Errors of all pairs with all models in one run, % of finite difference.
fn errors(scenario: ScenarioName, seed: u64) -> Vec<[[f64; 2]; 2]> {
    let device = Device::default();
    let case = Case {
        scenario,
        rate_hz: RATE_HZ,
        plant: PlantKind::Friction,
        seed,
        seconds: 6.0,
        keep: false,
    };
    let pairs = PAIRS.map(|pair| pair.map(|name| Kind::named(name).unwrap()));
    let reference = Kind::named("finite-difference").unwrap();
    let all: Vec<&Kind> = pairs.iter().flatten().copied().chain([reference]).collect();
    let right = trace(&case, &device, &all).unwrap();
    let mut turned = right.clone();
    for current in turned.current.as_mut().unwrap() {
        *current = -*current;
    }
    let omega = right.true_omega.as_deref().unwrap();
    let wanted = Wanted {
        rms: true,
        ..Wanted::NONE
    };
    let truth = Truth::new(omega, RATE_HZ, interval(&device), wanted).unwrap();
    let setup = setup_of(&case, &device);
    let error = |kind: &Kind, wrong: &Wrong| {
        let values = Parameters::default().values(kind, &setup, case.plant);
        let mut assumed = setup;
        (wrong.change)(&mut assumed);
        let trace = if wrong.turned { &turned } else { &right };
        let velocities = kind.build(&assumed, &values).unwrap().run(trace);
        truth.score(&velocities).rms_rad_s.unwrap()
    };
    let whole = error(reference, &ALL[0]);
    ALL.iter()
        .map(|wrong| pairs.map(|pair| pair.map(|kind| 100.0 * error(kind, wrong) / whole)))
        .collect()
}

#[test]
fn adaptation_corrects_the_model_of_another_device() {
    let runs: Vec<_> = SCENARIOS
        .iter()
        .flat_map(|&scenario| SEEDS.map(|seed| (scenario, seed)))
        .collect();
    let found: Vec<_> = runs
        .par_iter()
        .map(|&(scenario, seed)| errors(scenario, seed))
        .collect();
    let mut missed = Vec::new();
    for (i, wrong) in ALL.iter().enumerate() {
        let mean = |pair: usize, one: usize| {
            found.iter().map(|run| run[i][pair][one]).sum::<f64>() / found.len() as f64
        };
        for (pair, [_, name]) in PAIRS.iter().enumerate() {
            let (fixed, adaptive) = (mean(pair, 0), mean(pair, 1));
            println!("{}: {name} {adaptive:.1} of {fixed:.1}", wrong.name);
            let within = adaptive < wrong.largest[pair] * fixed;
            if !within {
                missed.push((wrong.name, name, fixed, adaptive));
            }
        }
    }
    assert!(missed.is_empty(), "{missed:#?}");
}

/// The constants of the default device are those of another device on every recording. From 256 to 4096
/// counts per revolution and from 500 Hz to 2 kHz the estimate is better than finite difference at every
/// phase of the encoder.
#[test]
fn learned_models_are_better_than_finite_difference_on_recordings() {
    let seconds = 10.0;
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../tests/data/real");
    let recordings = Recordings::read(&folder, &Device::default(), seconds).unwrap();
    let settings = Settings {
        estimators: PAIRS.map(|[_, name]| Kind::named(name).unwrap()).to_vec(),
        parameters: Parameters::default(),
        device: Device::default(),
        counts_per_rev: vec![256, 1024, 4096],
        rates_hz: vec![500.0, 1000.0, 2000.0],
        phases: vec![0.12, 0.37, 0.55, 0.81],
        seconds,
    };
    let cases = recordings.cases(&settings);
    let outcomes = run(&recordings, &cases, &settings, |_| false, &|| ()).unwrap();
    let rows = outcomes.iter().flat_map(|outcome| &outcome.rows);
    let learned: Vec<_> = rows
        .filter(|row| row.estimator != "finite-difference" && row.score.rms_pct.is_some())
        .collect();
    assert!(learned.len() >= 2 * 5 * 9 * 4, "{}", learned.len());
    for row in learned {
        assert!(row.score.rms_pct.unwrap() < 100.0, "{row:#?}");
    }
}
