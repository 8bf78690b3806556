use rand_distr::{Distribution as _, StandardNormal};
use rand_xoshiro::Xoshiro256PlusPlus;
use rand_xoshiro::rand_core::SeedableRng as _;

use simulation::trace::{EdgeStamp, Trace};

use super::*;

mod faults;
mod slow;

/// Noises per period and count of the synthetic recordings.
const JERK: f64 = 1e-8;
const SENSOR: f64 = 0.05;

/// Steps of the integration in a period.
const STEPS: usize = 8;

/// A recording of the smoother's own model at 1 kHz, with the true velocity in counts/s, and edges
/// where the noisy position crosses a boundary.
fn synthetic(rows: usize, seed: u64) -> Recording {
    let mut random = Xoshiro256PlusPlus::seed_from_u64(seed);
    let mut normal = || -> f64 { StandardNormal.sample(&mut random) };
    let h = 1.0 / STEPS as f64;
    let [mut x, mut v, mut a] = [0.3, 0.0, 0.0];
    let mut trace = Trace {
        rate_hz: 1e3,
        true_omega: Some(Vec::new()),
        edges: Some(Vec::new()),
        ..Trace::default()
    };
    let mut t = Vec::new();
    let mut edge = None;
    for k in 0..rows {
        let now = k as f64 * 1e-3;
        t.push(now);
        trace
            .counts_large
            .push((x + SENSOR.sqrt() * normal()).floor() as i64 as u32);
        trace.true_omega.as_mut().unwrap().push(v * 1e3);
        trace
            .edges
            .as_mut()
            .unwrap()
            .push(edge.map(|(at, boundary): (f64, i64)| EdgeStamp {
                age_s: now - at,
                boundary: boundary as u32,
            }));
        for step in 0..STEPS {
            let before = x;
            x += h * (v + h * (a / 2.0));
            v += h * a;
            a += (JERK * h).sqrt() * normal();
            if x.floor() != before.floor() {
                let boundary = x.max(before).floor();
                let part = (boundary - before) / (x - before);
                // The sensor noise moves the boundary that is crossed, so it moves the instant.
                let late = SENSOR.sqrt() * normal() / v.abs().max(0.1) * 1e-3;
                let at = now + 1e-3 * h * (step as f64 + part) + late;
                edge = Some((at.min(now + 1e-3), boundary as i64));
            }
        }
    }
    Recording {
        t,
        trace,
        ..Recording::default()
    }
}

/// RMS of the error divided by the standard deviation.
fn normalised_error(reference: &Reference, recording: &Recording, counts_per_rev: u32) -> f64 {
    let scale = TAU / f64::from(counts_per_rev);
    let truth = recording.trace.true_omega.as_ref().unwrap();
    let errors = reference.omega.iter().zip(truth).zip(&reference.sd);
    let squares = errors.map(|((omega, truth), sd)| ((omega - scale * truth) / sd).powi(2));
    (squares.sum::<f64>() / truth.len() as f64).sqrt()
}

#[test]
fn likelihood_recovers_the_noises_of_a_synthetic_recording() {
    let mut recording = synthetic(20_000, 7);
    recording.trace.edges = None;
    let noises = Noises::of(&recording).unwrap();
    // About 450 independent values of the jerk are resolved: three deviations are a factor of 1.8.
    let factor = noises.jerk / (JERK * 1e15);
    assert!((1.0 / 1.8..1.8).contains(&factor), "jerk off by {factor}");
    // 20 000 rows with the variance R + 1/12: three deviations are 0.004.
    assert!((noises.sensor - SENSOR).abs() < 0.004, "{}", noises.sensor);
    let said = Reference::with(&recording, 4096, noises).limits(1e3);
    assert!(!said.contains("noise"), "{said}");
}

/// A log of a magnetic encoder, or of one whose position is asked for over a bus.
#[test]
fn noise_of_many_counts_is_no_motion() {
    for (seed, deviation) in [(11, 6.0), (12, 60.0), (13, 300.0)] {
        let mut recording = synthetic(20_000, seed);
        recording.trace.edges = None;
        let mut random = Xoshiro256PlusPlus::seed_from_u64(100 + seed);
        for count in &mut recording.trace.counts_large {
            let noise: f64 = StandardNormal.sample(&mut random);
            *count = count.wrapping_add((deviation * noise).round() as i64 as u32);
        }
        let reference = Reference::of(&recording, 4096).unwrap();
        // 20 000 rows: three deviations are 3 %.
        let ratio = reference.noises.sensor / (deviation * deviation);
        assert!((0.96..1.04).contains(&ratio), "{deviation} counts: {ratio}");
        let error = normalised_error(&reference, &recording, 4096);
        // At least 40 independent values are resolved: three deviations are a factor of 2, and a third of the error.
        let jerk = reference.noises.jerk / (JERK * 1e15);
        assert!(
            (0.5..2.0).contains(&jerk),
            "{deviation} counts: jerk off by {jerk}"
        );
        assert!((0.7..1.4).contains(&error), "{deviation} counts: {error}");
        let said = reference.limits(1e3);
        let found = said
            .split_once("counts and times have a noise of ")
            .unwrap()
            .1;
        let found: f64 = found.split_once(" counts (").unwrap().0.parse().unwrap();
        assert!((found / deviation - 1.0).abs() < 0.03, "{said}");
    }
}

/// A fast motion of an encoder with many counts that is read seldom: up to 1e5 counts a row.
#[test]
fn fast_motion_of_many_counts_is_no_noise() {
    let [slow, fast] = [TAU * 5.0, TAU * 20.0];
    let mut trace = Trace {
        rate_hz: 1e2,
        ..Trace::default()
    };
    let (mut t, mut truth) = (Vec::new(), Vec::new());
    for k in 0..3000 {
        let now = f64::from(k) * 1e-2;
        let angle = (slow * now).sin() + 0.2 * (fast * now + 0.3).sin();
        let count = (angle * 1e6 / TAU).floor() as i64;
        trace.counts_large.push(count as u32);
        truth.push(slow * (slow * now).cos() + 0.2 * fast * (fast * now + 0.3).cos());
        t.push(now);
    }
    let recording = Recording {
        t,
        trace,
        ..Recording::default()
    };
    let reference = Reference::of(&recording, 1_000_000).unwrap();
    let squares = |values: &mut dyn Iterator<Item = f64>| values.map(|v| v * v).sum::<f64>();
    let errors = reference.omega.iter().zip(&truth).map(|(a, b)| a - b);
    let error = squares(&mut errors.skip(100)) / squares(&mut truth.iter().copied());
    assert!(error.sqrt() < 0.01, "{}", error.sqrt());
}

#[test]
fn standard_deviation_of_a_synthetic_recording_is_that_of_the_error() {
    for stamped in [false, true] {
        let mut recording = synthetic(20_000, 8);
        if !stamped {
            recording.trace.edges = None;
        }
        let noises = Noises {
            jerk: JERK * 1e15,
            sensor: SENSOR,
        };
        let reference = Reference::with(&recording, 4096, noises);
        let error = normalised_error(&reference, &recording, 4096);
        // About 450 independent values: three deviations are 10 %.
        assert!((0.9..1.1).contains(&error), "stamped {stamped}: {error}");
    }
}

#[test]
fn pieces_with_overlap_give_the_reference_of_the_whole() {
    let recording = synthetic(12_000, 9);
    let noises = Noises {
        jerk: JERK * 1e15,
        sensor: SENSOR,
    };
    let whole = Reference::in_pieces(&recording, 4096, noises, 12_000, 0);
    let pieces = Reference::in_pieces(&recording, 4096, noises, 2500, 1000);
    for (k, (a, b)) in whole.omega.iter().zip(&pieces.omega).enumerate() {
        let sd = whole.sd[k];
        assert!((a - b).abs() < 1e-3 * sd, "row {k}: {a} {b}, sd {sd}");
        assert!((pieces.sd[k] / sd - 1.0).abs() < 1e-3, "row {k}");
    }
}

#[test]
fn uneven_rows_and_any_start_of_the_counts_are_taken_exactly() {
    let mut recording = synthetic(6000, 10);
    recording.trace.edges = None;
    let noises = Noises {
        jerk: JERK * 1e15,
        sensor: SENSOR,
    };
    let even = Reference::with(&recording, 4096, noises);
    // The counts wrap, and every third row is missing.
    let keep = |k: &usize| k % 3 != 1;
    let mut thinned = recording.clone();
    thinned.t = (0..6000).filter(keep).map(|k| recording.t[k]).collect();
    let counts = &recording.trace.counts_large;
    let shifted = |k: usize| counts[k].wrapping_add(u32::MAX - 5);
    thinned.trace.counts_large = (0..6000).filter(keep).map(shifted).collect();
    let uneven = Reference::with(&thinned, 4096, noises);
    let rows = (0..6000).filter(keep);
    for (i, k) in rows.enumerate() {
        let off = (uneven.omega[i] - even.omega[k]).abs();
        assert!(
            off < 4.0 * uneven.sd[i],
            "row {k}: {off}, sd {}",
            uneven.sd[i]
        );
    }
    assert!(uneven.rms_sd(1e3) > even.rms_sd(1e3));
}

/// A sensor that is noisier than its counts informs alike in every row, whatever the motion.
#[test]
fn bandwidth_is_where_the_reference_halves_a_motion() {
    let noises = Noises {
        jerk: 4e11,
        sensor: 100.0,
    };
    const AMPLITUDE: f64 = 1e4;
    const ROWS: usize = 6000;
    let sine = |hz: f64| {
        let mut recording = synthetic(ROWS, 1);
        let count = |k: usize| (AMPLITUDE * (TAU * hz * k as f64 * 1e-3).sin()).floor();
        recording.trace.counts_large = (0..ROWS).map(|k| count(k) as i64 as u32).collect();
        recording.trace.edges = None;
        recording
    };
    let still = Reference::with(&sine(0.0), 4096, noises);
    // w0^6 is the density of the jerk times the information of a second.
    let corner_hz = f64::powf(4e11 * 1e3 / (100.0 + 1.0 / 12.0), 1.0 / 6.0) / TAU;
    let off = still.bandwidth_hz / corner_hz - 1.0;
    assert!(off.abs() < 0.01, "{} Hz", still.bandwidth_hz);
    let pieces = Reference::in_pieces(&sine(0.0), 4096, noises, 1000, 700);
    let off = pieces.bandwidth_hz / still.bandwidth_hz - 1.0;
    assert!(off.abs() < 0.01, "{} Hz in pieces", pieces.bandwidth_hz);
    // The part of the motion's velocity that is left, away from both ends.
    let gain = |hz: f64| {
        let reference = Reference::with(&sine(hz), 4096, noises);
        let rows = 1000..5000;
        let cosine = |k: usize| (TAU * hz * k as f64 * 1e-3).cos();
        let along: f64 = rows.clone().map(|k| reference.omega[k] * cosine(k)).sum();
        let whole: f64 = rows.map(|k| cosine(k).powi(2)).sum();
        along / whole / (AMPLITUDE * TAU * hz * TAU / 4096.0)
    };
    let gains = [0.5, 1.0, 2.0].map(|part| gain(part * corner_hz));
    // 1 / (1 + (w / w0)^6)
    for (gain, expected) in gains.into_iter().zip([64.0 / 65.0, 0.5, 1.0 / 65.0]) {
        assert!((gain - expected).abs() < 0.01, "{gains:?}");
    }
}

#[test]
fn recording_that_determines_no_noise_is_refused() {
    let mut still = synthetic(200, 1);
    still.trace.counts_large.fill(7);
    let error = Reference::of(&still, 4096).unwrap_err();
    assert!(
        error.starts_with("counts_large changes at 0 rows"),
        "{error}"
    );
    let short = synthetic(99, 1);
    let error = Reference::of(&short, 4096).unwrap_err();
    assert!(error.starts_with("99 rows;"), "{error}");
}
