//! Scenario `creep`: 0.05 rad/s both ways.

use super::{clamped::Profile, draw, draw_sign, servo::Tuning};
use rand_xoshiro::Xoshiro256PlusPlus;

/// Slip, rad/s.
const OMEGA: f64 = 0.05;
/// Time to turn round, s.
const TURN_S: f64 = 0.05;

/// Trapezoids of slip; each way lasts 0.8 to 1.5 s.
pub(super) struct Creep {
    random: Xoshiro256PlusPlus,
    way: f64,
    since: f64,
    until: f64,
    from: f64,
}

impl Creep {
    pub(super) fn new(mut random: Xoshiro256PlusPlus) -> Self {
        let way = draw_sign(&mut random);
        let until = draw(&mut random, 0.8, 1.5);
        Self {
            random,
            way,
            since: 0.0,
            until,
            from: 0.0,
        }
    }
}

impl Profile for Creep {
    /// Stiffer than the others, with an integral: at this speed what is left of friction would
    /// stop the motor.
    const TUNING: Tuning = Tuning {
        bandwidth_hz: 60.0,
        integral_per_s: 60.0,
        coulomb_at_rad_s: 0.02,
    };

    fn slip(&mut self, t: f64) -> f64 {
        while t >= self.until {
            self.from = self.way * OMEGA;
            self.way = -self.way;
            self.since = self.until;
            self.until += draw(&mut self.random, 0.8, 1.5);
        }
        let turned = ((t - self.since) / TURN_S).min(1.0);
        self.from + (self.way * OMEGA - self.from) * turned
    }
}
