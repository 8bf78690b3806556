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
