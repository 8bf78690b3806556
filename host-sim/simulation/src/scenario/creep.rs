//! Scenario `creep`: slip of 0.05 rad/s in both directions.

use super::{clamped::Profile, draw, draw_sign, servo::Tuning};
use rand_xoshiro::Xoshiro256PlusPlus;

/// Slip, rad/s.
const OMEGA: f64 = 0.05;
/// Duration of a reversal, s.
const TURN_S: f64 = 0.05;

/// Trapezoids of the slip velocity. Each direction lasts 0.8 to 1.5 s.
pub(super) struct Creep {
    random: Xoshiro256PlusPlus,
    direction: f64,
    since: f64,
    until: f64,
    from: f64,
}

impl Creep {
    pub(super) fn new(mut random: Xoshiro256PlusPlus) -> Self {
        let direction = draw_sign(&mut random);
        let until = draw(&mut random, 0.8, 1.5);
        Self {
            random,
            direction,
            since: 0.0,
            until,
            from: 0.0,
        }
    }
}

impl Profile for Creep {
    /// A higher bandwidth than that of other profiles, and integral action: otherwise the error of
    /// the friction that is fed forward would stop the motor at this speed.
    const TUNING: Tuning = Tuning {
        bandwidth_hz: 60.0,
        integral_per_s: 60.0,
        coulomb_at_rad_s: 0.02,
    };

    fn slip(&mut self, t: f64) -> f64 {
        while t >= self.until {
            self.from = self.direction * OMEGA;
            self.direction = -self.direction;
            self.since = self.until;
            self.until += draw(&mut self.random, 0.8, 1.5);
        }
        let turned = ((t - self.since) / TURN_S).min(1.0);
        self.from + (self.direction * OMEGA - self.from) * turned
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand_xoshiro::rand_core::SeedableRng;

    /// From plateau to plateau of the other direction in 0.05 s; each direction lasts 0.8 to 1.5 s.
    #[test]
    fn slip_is_trapezoids_of_random_duration() {
        const STEP_S: f64 = 1e-4;
        let mut creep = Creep::new(Xoshiro256PlusPlus::seed_from_u64(2));
        let slips: Vec<f64> = (0..600_000)
            .map(|k| creep.slip(f64::from(k) * STEP_S))
            .collect();
        assert_eq!(slips[0], 0.0);
        let at_plateau = |slip: f64| (slip.abs() - OMEGA).abs() < 1e-12;
        let mut turns = Vec::new();
        for (k, pair) in slips.windows(2).enumerate() {
            assert!(pair[1].abs() <= OMEGA + 1e-12, "{k}: {pair:?}");
            let change = (pair[1] - pair[0]).abs() / STEP_S;
            let slope = if k < 500 {
                OMEGA / TURN_S
            } else {
                2.0 * OMEGA / TURN_S
            };
            match (at_plateau(pair[0]), at_plateau(pair[1])) {
                (true, true) => assert!(change < 1e-9, "{k}: {pair:?}"),
                (false, false) => assert!((change / slope - 1.0).abs() < 1e-6, "{k}: {pair:?}"),
                (begins, _) => {
                    assert!(change <= slope * (1.0 + 1e-6), "{k}: {pair:?}");
                    turns.extend(begins.then_some(k));
                }
            }
        }
        let lasts = |pair: &[usize]| (pair[1] - pair[0]) as f64 * STEP_S;
        let lasts: Vec<f64> = turns.windows(2).map(lasts).collect();
        assert!(lasts.len() > 40, "{}", lasts.len());
        assert!(
            lasts.iter().all(|s| (0.799..1.501).contains(s)),
            "{lasts:?}"
        );
        let least = lasts.iter().copied().fold(f64::INFINITY, f64::min);
        let most = lasts.iter().copied().fold(0.0, f64::max);
        assert!(least < 0.9 && most > 1.4, "{least} {most}");
    }
}
