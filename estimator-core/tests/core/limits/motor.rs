//! The ranges of a motor's constants and of an observer's uncertainty.

use estimator_core::{
    Amps, Count, CoupledMotor, DesignError, Hertz, Model, MotorModel, Observer, ObserverDesign,
    Sample, Uncertainty, VelocityEstimator,
};

use super::{RATE, assert_range};
use crate::UNSURE;

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
        DesignError::DISTURBANCE,
        &[1e-5, 999_999.0],
        &[0.0, -1e-5, 1e6],
        |value| design(&|unsure| unsure.disturbance = value),
    );
    assert_range(
        "disturbance time",
        DesignError::DISTURBANCE_TIME,
        &[1e-3, 9.9e8],
        &[0.0, -1e-3, 1e9],
        |value| design(&|unsure| unsure.disturbance_time = value),
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
    let refused = design(&|unsure| unsure.disturbance = 1e-200);
    assert_eq!(refused.err(), Some(DesignError::DISTURBANCE));
}

/// White torque that alone spreads the velocity by 1e-9 to 512 counts a tick in a tick.
#[test]
fn quantised_observer_has_a_range_of_white_torque() {
    let counts_per_torque = 4096.0 / std::f64::consts::TAU * 1e-6 / 115e-7;
    let spread = |counts: f64| {
        let unsure = Uncertainty {
            torque_noise: counts / counts_per_torque / 1000f64.sqrt(),
            disturbance: 10.0 * counts / counts_per_torque,
            ..UNSURE
        };
        ObserverDesign::quantised(&CoupledMotor::DCX35L, RATE, &unsure).build()
    };
    let refused = |counts| spread(counts).err() == Some(DesignError::TORQUE_NOISE_FOR_QUANTISED);
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
    let torque_constant = |value| design(1000.0, &|device| device.motor.torque_constant = value);
    let damping = |value| design(1000.0, &|device| device.motor.damping = value);
    let inertia = |value| design(1000.0, &|device| device.motor.inertia = value);
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
        (device.motor.inertia, device.motor.torque_constant) = (1e300, 1e-300);
    });
    assert_eq!(moved, Err(DesignError::RATE_FOR_CURRENT));
    let coupled = |counts| design(1000.0, &|device| device.coupled_counts_per_rev = counts);
    assert_eq!(
        (coupled(0), coupled(1)),
        (Err(DesignError::COUPLED_COUNTS_PER_REV), Ok(()))
    );
    let refused = design(1000.0, &|device| device.motor.counts_per_rev = 0);
    assert_eq!(refused, Err(DesignError::COUNTS_PER_REV));
    assert_range("rate", DesignError::RATE, &[500.0], &[0.0, -1.0], |rate| {
        design(rate, &|_| ())
    });
}

#[test]
fn device_has_a_range() {
    let check = |change: &dyn Fn(&mut MotorModel)| {
        let mut device = MotorModel::DCX35L;
        change(&mut device);
        device.checked()
    };
    assert_eq!(check(&|_| ()), Ok(MotorModel::DCX35L));
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
    let design = |change: &dyn Fn(&mut MotorModel)| {
        let mut device = MotorModel::DCX35L;
        change(&mut device);
        Model::motor(&device, RATE, 0.1).err()
    };
    let stiffest = 700.0 * MotorModel::DCX35L.inertia * 1e3;
    let strongest = 1e9 * MotorModel::DCX35L.inertia / 1e-6 / (4096.0 / std::f64::consts::TAU);
    for (part, refused) in [(0.999, false), (1.001, true)] {
        let damped = design(&|device| device.damping = part * stiffest);
        assert_eq!(damped, refused.then_some(DesignError::RATE_FOR_DAMPING));
        let moved = design(&|device| device.torque_constant = part * strongest);
        assert_eq!(moved, refused.then_some(DesignError::RATE_FOR_CURRENT));
    }
    let moved = design(&|device| (device.inertia, device.torque_constant) = (1e300, 1e-300));
    assert_eq!(moved, Some(DesignError::RATE_FOR_CURRENT));
}

/// A rotor at rest leaves as soon as the torque of its current is above the assumed friction.
#[test]
fn rotor_leaves_at_the_friction_of_the_design() {
    let device = CoupledMotor {
        coulomb_friction: 6.5e-3,
        amplifier_lag: 0.0,
        ..CoupledMotor::DCX35L
    };
    let observer = Observer::new(&device, RATE, &UNSURE).expect("valid");
    let limit = device.coulomb_friction / device.motor.torque_constant;
    for direction in [1.0, -1.0] {
        let velocity = |amps: f64| {
            let mut state = observer.start(&Sample::new(Count(0)));
            let sample = Sample::new(Count(0)).with_current(Amps::new((direction * amps) as f32));
            f64::from(observer.update(&mut state, &sample).0) * direction
        };
        assert_eq!(velocity(limit * 0.99999), 0.0);
        assert!(velocity(limit * 1.00001) > 0.0);
        // At twice the friction v' = φ1 Tc s T² / J.
        let beta = device.motor.damping * 1e-3 / device.motor.inertia;
        let friction =
            device.coulomb_friction * 4096.0 / std::f64::consts::TAU * 1e-6 / device.motor.inertia;
        let exact = friction * (1.0 - (-beta).exp()) / beta;
        assert!((velocity(2.0 * limit) / exact - 1.0).abs() < 1e-5);
    }
}
