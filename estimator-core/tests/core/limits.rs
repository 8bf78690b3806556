//! The range of every parameter, on both sides of each end.

use estimator_core::{
    Amps, Count, CoupledMotor, DesignError, Device, EndFit, FiniteDifference, Foaw, Handover,
    Hertz, LowPass, Model, Observer, Pll, Sample, Scale, Uncertainty, VelocityEstimator,
};

const RATE: Hertz = Hertz(1000.0);

const UNSURE: Uncertainty = Uncertainty {
    torque_noise: 1e-5,
    load: 3e-4,
    load_time: 0.1,
    friction_share: 0.7,
    boundary_noise: 0.03,
};

/// Asserts that `design` refuses the value by this error, and no other way round.
#[track_caller]
fn assert_range<T>(
    what: &str,
    error: DesignError,
    accepted: &[f64],
    refused: &[f64],
    design: impl Fn(f64) -> Result<T, DesignError>,
) {
    for &value in accepted {
        assert_ne!(design(value).err(), Some(error), "{what} {value:e}");
    }
    for &value in refused
        .iter()
        .chain(&[f64::NAN, f64::INFINITY, f64::NEG_INFINITY])
    {
        assert_eq!(design(value).err(), Some(error), "{what} {value:e}");
    }
}

#[test]
fn uncertainty_has_a_range() {
    let design = |change: &dyn Fn(&mut Uncertainty)| {
        let mut unsure = UNSURE;
        change(&mut unsure);
        Observer::new(&CoupledMotor::DCX35L, RATE, &unsure)
    };
    assert_range(
        "torque noise",
        DesignError::TORQUE_NOISE,
        &[1e-6, 999_999.0],
        &[0.0, -1e-6, 1e6],
        |value| design(&|unsure| unsure.torque_noise = value),
    );
    assert_range(
        "load",
        DesignError::LOAD,
        &[1e-5, 999_999.0],
        &[0.0, -1e-5, 1e6],
        |value| design(&|unsure| unsure.load = value),
    );
    assert_range(
        "load time",
        DesignError::LOAD_TIME,
        &[1e-3, 9.9e8],
        &[0.0, -1e-3, 1e9],
        |value| design(&|unsure| unsure.load_time = value),
    );
    assert_range(
        "friction share",
        DesignError::FRICTION_SHARE,
        &[0.0, 1.0],
        &[-1e-3, 1.001],
        |value| design(&|unsure| unsure.friction_share = value),
    );
    assert_range(
        "boundary",
        DesignError::BOUNDARY_NOISE,
        &[1e-4, 1e3],
        &[0.99e-4, 1001.0, 0.0, -0.1],
        |value| design(&|unsure| unsure.boundary_noise = value),
    );
    // A variance that rounds to zero in counts and ticks is refused too.
    let refused = design(&|unsure| unsure.torque_noise = 1e-200);
    assert_eq!(refused.err(), Some(DesignError::TORQUE_NOISE));
    let refused = design(&|unsure| unsure.load = 1e-200);
    assert_eq!(refused.err(), Some(DesignError::LOAD));
}

/// White torque that alone spreads the velocity by 1e-9 to 512 counts a tick in a tick.
#[test]
fn soft_observer_has_a_range_of_white_torque() {
    let counts_per_torque = 4096.0 / std::f64::consts::TAU * 1e-6 / 115e-7;
    let spread = |counts: f64| {
        let unsure = Uncertainty {
            torque_noise: counts / counts_per_torque / 1000f64.sqrt(),
            load: 10.0 * counts / counts_per_torque,
            ..UNSURE
        };
        Observer::soft(&CoupledMotor::DCX35L, RATE, &unsure)
    };
    let refused = |counts| spread(counts).err() == Some(DesignError::TORQUE_NOISE_FOR_SOFT);
    assert!(refused(0.999e-9) && !refused(1.001e-9));
    assert!(refused(512.1) && !refused(511.9));
}

#[test]
fn coupled_motor_has_a_range() {
    let design = |rate: f64, change: &dyn Fn(&mut CoupledMotor)| {
        let mut device = CoupledMotor::DCX35L;
        change(&mut device);
        Observer::new(&device, Hertz(rate), &UNSURE).map(|_| ())
    };
    let friction = |value| design(1000.0, &|device| device.coulomb_friction = value);
    let torque_constant = |value| design(1000.0, &|device| device.large.torque_constant = value);
    let damping = |value| design(1000.0, &|device| device.large.damping = value);
    let inertia = |value| design(1000.0, &|device| device.large.inertia = value);
    let lag = |value| design(1000.0, &|device| device.amplifier_lag = value);
    assert_range(
        "friction",
        DesignError::COULOMB_FRICTION,
        &[0.0, 2.8],
        &[-1e-6],
        friction,
    );
    assert_range(
        "lag",
        DesignError::AMPLIFIER_LAG,
        &[0.0, 1e-9, 999.0],
        &[-1e-6, 1001.0],
        lag,
    );
    assert_range(
        "torque constant",
        DesignError::TORQUE_CONSTANT,
        &[1e-3],
        &[0.0, -1e-3],
        torque_constant,
    );
    assert_range(
        "damping",
        DesignError::DAMPING,
        &[0.0, 1e-3],
        &[-1e-6],
        damping,
    );
    assert_range(
        "inertia",
        DesignError::INERTIA,
        &[115e-7],
        &[0.0, -1e-6],
        inertia,
    );
    // In counts and ticks at 1 kHz, 4096 counts and 115e-7 kg.m2.
    let strongest = 1e6 * 115e-7 / 1e-6 / 4096.0;
    let stiffest = 8.0 * 115e-7 * 1000.0;
    for (limit, error, design) in [
        (
            strongest,
            DesignError::RATE_FOR_FRICTION,
            &friction as &dyn Fn(f64) -> _,
        ),
        (strongest, DesignError::RATE_FOR_CURRENT, &torque_constant),
        (stiffest, DesignError::RATE_FOR_DAMPING, &damping),
    ] {
        assert_ne!(design(0.999 * limit), Err(error), "{error}");
        assert_eq!(design(1.001 * limit), Err(error), "{error}");
    }
    // An ampere that moves nothing.
    let moved = design(1000.0, &|device| {
        (device.large.inertia, device.large.torque_constant) = (1e300, 1e-300);
    });
    assert_eq!(moved, Err(DesignError::RATE_FOR_CURRENT));
    let small = |counts| design(1000.0, &|device| device.small_counts_per_rev = counts);
    assert_eq!(
        (small(0), small(1)),
        (Err(DesignError::SMALL_COUNTS_PER_REV), Ok(()))
    );
    let refused = design(1000.0, &|device| device.large.counts_per_rev = 0);
    assert_eq!(refused, Err(DesignError::COUNTS_PER_REV));
    assert_range("rate", DesignError::RATE, &[500.0], &[0.0, -1.0], |rate| {
        design(rate, &|_| ())
    });
}

#[test]
fn device_has_a_range() {
    let check = |change: &dyn Fn(&mut Device)| {
        let mut device = Device::DCX35L;
        change(&mut device);
        device.checked()
    };
    assert_eq!(check(&|_| ()), Ok(Device::DCX35L));
    assert_range(
        "inertia",
        DesignError::INERTIA,
        &[1e-30, 1e30],
        &[0.0, -1e-9],
        |value| check(&|device| device.inertia = value),
    );
    assert_range(
        "torque constant",
        DesignError::TORQUE_CONSTANT,
        &[1e-30, 1e30],
        &[0.0, -1e-9],
        |value| check(&|device| device.torque_constant = value),
    );
    assert_range(
        "damping",
        DesignError::DAMPING,
        &[0.0, 1e30],
        &[-1e-9],
        |value| check(&|device| device.damping = value),
    );
    let refused = check(&|device| device.counts_per_rev = 0);
    assert_eq!(refused, Err(DesignError::COUNTS_PER_REV));
    assert!(check(&|device| device.counts_per_rev = 1).is_ok());
}

#[test]
fn motor_model_has_a_range() {
    let design = |change: &dyn Fn(&mut Device)| {
        let mut device = Device::DCX35L;
        change(&mut device);
        Model::motor(&device, RATE, 0.1).err()
    };
    let stiffest = 700.0 * Device::DCX35L.inertia * 1e3;
    let strongest = 1e9 * Device::DCX35L.inertia / 1e-6 / (4096.0 / std::f64::consts::TAU);
    for (part, refused) in [(0.999, false), (1.001, true)] {
        let damped = design(&|device| device.damping = part * stiffest);
        assert_eq!(damped, refused.then_some(DesignError::RATE_FOR_DAMPING));
        let moved = design(&|device| device.torque_constant = part * strongest);
        assert_eq!(moved, refused.then_some(DesignError::RATE_FOR_CURRENT));
    }
    let moved = design(&|device| (device.inertia, device.torque_constant) = (1e300, 1e-300));
    assert_eq!(moved, Some(DesignError::RATE_FOR_CURRENT));
}

#[test]
fn cutoff_is_a_millionth_to_half_of_the_rate() {
    let low_pass = |cutoff: f64| LowPass::new(FiniteDifference, Hertz(cutoff), RATE);
    let pll = |cutoff: f64| Pll::new(Hertz(cutoff), RATE);
    let (inside, outside) = ([1.001e-3, 1.0, 500.0], [0.999e-3, 500.1, 0.0, -1.0]);
    assert_range("low-pass", DesignError::CUTOFF, &inside, &outside, low_pass);
    assert_range("PLL", DesignError::BANDWIDTH, &inside, &outside, pll);
    for rate in [0.0, -1000.0, f64::NAN, f64::INFINITY] {
        let refused = LowPass::new(FiniteDifference, Hertz(1.0), Hertz(rate));
        assert_eq!(refused.err(), Some(DesignError::RATE));
        assert_eq!(
            Pll::new(Hertz(1.0), Hertz(rate)).err(),
            Some(DesignError::RATE)
        );
        assert_eq!(Scale::new(4096, Hertz(rate)).err(), Some(DesignError::RATE));
    }
    let refused = Scale::new(0, RATE).err();
    assert_eq!(refused, Some(DesignError::COUNTS_PER_REV));
}

/// The pole of a first-order low-pass is `exp(-2 π cutoff / rate)`: after a step of the velocity, n
/// ticks leave p^n of it.
#[test]
fn low_pass_has_its_pole() {
    let (cutoff, step) = (20.0, 100);
    let pole = (-std::f64::consts::TAU * cutoff / RATE.0).exp();
    let low_pass = LowPass::new(FiniteDifference, Hertz(cutoff), RATE).unwrap();
    let mut state = low_pass.start(&Sample::new(Count(0)));
    for n in 1..60 {
        let velocity = low_pass.update(&mut state, &Sample::new(Count(step * n))).0;
        let exact = f64::from(step) * (1.0 - pole.powi(n as i32));
        assert!(
            (f64::from(velocity) - exact).abs() < 1e-4,
            "{n}: {velocity} {exact}"
        );
    }
}

/// `e = y - (θ + v)`, `θ += v + (1 - p²) e`, `v += (1 - p)² e`, with positions that are absolute.
#[test]
fn pll_has_its_double_pole() {
    let pole = (-std::f64::consts::TAU * 35.0 / RATE.0).exp();
    let pll = Pll::new(Hertz(35.0), RATE).unwrap();
    let mut state = pll.start(&Sample::new(Count(0)));
    let (mut theta, mut v) = (0.0, 0.0);
    for n in 1..400u32 {
        // Steps of 0, 1, 3, 6, .. counts, and back.
        let y = n / 7 * (n % 20);
        let e = f64::from(y) - (theta + v);
        theta += v + (1.0 - pole * pole) * e;
        v += (1.0 - pole).powi(2) * e;
        let velocity = f64::from(pll.update(&mut state, &Sample::new(Count(y))).0);
        assert!(
            (velocity - v).abs() < 1e-4 * (1.0 + v.abs()),
            "{n}: {velocity} {v}"
        );
    }
}

#[test]
fn foaw_has_a_range() {
    for (window, bound, error) in [
        (0, 1, Some(DesignError::WINDOW)),
        (1, 1, None),
        (15, 1, None),
        (16, 1, Some(DesignError::WINDOW)),
        (15, 0, None),
        (15, 1 << 14, None),
        (15, (1 << 14) + 1, Some(DesignError::BOUND)),
    ] {
        let refused = Foaw::<15, EndFit>::new(window, bound).err();
        assert_eq!(refused, error, "{window} {bound}");
    }
}

#[test]
fn handover_has_a_range() {
    let new = |settle, fade| Handover::new(FiniteDifference, FiniteDifference, settle, fade);
    let longest = 1u16 << 15;
    for (settle, fade) in [(0, 1), (0, longest), (longest - 1, longest)] {
        assert!(new(settle, fade).is_ok(), "{settle} {fade}");
    }
    for (settle, fade, error) in [
        (0, 0, DesignError::FADE),
        (0, longest + 1, DesignError::FADE),
        (longest, 1, DesignError::SETTLE),
        (u16::MAX, 1, DesignError::SETTLE),
    ] {
        assert_eq!(new(settle, fade).err(), Some(error), "{settle} {fade}");
    }
}

/// A rotor at rest leaves as soon as the torque of its current is above the friction believed in.
#[test]
fn rotor_leaves_at_the_friction_of_the_design() {
    let device = CoupledMotor {
        coulomb_friction: 6.5e-3,
        amplifier_lag: 0.0,
        ..CoupledMotor::DCX35L
    };
    let observer = Observer::new(&device, RATE, &UNSURE).expect("valid");
    let limit = device.coulomb_friction / device.large.torque_constant;
    for direction in [1.0, -1.0] {
        let velocity = |amps: f64| {
            let mut state = observer.start(&Sample::new(Count(0)));
            let sample = Sample::new(Count(0)).with_current(Amps::new((direction * amps) as f32));
            f64::from(observer.update(&mut state, &sample).0) * direction
        };
        assert_eq!(velocity(limit * 0.99999), 0.0);
        assert!(velocity(limit * 1.00001) > 0.0);
        // At twice the friction v' = φ1 Tc s T² / J.
        let beta = device.large.damping * 1e-3 / device.large.inertia;
        let friction =
            device.coulomb_friction * 4096.0 / std::f64::consts::TAU * 1e-6 / device.large.inertia;
        let exact = friction * (1.0 - (-beta).exp()) / beta;
        assert!((velocity(2.0 * limit) / exact - 1.0).abs() < 1e-5);
    }
}

/// A message begins with the parameter, states the requirement and ends with the unit, and no two
/// messages are the same.
#[test]
fn message_has_parameter_requirement_and_unit() {
    for error in DesignError::ALL {
        let (parameter, unit) = (error.parameter(), error.unit());
        let message = error.to_string();
        let rest = message.strip_prefix(parameter).expect("the parameter");
        let words = rest.strip_suffix(&format!(" ({unit})")).unwrap_or(rest);
        assert_eq!(
            words.strip_prefix(' '),
            Some(error.requirement()),
            "{error}"
        );
        assert_eq!(words == rest, unit.is_empty(), "{error}");
        assert!(!parameter.is_empty() && !message.contains("  "), "{error}");
        let same = DesignError::ALL.iter();
        let same = same.filter(|other| other.message() == error.message());
        assert_eq!(same.count(), 1, "{error}");
    }
}

/// Names the API has: constructors and fields. A unit is left out where the parameter is a number.
#[test]
fn errors_name_parameters_of_the_api() {
    for (error, parameter, unit) in [
        (DesignError::RATE, "rate", "Hz"),
        (DesignError::CUTOFF, "cutoff", "Hz"),
        (DesignError::INERTIA, "inertia", "kg m^2"),
        (DesignError::TORQUE_NOISE, "torque_noise", "N m/sqrt(Hz)"),
        (DesignError::FRICTION_SHARE, "friction_share", ""),
        (DesignError::TABLE, "N", "ticks"),
    ] {
        assert_eq!((error.parameter(), error.unit()), (parameter, unit));
    }
}
