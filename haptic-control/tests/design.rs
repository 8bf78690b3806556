//! The velocity loop: its polynomials, its margins, and what it does to the plant it is for.

use std::f64::consts::TAU;

use estimator_core::Hertz;
use haptic_control::{DesignError, DualStage, LoopPoles, RadPerS, Rig, Rst, RstDesign};

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

/// The plant in f64, with the controller as it runs, in f32.
struct Bench {
    design: RstDesign,
    rst: Rst,
    state: haptic_control::RstState,
    omega: [f64; 2],
    current: [f64; 2],
}

impl Bench {
    fn new(rate: f64) -> Self {
        let design = design(rate);
        let rst = Rst::new(&design);
        Self {
            design,
            rst,
            state: rst.start(RadPerS(0.0)),
            omega: [0.0; 2],
            current: [0.0; 2],
        }
    }

    /// One tick; the current is limited, and `disturbance` amperes act beside it.
    fn tick(&mut self, wanted: f64, limit: f64, disturbance: f64) -> f64 {
        let Self {
            design: d,
            omega,
            current,
            ..
        } = self;
        let now =
            -d.a[1] * omega[0] - d.a[2] * omega[1] + d.b[1] * current[0] + d.b[2] * current[1];
        *omega = [now, omega[0]];
        let asked = self
            .rst
            .update(&mut self.state, RadPerS(wanted as f32), RadPerS(now as f32));
        let applied = f64::from(asked).clamp(-limit, limit);
        if applied != f64::from(asked) {
            self.state.limited(applied as f32);
        }
        *current = [applied + disturbance, current[0]];
        now
    }
}

#[test]
fn a_wanted_velocity_is_followed_as_the_tracking_filter_says() {
    for rate in RATES {
        let mut bench = Bench::new(rate);
        let gain = 1.0 - bench.design.tracking_pole;
        let (mut lag, mut filtered, mut before) = (0.0, 0.0, 0.0);
        let mut worst = 0.0_f64;
        for _ in 0..(0.5 * rate) as usize {
            let omega = bench.tick(10.0, 1e9, 0.0);
            let [b1, b2] = [bench.design.b[1], bench.design.b[2]];
            worst = worst.max((omega - (b1 * filtered + b2 * before) / (b1 + b2)).abs());
            lag += gain * (10.0 - lag);
            before = filtered;
            filtered += gain * (lag - filtered);
        }
        // 10 rad/s to four digits, at every rate: f32 loses nothing that matters.
        assert!(worst < 1e-3, "{rate}: {worst}");
    }
}

#[test]
fn a_constant_disturbance_is_given_up_in_a_tenth_of_a_second() {
    for rate in RATES {
        let mut bench = Bench::new(rate);
        let mut largest = 0.0_f64;
        let mut omega = 0.0;
        for _ in 0..(0.1 * rate) as usize {
            // Coulomb friction of 4 mN.m is 85 mA.
            omega = bench.tick(0.0, 1e9, 0.085);
            largest = largest.max(omega);
        }
        assert!((0.5..4.2).contains(&largest), "{rate}: {largest}");
        assert!(omega.abs() < 0.12 * largest, "{rate}: {omega} of {largest}");
        for _ in 0..rate as usize {
            omega = bench.tick(0.0, 1e9, 0.085);
        }
        assert!(omega.abs() < 1e-3, "{rate}: {omega}");
    }
}

#[test]
fn saturation_does_not_wind_the_integrator_up() {
    for rate in RATES {
        let mut bench = Bench::new(rate);
        // 100 rad/s would take 2.05 A: with 1 A it cannot be reached.
        for _ in 0..(2.0 * rate) as usize {
            bench.tick(100.0, 1.0, 0.0);
        }
        let back = (0..(0.3 * rate) as usize).map(|_| bench.tick(0.0, 1.0, 0.0));
        let least = back.fold(0.0_f64, f64::min);
        // A wound-up integrator would hold the speed for as long as it had been asked for.
        assert!(bench.omega[0].abs() < 1.0, "{rate}: {}", bench.omega[0]);
        assert!(least > -15.0, "{rate}: {least}");
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
    let docs = include_str!("../../docs/theory.md");
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
