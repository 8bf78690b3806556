//! Motion that is slow against the rate of the rows.

use super::*;

/// An exact encoder of `per_rev` counts on a shaft that swings by `swing` revolutions at `hz`, and drifts.
fn swinging(per_rev: f64, swing: f64, hz: f64, [rate_hz, seconds]: [f64; 2]) -> Recording {
    let t: Vec<f64> = (0..(rate_hz * seconds) as usize)
        .map(|k| k as f64 / rate_hz)
        .collect();
    let position = |t: &f64| per_rev * (0.37 + 0.01 * t + swing * (TAU * hz * t).sin());
    let omega = |t: &f64| TAU * (0.01 + swing * TAU * hz * (TAU * hz * t).cos());
    Recording {
        trace: Trace {
            rate_hz,
            counts_large: t
                .iter()
                .map(|t| position(t).floor() as i64 as u32)
                .collect(),
            true_omega: Some(t.iter().map(omega).collect()),
            ..Trace::default()
        },
        t,
        ..Recording::default()
    }
}

#[test]
fn many_rows_from_an_edge_to_the_next_are_no_jerk() {
    for (counts_per_rev, swing, hz, time) in [
        (90, 0.1, 0.5, [10e3, 10.0]),
        (90, 0.3, 1.5, [20e3, 5.0]),
        (4096, 0.03, 0.3, [50e3, 3.0]),
    ] {
        let recording = swinging(f64::from(counts_per_rev), swing, hz, time);
        let reference = Reference::of(&recording, counts_per_rev).unwrap();
        let truth = recording.trace.true_omega.as_ref().unwrap();
        let rms = |values: &mut dyn Iterator<Item = f64>| {
            (values.map(|x| x * x).sum::<f64>() / truth.len() as f64).sqrt()
        };
        let all = rms(&mut truth.iter().copied());
        let error = rms(&mut reference.omega.iter().zip(truth).map(|(a, b)| a - b)) / all;
        let sd = reference.rms_sd(time[0]) / all;
        let of = format!("{counts_per_rev} counts/rev at {} Hz", time[0]);
        assert!(error < 0.05, "{of}: {error}");
        assert!(sd < 0.05, "{of}: {sd}");
    }
}

/// The jerk of an even motion is the smallest of the search, and its edges are far apart.
#[test]
fn steady_motion_of_a_count_a_second_has_a_reference() {
    let mut recording = swinging(4096.0, 0.0, 1.0, [1e3, 60.0]);
    let count = |t: &f64| (t + 0.3).floor() as u32;
    recording.trace.counts_large = recording.t.iter().map(count).collect();
    let reference = Reference::of(&recording, 4096).unwrap();
    let omega = TAU / 4096.0;
    let mut errors = (reference.omega.iter()).map(|value| (value / omega - 1.0).abs());
    assert!(errors.all(|error| error < 0.05));
}

#[test]
fn rows_are_left_out_where_edges_are_rare() {
    let fast = swinging(90.0, 0.3, 1.5, [10e3, 2.0]);
    assert!(thinned::thinned(&fast).is_none());
    let slow = swinging(90.0, 0.3, 1.5, [20e3, 2.0]);
    let thinned = thinned::thinned(&slow).unwrap();
    let every = (20e3 / thinned.trace.rate_hz).round() as usize;
    assert_eq!(every, 10);
    assert_eq!(thinned.t[3], slow.t[3 * every]);
    assert_eq!(
        thinned.trace.counts_large[3],
        slow.trace.counts_large[3 * every]
    );
}

#[test]
fn rows_beside_an_edge_are_not_left_out() {
    let slow = swinging(90.0, 0.3, 1.5, [20e3, 2.0]);
    let counts = &slow.trace.counts_large;
    let mut rows = vec![sections::Row::Next; counts.len()];
    thinned::pass_over(&mut rows, &slow);
    for k in 1..counts.len() - 1 {
        let is_at_edge = counts[k - 1] != counts[k] || counts[k] != counts[k + 1];
        let is_kept = k % 10 == 0 || is_at_edge;
        assert_eq!(rows[k] == sections::Row::Next, is_kept, "row {k}");
    }
}

/// A sensor that is noisier than its counts informs alike in every row that is taken: each tenth, and two rows at each
/// edge, of which there are 80 rows or more to the next but for a fifth of them.
#[test]
fn bandwidth_is_that_of_the_rows_that_are_taken() {
    let noises = Noises {
        jerk: 1e9,
        sensor: 100.0,
    };
    let slow = swinging(90.0, 0.3, 1.5, [20e3, 2.0]);
    let rows_hz = 2e3;
    let corner_hz = f64::powf(1e9 * rows_hz / (100.0 + 1.0 / 12.0), 1.0 / 6.0) / TAU;
    let ratio = Reference::with(&slow, 90, noises).bandwidth_hz / corner_hz;
    // A quarter more rows are 4 % more bandwidth.
    assert!((0.99..1.05).contains(&ratio), "{ratio}");
}
