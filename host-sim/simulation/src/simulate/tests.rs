//! Tests of a run: reproducibility, ranges, and counts and time stamps against the true motion.

mod promises;

use super::*;

const ALL: Columns = Columns {
    counts_small: true,
    edges: true,
};
const RATES: [f64; 2] = [1000.0, 11_600.0];

fn trace(name: ScenarioName, rate_hz: f64, seed: u64) -> Trace {
    simulate(&Device::default(), name, rate_hz, seed, 10.0, ALL).unwrap()
}

fn omega(trace: &Trace) -> &[f64] {
    trace.true_omega.as_deref().unwrap()
}

fn rms(values: impl IntoIterator<Item = f64>) -> f64 {
    let (mut sum, mut n) = (0.0, 0);
    for value in values {
        sum += value * value;
        n += 1;
    }
    (sum / f64::from(n)).sqrt()
}

#[test]
fn trace_is_a_function_of_the_arguments_and_depends_on_the_seed() {
    for name in ScenarioName::ALL {
        let run = |seed| simulate(&Device::default(), name, 1000.0, seed, 2.0, ALL).unwrap();
        let (first, again, other) = (run(5), run(5), run(6));
        assert_eq!(format!("{first:?}"), format!("{again:?}"));
        let apart = rms(omega(&first).iter().zip(omega(&other)).map(|(a, b)| a - b));
        assert!(apart > 0.3 * rms(omega(&first).iter().copied()), "{name}");
        assert_ne!(first.counts_large[0], other.counts_large[0]);
    }
}

#[test]
fn columns_do_not_depend_on_the_presence_of_others() {
    for name in ScenarioName::ALL {
        let device = Device::default();
        let run = |columns| simulate(&device, name, 1000.0, 3, 1.0, columns).unwrap();
        let (all, few) = (run(ALL), run(Columns::default()));
        assert!(few.edges.is_none() && few.counts_small.is_none());
        assert_eq!(all.counts_large, few.counts_large);
        assert_eq!(all.current, few.current);
        assert_eq!(all.true_omega, few.true_omega);
    }
}

#[test]
fn unread_encoder_is_not_simulated() {
    for name in ScenarioName::ALL {
        let run = Run::new(&Device::default(), name, 1000.0, 1, Columns::default());
        assert_eq!(run.small.is_some(), name.reads_small());
        assert_eq!(run.reference.is_some(), name.reads_reference());
    }
}

#[test]
fn rate_or_duration_out_of_range_is_reported_with_the_range() {
    let run = |rate_hz, seconds| {
        let device = Device::default();
        simulate(&device, ScenarioName::Step, rate_hz, 1, seconds, ALL).unwrap_err()
    };
    assert_eq!(run(99.0, 1.0), "rate 99 Hz: must be from 100 to 100000 Hz");
    assert!(run(f64::NAN, 1.0).starts_with("rate NaN Hz: "));
    assert!(run(100_001.0, 1.0).starts_with("rate 100001 Hz: "));
    assert!(run(1000.0, f64::NAN).starts_with("duration NaN s: "));
    assert!(run(1000.0, -1.0).starts_with("duration -1 s: "));
    assert!(run(1000.0, 1e9).starts_with("duration 1000000000 s: "));
    assert_eq!(plant_steps(11_600.0, 1.0), Ok(11_600 * 9));
}

#[test]
fn counts_and_edges_agree_with_the_true_motion() {
    for name in ScenarioName::ALL {
        for rate in RATES {
            let trace = trace(name, rate, 2);
            let (omega, counts) = (omega(&trace), &trace.counts_large);
            let rad = TAU / 4096.0;
            let mut travelled = 0.0;
            let bound = if name == ScenarioName::Stochastic {
                10.0
            } else {
                4.0
            };
            for k in 1..trace.len() {
                travelled += 0.5 * (omega[k] + omega[k - 1]) / rate;
                let moved = f64::from(counts[k].wrapping_sub(counts[0]) as i32);
                // The quantisation of one count, and the error of the trapezoidal rule, which is
                // larger under white torque.
                let miss = moved - travelled / rad;
                assert!(miss.abs() < bound, "{name} at {rate} Hz, tick {k}: {miss}");
            }
            let mut last: Option<(f64, u32)> = None;
            for (k, edge) in trace.edges.as_ref().unwrap().iter().enumerate() {
                let Some(edge) = edge else {
                    assert_eq!(counts[k], counts[0]);
                    continue;
                };
                let above = edge.boundary.wrapping_sub(counts[k]);
                assert!(
                    above <= 1,
                    "{name}: boundary {} from the count",
                    above as i32
                );
                let stamp = k as f64 / rate - edge.age_s;
                if k > 0 && counts[k] != counts[k - 1] {
                    assert!(edge.age_s <= 1.0 / rate + 1.0 / EDGE_CLOCK_HZ);
                }
                // In steady motion, two edges seen at neighbouring ticks give the velocity.
                if let Some((t, boundary)) = last {
                    let counts = f64::from(edge.boundary.wrapping_sub(boundary) as i32);
                    let steady = k > 5
                        && omega[k].abs() > 5.0
                        && omega[k - 6..k]
                            .iter()
                            .all(|w| (w / omega[k] - 1.0).abs() < 0.01);
                    if steady && counts != 0.0 {
                        let slope: f64 = counts * rad / (stamp - t);
                        assert!((slope / omega[k] - 1.0).abs() < 0.02, "{name}: {slope}");
                    }
                }
                last = Some((stamp, edge.boundary));
            }
        }
    }
}

/// While the coupler heats, in 60 s, it loses 30 % of its damping.
#[test]
fn true_damping_is_that_of_the_middle_of_each_period() {
    let device = Device::default();
    let name = ScenarioName::Heating;
    let trace = simulate(&device, name, 200.0, 1, 6.0, Columns::default()).unwrap();
    let damping = trace.true_damping.unwrap();
    assert_eq!(damping.len(), 1200);
    for (k, damping) in damping.into_iter().enumerate() {
        let part = 1.0 - 0.3 * (k as f64 + 0.5) / 200.0 / 60.0;
        let expected = device.stages.damping * part;
        assert!((damping / expected - 1.0).abs() < 1e-12, "{k}: {damping}");
    }
}

#[test]
fn disc_errors_change_counts_by_at_most_one() {
    let mut device = Device::default();
    let good = simulate(&device, ScenarioName::Step, 1000.0, 1, 5.0, ALL).unwrap();
    device.disc = Disc {
        phase_counts: 0.2,
        line_counts: 0.15,
        random_counts: 0.09,
    };
    let bad = simulate(&device, ScenarioName::Step, 1000.0, 1, 5.0, ALL).unwrap();
    assert_eq!(good.true_omega, bad.true_omega);
    let apart = good.counts_large.iter().zip(&bad.counts_large);
    let apart: Vec<u32> = apart
        .map(|(a, b)| (a.wrapping_sub(*b) as i32).unsigned_abs())
        .collect();
    assert_eq!(apart.iter().max(), Some(&1));
    assert!(apart.iter().filter(|&&d| d == 1).count() > apart.len() / 50);
}

#[test]
fn intended_motion_of_a_seed_is_the_same_at_every_rate() {
    for name in ScenarioName::ALL {
        // The current of `stochastic` is drawn at each tick. The stick-slip motion of `hold`
        // depends on the rate.
        if matches!(name, ScenarioName::Stochastic | ScenarioName::Hold) {
            continue;
        }
        let (slow, fast) = (trace(name, 1000.0, 4), trace(name, 10_000.0, 4));
        let fast = omega(&fast).iter().step_by(10);
        let apart = rms(omega(&slow).iter().zip(fast).map(|(a, b)| a - b));
        // The stick-slip motion of `creep` depends on the rate, and 1 kHz samples `texture`
        // coarsely.
        let bound = match name {
            ScenarioName::Texture | ScenarioName::Creep => 0.8,
            _ => 0.05,
        };
        let part = apart / rms(omega(&slow).iter().copied());
        assert!(part < bound, "{name}: {part}");
    }
}

/// Their motion is that of the model of a Kalman filter.
#[test]
fn linear_plant_has_no_friction_ripple_or_disc_errors() {
    let mut device = Device::default();
    device.large_ripple.torque = 0.1;
    device.disc = Disc {
        phase_counts: 0.2,
        line_counts: 0.15,
        random_counts: 0.09,
    };
    let mut ideal = Device::default().frictionless();
    ideal.large_ripple.torque = 0.0;
    for name in ScenarioName::ALL {
        let run = |device| simulate(device, name, 1000.0, 1, 2.0, ALL).unwrap();
        let (found, ideal) = (run(&device), run(&ideal));
        let is_ideal =
            found.counts_large == ideal.counts_large && found.true_omega == ideal.true_omega;
        assert_eq!(is_ideal, name.linear_plant(), "{name}");
    }
}

/// Two runs on one device with two seeds have two discs of the same make.
#[test]
fn disc_is_drawn_from_the_seed_of_the_run() {
    let mut device = Device::default();
    device.disc.line_counts = 0.3;
    let disc = |seed| {
        let run = Run::new(&device, ScenarioName::Step, 1000.0, seed, ALL);
        let encoder = run.large;
        (0..4096).map(|e| encoder.disc_error(e)).collect::<Vec<_>>()
    };
    assert_eq!(disc(1), disc(1));
    assert_ne!(disc(1), disc(2));
}

/// With the same numbers the torque noise of `stochastic` would follow from its current.
#[test]
fn run_draws_other_numbers_than_its_scenario() {
    for name in ScenarioName::ALL {
        for seed in 0..20 {
            let run = Run::new(&Device::default(), name, 1000.0, seed, ALL);
            let mut of_scenario = Xoshiro256PlusPlus::seed_from_u64(name.mix(seed));
            let angle = run.plant.large().angle;
            for _ in 0..100 {
                assert_ne!(angle, draw(&mut of_scenario, 0.0, TAU), "{name}, {seed}");
            }
        }
    }
}
