//! Input of a stress run: counts, currents and edges.

use estimator_core::{Amps, ClockTicks, Count, Edge, Sample};

/// Random generator (SplitMix64) with the same draws on every machine.
#[derive(Clone, Debug)]
pub struct Draws(u64);

impl Draws {
    /// The generator of a seed.
    #[must_use]
    pub const fn new(seed: u64) -> Self {
        Self(seed)
    }

    /// 64 random bits.
    pub fn bits(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        z ^ (z >> 31)
    }

    /// Uniform in `-limit..=limit`.
    pub fn within(&mut self, limit: i32) -> i32 {
        let span = 2 * u64::from(limit.unsigned_abs()) + 1;
        (self.bits() % span) as i32 - limit
    }

    /// Uniform in -1 to 1.
    pub fn unit(&mut self) -> f64 {
        (self.bits() >> 11) as f64 / (1u64 << 52) as f64 - 1.0
    }
}

pub use simulation::trace::EDGE_CLOCK_HZ;

/// Largest displacement in a tick that the estimators treat as motion, counts.
pub const TOP_STEP: i32 = (1 << 15) - 1;

/// Input of one tick as plain numbers, from which both precisions make their samples.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Shown {
    /// Large encoder, modulo 2^32.
    pub large: u32,
    /// Small encoder, modulo 2^32.
    pub small: u32,
    /// Current over the period that ends at this tick, A; it can be invalid.
    pub amps: f32,
    /// Latest edge: boundary and age in ticks of the edge clock.
    pub edge: Option<(u32, u32)>,
}

impl Shown {
    /// The input as a sample.
    #[must_use]
    pub fn of(sample: &Sample) -> Self {
        Self {
            large: sample.count.0,
            small: sample.coupled.0,
            amps: sample.current.get(),
            edge: sample.edge.map(|edge| (edge.boundary.0, edge.age.0)),
        }
    }

    /// The sample of the core.
    #[must_use]
    pub fn sample(&self) -> Sample {
        Sample {
            count: Count(self.large),
            coupled: Count(self.small),
            current: Amps::new(self.amps),
            edge: self.edge.map(|(boundary, age)| Edge {
                boundary: Count(boundary),
                age: ClockTicks(age),
            }),
        }
    }
}

/// A stretch of a course.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Stretch {
    /// No motion and no current.
    Rest,
    /// The largest velocity that the estimators allow, in one direction.
    Top(i32),
    /// A constant velocity, in counts per tick; fractions like 1/2 keep lines on the limit of the band.
    Slope(f64),
    /// One count in this number of ticks.
    Creep(u16, i32),
    /// Alternation over one boundary at every tick.
    Chatter,
    /// Random steps of at most this number of counts.
    Walk(i32),
    /// A sine of this amplitude, counts, and period, ticks.
    Sine(f64, f64),
    /// Random 32-bit counts, and currents that are not numbers.
    Noise,
}

impl Stretch {
    /// Draws any stretch.
    fn any(draws: &mut Draws) -> Self {
        let sign = draws.within(1) | 1;
        match draws.bits() % 12 {
            0 => Self::Rest,
            1 => Self::Top(sign * TOP_STEP),
            2 => Self::Slope(draws.unit() * 40.0),
            // Fractions p/q: the true line runs through the ties of the quantiser.
            3 | 4 => Self::Slope(f64::from(draws.within(24)) / (draws.bits() % 12 + 1) as f64),
            5 => Self::Creep(64, sign),
            6 => Self::Creep((draws.bits() % 200 + 1) as u16, sign),
            7 => Self::Chatter,
            8 => Self::Walk((draws.bits() % 6 + 1) as i32),
            9 => Self::Walk((draws.bits() % 20_000 + 1) as i32),
            10 => Self::Sine(3000.0 * draws.unit(), 20.0 + 180.0 * draws.unit().abs()),
            _ => Self::Noise,
        }
    }

    /// Counts from the stretch's start at its `tick`.
    fn displacement(self, tick: u32, walked: i64, draws: &mut Draws) -> i64 {
        let t = f64::from(tick);
        match self {
            Self::Rest => 0,
            Self::Top(step) => i64::from(step) * i64::from(tick),
            Self::Slope(velocity) => (velocity * t).floor() as i64,
            Self::Creep(period, sign) => i64::from(sign) * i64::from(tick / u32::from(period)),
            Self::Chatter => i64::from(tick % 2),
            Self::Walk(limit) => walked + i64::from(draws.within(limit)),
            Self::Sine(amplitude, period) => {
                (amplitude * (std::f64::consts::TAU * t / period).sin()).floor() as i64
            }
            Self::Noise => draws.bits() as i64,
        }
    }
}

/// Invalid currents.
const BAD_AMPS: [f32; 8] = [
    f32::NAN,
    f32::INFINITY,
    f32::NEG_INFINITY,
    f32::MAX,
    f32::MIN,
    1e30,
    f32::MIN_POSITIVE / 8.0,
    -0.0,
];

/// An endless course, determined by its seed.
#[derive(Clone, Debug)]
pub struct Course {
    draws: Draws,
    stretch: Stretch,
    tick: u32,
    length: u32,
    origin: u32,
    walked: i64,
    shown: Shown,
    /// Edge-clock ticks in a control period.
    period: u32,
}

impl Course {
    /// Starts at a random count near a wrap of either counter width.
    #[must_use]
    pub fn new(seed: u64, rate_hz: f64) -> Self {
        let mut draws = Draws::new(seed);
        let wrap: u32 = if draws.bits().is_multiple_of(2) {
            0
        } else {
            1 << 16
        };
        let large = wrap.wrapping_add_signed(draws.within(100));
        Self {
            stretch: Stretch::Rest,
            tick: 0,
            length: 1,
            origin: large,
            walked: 0,
            shown: Shown {
                large,
                small: large,
                amps: 0.0,
                edge: None,
            },
            period: (EDGE_CLOCK_HZ / rate_hz) as u32,
            draws,
        }
    }

    /// Present input.
    #[must_use]
    pub const fn shown(&self) -> Shown {
        self.shown
    }

    /// Continues with rest.
    pub const fn rest(&mut self) {
        self.go(Stretch::Rest, u32::MAX);
    }

    /// Continues with another stretch of motion.
    pub fn move_on(&mut self) -> Stretch {
        let stretch = Stretch::any(&mut self.draws);
        let length = 200 + (self.draws.bits() % 4000) as u32;
        self.go(stretch, length);
        stretch
    }

    /// Continues with another stretch of motion, of this number of ticks.
    pub fn move_on_for(&mut self, length: u32) -> Stretch {
        let stretch = Stretch::any(&mut self.draws);
        self.go(stretch, length);
        stretch
    }

    /// Continues with a constant velocity, counts per tick, for this number of ticks.
    pub const fn slope(&mut self, velocity: f64, length: u32) {
        self.go(Stretch::Slope(velocity), length);
    }

    const fn go(&mut self, stretch: Stretch, length: u32) {
        self.stretch = stretch;
        self.length = length;
        self.tick = 0;
        self.walked = 0;
        self.origin = self.shown.large;
    }

    /// Whether the stretch is over.
    #[must_use]
    pub const fn is_over(&self) -> bool {
        self.tick >= self.length
    }

    /// One tick.
    pub fn step(&mut self) -> Shown {
        self.tick += 1;
        let before = self.shown;
        self.walked = self
            .stretch
            .displacement(self.tick, self.walked, &mut self.draws);
        let large = self.origin.wrapping_add(self.walked as u32);
        let amps = match self.stretch {
            Stretch::Rest => 0.0,
            Stretch::Noise => BAD_AMPS[(self.draws.bits() % 8) as usize],
            _ => 6.0 * self.draws.unit() as f32,
        };
        let small_step = match self.stretch {
            Stretch::Rest => 0,
            Stretch::Noise => self.draws.bits() as i32,
            _ => self.draws.within(30),
        };
        let step = large.wrapping_sub(before.large) as i32;
        let edge = if step == 0 {
            before
                .edge
                .map(|(boundary, age)| (boundary, age.saturating_add(self.period)))
        } else {
            // The boundary crossed last lies below the count on the way up, above it downwards.
            let boundary = if step > 0 {
                large
            } else {
                large.wrapping_add(1)
            };
            Some((
                boundary,
                (self.draws.bits() % u64::from(self.period)) as u32,
            ))
        };
        self.shown = Shown {
            large,
            small: before.small.wrapping_add_signed(small_step),
            amps,
            edge,
        };
        self.shown
    }
}
