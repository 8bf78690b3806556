//! Random draws of the constants of a scenario.

use rand_xoshiro::{Xoshiro256PlusPlus, rand_core::Rng};

/// A number uniform in `low..high`.
pub fn draw(random: &mut Xoshiro256PlusPlus, low: f64, high: f64) -> f64 {
    let unit = (random.next_u64() >> 11) as f64 * (0.5_f64).powi(53);
    low + (high - low) * unit
}

/// 1 or -1 with equal probability.
pub fn draw_sign(random: &mut Xoshiro256PlusPlus) -> f64 {
    if random.next_u64() >> 63 == 0 {
        1.0
    } else {
        -1.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand_xoshiro::rand_core::SeedableRng;

    #[test]
    fn draws_are_uniform_over_their_range() {
        let mut random = Xoshiro256PlusPlus::seed_from_u64(1);
        let draws: Vec<f64> = (0..10_000).map(|_| draw(&mut random, -2.0, 6.0)).collect();
        assert!(draws.iter().all(|x| (-2.0..6.0).contains(x)));
        let mean = draws.iter().sum::<f64>() / 10_000.0;
        assert!((mean - 2.0).abs() < 0.1, "{mean}");
        assert!(draws.iter().any(|&x| x < -1.98) && draws.iter().any(|&x| x > 5.98));
    }

    #[test]
    fn both_signs_are_as_frequent() {
        let mut random = Xoshiro256PlusPlus::seed_from_u64(1);
        let signs: Vec<f64> = (0..10_000).map(|_| draw_sign(&mut random)).collect();
        assert!(signs.iter().all(|sign| sign.abs() == 1.0));
        assert!(signs.iter().sum::<f64>().abs() < 300.0);
    }
}
