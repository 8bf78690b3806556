//! The observers against their definition.

mod wide;

use estimator_core::{
    Adaptation, Amps, Confidence, Correction, Counts, CoupledMotor, CurrentSource, Edge, Hertz,
    MotorModel, Observer, ObserverDesign, Sample, SlipSource, Uncertainty, VelocityEstimator,
};

use super::definition::{Definition, Kind, factors};
use super::modelled::modelled;
use super::{CLOCK, dressed};
use crate::motion::medley;

fn other_device() -> CoupledMotor {
    CoupledMotor {
        motor: MotorModel {
            counts_per_rev: 2000,
            inertia: 2.3e-5,
            damping: 1.7e-3,
            torque_constant: 0.061,
        },
        coulomb_friction: 2.1e-3,
        amplifier_lag: 0.9e-3,
        coupled_counts_per_rev: 3000,
    }
}

/// The same, but for constants that are all off: there is something to learn.
fn assumed(device: &CoupledMotor) -> CoupledMotor {
    CoupledMotor {
        motor: MotorModel {
            damping: 0.7 * device.motor.damping,
            torque_constant: 1.2 * device.motor.torque_constant,
            ..device.motor
        },
        coulomb_friction: 1.3 * device.coulomb_friction,
        ..*device
    }
}

const SURE: Uncertainty = Uncertainty {
    torque_noise: 8e-6,
    disturbance: 2.5e-4,
    disturbance_time: 0.07,
    friction_share: 0.6,
    boundary_noise: 0.05,
};

fn samples(rate: f64, device: &CoupledMotor) -> Vec<(&'static str, Vec<Sample>)> {
    let whole = modelled(rate, 1.2, 0.4, *device).0;
    let in_motion = whole[(0.15 * rate) as usize..].to_vec();
    let bare: Vec<Sample> = whole.iter().map(|s| Sample { edge: None, ..*s }).collect();
    // Rest, a push below friction, and the motion again.
    let mut rests = whole[..(0.2 * rate) as usize].to_vec();
    let last = *rests.last().expect("not empty");
    let push = last.with_current(Amps::new(0.01));
    rests.resize(rests.len() + (0.1 * rate) as usize, push);
    // Beyond what is taken for motion, and back: every limit of the state is reached.
    let third = whole.len() / 3;
    let mut jumps = whole.clone();
    for sample in &mut jumps[third..2 * third] {
        sample.count = sample.count + Counts(300_000);
        sample.edge = sample.edge.map(|edge| Edge {
            boundary: edge.boundary + Counts(300_000),
            ..edge
        });
    }
    vec![
        ("modelled", whole),
        ("in motion", in_motion),
        ("without edges", bare),
        ("rest", rests),
        ("jumps", jumps),
        ("medley", dressed(&medley(), 5, rate, 1)),
    ]
}

/// Largest differences of velocity, its variance and the parameters, relative where they are large.
fn largest_difference<C, S, M, L>(
    estimator: &Observer<C, S, M, L>,
    definition: &mut Definition,
    samples: &[Sample],
) -> [f64; 3]
where
    C: CurrentSource,
    S: SlipSource,
    M: Correction,
    L: Adaptation,
{
    let mut state = estimator.start(&samples[0]);
    let mut off = [0.0f64; 3];
    for sample in &samples[1..] {
        let (ours, exact) = (
            estimator.update(&mut state, sample).0,
            definition.update(sample),
        );
        off[0] = off[0].max((f64::from(ours) - exact).abs() / (1.0 + exact.abs()));
        let (ours, exact) = (estimator.variance(&state).0, definition.variance());
        off[1] = off[1].max((f64::from(ours) - exact).abs() / exact);
        let ours = estimator.parameter_errors(&state);
        let ours = [ours.damping, ours.friction, ours.torque_constant];
        let exact = definition
            .learner
            .as_ref()
            .map_or([0.0; 3], |learner| learner.parameters.into());
        for (ours, exact) in ours.iter().zip(exact) {
            off[2] = off[2].max((f64::from(*ours) - exact).abs());
        }
    }
    off
}

/// The same differences between the definition and itself with a state that is rounded to f32 at each
/// tick.
fn spread(mut exact: Definition, mut off: Definition, samples: &[Sample]) -> [f64; 3] {
    off.rounds = true;
    let mut largest = [0.0f64; 3];
    for sample in &samples[1..] {
        let (v, w) = (off.update(sample), exact.update(sample));
        largest[0] = largest[0].max((v - w).abs() / (1.0 + w.abs()));
        let (p, q) = (off.variance(), exact.variance());
        largest[1] = largest[1].max((p - q).abs() / q);
        if let (Some(ours), Some(exact)) = (&off.learner, &exact.learner) {
            largest[2] = largest[2].max((ours.parameters - exact.parameters).amax());
        }
    }
    largest
}

/// How an observer is compared with its definition.
type Difference<'a> = dyn Fn(&mut Definition, &[Sample]) -> [f64; 3] + 'a;

/// Roundings of 6e-8 over the some 100 ticks that an observer remembers. The medley and what follows
/// a jump have speeds of thousands of counts a tick, and what is left of their roundings is seen at
/// rest and in the parameters: ten times what it is where the definition's state alone is rounded.
#[track_caller]
fn assert_rounding(off: [f64; 3], samples: &str, what: &str) {
    let allowed = match samples {
        "medley" => [2e-3, 1e-3, 5e-4],
        "jumps" => [2e-3, 4e-4, 1e-3],
        _ => [1e-5, 1e-4, 1e-4],
    };
    let within = (0..3).all(|i| off[i] <= allowed[i]);
    assert!(within, "{what}, {samples}: {off:?}");
}

#[test]
fn observers_agree_with_their_definition() {
    let mut found = Vec::new();
    for rate in [1000.0, 8000.0] {
        let hertz = Hertz(rate);
        let device = other_device();
        let assumed = assumed(&device);
        let counts = ObserverDesign::new(&assumed, hertz, &SURE);
        let quantised = ObserverDesign::quantised(&assumed, hertz, &SURE);
        let edges = counts.with_edges(CLOCK);
        let learns = (
            counts.adaptive().build().expect("valid"),
            quantised.adaptive().build().expect("valid"),
            edges.adaptive().build().expect("valid"),
        );
        let counts = counts.build().expect("valid");
        let quantised = quantised.build().expect("valid");
        let edges = edges.build().expect("valid");
        for (name, samples) in samples(rate, &device) {
            let new =
                |kind, learns| Definition::new(kind, learns, &assumed, rate, &SURE, &samples[0]);
            let mut compare = |what: &str, kind, learner, difference: &Difference<'_>| {
                let off = difference(&mut new(kind, learner), &samples);
                assert_rounding(off, name, &format!("{what} at {rate} Hz"));
                let spread = spread(new(kind, learner), new(kind, learner), &samples);
                found.push((name, format!("{what} at {rate} Hz"), off, spread));
            };
            compare("counts", Kind::CountUpdate, false, &|exact, samples| {
                largest_difference(&counts, exact, samples)
            });
            compare("quantised", Kind::Quantised, false, &|exact, samples| {
                largest_difference(&quantised, exact, samples)
            });
            compare("edges", Kind::EdgeUpdate, false, &|exact, samples| {
                largest_difference(&edges, exact, samples)
            });
            compare(
                "counts, learning",
                Kind::CountUpdate,
                true,
                &|exact, samples| largest_difference(&learns.0, exact, samples),
            );
            compare(
                "adaptive, quantised",
                Kind::Quantised,
                true,
                &|exact, samples| largest_difference(&learns.1, exact, samples),
            );
            compare(
                "edges, learning",
                Kind::EdgeUpdate,
                true,
                &|exact, samples| largest_difference(&learns.2, exact, samples),
            );
        }
    }
    // The core rounds every operation, some ten times as often as the definition is rounded here.
    for (name, what, off, _) in &found {
        let mut allowed = [0.0f64; 3];
        for (.., spread) in found.iter().filter(|one| one.0 == *name) {
            for i in 0..3 {
                allowed[i] = allowed[i].max(10.0 * spread[i]);
            }
        }
        let within = (0..3).all(|i| off[i] <= allowed[i]);
        assert!(within, "{what}, {name}: {off:?}, allowed {allowed:?}");
    }
}

/// Without the small encoder, and without current, friction and damping: the same equations.
#[test]
fn observers_without_an_input_agree_with_their_definition() {
    for rate in [1000.0, 8000.0] {
        let hertz = Hertz(rate);
        let device = other_device();
        let unknown = CoupledMotor {
            motor: MotorModel {
                damping: 0.0,
                ..device.motor
            },
            coulomb_friction: 0.0,
            ..device
        };
        let held = |device| {
            let held = ObserverDesign::new(device, hertz, &SURE).held();
            held.build().expect("valid")
        };
        // A motor without friction knows no share of it, whatever it is asked for.
        let smooth = CoupledMotor {
            coulomb_friction: 0.0,
            ..device
        };
        let wide = Uncertainty {
            disturbance: 2e-2,
            ..SURE
        };
        let blind = ObserverDesign::blind(&device, hertz, CLOCK, &wide);
        let blind = blind.build().expect("valid");
        for (name, samples) in samples(rate, &device) {
            let new = |kind, device, unsure| {
                let mut definition =
                    Definition::new(kind, false, device, rate, unsure, &samples[0]);
                definition.ratio = 0.0;
                definition
            };
            let what = format!("held at {rate} Hz");
            let off = largest_difference(
                &held(&device),
                &mut new(Kind::CountUpdate, &device, &SURE),
                &samples,
            );
            assert_rounding(off, name, &what);
            let mut definition = new(Kind::CountUpdate, &smooth, &SURE);
            let off = largest_difference(&held(&smooth), &mut definition, &samples);
            assert_rounding(off, name, &format!("without friction at {rate} Hz"));
            let mut definition = new(Kind::EdgeUpdate, &unknown, &wide);
            definition.per_amp = 0.0;
            definition.unstamped = 0.0;
            let off = largest_difference(&blind, &mut definition, &samples);
            assert_rounding(off, name, &format!("blind at {rate} Hz"));
        }
    }
}

/// Gains by the gap, as far as the table goes and beyond.
#[test]
fn gains_agree_with_a_filter_corrected_every_n_ticks() {
    for rate in [1000.0, 8000.0] {
        let device = other_device();
        let observer = Observer::new(&device, Hertz(rate), &SURE).expect("valid");
        let first = Sample::default();
        let mut definition =
            Definition::new(Kind::CountUpdate, false, &device, rate, &SURE, &first);
        for ticks in [
            1, 2, 3, 31, 63, 64, 65, 66, 96, 97, 500, 929, 960, 961, 962, 5000,
        ] {
            let (ours, exact) = (observer.gain(ticks), definition.gain(ticks as f64));
            let ours = [
                ours.position,
                ours.velocity,
                ours.disturbance,
                ours.variance,
            ];
            let exact = [exact.k[0], exact.k[1], exact.k[2], exact.variance];
            for (ours, exact) in ours.iter().zip(exact) {
                assert!(
                    (f64::from(*ours) / exact - 1.0).abs() < 1e-6,
                    "{ticks} ticks at {rate} Hz: {ours} {exact}"
                );
            }
        }
    }
}

/// The factors of both covariances that are kept at run time.
#[test]
fn covariances_agree_with_the_definition() {
    let rate = 1000.0;
    let hertz = Hertz(rate);
    let assumed = assumed(&other_device());
    let quantised = ObserverDesign::quantised(&assumed, hertz, &SURE);
    let learns = quantised.adaptive().build().expect("valid");
    let (_, samples) = samples(rate, &other_device()).swap_remove(0);
    let mut definition = Definition::new(Kind::Quantised, true, &assumed, rate, &SURE, &samples[0]);
    let mut state = learns.start(&samples[0]);
    let mut off = 0.0f64;
    for sample in &samples[1..] {
        learns.update(&mut state, sample);
        definition.update(sample);
        let covariance = definition.covariance;
        let coupling = covariance[(0, 1)] / covariance[(0, 0)];
        let left = covariance[(1, 1)] - coupling * covariance[(0, 1)];
        let learner = definition.learner.as_ref().expect("learns");
        let (d, u) = factors(&learner.p);
        let exact = [
            covariance[(0, 0)],
            left,
            coupling,
            d[0],
            d[1],
            d[2],
            u[(0, 1)],
            u[(0, 2)],
            u[(1, 2)],
        ];
        let ([p, s], g) = (
            state.correction().covariance().diagonal(),
            state.correction().covariance().coupling(),
        );
        let [d0, d1, d2] = *state.adaptation().diagonal();
        let [u01, u02, u12] = *state.adaptation().upper();
        for (ours, exact) in [p, s, g, d0, d1, d2, u01, u02, u12].iter().zip(exact) {
            off = off.max((f64::from(*ours) - exact).abs() / (1e-3 + exact.abs()));
        }
    }
    assert!(off < 1e-3, "{off}");
    assert!(state.adaptation().upper().iter().all(|u| u.abs() > 1e-3));
}
