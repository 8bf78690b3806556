//! Slip of the scenarios `track` and `heating`: chirps, and triangular reversals between them.

use super::{clamped::Profile, draw, draw_sign};
use rand_xoshiro::Xoshiro256PlusPlus;
use std::f64::consts::TAU;

/// Duration of a cycle: a chirp, then reversals, s.
const CYCLE_S: f64 = 5.0;
/// Duration of the chirp of a cycle, s.
const CHIRP_S: f64 = 3.0;
/// Time over which the amplitude of each part rises at its start and falls at its end, s.
const FADE_S: f64 = 0.1;
const LOWEST_HZ: f64 = 0.5;
const HIGHEST_HZ: f64 = 20.0;

/// The desired slip velocity of the scenario `track`.
pub struct Track {
    random: Xoshiro256PlusPlus,
    cycle: u64,
    draws: Draws,
}

/// Random constants of one cycle.
struct Draws {
    /// Signed amplitude, rad/s.
    chirp: f64,
    rising: bool,
    phase: f64,
    /// Signed amplitude, rad/s.
    triangle: f64,
    triangle_s: f64,
}

impl Draws {
    fn new(random: &mut Xoshiro256PlusPlus) -> Self {
        Self {
            chirp: draw_sign(random) * draw(random, 10.0, 15.0),
            rising: draw_sign(random) > 0.0,
            phase: draw(random, 0.0, TAU),
            triangle: draw_sign(random) * draw(random, 5.0, 15.0),
            triangle_s: draw(random, 0.2, 0.5),
        }
    }

    fn slip(&self, t: f64) -> f64 {
        if t < CHIRP_S {
            let along = if self.rising { t } else { CHIRP_S - t };
            // The integral of a frequency that grows exponentially.
            let growth = (HIGHEST_HZ / LOWEST_HZ).ln();
            let turns = LOWEST_HZ * CHIRP_S / growth * ((growth * along / CHIRP_S).exp() - 1.0);
            return self.chirp * fade(t, CHIRP_S) * (self.phase + TAU * turns).sin();
        }
        let t = t - CHIRP_S;
        let turns = t / self.triangle_s;
        let triangle = 1.0 - 4.0 * (turns.fract() - 0.5).abs();
        self.triangle * fade(t, CYCLE_S - CHIRP_S) * triangle
    }
}

/// Amplitude factor at `t` within a part of duration `length`: 0 at both ends, 1 in between, s.
fn fade(t: f64, length: f64) -> f64 {
    (t.min(length - t) / FADE_S).clamp(0.0, 1.0)
}

impl Track {
    /// A slip whose cycles have amplitudes, phases and directions drawn from `random`.
    pub fn new(mut random: Xoshiro256PlusPlus) -> Self {
        let draws = Draws::new(&mut random);
        Self {
            random,
            cycle: 0,
            draws,
        }
    }
}

impl Track {
    /// Desired slip velocity at `t` (s), rad/s. Callers pass increasing `t`.
    pub fn omega(&mut self, t: f64) -> f64 {
        while t >= (self.cycle + 1) as f64 * CYCLE_S {
            self.cycle += 1;
            self.draws = Draws::new(&mut self.random);
        }
        self.draws.slip(t - self.cycle as f64 * CYCLE_S)
    }
}

impl Profile for Track {
    fn slip(&mut self, t: f64) -> f64 {
        self.omega(t)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand_xoshiro::rand_core::SeedableRng;

    #[test]
    fn slip_is_continuous_and_bounded_and_reverses() {
        let mut track = Track::new(Xoshiro256PlusPlus::seed_from_u64(11));
        let (mut last, mut largest, mut steepest, mut reversals) = (0.0, 0.0_f64, 0.0_f64, 0);
        for k in 1..100_000 {
            let slip = track.slip(f64::from(k) * 1e-4);
            steepest = steepest.max(((slip - last) / 1e-4_f64).abs());
            largest = largest.max(slip.abs());
            reversals += i32::from(slip * last < 0.0);
            last = slip;
        }
        assert!((10.0..=15.0).contains(&largest), "{largest}");
        // 15 rad/s at 20 Hz is 1885 rad/s², and the fading adds up to 150 rad/s².
        assert!((1200.0..2100.0).contains(&steepest), "{steepest}");
        assert!(reversals > 60, "{reversals}");
    }
}
