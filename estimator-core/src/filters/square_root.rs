//! The square root in f32, by additions, multiplications and divisions.

/// `sqrt(x)` for x from 2^-64 to 2^64, to 2^-23 of the root; 0 below 2^-64, and for NaN.
///
/// The number of bits of the integer part gives the root to within a fifth. Each of the three steps
/// of Newton's iteration squares that error and halves it: the last one leaves 3e-8.
#[inline]
pub(super) const fn square_root(x: f32) -> f32 {
    const UP: f32 = 4_294_967_296.0;
    // The root of x 4^k is 2^k times that of x: k brings x to 1 or more, below 2^32.
    let (scaled, back) = if x >= UP {
        (x * (1.0 / UP), 65_536.0)
    } else if x >= 1.0 {
        (x, 1.0)
    } else if x >= 1.0 / UP {
        (x * UP, 1.0 / 65_536.0)
    } else {
        (x * UP * UP, 1.0 / UP)
    };
    let bits = 32 - (scaled as u32).leading_zeros();
    if bits == 0 {
        return 0.0;
    }
    // The root lies between 2^((bits - 1)/2) and 2^(bits/2). The middle of this range:
    let middle = if bits % 2 == 0 {
        0.840_896_4
    } else {
        1.189_207_1
    };
    let mut root = (1u32 << (bits / 2)) as f32 * middle;
    root = 0.5 * (root + scaled / root);
    root = 0.5 * (root + scaled / root);
    root = 0.5 * (root + scaled / root);
    root * back
}

#[cfg(test)]
mod tests {
    use super::square_root;

    fn assert_close(x: f32) {
        let exact = f64::from(x).sqrt();
        let error = (f64::from(square_root(x)) / exact - 1.0).abs();
        assert!(error <= 2f64.powi(-23), "{x:e}: {error:e}");
    }

    /// All floats of two octaves, which contain every mantissa and both parities of the exponent.
    #[test]
    fn root_is_that_of_f64_over_two_octaves() {
        for bits in 1f32.to_bits()..4f32.to_bits() {
            assert_close(f32::from_bits(bits));
        }
    }

    /// A step in the mantissa that is prime visits every octave at different places.
    #[test]
    fn root_is_that_of_f64_over_the_whole_range() {
        let (first, last) = (2f32.powi(-64).to_bits(), 2f32.powi(64).to_bits());
        for bits in (first..last).step_by(997) {
            assert_close(f32::from_bits(bits));
        }
        for exponent in -64..64 {
            let power = 2f32.powi(exponent);
            assert_close(power);
            assert_close(power.next_up());
            assert_close((2.0 * power).next_down());
        }
    }

    #[test]
    fn root_of_zero_and_below_the_range_is_zero() {
        for x in [0.0, -0.0, -1.0, f32::NAN, 2f32.powi(-64).next_down()] {
            assert_eq!(square_root(x), 0.0, "{x:e}");
        }
    }
}
