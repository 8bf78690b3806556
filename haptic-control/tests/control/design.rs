//! The design of the velocity loop: its polynomials and its margins.

use std::f64::consts::TAU;

use estimator_core::{CoupledMotor, Hertz};
use haptic_control::{DesignError, DualStage, LEAST_MODULUS, LoopPoles, Rig, RstDesign, SceneKind};

pub(crate) const RATES: [f64; 5] = [800.0, 1e3, 10e3, 11.6e3, 20e3];

pub(crate) fn design(rate: f64) -> RstDesign {
    RstDesign::new(&DualStage::DEFAULT, Hertz(rate), LoopPoles::DEFAULT).unwrap()
}

pub(crate) fn product(x: &[f64], y: &[f64]) -> Vec<f64> {
    let mut z = vec![0.0; x.len() + y.len() - 1];
    for (i, x) in x.iter().enumerate() {
        for (j, y) in y.iter().enumerate() {
            z[i + j] += x * y;
        }
    }
    z
}

/// The core states the motor and its amplifier; its bandwidth comes back to the last bit.
#[test]
fn default_device_has_the_motor_of_the_core() {
    let device = DualStage::DEFAULT;
    assert_eq!(device.coupled_motor(), CoupledMotor::DCX35L);
    assert_eq!(device.amplifier_bandwidth, Hertz(2000.0));
}

#[test]
fn plant_model_is_motor_with_amplifier_lag() {
    // Independent of the closed form: the differential equations in tiny steps over one tick.
    let device = DualStage::DEFAULT;
    for rate in RATES {
        let d = design(rate);
        let (mut current, mut omega) = (0.0, 0.0);
        let mut response = vec![];
        for _ in 0..3 {
            let steps = 20_000;
            let h = 1.0 / rate / f64::from(steps);
            for _ in 0..steps {
                let lag = TAU * device.amplifier_bandwidth.0;
                let middle = current + 0.5 * h * lag * (1.0 - current);
                let torque = device.large.torque_constant * middle;
                omega += h * (torque - device.damping * omega) / device.large.inertia;
                current += h * lag * (1.0 - middle);
            }
            response.push(omega);
        }
        // Step response of B / A.
        let mut y = [0.0; 4];
        for k in 1..4 {
            y[k] = d.b[1] + if k > 1 { d.b[2] } else { 0.0 }
                - d.a[1] * y[k - 1]
                - if k > 1 { d.a[2] * y[k - 2] } else { 0.0 };
        }
        for (y, simulated) in y[1..].iter().zip(&response) {
            assert!(
                (y / simulated - 1.0).abs() < 2e-3,
                "{rate}: {y} {simulated}"
            );
        }
    }
}

#[test]
fn closed_loop_has_the_requested_poles() {
    for rate in RATES {
        let d = design(rate);
        let closed: Vec<_> = product(&d.a, &d.s)
            .iter()
            .zip(product(&d.b, &d.r))
            .map(|(x, y)| x + y)
            .collect();
        for (closed, wanted) in closed.iter().zip(&d.p) {
            assert!((closed - wanted).abs() < 1e-12, "{rate}: {closed} {wanted}");
        }
        // A triple real pole at the regulation bandwidth.
        let pole = (-TAU * LoopPoles::DEFAULT.regulation.0 / rate).exp();
        let p = |z: f64| d.p.iter().rev().fold(0.0, |sum, c| sum / z + c);
        assert!(p(pole).abs() < 1e-12, "{rate}: {}", p(pole));
    }
}

#[test]
fn rates_and_bandwidths_are_accepted_at_the_limits_and_refused_beyond() {
    let with = |rate, poles| RstDesign::new(&DualStage::DEFAULT, Hertz(rate), poles).err();
    // Low enough for every rate; a loop that slow may miss its margins.
    let poles = LoopPoles {
        regulation: Hertz(2.0),
        tracking: Hertz(5.0),
        ..LoopPoles::DEFAULT
    };
    for rate in [99.9, 100_001.0, f64::NAN, f64::INFINITY, 0.0, -1e3] {
        assert_eq!(with(rate, poles), Some(DesignError::Rate), "{rate}");
    }
    assert_ne!(with(100.0, poles), Some(DesignError::Rate));
    assert_ne!(with(100e3, poles), Some(DesignError::Rate));
    let set = [
        |poles: &mut LoopPoles, value| poles.regulation = Hertz(value),
        |poles: &mut LoopPoles, value| poles.tracking = Hertz(value),
        |poles: &mut LoopPoles, value| poles.estimator_delay_s = value,
    ];
    for (i, set) in set.iter().enumerate() {
        let of = |value| {
            let mut poles = LoopPoles::DEFAULT;
            set(&mut poles, value);
            with(1e3, poles)
        };
        // A delay may be none, and is at most 0.1 s; a bandwidth is at most a tenth of the rate.
        let most = if i == 2 { 0.1 } else { 100.0 };
        for value in [-1e-9, f64::NAN, f64::INFINITY, 1.001 * most] {
            assert_eq!(of(value), Some(DesignError::Bandwidth), "{i} {value}");
        }
        let none = (i != 2).then_some(DesignError::Bandwidth);
        assert_eq!(of(0.0), none, "{i}");
        assert_ne!(of(most), Some(DesignError::Bandwidth), "{i}");
        assert_eq!(of([10.0, 10.0, 2e-3][i]), None, "{i}");
    }
}

#[test]
fn loop_below_the_least_modulus_margin_is_refused() {
    // Regulation up to where the margin ends: refused above it, within 1 % of it below.
    let modulus = |hz| {
        let poles = LoopPoles {
            regulation: Hertz(hz),
            ..LoopPoles::DEFAULT
        };
        RstDesign::new(&DualStage::DEFAULT, Hertz(1e3), poles).map(|design| design.margins.modulus)
    };
    let (mut low, mut high) = (12.0, 99.0);
    assert_eq!(modulus(high), Err(DesignError::Margins));
    while high - low > 1e-3 {
        let middle = 0.5 * (low + high);
        match modulus(middle) {
            Ok(_) => low = middle,
            Err(error) => {
                assert_eq!(error, DesignError::Margins);
                high = middle;
            }
        }
    }
    let last = modulus(low).unwrap();
    assert!(
        (LEAST_MODULUS..LEAST_MODULUS + 0.005).contains(&last),
        "{last}"
    );
    assert_eq!(LEAST_MODULUS, 0.5);
}

/// Light motors and strong couplers settle faster than the regulation, which must not slow them down.
#[test]
fn fast_motors_keep_their_pole_and_the_margins() {
    let default = RstDesign::new(&DualStage::DEFAULT, Hertz(1e3), LoopPoles::DEFAULT).unwrap();
    for rate in RATES {
        for (inertia, damping) in [
            (1.0, 1.7),
            (1.0, 1.9),
            (1.0, 4.0),
            (0.3, 1.0),
            (0.1, 1.0),
            (0.1, 10.0),
            (0.01, 1.0),
        ] {
            let mut device = DualStage::DEFAULT;
            device.large.inertia *= inertia;
            device.damping *= damping;
            let design = RstDesign::new(&device, Hertz(rate), LoopPoles::DEFAULT).unwrap();
            let p = (-TAU * LoopPoles::DEFAULT.regulation.0 / rate).exp();
            let own = (-device.damping / device.large.inertia / rate).exp();
            // 13.3 Hz of the default device are 1.11 times the regulation.
            let q = if 1.11 * damping / inertia > 2.0 {
                own
            } else {
                p
            };
            let electrical = design.electrical_pole;
            let wanted = product(
                &product(&[1.0, -p], &[1.0, -p]),
                &product(&[1.0, -q], &[1.0, -electrical]),
            );
            for (found, wanted) in design.p.iter().zip(wanted) {
                assert!((found - wanted).abs() < 1e-12, "{rate} {inertia} {damping}");
            }
            let modulus = design.margins.modulus;
            println!("{rate} Hz, J {inertia}, b {damping}: {modulus:.3}");
            assert!(
                modulus > default.margins.modulus - 0.01,
                "{rate} {inertia} {damping}: {modulus}"
            );
        }
    }
}

#[test]
fn devices_within_a_factor_of_ten_have_a_loop_and_every_scene() {
    let keys: [fn(&mut DualStage) -> &mut f64; 7] = [
        |device| &mut device.damping,
        |device| &mut device.large.inertia,
        |device| &mut device.large.torque_constant,
        |device| &mut device.large.current_limit,
        |device| &mut device.small.inertia,
        |device| &mut device.small.torque_constant,
        |device| &mut device.small.current_limit,
    ];
    for k in 0..3_usize.pow(keys.len() as u32) {
        let mut device = DualStage::DEFAULT;
        for (place, key) in keys.iter().enumerate() {
            *key(&mut device) *= [0.1, 1.0, 10.0][k / 3_usize.pow(place as u32) % 3];
        }
        for rate in [Hertz(1e3), Hertz(10e3)] {
            let rig = Rig::new(&device, rate, LoopPoles::DEFAULT);
            assert!(rig.is_ok(), "{rate:?}: {device:?}: {:?}", rig.err());
            for scene in SceneKind::ALL {
                let usual = scene.usual(&device, rate);
                assert!(
                    usual.is_ok(),
                    "{rate:?}: {device:?}: {scene}: {:?}",
                    usual.err()
                );
            }
        }
    }
}

/// The motor on its coupler is as slow as the amplifier: the quotient of their closed form is 0/0. The limit is that of
/// two equal lags, and the response is continuous around it.
#[test]
fn motor_as_fast_as_its_amplifier_has_the_response_of_two_equal_lags() {
    let rate = Hertz(10e3);
    let at = |relative: f64| {
        let mut device = DualStage::DEFAULT;
        device.large.inertia = device.amplifier_lag() * device.damping * (1.0 + relative);
        device
    };
    let equal = at(0.0);
    assert_eq!(
        equal.large.inertia / equal.damping,
        equal.amplifier_lag(),
        "to the last bit"
    );
    let x = rate.period_s() / equal.amplifier_lag();
    let limit = 1.0 - (-x).exp() * (1.0 + x);
    let gain = equal.large.torque_constant / equal.damping;
    for relative in [
        0.0, 1e-12, -1e-12, 1e-6, 0.99e-4, -0.99e-4, 1.01e-4, -1.01e-4,
    ] {
        let design = RstDesign::new(&at(relative), rate, LoopPoles::DEFAULT);
        let design = design.unwrap_or_else(|error| panic!("{relative}: {error}"));
        let response = design.b[1] / gain;
        // The response falls by less than its relative change of one of both time constants; the closed form keeps
        // eleven digits at 1e-4.
        let change = (response - limit).abs();
        assert!(
            change <= relative.abs() * limit + 1e-11,
            "{relative}: {change}"
        );
        assert!(Rig::new(&at(relative), rate, LoopPoles::DEFAULT).is_ok());
    }
    // Both sides of the limit of the series, one ten-millionth apart.
    let [series, closed] = [0.999_999e-4, 1.000_001e-4].map(|relative| {
        let design = RstDesign::new(&at(relative), rate, LoopPoles::DEFAULT);
        design.unwrap().b[1] / gain
    });
    assert!((series - closed).abs() < 1e-9, "{series} {closed}");
}

#[test]
fn impossible_designs_are_refused() {
    let late = LoopPoles {
        estimator_delay_s: 0.05,
        ..LoopPoles::DEFAULT
    };
    let design = RstDesign::new(&DualStage::DEFAULT, Hertz(1e3), late);
    assert_eq!(design.err(), Some(DesignError::Margins));
    let mut device = DualStage::DEFAULT;
    device.large.inertia = 0.0;
    let rig = Rig::new(&device, Hertz(1e3), LoopPoles::DEFAULT);
    assert_eq!(rig.err(), Some(DesignError::Device));
}

#[test]
fn messages_name_parameter_and_requirement() {
    for (error, words) in [
        (DesignError::Rate, "100 Hz to 100 kHz"),
        (DesignError::Device, "device constants"),
        (DesignError::Bandwidth, "a tenth of the control rate"),
        (DesignError::Singular, "no solution"),
        (DesignError::Margins, "misses its margins"),
        (DesignError::Scene, "scene parameter"),
        (DesignError::ExciteRate, "1 to 100 kHz"),
    ] {
        assert!(error.message().contains(words), "{error:?}");
        assert_eq!(error.to_string(), error.message());
    }
}
