//! Stability margins of a sampled loop, from its open loop's frequency response.

use crate::numeric::cos_sin;

/// Margins of the loop `L = B R / (A S)`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Margins {
    /// Modulus margin: least distance of the open loop from -1, which is the inverse of the
    /// largest sensitivity; 1 at most.
    pub modulus: f64,
    /// Gain margin: the factor by which the gain may rise where the phase crosses -180°; infinite
    /// if it never does.
    pub gain: f64,
    /// Phase margin at the crossover of gain 1, as the cosine of the angle to -180°.
    pub cos_phase: f64,
    /// Crossover of gain 1, Hz; the highest if there are several.
    pub crossover_hz: f64,
    /// Delay margin: additional delay that reduces the phase margin to zero, s.
    pub delay_s: f64,
}

impl Margins {
    /// Phase margin, degrees.
    #[must_use]
    pub fn phase_deg(&self) -> f64 {
        self.delay_s * self.crossover_hz * 360.0
    }
}

/// Frequencies from the Nyquist frequency down, [`PER_HALVING`] to a halving.
const HALVINGS: usize = 14;
const PER_HALVING: usize = 16;

/// Margins of the loop with an additional delay of `delay_s`.
///
/// The open loop is evaluated from the Nyquist frequency down through 14 octaves, 16 points each;
/// below, integral action makes it large. Crossings are interpolated linearly.
pub(crate) const fn margins(
    a: &[f64; 3],
    b: &[f64; 3],
    r: &[f64; 3],
    s: &[f64; 3],
    period_s: f64,
    delay_s: f64,
) -> Margins {
    let mut margins = Margins {
        modulus: 1.0,
        gain: f64::INFINITY,
        cos_phase: 1.0,
        crossover_hz: 0.0,
        delay_s: f64::INFINITY,
    };
    let mut octave = 0;
    let mut top = core::f64::consts::PI;
    let mut above = Complex { re: 0.0, im: 0.0 };
    while octave < HALVINGS {
        let mut i = 0;
        while i < PER_HALVING {
            // Steps of constant size within an octave need no root.
            let angle = top * (1.0 - 0.5 * i as f64 / PER_HALVING as f64);
            let open = open_loop(a, b, r, s, angle, delay_s / period_s);
            let distance = Complex {
                re: open.re + 1.0,
                im: open.im,
            }
            .modulus();
            if !(distance >= margins.modulus) {
                margins.modulus = distance;
            }
            if above.im * open.im < 0.0 && open.re < 0.0 {
                let part = above.im / (above.im - open.im);
                let crossing = above.re + part * (open.re - above.re);
                if crossing < 0.0 && -1.0 / crossing < margins.gain {
                    margins.gain = -1.0 / crossing;
                }
            }
            if margins.crossover_hz == 0.0 && open.modulus() >= 1.0 {
                margins.crossover_hz = angle / (2.0 * core::f64::consts::PI * period_s);
                margins.cos_phase = -open.re / open.modulus();
                margins.delay_s = angle_to_negative_axis(open) / angle * period_s;
            }
            above = open;
            i += 1;
        }
        octave += 1;
        top /= 2.0;
    }
    margins
}

#[derive(Clone, Copy)]
struct Complex {
    re: f64,
    im: f64,
}

impl Complex {
    const fn times(self, other: Self) -> Self {
        Self {
            re: self.re * other.re - self.im * other.im,
            im: self.re * other.im + self.im * other.re,
        }
    }

    const fn over(self, other: Self) -> Self {
        let square = other.re * other.re + other.im * other.im;
        let conjugate = Self {
            re: other.re,
            im: -other.im,
        };
        let product = self.times(conjugate);
        Self {
            re: product.re / square,
            im: product.im / square,
        }
    }

    /// Square root by Newton's method. Zero and NaN are returned unchanged.
    const fn modulus(self) -> f64 {
        let square = self.re * self.re + self.im * self.im;
        if !(square > 0.0 && square < f64::INFINITY) {
            return square;
        }
        let mut root = if square > 1.0 { square } else { 1.0 };
        let mut i = 0;
        while i < 600 {
            let next = 0.5 * (root + square / root);
            if next >= root {
                return root;
            }
            root = next;
            i += 1;
        }
        root
    }
}

/// `B R / (A S)` at `z = e^(j angle)`, with an additional delay in periods.
const fn open_loop(
    a: &[f64; 3],
    b: &[f64; 3],
    r: &[f64; 3],
    s: &[f64; 3],
    angle: f64,
    delay: f64,
) -> Complex {
    let (cos, sin) = cos_sin(angle);
    let z = Complex { re: cos, im: -sin };
    let open = at(b, z).times(at(r, z)).over(at(a, z).times(at(s, z)));
    open.times(turned(angle * delay))
}

/// A polynomial in z⁻¹ at `z⁻¹ = x`.
const fn at(c: &[f64; 3], x: Complex) -> Complex {
    let last = Complex { re: c[2], im: 0.0 }.times(x);
    let rest = Complex {
        re: last.re + c[1],
        im: last.im,
    }
    .times(x);
    Complex {
        re: rest.re + c[0],
        im: rest.im,
    }
}

/// `e^(-j angle)` for any angle >= 0.
const fn turned(angle: f64) -> Complex {
    let turn = 2.0 * core::f64::consts::PI;
    let mut rest = angle - turn * (angle / turn) as u64 as f64;
    let mut sign = -1.0;
    if rest > core::f64::consts::PI {
        rest = turn - rest;
        sign = 1.0;
    }
    let (cos, sin) = cos_sin(rest);
    Complex {
        re: cos,
        im: sign * sin,
    }
}

/// Angle by which a point may still turn clockwise to the negative axis, rad, 0 to 2π.
const fn angle_to_negative_axis(point: Complex) -> f64 {
    // Bisect for the angle whose direction is that of -point, clockwise being positive.
    let modulus = point.modulus();
    let cos = -point.re / modulus;
    let (mut low, mut high) = (0.0, core::f64::consts::PI);
    let mut i = 0;
    while i < 50 {
        let middle = 0.5 * (low + high);
        if cos_sin(middle).0 > cos {
            low = middle;
        } else {
            high = middle;
        }
        i += 1;
    }
    // Below the axis the angle is less than π, above it more.
    if point.im <= 0.0 {
        low
    } else {
        2.0 * core::f64::consts::PI - low
    }
}

#[cfg(test)]
mod tests;
