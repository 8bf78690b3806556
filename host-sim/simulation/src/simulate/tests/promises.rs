//! Tests of every scenario's description at a low and a high rate.

use super::*;
use crate::plant::Grip;
use crate::scenario::Speeds;
use rustfft::{FftPlanner, num_complex::Complex};

/// Calls `each` at every tick with the time, the plant's state and the scenario's inputs.
fn for_each_tick(
    device: &Device,
    name: ScenarioName,
    rate_hz: f64,
    seed: u64,
    seconds: f64,
    mut each: impl FnMut(f64, &Plant, &Drive),
) {
    let mut run = Run::new(device, name, rate_hz, seed, Columns::default());
    for k in 0..ticks(rate_hz, seconds).unwrap() {
        let t = k as f64 / rate_hz;
        let plant = run.plant.clone();
        let drive = run.tick(k as u64, run.loop_counts(), t, &mut ());
        each(t, &plant, &drive);
    }
}

#[test]
fn speeds_and_currents_are_within_their_ranges() {
    for name in ScenarioName::ALL {
        for (rate, seed) in [(1000.0, 1), (1000.0, 2), (11_600.0, 3), (11_600.0, 4)] {
            let trace = trace(name, rate, seed);
            assert_eq!(trace.len(), (10.0 * rate) as usize);
            let omega = omega(&trace);
            assert!(omega.iter().all(|w| w.is_finite()));
            let largest = omega.iter().fold(0.0_f64, |a, w| a.max(w.abs()));
            let rms_speed = rms(omega.iter().copied());
            let Speeds {
                largest: [low, high],
                rms: [low_rms, high_rms],
            } = name.speeds();
            assert!(high.is_finite(), "{name} has no bounds of its speed");
            assert!((low..high).contains(&largest), "{name}: largest {largest}");
            assert!(
                (low_rms..high_rms).contains(&rms_speed),
                "{name}: RMS {rms_speed}"
            );
            let current = trace.current.unwrap();
            let largest = current.iter().fold(0.0_f64, |a, i| a.max(i.abs()));
            assert!(largest < 2.0, "{name}: {largest} A");
            let small = trace.counts_small.unwrap();
            let moves = small.iter().any(|&count| count != small[0]);
            assert_eq!(moves, name.reads_small(), "{name}: motion of the handle");
        }
    }
}

#[test]
fn track_reverses_often_and_permanent_never() {
    for rate in RATES {
        let reversals = |name| {
            let trace = trace(name, rate, 1);
            let pairs = omega(&trace).windows(2);
            pairs
                .filter(|w| w[0] * w[1] < 0.0 || w[1] == 0.0 && w[0] != 0.0)
                .count()
        };
        assert!(reversals(ScenarioName::Track) > 60);
        assert_eq!(reversals(ScenarioName::Permanent), 0);
    }
}

#[test]
fn step_holds_each_current_for_a_quarter_of_a_second() {
    for rate in RATES {
        let trace = trace(ScenarioName::Step, rate, 1);
        let current = trace.current.unwrap();
        let on = |i: &f64| (0.15..=0.9).contains(&i.abs());
        assert!(current.iter().all(|i| on(i) || *i == 0.0));
        let share = current.iter().filter(|i| on(i)).count() as f64 / current.len() as f64;
        assert!((share - 0.5).abs() < 0.03, "on for {share} of the time");
        assert!(current.iter().any(|&i| i > 0.0) && current.iter().any(|&i| i < 0.0));
        let steps: Vec<usize> = (1..current.len())
            .filter(|&k| current[k] != current[k - 1])
            .collect();
        let expected: Vec<usize> = (1..40)
            .map(|k| (f64::from(k) * 0.25 * rate) as usize)
            .collect();
        assert_eq!(steps, expected);
    }
}

#[test]
fn creep_has_its_mean_speed_in_both_directions() {
    for rate in RATES {
        let trace = trace(ScenarioName::Creep, rate, 1);
        let (mut forward, mut back) = (Vec::new(), Vec::new());
        // Means over 100 ms, without those that contain a reversal.
        for chunk in omega(&trace).chunks((0.1 * rate) as usize) {
            let mean = chunk.iter().sum::<f64>() / chunk.len() as f64;
            if mean > 0.03 {
                forward.push(mean);
            } else if mean < -0.03 {
                back.push(mean);
            }
        }
        assert!(forward.len() > 20 && back.len() > 20);
        for (expected, means) in [(0.05, forward), (-0.05, back)] {
            let mean = means.iter().sum::<f64>() / means.len() as f64;
            assert!((mean - expected).abs() < 0.005, "{mean} rad/s");
        }
    }
}

/// The slip is at most 0.05 rad/s, and 20000 counts of the reference at 100 Hz are 0.03 rad/s each.
#[test]
fn loop_of_creep_is_stable_at_slow_rates() {
    for rate in [100.0, 120.0, 150.0, 200.0, 400.0] {
        let trace = simulate(
            &Device::default().frictionless(),
            ScenarioName::Creep,
            rate,
            1,
            10.0,
            ALL,
        )
        .unwrap();
        let largest = omega(&trace)
            .iter()
            .fold(0.0_f64, |most, w| most.max(w.abs()));
        assert!(largest < 0.3, "{rate} Hz: {largest} rad/s");
    }
}

#[test]
fn texture_moves_the_motor_at_50_to_300_hz() {
    for rate in RATES {
        let trace = trace(ScenarioName::Texture, rate, 1);
        let mut bins: Vec<Complex<f64>> = omega(&trace)
            .iter()
            .map(|&w| Complex::new(w, 0.0))
            .collect();
        let n = bins.len();
        FftPlanner::new().plan_fft_forward(n).process(&mut bins);
        let power = |low: f64, high: f64| {
            let bin = |hz: f64| (hz * n as f64 / rate) as usize;
            bins[bin(low)..bin(high)]
                .iter()
                .map(Complex::norm_sqr)
                .sum::<f64>()
        };
        let (slow, texture, above) = (power(0.0, 45.0), power(45.0, 330.0), power(330.0, 500.0));
        assert!(texture > 5.0 * slow, "{slow} {texture}");
        assert!(texture > 50.0 * above, "{above} {texture}");
    }
}

#[test]
fn wall_is_entered_and_left_and_its_torque_acts_on_the_hand() {
    let device = Device::default();
    for rate in RATES {
        let (mut deepest, mut farthest, mut entries) = (0.0_f64, 0.0_f64, 0);
        let (mut errors, mut before) = (Vec::new(), 0.0);
        for_each_tick(
            &device,
            ScenarioName::Wall,
            rate,
            1,
            10.0,
            |t, plant, drive| {
                let depth = plant.small().angle - 0.10;
                entries += i32::from(depth > 0.0 && before <= 0.0 && t > 0.0);
                before = depth;
                deepest = deepest.max(depth);
                farthest = farthest.min(depth);
                if t > 0.1 {
                    errors.push(plant.handle_torque(&drive.grip, 0.0) + 0.30 * depth.max(0.0));
                }
            },
        );
        assert!((0.02..0.2).contains(&deepest), "{deepest} rad deep");
        assert!(
            farthest < -0.03 && entries >= 3,
            "{farthest} rad, {entries} entries"
        );
        let error = rms(errors);
        assert!(error < 2e-3, "error of the torque: {error} N.m");
    }
}

#[test]
fn hand_feels_little_torque_if_none_is_wanted() {
    let device = Device::default();
    for rate in RATES {
        for name in [ScenarioName::FreeAir, ScenarioName::Hold] {
            let mut felt = Vec::new();
            for_each_tick(&device, name, rate, 1, 10.0, |t, plant, drive| {
                assert!(matches!(drive.grip, Grip::Hand(_)));
                if t > 0.1 {
                    felt.push(plant.handle_torque(&drive.grip, 0.0));
                }
            });
            let felt = rms(felt);
            assert!(felt < 2e-3, "{name}: {felt} N.m");
        }
    }
}

#[test]
fn heating_reduces_the_damping_by_30_percent_within_60_s() {
    let mut device = Device::default();
    device.small_ripple.torque = 0.0;
    let (kt, b) = (device.stages.small.torque_constant, device.stages.damping);
    let (mut decided, mut slipped) = (1.0, 0.0_f64);
    let each = |t: f64, plant: &Plant, drive: &Drive| {
        // The plant has the damping that was applied at the previous tick.
        let coupler = plant.handle_torque(&drive.grip, 0.0) - kt * plant.currents().1;
        let slip = plant.large().omega;
        assert!((coupler - decided * b * slip).abs() < 1e-12);
        slipped = slipped.max(slip.abs());
        let expected = 1.0 - 0.3 * (t.min(60.0) / 60.0);
        decided = drive.damping_part;
        assert!((decided - expected).abs() < 2e-5);
    };
    for_each_tick(&device, ScenarioName::Heating, 200.0, 1, 70.0, each);
    assert!((decided - 0.7).abs() < 1e-12 && slipped > 5.0);
}

#[test]
fn stochastic_has_the_documented_equations_of_motion() {
    let device = Device::default();
    let (b, j) = (device.stages.damping, device.stages.large.inertia);
    let (kt, lag) = (
        device.stages.large.torque_constant,
        1.0 / (TAU * device.stages.amplifier_bandwidth.0),
    );
    for rate in RATES {
        let trace = trace(ScenarioName::Stochastic, rate, 1);
        let (omega, current) = (omega(&trace), trace.current.as_ref().unwrap());
        let (a, c) = ((-b / j / rate).exp(), (-1.0 / lag / rate).exp());
        let (mut i, mut rest) = (0.0, Vec::new());
        for k in 0..omega.len() - 1 {
            let u = current[k];
            let driven = kt * u / b * (1.0 - a) + kt * (i - u) / j * (c - a) / (b / j - 1.0 / lag);
            rest.push(omega[k + 1] - a * omega[k] - driven);
            i = u + (i - u) * c;
        }
        let expected = crate::scenario::TORQUE_INTENSITY_NM2_S * (1.0 - a * a) / (2.0 * b * j);
        let part = rms(rest).powi(2) / expected;
        assert!((part - 1.0).abs() < 0.06, "{rate} Hz: {part}");
        let std = rms(current.iter().copied()) / crate::scenario::CURRENT_STD_A;
        assert!((std - 1.0).abs() < 0.03, "{std}");
    }
}
