//! An image that reads the reference encoder too.

use std::f64::consts::TAU;

use experiments::closed_loop::Hand;
use haptic_control::SceneKind;
use simulation::device::Device;

use crate::image::{free_air, of_scene, run_image};

#[test]
fn reference_encoder_is_logged_with_the_true_counts() {
    let setup = of_scene(SceneKind::FreeAir, Hand::Moving, 2.0);
    let run = run_image("reference", &setup);
    assert_eq!(run.complaints, [""; 0], "pins");
    let counts_per_rad = f64::from(Device::default().reference.counts_per_rev) / TAU;
    let mut first = None;
    let (mut worst, mut furthest) = (0.0_f64, 0.0_f64);
    for frame in &run.telemetry.frames {
        let count = frame
            .side_lines
            .reference
            .expect("a line beside every frame");
        let angle = run.tick(frame).expect("a tick").large.angle;
        let (first_count, first_angle) = *first.get_or_insert((count, angle));
        let counts = f64::from(count.wrapping_sub(first_count).cast_signed());
        let turned = (angle - first_angle) * counts_per_rad;
        worst = worst.max((counts - turned).abs());
        furthest = furthest.max(turned.abs());
    }
    // Two readings are rounded, and this one is read last in its tick: 20 us later or so, which
    // at 4 rad/s is a quarter of a count.
    assert!(worst < 2.0, "{worst} counts");
    assert!(furthest > 1000.0, "{furthest} counts");
}

#[test]
fn image_without_the_reference_encoder_does_not_log_it() {
    assert!(
        free_air()
            .telemetry
            .frames
            .iter()
            .all(|frame| frame.side_lines.reference.is_none())
    );
}
