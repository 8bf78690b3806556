//! Error on recordings of real devices with tuned values as they are and scaled to the encoder. The
//! powers of the rule were chosen with none of them; that no band gets wider than the tuned one was chosen
//! with all.

use std::path::Path;

use catalogue::estimators::Kind;
use catalogue::parameters::{Parameters, PlantKind, Presets};
use experiments::real::cases::{Case, Recordings};
use experiments::real::run::{Settings, run};
use experiments::real::sources::Role;
use simulation::device::Device;

/// Encoders coarser and finer than the tuned one, counts per revolution.
const ENCODERS: [u32; 2] = [256, 16_384];

const SCALED: [&str; 8] = [
    "low-pass",
    "foaw-end-fit",
    "foaw-best-fit",
    "savitzky-golay",
    "pll",
    "alpha-beta-gamma",
    "tracking-differentiator",
    "finite-difference",
];

/// The shipped parameters, with the values that were tuned at `rate_hz` set by name.
fn unscaled(kinds: &[&'static Kind], rate_hz: f64) -> Parameters {
    let shipped = Presets::shipped();
    let mut parameters = Parameters::default();
    for kind in kinds {
        let tuned = shipped.nearest(kind.name, rate_hz, PlantKind::Friction);
        for (name, value) in tuned
            .iter()
            .flat_map(|preset| &preset.estimators[kind.name])
        {
            let text = format!("{}.{name}={value}", kind.name);
            parameters.set(&text).unwrap();
        }
    }
    parameters
}

/// RMS error of each estimator, % of the finite difference, as mean over the runs on recordings that
/// chose no constant.
fn errors(recordings: &Recordings, parameters: Parameters, rate_hz: f64) -> Vec<f64> {
    let estimators = SCALED.map(|name| Kind::named(name).unwrap()).to_vec();
    let settings = Settings {
        estimators,
        parameters,
        device: Device::default(),
        counts_per_rev: ENCODERS.to_vec(),
        rates_hz: vec![rate_hz],
        phases: vec![0.37],
        seconds: 5.0,
    };
    let judges = |case: &Case| case.role == Role::Judges && case.phase.is_some();
    let cases = recordings.cases(&settings);
    let cases: Vec<_> = cases.into_iter().filter(judges).collect();
    assert!(cases.len() >= 2 * 3);
    let outcomes = run(recordings, &cases, &settings, |_| false, &|| ()).unwrap();
    let mean = |name: &&str| {
        let rows = outcomes.iter().flat_map(|outcome| &outcome.rows);
        let of = rows.filter(|row| row.estimator == *name);
        let all: Vec<f64> = of.map(|row| row.score.rms_pct.unwrap()).collect();
        all.iter().sum::<f64>() / all.len() as f64
    };
    SCALED.iter().map(mean).collect()
}

#[test]
fn scaled_values_have_a_smaller_error_on_coarse_and_fine_encoders_together() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../tests/data/real");
    let recordings = Recordings::read(&folder, &Device::default(), 5.0).unwrap();
    let kinds = SCALED.map(|name| Kind::named(name).unwrap());
    for rate_hz in [1000.0, 2000.0] {
        let before = errors(&recordings, unscaled(&kinds, rate_hz), rate_hz);
        let after = errors(&recordings, Parameters::default(), rate_hz);
        for (name, (before, after)) in SCALED.iter().zip(before.iter().zip(&after)) {
            if *name == "finite-difference" {
                assert_eq!(before, after);
            } else {
                assert!(
                    after < before,
                    "{name} at {rate_hz} Hz: {before} to {after}"
                );
            }
        }
    }
}
