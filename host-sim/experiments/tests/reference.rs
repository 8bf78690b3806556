//! The reference of a recording against its true velocity, which the reference does not read.

use std::path::Path;

use catalogue::estimators::{Kind, Setup};
use catalogue::parameters::{Parameters, PlantKind};
use experiments::real::cases::{Case, Recordings};
use experiments::real::run::Settings;
use experiments::reference::Reference;
use recordings::recording::Recording;
use scoring::evaluation::Evaluation;
use scoring::score::SKIP_S;
use simulation::device::Device;

const RECORDINGS: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../../tests/data/real");

const RATE_HZ: f64 = 1e3;

fn settings() -> Settings {
    Settings {
        estimators: Kind::all().iter().collect(),
        parameters: Parameters::default(),
        device: Device::default(),
        counts_per_rev: vec![256, 4096],
        rates_hz: vec![RATE_HZ],
        phases: vec![0.0],
        seconds: 10.0,
    }
}

/// The scored samples.
fn scored<T>(samples: &[T]) -> &[T] {
    &samples[(SKIP_S * RATE_HZ) as usize..]
}

/// Root mean square of `a - b` over the scored samples.
fn rms(a: &[f64], b: &[f64]) -> f64 {
    let squares = scored(a)
        .iter()
        .zip(scored(b))
        .map(|(a, b)| (a - b).powi(2));
    (squares.sum::<f64>() / scored(a).len() as f64).sqrt()
}

/// The velocities of the estimators that need no device.
fn estimates(case: &Case, recording: &Recording) -> Vec<Vec<f64>> {
    let mut device = Device::default();
    device.stages.large.counts_per_rev = case.counts_per_rev;
    let needs_device =
        |kind: &&Kind| kind.is_observer() || kind.needs.current || kind.needs.coupled;
    let kinds = Kind::all().iter().filter(|kind| !needs_device(kind));
    let evaluation = Evaluation::new(
        &kinds.collect::<Vec<_>>(),
        &Parameters::default(),
        &Setup::of(&device, RATE_HZ),
        PlantKind::Friction,
    );
    let estimates = evaluation.unwrap().estimates(&recording.trace);
    let wide = |v: Vec<f32>| v.into_iter().map(f64::from).collect();
    estimates.into_iter().map(|e| wide(e.velocity)).collect()
}

/// Runs `check` with each recording, with and without its time stamps, that determines a reference.
fn each(mut check: impl FnMut(&str, &Case, &Recording, &Reference)) {
    let recordings = Recordings::read(Path::new(RECORDINGS), 10.0).unwrap();
    let settings = settings();
    for case in recordings.cases(&settings) {
        let mut recording = recordings.recording(&case, &settings).unwrap();
        for stamps in ["stamps", "counts"] {
            if stamps == "counts" {
                recording.trace.edges = None;
            }
            if let Ok(reference) = Reference::of(&recording, case.counts_per_rev) {
                let called = format!("{} at {}, {stamps}", case.name, case.counts_per_rev);
                check(&called, &case, &recording, &reference);
            }
        }
    }
}

#[test]
fn error_of_the_reference_is_that_of_its_standard_deviation() {
    let mut checked = 0;
    each(|called, case, recording, reference| {
        // The truth of a coarse encoder has the errors of its disc, which the reference has not.
        if case.phase.is_none() {
            return;
        }
        let truth = recording.trace.true_omega.as_ref().unwrap();
        let error = rms(&reference.omega, truth);
        let sd = reference.rms_sd(RATE_HZ);
        // One density of jerk for the whole recording makes the standard deviation too large in
        // quiet parts, up to a factor of 2.5 on the average.
        assert!(
            (0.4..1.3).contains(&(error / sd)),
            "{called}: {error} rad/s, sd {sd}"
        );
        let errors = scored(&reference.omega).iter().zip(scored(truth));
        let errors = errors.map(|(a, b)| (a - b).abs());
        let within = errors
            .zip(scored(&reference.sd))
            .filter(|(e, sd)| *e <= 2.0 * **sd);
        let share = within.count() as f64 / scored(truth).len() as f64;
        assert!(
            share > 0.9,
            "{called}: {share} within two standard deviations"
        );
        checked += 1;
    });
    // Eight recordings, two resolutions, with and without stamps; one has too few counts at 256.
    assert_eq!(checked, 30);
}

#[test]
fn best_estimator_by_the_reference_is_within_5_percent_of_the_best() {
    let (mut resolved, mut all) = (0, 0);
    each(|called, case, recording, reference| {
        let truth = recording.trace.true_omega.as_ref().unwrap();
        let estimates = estimates(case, recording);
        let scores = |against: &[f64]| -> Vec<f64> {
            estimates
                .iter()
                .map(|velocity| rms(velocity, against))
                .collect()
        };
        let (by_reference, by_truth) = (scores(&reference.omega), scores(truth));
        let least = |scores: &[f64]| scores.iter().copied().fold(f64::INFINITY, f64::min);
        let best = least(&by_reference);
        all += 1;
        if !reference.resolves(best, RATE_HZ) {
            return;
        }
        resolved += 1;
        let chosen = by_reference.iter().position(|rms| *rms == best).unwrap();
        let loss = by_truth[chosen] / least(&by_truth);
        assert!(loss < 1.05, "{called}: {loss} times the best");
    });
    assert!(2 * resolved > all, "{resolved} of {all} resolved");
}
