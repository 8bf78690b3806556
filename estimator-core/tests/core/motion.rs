//! Motions to try estimators on: true positions in counts, beyond 32 bits, and currents.

use estimator_core::{Amps, Count, Sample};
use proptest::prelude::*;

/// A random generator small enough to read (SplitMix64): the same draws on every machine.
pub(crate) struct Draws(pub(crate) u64);

impl Draws {
    pub(crate) fn bits(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        z ^ (z >> 31)
    }

    /// Uniform in `-limit..=limit`.
    pub(crate) fn within(&mut self, limit: i64) -> i64 {
        let span = 2 * limit.unsigned_abs() + 1;
        (self.bits() % span) as i64 - limit
    }

    /// Uniform in -1 to 1.
    pub(crate) fn unit(&mut self) -> f64 {
        (self.bits() >> 11) as f64 / (1u64 << 52) as f64 - 1.0
    }
}

/// One stretch of a motion.
#[derive(Clone, Debug)]
pub(crate) enum Stretch {
    /// No motion.
    Rest,
    /// This number of counts each tick.
    Ramp(i64),
    /// A constant velocity that is no whole number of counts, quantised.
    Slope(f64),
    /// One count every this many ticks, in either direction.
    Creep(u16, bool),
    /// Random steps of at most this many counts.
    Walk(i64, u64),
    /// A quantised sine of this amplitude, in counts, and period, in ticks.
    Sine(f64, f64),
}

/// Positions and currents, one of each a tick.
#[derive(Clone, Debug)]
pub(crate) struct Motion {
    pub(crate) counts: Vec<i64>,
    pub(crate) amps: Vec<f32>,
}

impl Motion {
    /// The stretches one after the other, `ticks` long each, from zero, with random currents.
    pub(crate) fn of(stretches: &[(Stretch, u16)], seed: u64) -> Self {
        let mut draws = Draws(seed);
        let mut counts = vec![0];
        for (stretch, ticks) in stretches {
            let from = *counts.last().expect("never empty");
            let mut walked = from;
            let mut steps = Draws(seed);
            if let Stretch::Walk(_, seed) = stretch {
                steps = Draws(*seed);
            }
            for tick in 1..=i64::from(*ticks) {
                let t = tick as f64;
                counts.push(match stretch {
                    Stretch::Rest => from,
                    Stretch::Ramp(step) => from + step * tick,
                    Stretch::Slope(v) => from + (v * t).floor() as i64,
                    Stretch::Creep(period, up) => {
                        let moved = tick / i64::from(*period);
                        from + if *up { moved } else { -moved }
                    }
                    Stretch::Walk(limit, _) => {
                        walked += steps.within(*limit);
                        walked
                    }
                    Stretch::Sine(amplitude, period) => {
                        let phase = std::f64::consts::TAU * t / period;
                        from + (amplitude * phase.sin()).floor() as i64
                    }
                });
            }
        }
        let amps = counts.iter().map(|_| draws.unit() as f32).collect();
        Self { counts, amps }
    }

    /// The samples of a device whose counter shows `offset` at position zero.
    pub(crate) fn samples(&self, offset: u32) -> Vec<Sample> {
        let sample = |(&count, &amps): (&i64, &f32)| {
            Sample::new(Count((count as u32).wrapping_add(offset))).with_current(Amps::new(amps))
        };
        self.counts.iter().zip(&self.amps).map(sample).collect()
    }

    /// The same motion in the opposite direction.
    pub(crate) fn mirrored(&self) -> Self {
        Self {
            counts: self.counts.iter().map(|count| -count).collect(),
            amps: self.amps.iter().map(|amps| -amps).collect(),
        }
    }

    /// The largest displacement in a tick.
    pub(crate) fn fastest(&self) -> i64 {
        let steps = self.counts.windows(2).map(|pair| (pair[1] - pair[0]).abs());
        steps.max().unwrap_or(0)
    }
}

/// A motion with a stretch of each kind, about 900 ticks long.
pub(crate) fn medley() -> Motion {
    Motion::of(
        &[
            (Stretch::Rest, 20),
            (Stretch::Slope(3.7), 150),
            (Stretch::Walk(2, 1), 100),
            (Stretch::Creep(37, false), 200),
            (Stretch::Sine(900.0, 70.0), 150),
            (Stretch::Ramp(-2900), 40),
            (Stretch::Walk(4000, 2), 60),
            (Stretch::Rest, 200),
        ],
        3,
    )
}

fn stretch() -> impl Strategy<Value = Stretch> {
    prop_oneof![
        Just(Stretch::Rest),
        (-3000i64..3000).prop_map(Stretch::Ramp),
        (-40.0..40.0).prop_map(Stretch::Slope),
        (1u16..90, any::<bool>()).prop_map(|(period, up)| Stretch::Creep(period, up)),
        (1i64..5000, any::<u64>()).prop_map(|(limit, seed)| Stretch::Walk(limit, seed)),
        (0.5..2000.0, 10.0..200.0).prop_map(|(amplitude, period)| Stretch::Sine(amplitude, period)),
    ]
}

/// Any motion slower than 2^15 counts a tick.
pub(crate) fn any_motion() -> impl Strategy<Value = Motion> {
    let stretches = proptest::collection::vec((stretch(), 1u16..120), 1..6);
    (stretches, any::<u64>()).prop_map(|(stretches, seed)| Motion::of(&stretches, seed))
}
