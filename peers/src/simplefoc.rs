//! The velocities of SimpleFOC.

use estimator_core::{Count, CountsPerTick, Hertz, Sample, Signals, VelocityEstimator};

/// The time constant of the velocity's low-pass in the default configuration, s.
const FILTER_TIME_S: f64 = 0.005;

/// The low-pass of SimpleFOC: `y = a y + (1 - a) x`, `a = Tf / (Tf + T)`.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Filter {
    old: f32,
    new: f32,
}

impl Filter {
    const fn new(filter_time_s: f64, rate: Hertz) -> Self {
        let old = filter_time_s / (filter_time_s + rate.period_s());
        Self {
            old: old as f32,
            new: (1.0 - old) as f32,
        }
    }

    #[inline(always)]
    fn filtered(&self, y: f32, x: f32) -> f32 {
        self.old * y + self.new * x
    }
}

/// The velocity of a SimpleFOC sensor without interrupts, as a magnetic one: the difference of the last
/// two different counts over the time between the samples that saw them, then the low-pass.
///
/// The velocity stays as it is while the count stays: at rest it is that of the last change for ever.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SimpleFocSensor {
    filter: Filter,
}

impl SimpleFocSensor {
    /// The time constant of the low-pass in the default configuration, s.
    pub const FILTER_TIME_S: f64 = FILTER_TIME_S;

    /// With a low-pass of the time constant `filter_time_s`, called at `rate`, at most 10 kHz.
    #[must_use]
    pub const fn new(filter_time_s: f64, rate: Hertz) -> Self {
        Self {
            filter: Filter::new(filter_time_s, rate),
        }
    }
}

/// State of [`SimpleFocSensor`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SimpleFocSensorState {
    /// The count of the latest change, and the ticks since then.
    anchor: Count,
    ticks: u32,
    velocity: f32,
    filtered: f32,
}

impl VelocityEstimator for SimpleFocSensor {
    type State = SimpleFocSensorState;
    const NEEDS: Signals = Signals::COUNT;

    fn start(&self, first: &Sample) -> SimpleFocSensorState {
        SimpleFocSensorState {
            anchor: first.count,
            ticks: 0,
            velocity: 0.0,
            filtered: 0.0,
        }
    }

    #[inline(always)]
    fn update(&self, state: &mut SimpleFocSensorState, sample: &Sample) -> CountsPerTick {
        state.ticks = state.ticks.saturating_add(1);
        let step = sample.count - state.anchor;
        if step.0 != 0 {
            state.velocity = step.to_f32() / state.ticks as f32;
            state.anchor = sample.count;
            state.ticks = 0;
        }
        state.filtered = self.filter.filtered(state.filtered, state.velocity);
        CountsPerTick(state.filtered)
    }
}

/// The velocity of a SimpleFOC encoder with interrupts, then the low-pass.
///
/// ```text
/// d = 1 + h' - h     ticks between the edges before this tick and before the last one;
///                    h and h' are the ages of the latest edge at this tick and at the last one
/// v = n / d          n counts since the last tick; v stays as it is for n = 0 and for d <= 1/2
/// v = 0              if the latest edge is older than 0.1 s
/// ```
///
/// Ages are whole microseconds.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SimpleFocEncoder {
    filter: Filter,
    /// Ticks of the clock that stamps edges in a microsecond.
    per_us: u32,
    /// Control periods in a microsecond.
    ticks_per_us: f32,
    /// Age of the latest edge at rest, control periods.
    rest: f32,
}

impl SimpleFocEncoder {
    /// The time constant of the low-pass in the default configuration, s.
    pub const FILTER_TIME_S: f64 = FILTER_TIME_S;

    /// With a low-pass of the time constant `filter_time_s`, called at `rate`; edges are stamped by
    /// `clock`, a multiple of 1 MHz.
    #[must_use]
    pub const fn new(filter_time_s: f64, rate: Hertz, clock: Hertz) -> Self {
        Self {
            filter: Filter::new(filter_time_s, rate),
            per_us: (clock.0 * 1e-6) as u32,
            ticks_per_us: (rate.0 * 1e-6) as f32,
            rest: (0.1 * rate.0) as f32,
        }
    }
}

/// State of [`SimpleFocEncoder`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SimpleFocEncoderState {
    anchor: Count,
    /// Age of the latest edge at the last tick, control periods.
    age: f32,
    velocity: f32,
    filtered: f32,
}

impl VelocityEstimator for SimpleFocEncoder {
    type State = SimpleFocEncoderState;
    const NEEDS: Signals = Signals {
        edge: true,
        ..Signals::COUNT
    };

    fn start(&self, first: &Sample) -> SimpleFocEncoderState {
        SimpleFocEncoderState {
            anchor: first.count,
            age: 0.0,
            velocity: 0.0,
            filtered: 0.0,
        }
    }

    #[inline(always)]
    fn update(&self, state: &mut SimpleFocEncoderState, sample: &Sample) -> CountsPerTick {
        let step = sample.count - state.anchor;
        state.anchor = sample.count;
        let age = match sample.edge {
            Some(edge) => (edge.age.0 / self.per_us) as f32 * self.ticks_per_us,
            None => state.age + 1.0,
        };
        let between = 1.0 + state.age - age;
        state.age = age;
        if step.0 != 0 && between > 0.5 {
            state.velocity = step.to_f32() / between;
        }
        if age > self.rest {
            state.velocity = 0.0;
        }
        state.filtered = self.filter.filtered(state.filtered, state.velocity);
        CountsPerTick(state.filtered)
    }
}
