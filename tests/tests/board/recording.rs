//! Frames of the image as a recording.

use recordings::recording::Recording;

use crate::image::free_air;

#[test]
fn frames_of_the_image_are_converted_and_replayed() {
    let run = free_air();
    let recording = Recording::parse(run.csv().unwrap().as_bytes(), "board").unwrap();
    let trace = &recording.trace;
    assert_eq!(recording.uneven_steps, 0);
    assert!((trace.rate_hz - 1000.0).abs() < 1e-6);
    assert_eq!(trace.len(), run.telemetry.frames.len());
    // Counts and truth are of the same motion: a count's difference at 1 kHz is 1.53 rad/s.
    let omega = trace.true_omega.as_ref().unwrap();
    let mut worst = 0.0_f64;
    for (k, pair) in trace.counts_large.windows(2).enumerate() {
        let counts = f64::from(pair[1].wrapping_sub(pair[0]) as i32);
        let mean = 0.5 * (omega[k] + omega[k + 1]);
        worst = worst.max((counts * 1e3 / 4096.0 * std::f64::consts::TAU - mean).abs());
    }
    assert!(worst < 1.6 * 1.534, "{worst} rad/s");
    assert!(omega.iter().any(|omega| omega.abs() > 2.0));
}
