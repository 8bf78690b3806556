//! Scenario `permanent`: constant slip, the paper's figure 7.

use super::{clamped::Profile, draw, draw_sign};
use rand_xoshiro::Xoshiro256PlusPlus;

/// Levels between the smallest and the largest slip; each is held for 1 s.
const LEVELS: usize = 10;
/// Slope from one level to the next, rad/s^2.
const SLOPE: f64 = 400.0;

/// Ten levels in random order, one from each tenth of 2 to 20 rad/s. All ten have the same sign.
pub(super) struct Permanent {
    random: Xoshiro256PlusPlus,
    levels: [f64; LEVELS],
    second: usize,
    from: f64,
}

impl Permanent {
    pub(super) fn new(mut random: Xoshiro256PlusPlus) -> Self {
        let levels = levels(&mut random);
        Self {
            random,
            levels,
            second: 0,
            from: 0.0,
        }
    }
}

fn levels(random: &mut Xoshiro256PlusPlus) -> [f64; LEVELS] {
    let sign = draw_sign(random);
    let mut levels = [0.0; LEVELS];
    for (k, level) in levels.iter_mut().enumerate() {
        let part = (k as f64 + draw(random, 0.0, 1.0)) / LEVELS as f64;
        *level = sign * (2.0 + 18.0 * part);
    }
    for k in (1..LEVELS).rev() {
        levels.swap(k, draw(random, 0.0, (k + 1) as f64) as usize);
    }
    levels
}

impl Profile for Permanent {
    fn slip(&mut self, t: f64) -> f64 {
        while t >= (self.second + 1) as f64 {
            self.from = self.levels[self.second % LEVELS];
            self.second += 1;
            if self.second.is_multiple_of(LEVELS) {
                self.levels = levels(&mut self.random);
            }
        }
        let to = self.levels[self.second % LEVELS];
        let reach = SLOPE * (t - self.second as f64);
        self.from + (to - self.from).clamp(-reach, reach)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand_xoshiro::rand_core::SeedableRng;

    #[test]
    fn levels_last_a_second_and_ten_cover_the_range() {
        let mut profile = Permanent::new(Xoshiro256PlusPlus::seed_from_u64(4));
        let mut seen = Vec::new();
        for second in 0..10 {
            let early = profile.slip(f64::from(second) + 0.15);
            let late = profile.slip(f64::from(second) + 0.999);
            assert_eq!(early, late);
            seen.push(late.abs());
        }
        assert!(!seen.is_sorted(), "{seen:?}");
        seen.sort_by(f64::total_cmp);
        for (k, level) in seen.iter().enumerate() {
            let low = 2.0 + 1.8 * k as f64;
            assert!((low..=low + 1.8).contains(level), "{seen:?}");
        }
    }
}
