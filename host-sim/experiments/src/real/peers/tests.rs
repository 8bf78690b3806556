use std::path::Path as FilePath;

use catalogue::estimators::Kind;
use catalogue::parameters::Parameters;
use estimator_core::Pll;
use simulation::device::Device;

use super::*;
use crate::real::run::run;
use crate::real::sources::Role;

fn settings(estimators: &[&str]) -> Settings {
    let kinds = estimators.iter().map(|name| Kind::named(name).unwrap());
    Settings {
        estimators: kinds.collect(),
        parameters: Parameters::default(),
        device: Device::default(),
        counts_per_rev: vec![4096],
        rates_hz: vec![1000.0],
        phases: vec![0.37],
        seconds: 2.0,
    }
}

fn recordings(settings: &Settings) -> (Recordings, Vec<Case>) {
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/../../tests/data/real");
    let recordings =
        Recordings::read(FilePath::new(folder), &settings.device, settings.seconds).unwrap();
    let cases = recordings.cases(settings);
    (recordings, cases)
}

#[test]
fn newest_sample_at_or_before_a_tick_is_read() {
    // 12.5 kHz: every second tick of 1 kHz is between two samples.
    assert_eq!(path::ticks(1000.0, 4, 12_500.0, 100), [0, 12, 25, 37]);
    assert_eq!(path::ticks(1000.0, 3, 8000.0, 17), [0, 8, 16]);
    // A slower rate holds its velocity, and so does the end of the samples.
    assert_eq!(path::ticks(2000.0, 4, 1000.0, 2), [0, 0, 1, 1]);
    assert_eq!(path::ticks(1000.0, 3, 8000.0, 10), [0, 8, 9]);
}

#[test]
fn velocity_at_a_tick_is_in_rad_per_s_at_the_rate_of_the_samples() {
    // Three counts of 4096 in each sample of 8 kHz, read at 1 kHz.
    let trace = Trace {
        rate_hz: 8000.0,
        counts_large: (0..33).map(|k| 3 * k).collect(),
        ..Trace::default()
    };
    let found = Path::new(&trace, 1000.0, 5, 4096).velocities(&FiniteDifference);
    let speed = (3.0 * 8000.0 * std::f64::consts::TAU / 4096.0) as f32;
    assert_eq!(found, [0.0, speed, speed, speed, speed]);
}

#[test]
fn rate_of_the_ticks_gives_the_scores_of_real() {
    let settings = settings(&["pll", "imm-edge", "finite-difference"]);
    let (recordings, cases) = recordings(&settings);
    let outcomes = run(&recordings, &cases, &settings, |_| false, &|| ()).unwrap();
    let of_real = outcomes.into_iter().flat_map(|outcome| outcome.rows);
    let of_real: Vec<_> = of_real.filter(|row| row.phase.is_some()).collect();
    assert_eq!(of_real.len(), 8 * 3);
    let at_ticks = ours_at(&recordings, &cases, &settings, 1000.0).unwrap();
    assert_eq!(of_real, at_ticks);
    // At 8 kHz a count is worth eight times as much, and the newest difference is read.
    let faster = ours_at(&recordings, &cases, &settings, 8000.0).unwrap();
    let difference = |row: &&Row| row.estimator == "finite-difference";
    for row in faster.iter().filter(difference) {
        assert!(row.score.rms_pct.unwrap() > 200.0, "{row:?}");
    }
}

/// A finite difference and a loop of this project as peers.
const OURS: [Peer; 2] = [
    Peer {
        name: "difference",
        parameters: &[],
        run: |path, _| path.velocities(&FiniteDifference),
        ..PLL
    },
    Peer {
        name: "loop",
        rate_hz: Some(8000.0),
        run: |path, p| {
            path.velocities(&Pll::new(estimator_core::Hertz(p[0]), path.rate()).unwrap())
        },
        ..PLL
    },
];

#[test]
fn peer_has_rows_for_defaults_and_tuned_values_on_fine_recordings() {
    let settings = settings(&[]);
    let (recordings, cases) = recordings(&settings);
    let tuned = tune(&recordings, &cases, &settings, &OURS).unwrap();
    assert_eq!(tuned.len(), 1);
    assert_eq!(names(&OURS, &tuned), ["difference", "loop", "pll-tuned"]);
    assert_eq!(
        shown(&OURS, &tuned[0]),
        format!("bandwidth_hz {}", tuned[0].values[0])
    );
    let rows = rows(&recordings, &cases, &settings, &OURS, &tuned).unwrap();
    assert_eq!(rows.len(), 8 * 3);
    let mean = |name: &str, role: Role| {
        let own = rows
            .iter()
            .filter(|row| row.estimator == name && row.role == role);
        let errors: Vec<f64> = own.map(|row| row.score.rms_pct.unwrap()).collect();
        errors.iter().sum::<f64>() / errors.len() as f64
    };
    assert_eq!(mean("difference", Role::Judges), 100.0);
    // Tuning is on the recordings that choose: no bandwidth near it is better there.
    let best = mean("pll-tuned", Role::Chooses);
    assert!(best < mean("loop", Role::Chooses));
    for factor in [0.8, 1.25] {
        let values = vec![factor * tuned[0].values[0]];
        let other = Tuned {
            values,
            ..tuned[0].clone()
        };
        let moved = super::rows(&recordings, &cases, &settings, &OURS, &[other]).unwrap();
        let own = |row: &&Row| row.estimator == "pll-tuned" && row.role == Role::Chooses;
        let errors = moved
            .iter()
            .filter(own)
            .map(|row| row.score.rms_pct.unwrap());
        assert!(errors.sum::<f64>() / 4.0 > best);
    }
}

#[test]
fn every_default_is_within_its_range_and_every_name_is_once() {
    let mut names = std::collections::BTreeSet::new();
    for peer in PEERS {
        assert!(names.insert(peer.name), "{}", peer.name);
        assert_eq!(peer.tuned.is_empty(), peer.parameters.is_empty());
        for parameter in peer.parameters {
            let [low, high] = parameter.range;
            assert!((low..=high).contains(&parameter.default), "{}", peer.name);
        }
    }
}
