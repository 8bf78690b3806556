//! Margins of the velocity loop against its frequency response.

use std::f64::consts::TAU;

use estimator_core::Hertz;
use haptic_control::{DesignError, DualStage, LoopPoles, RstDesign};

use crate::design::{RATES, design, product};

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

/// `B R / (A S)` of a design at an angle, behind a delay of so many periods.
fn open_loop(d: &RstDesign, delay: f64, angle: f64) -> (f64, f64) {
    let ((a, b), (c, e)) = (
        at(&product(&d.b, &d.r), angle),
        at(&product(&d.a, &d.s), angle),
    );
    let square = c * c + e * e;
    let (re, im) = ((a * c + b * e) / square, (b * c - a * e) / square);
    let (sin, cos) = (-angle * delay).sin_cos();
    (re * cos - im * sin, re * sin + im * cos)
}

#[test]
fn margins_agree_with_the_frequency_response() {
    let mut heavy = DualStage::DEFAULT;
    heavy.large.inertia *= 4.0;
    heavy.damping *= 0.5;
    let mut slow = DualStage::DEFAULT;
    slow.amplifier_bandwidth = Hertz(60.0);
    for device in [DualStage::DEFAULT, heavy, slow] {
        for rate in RATES {
            for (regulation, delay_s) in [(12.0, 1e-3), (12.0, 0.0), (20.0, 4e-3), (40.0, 2e-4)] {
                let poles = LoopPoles {
                    regulation: Hertz(regulation),
                    estimator_delay_s: delay_s,
                    ..LoopPoles::DEFAULT
                };
                match RstDesign::new(&device, Hertz(rate), poles) {
                    Ok(design) => compare_margins(&design, rate, delay_s),
                    // The slow amplifier bears no fast regulation.
                    Err(error) => {
                        assert!(error == DesignError::Margins && device != DualStage::DEFAULT);
                    }
                }
            }
        }
    }
    for rate in RATES {
        let margins = design(rate).margins;
        assert!(margins.modulus > 0.75 && margins.phase_deg() > 60.0 && margins.gain > 6.0);
    }
}

/// Holds a design's margins against its response on a fine logarithmic grid, from the Nyquist
/// frequency down.
fn compare_margins(d: &RstDesign, rate: f64, delay_s: f64) {
    let margins = &d.margins;
    let angles = (0..20_000).map(|i| std::f64::consts::PI * (-f64::from(i) * 5e-4).exp());
    let (mut modulus, mut gain) = (1.0_f64, f64::INFINITY);
    let (mut crossover, mut phase) = (None, 0.0);
    let mut above = (0.0, 0.0);
    for angle in angles {
        let (re, im) = open_loop(d, delay_s * rate, angle);
        modulus = modulus.min((re + 1.0).hypot(im));
        if im * above.1 < 0.0 && re < 0.0 {
            gain = gain.min(-1.0 / re);
        }
        if crossover.is_none() && re.hypot(im) >= 1.0 {
            crossover = Some(angle * rate / TAU);
            phase = (180.0 + im.atan2(re).to_degrees()).rem_euclid(360.0);
        }
        above = (re, im);
    }
    let crossover = crossover.unwrap();
    let close = |value: f64, wanted: f64, part: f64| (value / wanted - 1.0).abs() < part;
    let told = format!("{rate}, {delay_s}: {margins:?}; {modulus} {gain} {crossover} {phase}");
    // The design's grid has sixteen points to an octave.
    assert!((margins.modulus - modulus).abs() < 0.005, "{told}");
    assert!(
        margins.gain == gain || close(margins.gain, gain, 0.01),
        "{told}"
    );
    assert!(close(margins.crossover_hz, crossover, 0.05), "{told}");
    let (re, im) = open_loop(d, delay_s * rate, margins.crossover_hz * TAU / rate);
    let phase_there = (180.0 + im.atan2(re).to_degrees()).rem_euclid(360.0);
    assert!((phase_there - phase).abs() < 4.0, "{told}");
    assert!(
        (margins.phase_deg() - phase_there).abs() < 0.01,
        "{told} {phase_there}"
    );
    let cos_phase = phase_there.to_radians().cos();
    assert!((margins.cos_phase - cos_phase).abs() < 1e-6, "{told}");
    let delay = phase_there / 360.0 / margins.crossover_hz;
    assert!(close(margins.delay_s, delay, 1e-4), "{told} {delay}");
}
