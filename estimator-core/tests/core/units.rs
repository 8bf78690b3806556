//! Quantities at the core's edge: counts modulo 2^32, currents that are numbers, scales, signals.

use estimator_core::{
    AccelerationEstimator, Amps, Confidence, Count, Counts, CountsPerTick, Hertz, LateCurrent,
    Model, ParameterErrors, Sample, Scale, Signals, SteadyKalman, Variance, VelocityEstimator,
};

#[test]
fn counts_are_modulo_two_to_the_32() {
    for (newer, older, moved) in [
        (2, u32::MAX, 3),
        (u32::MAX, 2, -3),
        (1 << 31, 0, i32::MIN),
        (7, 7, 0),
        (1000, 400, 600),
    ] {
        assert_eq!(Count(newer) - Count(older), Counts(moved));
        assert_eq!(Count(older) + Counts(moved), Count(newer));
    }
    assert_eq!(Counts(-16_777_216).to_f32(), -16_777_216.0);
}

/// A 16-bit counter that moves by less than 2^15 between two readings is followed.
#[test]
fn sixteen_bit_counts_are_extended_by_the_smaller_difference() {
    for count in [0u32, 0x1_FFFF, 0x2_0002, 0x7FFF_FFFF, u32::MAX, 12_345_678] {
        for moved in [-32_768i32, -32_767, -1, 0, 1, 3, 255, 32_767] {
            let now = count.wrapping_add_signed(moved);
            assert_eq!(
                Count(count).extended(now as u16),
                Count(now),
                "{count} {moved}"
            );
        }
    }
}

#[test]
fn currents_are_numbers_within_1000_a() {
    for (amps, taken) in [
        (0.25, 0.25),
        (-0.25, -0.25),
        (1000.0, 1000.0),
        (-1000.0, -1000.0),
        (1000.1, 1000.0),
        (-1000.1, -1000.0),
        (f32::MAX, 1000.0),
        (f32::MIN, -1000.0),
        (f32::INFINITY, 0.0),
        (f32::NEG_INFINITY, 0.0),
        (f32::NAN, 0.0),
        (-f32::NAN, 0.0),
    ] {
        assert_eq!(Amps::new(amps).get(), taken, "{amps}");
    }
    assert_eq!((Amps::ZERO.get(), Amps::default().get()), (0.0, 0.0));
}

#[test]
fn scale_is_a_turn_per_counts_and_ticks() {
    for (counts, rate) in [(4096, 1000.0), (1, 50.0), (20_000, 11_600.0)] {
        let scale = Scale::new(counts, Hertz(rate)).expect("valid");
        let exact = std::f64::consts::TAU * rate / f64::from(counts);
        let velocity = f64::from(CountsPerTick(-3.0).rad_per_s(&scale));
        assert!((velocity / (-3.0 * exact) - 1.0).abs() < 2e-7);
    }
    assert_eq!(Hertz(250.0).period_s(), 0.004);
}

/// Every pair of sets of signals: what is needed by either, and what is there.
#[test]
fn signals_are_sets() {
    let all = (0..8u8).map(|bits| Signals {
        current: bits & 1 != 0,
        coupled: bits & 2 != 0,
        edge: bits & 4 != 0,
    });
    let all: Vec<Signals> = all.collect();
    for (a, one) in (0..8usize).zip(&all) {
        for (b, other) in (0..8usize).zip(&all) {
            assert_eq!(one.or(*other), all[a | b]);
            assert_eq!(one.within(*other), a & !b == 0, "{one:?} in {other:?}");
        }
    }
    assert_eq!(
        (Signals::COUNT, Signals::COUNT_AND_CURRENT),
        (all[0], all[1])
    );
}

#[test]
fn ratio_of_the_damping_is_by_the_torque_constant() {
    let learned = ParameterErrors {
        damping: 0.2,
        friction: 0.9,
        torque_constant: -0.4,
    };
    assert!((learned.damping_ratio() - 2.0).abs() < 1e-6);
}

/// A late current changes nothing in what the estimator believes of its error.
#[test]
fn late_current_has_the_variance_of_its_estimator() {
    let model = Model::triple_integrator(4096, Hertz(1000.0), 2e4).expect("valid");
    let steady = SteadyKalman::new(&model).expect("valid");
    let first = Sample::new(Count(0));
    let own = steady.variance(&steady.start(&first));
    let late = LateCurrent(steady);
    assert_eq!(late.variance(&late.start(&first)), own);
    assert!(own > Variance(0.0) && own < Variance(1.0), "{own:?}");
    assert_eq!(steady.acceleration(&steady.start(&first)).0, 0.0);
}
