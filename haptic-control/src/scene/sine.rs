/// `sin(π x)` for -1 <= x <= 1 by two parabolas, with an error of at most 0.0011. It needs no
/// library, so its bits are the same on every machine.
pub(crate) fn sine(x: f32) -> f32 {
    let magnitude = if x < 0.0 { -x } else { x };
    let parabola = 4.0 * x * (1.0 - magnitude);
    let size = if parabola < 0.0 { -parabola } else { parabola };
    parabola * (0.775 + 0.225 * size)
}

#[cfg(test)]
mod tests {
    extern crate std;

    #[test]
    fn sine_is_within_its_bound() {
        for i in -1000..=1000_i16 {
            let x = f32::from(i) / 1000.0;
            let error = super::sine(x) - (core::f32::consts::PI * x).sin();
            assert!(error.abs() < 0.0011, "{x}: {error}");
        }
    }
}
