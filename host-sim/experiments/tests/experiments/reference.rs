//! The reference of a recording against its true velocity, which the reference does not read.

use std::path::Path;
use std::sync::LazyLock;

use catalogue::estimators::{Kind, Setup};
use catalogue::parameters::{Parameters, PlantKind};
use experiments::real::cases::{Case, Recordings};
use experiments::real::run::Settings;
use experiments::reference::Reference;
use measured::digits::{rounded, within_a_tenth};
use measured::tables::REFERENCE;
use recordings::recording::Recording;
use scoring::evaluation::Evaluation;
use scoring::score::skipped;
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
    &samples[skipped(RATE_HZ)..]
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

/// What the reference says of one recording, beside its truth. Errors are RMS, rad/s.
struct Checked {
    recording: String,
    counts_per_rev: u32,
    is_coarse: bool,
    read: &'static str,
    /// RMS of the reference's standard deviation.
    sd: f64,
    /// Error of the reference.
    error: f64,
    /// Share of the samples within two standard deviations.
    within: f64,
    /// Error of finite difference.
    difference: f64,
    /// Error of the estimator that is best by the reference, and that of the best one.
    chosen: f64,
    best: f64,
    /// Whether the reference resolves the error of the estimator that is best by it.
    resolved: bool,
}

impl Checked {
    fn of(case: &Case, recording: &Recording, read: &'static str) -> Option<Self> {
        let reference = Reference::of(recording, case.counts_per_rev).ok()?;
        let truth = recording.trace.true_omega.as_ref().unwrap();
        let errors = scored(&reference.omega).iter().zip(scored(truth));
        let errors = errors.map(|(a, b)| (a - b).abs());
        let within = errors
            .zip(scored(&reference.sd))
            .filter(|(e, sd)| *e <= 2.0 * **sd);
        let within = within.count() as f64 / scored(truth).len() as f64;
        let estimates = estimates(case, recording);
        let scores = |against: &[f64]| -> Vec<f64> {
            let each = estimates.iter();
            each.map(|velocity| rms(velocity, against)).collect()
        };
        let (by_reference, by_truth) = (scores(&reference.omega), scores(truth));
        let least = |scores: &[f64]| scores.iter().copied().fold(f64::INFINITY, f64::min);
        let smallest = least(&by_reference);
        let chosen = by_reference.iter().position(|rms| *rms == smallest)?;
        Some(Self {
            recording: case.name.clone(),
            counts_per_rev: case.counts_per_rev,
            is_coarse: case.phase.is_none(),
            read,
            sd: reference.rms_sd(RATE_HZ),
            error: rms(&reference.omega, truth),
            within,
            // The first of all estimators.
            difference: by_truth[0],
            chosen: by_truth[chosen],
            best: least(&by_truth),
            resolved: reference.resolves(smallest, RATE_HZ),
        })
    }
}

/// Each recording that determines a reference, with and without its time stamps.
static CHECKED: LazyLock<Vec<Checked>> = LazyLock::new(|| {
    let recordings = Recordings::read(Path::new(RECORDINGS), &Device::default(), 10.0).unwrap();
    let settings = settings();
    let each = |case: &Case| {
        let mut recording = recordings.recording(case).unwrap();
        let stamps = Checked::of(case, &recording, "stamps");
        recording.trace.edges = None;
        [stamps, Checked::of(case, &recording, "counts")]
    };
    let cases = recordings.cases(&settings);
    cases.iter().flat_map(each).flatten().collect()
});

#[test]
fn error_of_the_reference_is_that_of_its_standard_deviation() {
    // The truth of a coarse encoder has the errors of its disc, which the reference has not.
    let fine: Vec<_> = CHECKED.iter().filter(|of| !of.is_coarse).collect();
    for of in &fine {
        let called = format!("{} at {}, {}", of.recording, of.counts_per_rev, of.read);
        // One density of jerk for the whole recording makes the standard deviation too large in
        // quiet parts, up to a factor of 2.5 on the average.
        let ratio = of.error / of.sd;
        assert!(
            (0.4..1.3).contains(&ratio),
            "{called}: {ratio} standard deviations"
        );
        assert!(of.within > 0.9, "{called}: {} within two", of.within);
    }
    // Eight recordings, two resolutions, with and without stamps; one has too few counts at 256.
    assert_eq!(fine.len(), 30);
}

#[test]
fn best_estimator_by_the_reference_is_near_the_best() {
    let resolved: Vec<_> = CHECKED.iter().filter(|of| of.resolved).collect();
    for of in &resolved {
        let loss = of.chosen / of.best;
        // The reference takes the errors of a coarse disc for motion, and an estimator that learns them
        // for a worse one: on the spindle the chosen one has 1.04 times the error of the best.
        let limit = if of.is_coarse { 1.1 } else { 1.05 };
        assert!(
            loss < limit,
            "{} {}: {loss} times the best",
            of.recording,
            of.read
        );
    }
    assert!(
        2 * resolved.len() > CHECKED.len(),
        "{} resolved",
        resolved.len()
    );
}

#[test]
fn documented_references_are_those_measured() {
    let shown = CHECKED.iter().filter(|of| of.counts_per_rev != 256);
    let row = |of: &Checked| {
        let percent = |rms: f64| rounded(100.0 * rms / of.difference, 6);
        vec![
            of.recording.clone(),
            of.counts_per_rev.to_string(),
            of.read.to_owned(),
            percent(of.error),
            percent(of.sd),
            percent(of.chosen),
            percent(of.best),
            if of.resolved { "yes" } else { "no" }.to_owned(),
        ]
    };
    let rows: Vec<_> = shown.map(row).collect();
    let checked = REFERENCE.check(&[], &rows, |_, then, now| within_a_tenth(then, now));
    checked.unwrap_or_else(|error| panic!("{error}"));
}
