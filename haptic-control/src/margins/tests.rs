//! Margins against their definition, for loops of any shape.

use super::{Complex, angle_to_negative_axis, margins, turned};
use core::f64::consts::{PI, TAU};
extern crate std;
use std::vec::Vec;

/// `B R / (A S)` at `z⁻¹ = e^(-j angle)`, by sums of cosines and sines.
fn open_loop(polynomials: &[[f64; 3]; 4], angle: f64, delay: f64) -> (f64, f64) {
    let at = |c: &[f64; 3]| {
        let sum = |f: fn(f64) -> f64| (0..3).map(|k| c[k] * f(k as f64 * angle)).sum::<f64>();
        (sum(f64::cos), -sum(f64::sin))
    };
    let [a, b, r, s] = [0, 1, 2, 3].map(|i| {
        let (re, im): (f64, f64) = at(&polynomials[i]);
        (re.hypot(im), im.atan2(re))
    });
    let (size, phase) = (
        b.0 * r.0 / (a.0 * s.0),
        b.1 + r.1 - a.1 - s.1 - angle * delay,
    );
    (size * phase.cos(), size * phase.sin())
}

/// Compares the margins with their definition on the same grid of frequencies, for stable and
/// unstable loops.
#[test]
fn margins_agree_with_their_definition_on_a_grid() {
    let mut seed = 1_u32;
    let mut draw = |low: f64, high: f64| {
        seed = seed.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        low + (high - low) * f64::from(seed >> 8) / f64::from(1 << 24)
    };
    let (mut never, mut several) = (0, 0);
    for _ in 0..300 {
        let mut pair = |largest: f64, gain: f64| {
            let (size, angle) = (draw(0.2, largest), draw(0.0, 3.0));
            [gain, -2.0 * gain * size * angle.cos(), gain * size * size]
        };
        let polynomials = [
            pair(0.9, 1.0),
            pair(1.2, 0.3),
            pair(1.2, 1.0),
            pair(0.9, 1.0),
        ];
        let (period_s, delay) = (draw(1e-4, 1e-3), draw(0.0, 9.0));
        let [a, b, r, s] = &polynomials;
        let found = margins(a, b, r, s, period_s, delay * period_s);

        let grid: Vec<(f64, (f64, f64))> = (0..14 * 16)
            .map(|n| {
                let angle = PI / f64::from(1 << (n / 16)) * (1.0 - f64::from(n % 16) / 32.0);
                (angle, open_loop(&polynomials, angle, delay))
            })
            .collect();
        let near = |value: f64, wanted: f64| (value - wanted).abs() < 1e-7 * (1.0 + wanted.abs());
        let distances = grid.iter().map(|(_, (re, im))| (re + 1.0).hypot(*im));
        assert!(
            near(found.modulus, distances.fold(1.0, f64::min)),
            "{found:?}"
        );

        let crossings: Vec<f64> = grid
            .windows(2)
            .filter(|pair| pair[0].1.1 * pair[1].1.1 < 0.0 && pair[1].1.0 < 0.0)
            .map(|pair| {
                let ((re, im), (next, below)) = (pair[0].1, pair[1].1);
                re + im / (im - below) * (next - re)
            })
            .filter(|crossing| *crossing < 0.0)
            .collect();
        let gain = crossings
            .iter()
            .map(|re| -1.0 / re)
            .fold(f64::INFINITY, f64::min);
        // At the Nyquist frequency rounding decides whether there is a crossing.
        assert!(
            found.gain == gain || near(found.gain, gain),
            "{found:?} {gain}"
        );
        several +=
            usize::from(crossings.len() > 1 && gain != -1.0 / crossings[crossings.len() - 1]);

        let Some((angle, (re, im))) = grid.iter().find(|(_, (re, im))| re.hypot(*im) >= 1.0) else {
            assert_eq!((found.crossover_hz, found.cos_phase), (0.0, 1.0));
            assert_eq!(found.delay_s, f64::INFINITY);
            never += 1;
            continue;
        };
        let phase = (PI + im.atan2(*re)).rem_euclid(TAU);
        assert!(
            near(found.crossover_hz, angle / TAU / period_s),
            "{found:?}"
        );
        assert!(near(found.cos_phase, phase.cos()), "{found:?} {phase}");
        assert!(
            near(found.delay_s, phase / angle * period_s),
            "{found:?} {phase}"
        );
        assert!(near(found.phase_deg(), phase.to_degrees()), "{found:?}");
    }
    // The random loops include stable and unstable ones, with and without crossings.
    assert!(
        never > 20 && never < 280 && several > 20,
        "{never} {several}"
    );
}

#[test]
fn complex_numbers_agree_with_the_standard_library() {
    for size in [1e-9, 0.3, 1.0, 7.0, 1e9] {
        for k in 0..64 {
            let angle = TAU * f64::from(k) / 64.0 + 0.01;
            let z = Complex {
                re: size * angle.cos(),
                im: size * angle.sin(),
            };
            assert!((z.modulus() / size - 1.0).abs() < 1e-14, "{size} {k}");
            let left = angle_to_negative_axis(z);
            assert!(
                (left - (angle + PI).rem_euclid(TAU)).abs() < 1e-7,
                "{size} {k}"
            );
            let e = turned(size * angle);
            let whole = (size * angle).rem_euclid(TAU);
            if size < 1e3 {
                assert!((e.re - whole.cos()).abs() < 1e-12, "{size} {k}");
                assert!((e.im + whole.sin()).abs() < 1e-12, "{size} {k}");
            }
        }
    }
    let of = |re: f64| Complex { re, im: 0.0 }.modulus();
    assert_eq!(of(0.0), 0.0);
    assert!(of(f64::NAN).is_nan());
    assert_eq!(of(f64::INFINITY), f64::INFINITY);
}
