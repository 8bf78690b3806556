//! Observers in the wide range against their definition.

use estimator_core::{CoupledMotor, Hertz, MotorModel, ObserverDesign};

use super::super::CLOCK;
use super::super::definition::{Definition, Kind};
use super::{SURE, assert_rounding, largest_difference, other_device, samples, spread};

/// Without the small encoder and with a model that is wrong by factors: the same equations in the wide
/// range. The damping of the model decides between its bounds, and a model without friction has another
/// unit of it.
#[test]
fn observers_in_the_wide_range_agree_with_their_definition() {
    for rate in [1000.0, 8000.0] {
        let hertz = Hertz(rate);
        let device = other_device();
        let with = |inertia: f64, damping: f64, friction: f64| CoupledMotor {
            motor: MotorModel {
                inertia: inertia * device.motor.inertia,
                damping: damping * device.motor.damping,
                ..device.motor
            },
            coulomb_friction: friction * device.coulomb_friction,
            ..device
        };
        for (belief, what) in [
            (with(1.0, 0.7, 1.3), "nearly right"),
            (with(4.0, 1.0, 1.0), "too heavy"),
            (with(0.4, 12.0, 0.0), "damped instead of braked"),
        ] {
            let counts = ObserverDesign::new(&belief, hertz, &SURE).held();
            let edges = counts.with_edges(CLOCK).widely_adaptive();
            let edges = edges.build().expect("valid");
            let counts = counts.widely_adaptive().build().expect("valid");
            for (name, samples) in samples(rate, &device) {
                let new = |kind| {
                    Definition::new(kind, true, &belief, rate, &SURE, &samples[0]).held_and_wide()
                };
                let what = format!("{what} at {rate} Hz");
                let off = largest_difference(&counts, &mut new(Kind::CountUpdate), &samples);
                let spread_of = |kind| spread(new(kind), new(kind), &samples);
                let spread = spread_of(Kind::CountUpdate);
                assert_rounding_or_spread(off, spread, 20.0, name, &format!("counts, {what}"));
                let off = largest_difference(&edges, &mut new(Kind::EdgeUpdate), &samples);
                let spread = spread_of(Kind::EdgeUpdate);
                // The velocity after a contradiction is that of single ticks, with all of their rounding.
                assert_rounding_or_spread(off, spread, 50.0, name, &format!("edges, {what}"));
            }
        }
    }
}

/// As [`assert_rounding`], for errors of a parameter up to 20; where the definition is more sensitive to
/// its own rounding, `times` that spread.
#[track_caller]
fn assert_rounding_or_spread(
    off: [f64; 3],
    spread: [f64; 3],
    times: f64,
    samples: &str,
    what: &str,
) {
    let explained = |i: usize| {
        if off[i] <= times * spread[i] {
            0.0
        } else {
            off[i]
        }
    };
    assert_rounding(
        [explained(0), explained(1), explained(2) / 20.0],
        samples,
        what,
    );
}
