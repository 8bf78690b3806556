//! Recordings with gaps, jumps of the counter and bad counts.

use super::*;

/// The recording of the rows that `keep` keeps.
fn thinned(recording: &Recording, keep: impl Fn(usize) -> bool) -> Recording {
    let kept = |k: &usize| keep(*k);
    let rows = || (0..recording.t.len()).filter(kept);
    let trace = &recording.trace;
    let truth = trace.true_omega.as_ref().unwrap();
    let edges = trace.edges.as_ref();
    Recording {
        t: rows().map(|k| recording.t[k]).collect(),
        trace: Trace {
            counts_large: rows().map(|k| trace.counts_large[k]).collect(),
            true_omega: Some(rows().map(|k| truth[k]).collect()),
            edges: edges.map(|edges| rows().map(|k| edges[k]).collect()),
            ..trace.clone()
        },
        ..recording.clone()
    }
}

#[test]
fn reference_of_a_recording_with_a_gap_has_the_error_of_its_standard_deviation() {
    for gap in [10, 50, 150, 198, 210, 500, 5000, 15_000] {
        for stamped in [false, true] {
            let mut recording = synthetic(30_000, 11);
            if !stamped {
                recording.trace.edges = None;
            }
            let with_gap = thinned(&recording, |k| !(7000..7000 + gap).contains(&k));
            let reference = Reference::of(&with_gap, 4096).unwrap();
            let error = normalised_error(&reference, &with_gap, 4096);
            // At least 300 independent values: three deviations are 12 %. The noises are found with
            // an error that moves the standard deviation by some per cent more.
            assert!(
                (0.85..1.15).contains(&error),
                "gap {gap}, stamped {stamped}: {error}"
            );
        }
    }
}

/// Rows at 1 kHz of a shaft that swings by 3 rad at 0.7 Hz, with 4096 counts/rev.
fn swing() -> Recording {
    swing_of(3000)
}

fn swing_of(rows: u32) -> Recording {
    let angular = TAU * 0.7;
    let t: Vec<f64> = (0..rows).map(|k| f64::from(k) * 1e-3).collect();
    let scale = 4096.0 / TAU;
    let count = |t: &f64| (scale * 3.0 * (angular * t).sin()).floor() as i64 as u32;
    let velocity = |t: &f64| scale * 3.0 * angular * (angular * t).cos();
    Recording {
        trace: Trace {
            rate_hz: 1e3,
            counts_large: t.iter().map(count).collect(),
            true_omega: Some(t.iter().map(velocity).collect()),
            ..Trace::default()
        },
        t,
        ..Recording::default()
    }
}

/// RMS of the error, rad/s, of the rows that `keep` keeps.
fn rms_error(recording: &Recording, keep: impl Fn(f64) -> bool) -> f64 {
    let reference = Reference::of(recording, 4096).unwrap();
    let truth = recording.trace.true_omega.as_ref().unwrap();
    let rows = recording.t.iter().zip(reference.omega.iter().zip(truth));
    let errors = rows.filter(|(t, _)| keep(**t));
    let squares: Vec<f64> = errors
        .map(|(_, (omega, truth))| (omega - TAU / 4096.0 * truth).powi(2))
        .collect();
    (squares.iter().sum::<f64>() / squares.len() as f64).sqrt()
}

#[test]
fn gap_or_bad_count_does_not_change_the_error_of_other_rows() {
    // Half of the time constant of the smoother is 5 ms: 50 ms after a fault nothing is left of it.
    let away = |t: f64| {
        let late = [3600.0, 1.7e9].into_iter().filter(|pause| t >= *pause);
        let t = t - late.fold(0.0, f64::max);
        // The ends, the faults, and where the counts pass 0.
        let zeros = [1.0, 2.0, 3.0, 4.0].map(|half| half / 1.4);
        let mut near = [0.0, 1.0, 1.5, 2.0, 3.0].into_iter().chain(zeros);
        near.all(|at| (t - at).abs() > 0.05)
    };
    let whole = rms_error(&swing(), away);
    assert!(whole < 0.02, "{whole} of 13 rad/s");
    let mut faulty: Vec<(String, Recording)> = Vec::new();
    for gap in [5, 100, 198, 300, 999] {
        let gone = |k: usize| (1001..1001 + gap).contains(&k);
        faulty.push((format!("gap {gap}"), thinned(&swing(), |k| !gone(k))));
    }
    for (name, pause) in [("an hour", 3600.0), ("half a century", 1.7e9)] {
        let mut late = swing();
        late.t[1500..].iter_mut().for_each(|t| *t += pause);
        faulty.push((name.to_owned(), late));
    }
    for bad in [1 << 24, u32::MAX, 200_000] {
        let mut glitch = swing();
        glitch.trace.counts_large[1500] = bad;
        faulty.push((format!("count {bad}"), glitch));
    }
    for jump in [1 << 20, 1 << 28] {
        let mut jumped = swing();
        let counts = jumped.trace.counts_large[1500..].iter_mut();
        counts.for_each(|count| *count = count.wrapping_add(jump));
        faulty.push((format!("jump {jump}"), jumped));
    }
    let mut wrapped = swing();
    let counts = wrapped.trace.counts_large.iter_mut();
    counts.for_each(|count| *count %= 1 << 24);
    faulty.push(("24 bits".to_owned(), wrapped));
    for (name, recording) in faulty {
        let rms = rms_error(&recording, away);
        assert!(
            (0.8..1.25).contains(&(rms / whole)),
            "{name}: {rms} rad/s, {whole} without it"
        );
    }
}

#[test]
fn counts_that_are_no_motion_give_a_finite_reference_or_an_error() {
    let mut random = Xoshiro256PlusPlus::seed_from_u64(1);
    for bits in [8, 16, 24, 30, 31] {
        let mut recording = swing();
        for count in &mut recording.trace.counts_large {
            let value: f64 = StandardNormal.sample(&mut random);
            *count = (value * f64::from(1_u32 << bits)) as i64 as u32;
        }
        match Reference::of(&recording, 4096) {
            Ok(reference) => {
                let mut values = reference.omega.iter().chain(&reference.sd);
                assert!(values.all(|value| value.is_finite()), "{bits} bits");
            }
            Err(why) => assert!(why.starts_with("counts_large is no motion"), "{why}"),
        }
    }
}

/// The likelihood of this recording is computed over pieces that begin at the rows 0, 1000 and 2000.
#[test]
fn bad_count_at_the_begin_of_a_piece_is_no_noise() {
    let mut recording = swing_of(4000);
    for k in [1000, 2000] {
        let count = &mut recording.trace.counts_large[k];
        *count = count.wrapping_add(5000);
    }
    let noise = Noises::of(&recording).unwrap().sensor.sqrt();
    assert!(noise < 0.1, "{noise} counts");
}
