//! Invariants of the observers and of the M/T method, which hold for any motion.
//!
//! These estimators read more than counts, so they have motions of their own: the medley with a
//! coupled shaft, currents and edges at random instants, and a motor that obeys its model exactly.

mod adaptive;
mod adaptive_covariance;
mod by_definition;
mod cases;
mod definition;
mod modelled;

use estimator_core::{
    Amps, ClockTicks, Count, Counts, CoupledMotor, Edge, Hertz, ObserverDesign, Sample, Uncertainty,
};
use proptest::prelude::*;

use cases::{Case, at, bits, case, dressed, everywhere};

use crate::UNSURE;
use crate::motion::{Draws, any_motion, medley};

const CLOCK: Hertz = Hertz(84e6);
const RATES: [f64; 3] = [1000.0, 10_000.0, 11_600.0];

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::with_cases(24) })]

    #[test]
    fn shift_of_both_counters_changes_nothing(motion in any_motion(), shift: u32) {
        // The offset is a whole number of lines, so that the phases of the disc are the same.
        let shift = shift & !3;
        for rate in RATES {
            let (here, there) = (dressed(&motion, 0, rate, 1), dressed(&motion, shift, rate, 1));
            for case in at(rate) {
                prop_assert_eq!(bits(&(case.run)(&here)), bits(&(case.run)(&there)), "{}", case.name);
            }
        }
    }

    #[test]
    fn mirrored_motion_gives_mirrored_velocity(motion in any_motion(), start: u32) {
        for rate in RATES {
            let (forth, back) = (dressed(&motion, start, rate, 1), dressed(&motion, start, rate, -1));
            for case in at(rate) {
                let forth: Vec<f32> = (case.run)(&forth).iter().map(|v| -v).collect();
                prop_assert_eq!(bits(&forth), bits(&(case.run)(&back)), "{}", case.name);
            }
        }
    }

    #[test]
    fn any_input_gives_finite_output(seed: u64) {
        let mut draws = Draws(seed);
        let samples: Vec<Sample> = (0..400).map(|_| {
            let wild = |draws: &mut Draws| Count(draws.bits() as u32);
            let current = f32::from_bits(draws.bits() as u32);
            let count = if draws.bits() % 4 == 0 { wild(&mut draws) } else { Count(draws.within(40) as u32) };
            // Half of the stamps fit their count.
            let boundary = if draws.bits() % 2 == 0 { wild(&mut draws) } else { Count(count.0.wrapping_add(draws.bits() as u32 & 1)) };
            let age = ClockTicks((draws.bits() >> (draws.bits() % 60)) as u32);
            Sample::new(count)
                .with_coupled(wild(&mut draws))
                .with_current(Amps::new(current))
                .with_edge(Edge { boundary, age })
        }).collect();
        for case in everywhere() {
            let outputs = (case.run)(&samples);
            prop_assert!(outputs.iter().all(|v| v.is_finite()), "{}", case.name);
        }
    }

    #[test]
    fn signals_not_needed_are_not_read(motion in any_motion(), start: u32, seed: u64) {
        let mut draws = Draws(seed);
        for rate in RATES {
            let samples = dressed(&motion, start, rate, 1);
            for case in at(rate) {
                let other: Vec<Sample> = samples.iter().map(|sample| {
                    let mut other = *sample;
                    if !case.needs.current { other.current = Amps::new(draws.unit() as f32); }
                    if !case.needs.coupled { other.coupled = Count(draws.bits() as u32); }
                    if !case.needs.edge { other.edge = None; }
                    other
                }).collect();
                prop_assert_eq!(bits(&(case.run)(&samples)), bits(&(case.run)(&other)), "{}", case.name);
            }
        }
    }
}

#[test]
fn wrap_of_either_counter_does_not_change_the_velocity() {
    let motion = medley();
    for case in everywhere() {
        let far = (case.run)(&dressed(&motion, 1 << 30, 1000.0, 1));
        for moment in (1..motion.counts.len()).step_by(31) {
            for boundary in [0u32, 1 << 31] {
                let start = boundary.wrapping_sub(motion.counts[moment] as u32) & !3;
                let wrapped = (case.run)(&dressed(&motion, start, 1000.0, 1));
                assert_eq!(bits(&far), bits(&wrapped), "{} at {moment}", case.name);
            }
        }
    }
}

#[test]
fn velocity_is_zero_at_rest_at_any_count_and_below_friction() {
    let mut draws = Draws(5);
    for _ in 0..20 {
        let still =
            Sample::new(Count(draws.bits() as u32)).with_coupled(Count(draws.bits() as u32));
        // 80 mA are 3.7 of 4 mN.m: a model with friction stays at rest.
        for case in everywhere() {
            let pushed = still.with_current(Amps::new(if case.needs.current { 0.08 } else { 0.0 }));
            let mut samples = vec![still];
            samples.resize(400, pushed);
            let outputs = (case.run)(&samples);
            assert!(outputs.iter().all(|v| *v == 0.0), "{}", case.name);
        }
    }
}

#[test]
fn velocity_comes_back_to_zero_at_rest_without_current() {
    let motion = medley();
    for rate in RATES {
        let mut samples = dressed(&motion, 9, rate, 1);
        let last = samples.last().expect("not empty").with_current(Amps::ZERO);
        for tick in 0..20_000u32 {
            let mut rest = last;
            if let Some(edge) = &mut rest.edge {
                let waited = (f64::from(tick) + 1.0) * CLOCK.0 / rate;
                edge.age = ClockTicks(edge.age.0.saturating_add(waited as u32));
            }
            samples.push(rest);
        }
        for case in at(rate) {
            let outputs = (case.run)(&samples);
            let end = outputs.last().expect("not empty").abs();
            // Without a current only the ends of the quantisation interval limit the position.
            let bound = if case.name.contains("blind") {
                1e-2
            } else {
                1e-3
            };
            assert!(end < bound, "{}: {end}", case.name);
        }
    }
}

/// A stamp of a boundary that does not touch the count's cell, as a counter read one count late
/// shows it, or one that is older than a tick, is none, bit for bit.
#[test]
fn stamp_of_another_interval_or_tick_is_ignored() {
    let rate = 1000.0;
    let motion = medley();
    let whole = dressed(&motion, 40, rate, 1);
    let with = |edge: &dyn Fn(&Sample) -> Option<Edge>| {
        let change = |sample: &Sample| Sample {
            edge: edge(sample),
            ..*sample
        };
        whole.iter().map(change).collect::<Vec<_>>()
    };
    let none = with(&|_| None);
    for case in at(rate).iter().filter(|case| case.needs.edge) {
        let without = bits(&(case.run)(&none));
        for (above, age) in [(-1, 500), (2, 500), (-1, 0), (0, 84_000), (1, 84_000)] {
            let wrong = with(&|sample| {
                Some(Edge {
                    boundary: sample.count + Counts(above),
                    age: ClockTicks(age),
                })
            });
            assert_eq!(
                bits(&(case.run)(&wrong)),
                without,
                "{} {above} {age}",
                case.name
            );
        }
        for (above, age) in [(0, 500), (1, 500), (0, 83_999)] {
            let right = with(&|sample| {
                Some(Edge {
                    boundary: sample.count + Counts(above),
                    age: ClockTicks(age),
                })
            });
            assert_ne!(
                bits(&(case.run)(&right)),
                without,
                "{} {above} {age}",
                case.name
            );
        }
    }
}

/// A knock that no current explains: counts find the new velocity, at any speed, and keep it.
#[test]
fn quantised_observer_finds_a_velocity_that_jumps() {
    for rate in [1000.0, 10_000.0] {
        let hertz = Hertz(rate);
        let unsure = Uncertainty {
            torque_noise: 8e-6,
            disturbance: 3e-4,
            boundary_noise: 0.0625,
            ..UNSURE
        };
        let device = CoupledMotor::DCX35L;
        let design = ObserverDesign::quantised(&device, hertz, &unsure);
        let quantised = design.build().expect("valid");
        let learning = design.adaptive().build().expect("valid");
        let friction = (device.coulomb_friction / device.motor.torque_constant) as f32;
        for step in 0..60 {
            let turns = 0.2 * 1.08f64.powi(step);
            let velocity = turns * 4096.0 / rate;
            let jump = (0.2 * rate) as i32;
            let samples = |current: f32| {
                let at = move |tick: i32| {
                    let moved = f64::from((tick - jump).max(0)) * velocity;
                    let count = Count(7000 + moved as u32);
                    let current = if tick > jump { current } else { 0.0 };
                    Sample::new(count)
                        .with_coupled(count)
                        .with_current(Amps::new(current))
                };
                (0..3 * jump).map(at).collect::<Vec<_>>()
            };
            let lost_for = |case: Case, current: f32| {
                let velocities = (case.run)(&samples(current));
                let off = |v: &f32| (f64::from(*v) - velocity).abs() > 0.2 * velocity;
                let last = velocities
                    .iter()
                    .rposition(off)
                    .expect("not before the knock");
                f64::from(last as i32 + 2 - jump) / rate
            };
            for (case, current) in [
                (case("quantised", rate, quantised), friction),
                (case("learning", rate, learning), friction),
                // A second error: friction that nothing overcomes does not slow the rotor down.
                (case("learning", rate, learning), 0.0),
            ] {
                let name = case.name.clone();
                let lost = lost_for(case, current);
                assert!(
                    lost < 0.03,
                    "{name}, {turns} turns/s, {current} A: {lost} s"
                );
            }
        }
    }
}
