//! Longest settling time of an estimator after any motion, derived from its design.

use estimator_core::{CountObserver, CoupledMotor};

/// Largest correction of an observer, counts.
const LARGEST_INNOVATION: f64 = 65_536.0;

/// Largest velocity of random 32-bit counts, counts per tick.
const FASTEST: f64 = (1u64 << 31) as f64;

/// Ticks until [`FASTEST`] has decayed below `quiet`, counts per tick, with `order` poles within
/// `radius` of zero: the least k with `(1 + x)^(order - 1) exp(-x) FASTEST < quiet`,
/// `x = -k ln(radius)`, which is the slowest possible decay.
pub(crate) fn poles(radius: f64, order: i32, quiet: f64) -> u32 {
    let rate = -radius.ln();
    let left = |ticks: u32| {
        let x = f64::from(ticks) * rate;
        (1.0 + x).powi(order - 1) * (-x).exp() * FASTEST
    };
    // The function rises at first and falls from `x = order - 2` on.
    let mut ticks = (f64::from(order) / rate) as u32;
    while left(ticks) >= quiet {
        ticks += 1;
    }
    ticks
}

/// Radius of one pole of this frequency.
pub(crate) fn pole(cutoff_hz: f64, rate_hz: f64) -> f64 {
    (-std::f64::consts::TAU * cutoff_hz / rate_hz).exp()
}

/// Spectral radius of `(I - K H) A`, the error's transition of a filter with transition `a` and gain
/// `k` of the position: the growth of the norm of its powers per tick.
pub(crate) fn radius<const S: usize>(a: &[[f64; S]; S], k: &[f32; S]) -> f64 {
    let mut m = *a;
    for (row, k) in m.iter_mut().zip(k) {
        for (element, first) in row.iter_mut().zip(a[0]) {
            *element -= f64::from(*k) * first;
        }
    }
    // The logarithm of the norm of M^(2^i) by repeated squaring, scaled to stay in range.
    let (mut logarithm, mut power) = (0.0, 1.0);
    for _ in 0..30 {
        let norm = m.iter().flatten().fold(0.0f64, |norm, x| norm.max(x.abs()));
        logarithm += norm.ln() / power;
        m = m.map(|row| row.map(|x| x / norm));
        let mut square = [[0.0; S]; S];
        for (into, row) in square.iter_mut().zip(&m) {
            for (x, other) in row.iter().zip(&m) {
                for (sum, y) in into.iter_mut().zip(other) {
                    *sum += x * y;
                }
            }
        }
        m = square;
        power *= 2.0;
    }
    f64::exp(logarithm)
}

/// Largest gain of the disturbance torque in the table.
pub(crate) fn largest_gain(observer: &CountObserver) -> f64 {
    let gains = (1..=64).map(|ticks| f64::from(observer.gain(ticks).disturbance));
    gains.fold(0.0, f64::max)
}

/// Largest gain of the disturbance torque with the truncated-Gaussian update: the gain of the velocity
/// is at most 3/2, and the ratio of both is fixed.
pub(crate) fn largest_soft_gain(observer: &CountObserver) -> f64 {
    let every_tick = observer.gain(1);
    1.5 * f64::from(every_tick.disturbance / every_tick.velocity)
}

/// Ticks until the disturbance torque after the largest correction with the largest `gain` has decayed
/// below half of the design's friction. The other half can be compensated by the friction correction.
pub(crate) fn unknown_torque(gain: f64, load_time: f64, rate_hz: f64) -> u32 {
    let CoupledMotor {
        motor,
        coulomb_friction,
        ..
    } = CoupledMotor::DCX35L;
    let per_torque = f64::from(motor.counts_per_rev)
        / (std::f64::consts::TAU * rate_hz * rate_hz * motor.inertia);
    let holds = 0.5 * per_torque * coulomb_friction;
    let left = gain * LARGEST_INNOVATION;
    (load_time * rate_hz * (left / holds).ln()).ceil() as u32
}

/// Ticks until the disturbance torque after the largest correction with the largest `gain` moves the
/// rotor by less than a count per its correlation time. Without friction, the quantisation interval
/// then keeps the rotor at rest.
pub(crate) fn unknown_torque_alone(gain: f64, load_time: f64, rate_hz: f64) -> u32 {
    let time = load_time * rate_hz;
    (time * (gain * LARGEST_INNOVATION * time * time).ln()).ceil() as u32
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_pole_decays_by_its_radius() {
        // After 31 ticks 1 of 2^31 is left, after 32 a half.
        assert_eq!(poles(0.5, 1, 0.9), 32);
        assert!(poles(0.5, 2, 0.9) > 32);
    }

    #[test]
    fn radius_is_that_of_the_slowest_pole() {
        // The tracking loop of docs/theory/pll.md: both poles at p.
        let p = 0.7f64;
        let k = [(1.0 - p * p) as f32, ((1.0 - p) * (1.0 - p)) as f32];
        let found = radius(&[[1.0, 1.0], [0.0, 1.0]], &k);
        assert!((found - p).abs() < 1e-3, "{found}");
    }
}
