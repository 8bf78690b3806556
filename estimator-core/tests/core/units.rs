//! Quantities at the core's edge: counts modulo 2^32, currents that are numbers, scales, signals.

use estimator_core::{
    AccelerationEstimator, Amps, Confidence, Count, Counts, CountsPerTick, Hertz, LateCurrent,
    Model, ParameterErrors, Sample, Scale, Signals, SteadyKalman, Variance, VelocityEstimator,
    WrapError,
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

/// An absolute encoder is followed over a long motion in steps of up to half a turn, in both
/// directions, from a position known without wrapping.
#[test]
fn absolute_encoders_are_followed_over_many_turns() {
    for modulus in [
        2_u32,
        3,
        360,
        999,
        4095,
        4096,
        16_384,
        1 << 16,
        (1 << 31) - 1,
        1 << 31,
    ] {
        let longest = (i64::from(modulus) - 1) / 2;
        let mut position = i64::from(modulus) - 1;
        let mut count = Count(position as u32);
        for k in 0..2000_i64 {
            let forward = (k / 500) % 2 == 0;
            let step = (longest * (k % 7)) / 6 * if forward { 1 } else { -1 };
            let next = position + step;
            // A modulus that does not divide 2^32 needs a position of 32 bits.
            if !modulus.is_power_of_two() && i32::try_from(next).is_err() {
                continue;
            }
            position = next;
            let raw = position.rem_euclid(i64::from(modulus)) as u32;
            count = count.wrapped(raw, modulus).unwrap();
            assert_eq!(count, Count(position as u32), "{modulus} {k}");
        }
        // Half of an even turn is taken backward, as the smallest 16-bit number is negative.
        if modulus % 2 == 0 {
            let half = modulus / 2;
            let back = Count(5).wrapped((5 + half) % modulus, modulus).unwrap();
            assert_eq!(back - Count(5), Counts(-(half as i32)), "{modulus}");
        }
    }
}

#[test]
fn powers_of_two_wrap_beyond_32_bits_and_16_bits_agree_with_a_counter() {
    let mut count = Count(u32::MAX - 10);
    for k in 0..20_u32 {
        let position = (u32::MAX - 10).wrapping_add(100 * k);
        count = count.wrapped(position % 4096, 4096).unwrap();
        assert_eq!(count, Count(position));
    }
    for raw in [0, 1, 0x7FFF, 0x8000, 0xFFFF] {
        for count in [Count(0x1_8000), Count(u32::MAX), Count(77)] {
            assert_eq!(
                count.wrapped(raw, 1 << 16),
                Ok(count.extended(raw as u16)),
                "{count:?} {raw}"
            );
        }
    }
}

#[test]
fn invalid_readings_of_absolute_encoders_are_refused() {
    for (count, raw, modulus, error) in [
        (0, 0, 0, WrapError::Modulus),
        (0, 0, 1, WrapError::Modulus),
        (0, 0, (1 << 31) + 1, WrapError::Modulus),
        (7, 4096, 4096, WrapError::Raw),
        (7, 3600, 3600, WrapError::Raw),
        (0, 1 << 31, 1 << 31, WrapError::Raw),
        // 2^31 - 1 is 847 modulo 3600: the next count has no signed number.
        (i32::MAX as u32, 848, 3600, WrapError::Position),
        // -2^31 is 2752 modulo 3600.
        (1 << 31, 2751, 3600, WrapError::Position),
    ] {
        let refused = Count(count).wrapped(raw, modulus);
        assert_eq!(refused, Err(error), "{count} {raw} {modulus}");
    }
    assert_eq!(i32::MAX.rem_euclid(3600), 847);
    assert_eq!(i32::MIN.rem_euclid(3600), 2752);
    assert!(WrapError::Raw.to_string().contains("below modulus"));
    const NEXT: Result<Count, WrapError> = Count(4095).wrapped(0, 4096);
    assert_eq!(NEXT, Ok(Count(4096)));
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

/// A late current changes nothing in its standard deviation.
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
