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
    let error = DesignError::Uncertainty;
    assert_range(
        "torque noise",
        error,
        &[1e-6, 999_999.0],
        &[0.0, -1e-6, 1e6],
        |value| design(&|unsure| unsure.torque_noise = value),
    );
    assert_range(
        "load",
        error,
        &[1e-5, 999_999.0],
        &[0.0, -1e-5, 1e6],
        |value| design(&|unsure| unsure.load = value),
    );
    assert_range(
        "load time",
        error,
        &[1e-3, 9.9e8],
        &[0.0, -1e-3, 1e9],
        |value| design(&|unsure| unsure.load_time = value),
    );
    assert_range(
        "friction share",
        error,
        &[0.0, 1.0],
        &[-1e-3, 1.001],
        |value| design(&|unsure| unsure.friction_share = value),
    );
    assert_range(
        "boundary",
        error,
        &[1e-4, 1e3],
        &[0.99e-4, 1001.0, 0.0, -0.1],
        |value| design(&|unsure| unsure.boundary_noise = value),
    );
    // Noise that is nothing in counts and ticks is none.
    let error = Some(DesignError::ProcessNoise);
    assert_eq!(design(&|unsure| unsure.torque_noise = 1e-200).err(), error);
    assert_eq!(design(&|unsure| unsure.load = 1e-200).err(), error);
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
    let refused = |counts| spread(counts).err() == Some(DesignError::ProcessNoise);
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
        DesignError::CoupledMotor,
        &[0.0, 2.8],
        &[-1e-6],
        friction,
    );
    assert_range(
        "lag",
        DesignError::CoupledMotor,
        &[0.0, 1e-9, 999.0],
        &[-1e-6, 1001.0],
        lag,
    );
    assert_range(
        "torque constant",
        DesignError::Device,
        &[1e-3],
        &[0.0, -1e-3],
        torque_constant,
    );
    assert_range(
        "damping",
        DesignError::Device,
        &[0.0, 1e-3],
        &[-1e-6],
        damping,
    );
    assert_range(
        "inertia",
        DesignError::Device,
        &[115e-7],
        &[0.0, -1e-6],
        inertia,
    );
    // In counts and ticks at 1 kHz, 4096 counts and 115e-7 kg.m2.
    let strongest = 1e6 * 115e-7 / 1e-6 / 4096.0;
    let stiffest = 8.0 * 115e-7 * 1000.0;
    for (what, limit, design) in [
        ("friction", strongest, &friction as &dyn Fn(f64) -> _),
        ("torque constant", strongest, &torque_constant),
        ("damping", stiffest, &damping),
    ] {
        assert_ne!(design(0.999 * limit), Err(DesignError::Tick), "{what}");
        assert_eq!(design(1.001 * limit), Err(DesignError::Tick), "{what}");
    }
    // An ampere that moves nothing.
    let moved = design(1000.0, &|device| {
        (device.large.inertia, device.large.torque_constant) = (1e300, 1e-300);
    });
    assert_eq!(moved, Err(DesignError::Tick));
    let small = |counts| design(1000.0, &|device| device.small_counts_per_rev = counts);
    assert_eq!(
        (small(0), small(1)),
        (Err(DesignError::CoupledMotor), Ok(()))
    );
    let refused = design(1000.0, &|device| device.large.counts_per_rev = 0);
    assert_eq!(refused, Err(DesignError::Device));
    assert_range("rate", DesignError::Rate, &[500.0], &[0.0, -1.0], |rate| {
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
    let error = DesignError::Device;
    assert_eq!(check(&|_| ()), Ok(Device::DCX35L));
    assert_range("inertia", error, &[1e-30, 1e30], &[0.0, -1e-9], |value| {
        check(&|device| device.inertia = value)
    });
    assert_range(
        "torque constant",
        error,
        &[1e-30, 1e30],
        &[0.0, -1e-9],
        |value| check(&|device| device.torque_constant = value),
    );
    assert_range("damping", error, &[0.0, 1e30], &[-1e-9], |value| {
        check(&|device| device.damping = value)
    });
    assert_eq!(check(&|device| device.counts_per_rev = 0), Err(error));
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
    for (part, error) in [(0.999, None), (1.001, Some(DesignError::Tick))] {
        assert_eq!(design(&|device| device.damping = part * stiffest), error);
        assert_eq!(
            design(&|device| device.torque_constant = part * strongest),
            error
        );
    }
    let moved = design(&|device| (device.inertia, device.torque_constant) = (1e300, 1e-300));
    assert_eq!(moved, Some(DesignError::Tick));
}

#[test]
fn cutoff_is_a_millionth_to_half_of_the_rate() {
    let low_pass = |cutoff: f64| LowPass::new(FiniteDifference, Hertz(cutoff), RATE);
    let pll = |cutoff: f64| Pll::new(Hertz(cutoff), RATE);
    let (inside, outside) = ([1.001e-3, 1.0, 500.0], [0.999e-3, 500.1, 0.0, -1.0]);
    assert_range("low-pass", DesignError::Cutoff, &inside, &outside, low_pass);
    assert_range("PLL", DesignError::Cutoff, &inside, &outside, pll);
    for rate in [0.0, -1000.0, f64::NAN, f64::INFINITY] {
        let refused = LowPass::new(FiniteDifference, Hertz(1.0), Hertz(rate));
        assert_eq!(refused.err(), Some(DesignError::Rate));
        assert_eq!(
            Pll::new(Hertz(1.0), Hertz(rate)).err(),
            Some(DesignError::Rate)
        );
        assert_eq!(Scale::new(4096, Hertz(rate)).err(), Some(DesignError::Rate));
    }
    assert_eq!(Scale::new(0, RATE).err(), Some(DesignError::Device));
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
        (0, 1, Some(DesignError::Window)),
        (1, 1, None),
        (15, 1, None),
        (16, 1, Some(DesignError::Window)),
        (15, 0, None),
        (15, 1 << 14, None),
        (15, (1 << 14) + 1, Some(DesignError::NoiseBound)),
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
    for (settle, fade) in [(0, 0), (0, longest + 1), (longest, 1), (u16::MAX, 1)] {
        assert_eq!(
            new(settle, fade).err(),
            Some(DesignError::Fade),
            "{settle} {fade}"
        );
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

/// A refusal says what is out of range: no other parameter, and no two errors the same.
#[test]
fn refusals_name_the_parameter() {
    let said = [
        (DesignError::Rate, "control rate"),
        (DesignError::Cutoff, "cut-off"),
        (DesignError::EdgeClock, "edge clock"),
        (DesignError::Fade, "fade"),
        (DesignError::Window, "window"),
        (DesignError::NoiseBound, "noise bound"),
        (DesignError::Device, "device constants"),
        (DesignError::CoupledMotor, "friction and amplifier lag"),
        (
            DesignError::Tick,
            "control rate is out of range for the device",
        ),
        (DesignError::Uncertainty, "torque noise and load"),
        (DesignError::ProcessNoise, "process noise"),
        (DesignError::NotConverged, "does not converge"),
        (DesignError::NotStable, "not stable"),
        (DesignError::Table, "table"),
    ];
    for (error, words) in said {
        assert!(error.message().contains(words), "{error:?}: {error}");
        let same = said
            .iter()
            .filter(|(other, _)| other.message() == error.message());
        assert_eq!(same.count(), 1, "{error:?}");
    }
}
