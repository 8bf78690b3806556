//! The design of the velocity loop: its polynomials and its margins.

use std::f64::consts::TAU;

use estimator_core::Hertz;
use haptic_control::{DesignError, DualStage, LoopPoles, Rig, RstDesign};

const RATES: [f64; 5] = [800.0, 1e3, 10e3, 11.6e3, 20e3];

fn design(rate: f64) -> RstDesign {
    RstDesign::new(&DualStage::DEFAULT, Hertz(rate), LoopPoles::DEFAULT).unwrap()
}

fn product(x: &[f64], y: &[f64]) -> Vec<f64> {
    let mut z = vec![0.0; x.len() + y.len() - 1];
    for (i, x) in x.iter().enumerate() {
        for (j, y) in y.iter().enumerate() {
            z[i + j] += x * y;
        }
    }
    z
}

/// `(re, im)` of a polynomial in z⁻¹ at an angle.
fn at(c: &[f64], angle: f64) -> (f64, f64) {
    let term = |(k, c): (usize, &f64)| {
        let (sin, cos) = (-(k as f64) * angle).sin_cos();
        (c * cos, c * sin)
    };
    c.iter()
        .enumerate()
        .map(term)
        .fold((0.0, 0.0), |a, b| (a.0 + b.0, a.1 + b.1))
}

#[test]
fn the_plant_is_the_motor_behind_its_amplifier() {
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
                let lag = TAU * device.amplifier.0;
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
fn the_closed_loop_has_the_poles_it_was_given() {
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
fn margins_are_those_of_the_frequency_response() {
    for rate in RATES {
        let d = design(rate);
        let delay = LoopPoles::DEFAULT.estimator_delay_s * rate;
        let (num, den) = (product(&d.b, &d.r), product(&d.a, &d.s));
        // On a fine logarithmic grid, from the Nyquist frequency down.
        let open = |angle: f64| {
            let ((a, b), (c, e)) = (at(&num, angle), at(&den, angle));
            let square = c * c + e * e;
            let (re, im) = ((a * c + b * e) / square, (b * c - a * e) / square);
            let (sin, cos) = (-angle * delay).sin_cos();
            (re * cos - im * sin, re * sin + im * cos)
        };
        let angles = (0..200_000).map(|i| std::f64::consts::PI * (-f64::from(i) * 5e-5).exp());
        let (mut modulus, mut crossover, mut phase) = (1.0_f64, None, 0.0);
        for angle in angles {
            let (re, im) = open(angle);
            modulus = modulus.min((re + 1.0).hypot(im));
            if crossover.is_none() && re.hypot(im) >= 1.0 {
                crossover = Some(angle * rate / TAU);
                phase = 180.0 + im.atan2(re).to_degrees();
            }
        }
        let crossover = crossover.unwrap();
        let margins = &d.margins;
        assert!(
            (margins.modulus - modulus).abs() < 0.01,
            "{rate}: {margins:?} {modulus}"
        );
        // The design's grid has sixteen points to an octave.
        assert!(
            (margins.crossover_hz / crossover - 1.0).abs() < 0.05,
            "{rate}: {crossover}"
        );
        assert!((margins.phase_deg() - phase).abs() < 3.0, "{rate}: {phase}");
        assert!(
            (margins.delay_s / (phase / 360.0 / crossover) - 1.0).abs() < 0.06,
            "{rate}"
        );
        assert!(margins.modulus > 0.75 && margins.phase_deg() > 60.0 && margins.gain > 6.0);
    }
}

#[test]
fn what_cannot_work_is_refused() {
    let with = |rate, poles| RstDesign::new(&DualStage::DEFAULT, Hertz(rate), poles).err();
    let poles = LoopPoles::DEFAULT;
    assert_eq!(with(50.0, poles), Some(DesignError::Rate));
    assert_eq!(with(f64::NAN, poles), Some(DesignError::Rate));
    let fast = LoopPoles {
        regulation: Hertz(99.0),
        ..poles
    };
    assert_eq!(with(1e3, fast), Some(DesignError::Margins));
    let faster = LoopPoles {
        regulation: Hertz(101.0),
        ..poles
    };
    assert_eq!(with(1e3, faster), Some(DesignError::Bandwidth));
    let late = LoopPoles {
        estimator_delay_s: 0.05,
        ..poles
    };
    assert_eq!(with(1e3, late), Some(DesignError::Margins));
    let mut device = DualStage::DEFAULT;
    device.large.inertia = 0.0;
    assert_eq!(
        Rig::new(&device, Hertz(1e3), poles).err(),
        Some(DesignError::Device)
    );
}

#[test]
fn the_table_in_the_docs_is_so() {
    let docs = include_str!("../../../docs/theory.md");
    let rows: Vec<Vec<f64>> = docs
        .lines()
        .skip_while(|line| !line.starts_with("| rate, kHz |"))
        .skip(2)
        .take_while(|line| line.starts_with('|'))
        .map(|line| {
            line.trim_matches('|')
                .split('|')
                .map(|c| c.trim().parse().unwrap())
                .collect()
        })
        .collect();
    assert_eq!(rows.len(), 4);
    for row in rows {
        let m = design(1e3 * row[0]).margins;
        let computed = [
            m.modulus,
            m.gain,
            m.phase_deg(),
            1e3 * m.delay_s,
            m.crossover_hz,
        ];
        for (written, computed) in row[1..].iter().zip(computed) {
            assert!(
                (written / computed - 1.0).abs() < 0.02,
                "{row:?}: {computed}"
            );
        }
    }
}
