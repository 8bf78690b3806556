//! The velocity of the dVRK controllers.

use estimator_core::{Count, CountsPerTick, Hertz, Sample, Signals, VelocityEstimator};

/// The clock of the FPGA that counts between edges, Hz.
const FPGA_CLOCK_HZ: f64 = 49_152_000.0;

/// The counters of the FPGA have 26 bits.
const LONGEST_S: f64 = ((1 << 26) - 1) as f64 / FPGA_CLOCK_HZ;

/// The velocity of the dVRK controllers.
///
/// ```text
/// q1 .. q5    times between the last six edges, the newest first; r time since the newest
/// p = q1 + q2 + q3 + q4,  p' = q2 + q3 + q4 + q5
/// v = ± 4 / p
/// a = ± 8 (q5 - q1) / (p p' (q5 + q1))
/// u = v + a (p/2 + r),  not of the other sign,  |u| <= 1 / r
/// ```
///
/// `v` is 0 if the last four edges have not one direction, and if `p` is longer than the counter. `a` is
/// 0 if the fifth edge has another direction, and if `q1` is shorter than the threshold. The first four
/// lines are the FPGA's, the prediction `u` is that of the computer that reads it.
///
/// An update takes the newest edge from the sample. Further edges since the last update are taken as
/// evenly spaced, so the rate should be above that of the edges. The two edges of a count that is left
/// and entered again within an update are not seen. Times are f32, not whole ticks of the FPGA's clock.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Dvrk {
    predicts: bool,
    /// Control periods in a tick of the clock that stamps edges.
    per_clock: f32,
    /// Longest time that a counter holds, control periods.
    longest: f32,
    /// Shortest `q1` with an acceleration, control periods.
    shortest: f32,
}

impl Dvrk {
    /// The threshold with which the project's component for robots calls the prediction: the inverse of
    /// the shortest `q1`, 1/ticks of the FPGA's clock.
    pub const THRESHOLD: f64 = 0.0005;

    /// The velocity `v` for samples at `rate`, with edges stamped by `clock`.
    #[must_use]
    pub const fn measured(rate: Hertz, clock: Hertz) -> Self {
        Self {
            predicts: false,
            per_clock: (rate.0 / clock.0) as f32,
            longest: (LONGEST_S * rate.0) as f32,
            shortest: (rate.0 / (Self::THRESHOLD * FPGA_CLOCK_HZ)) as f32,
        }
    }

    /// The velocity `u` for samples at `rate`, with edges stamped by `clock`.
    #[must_use]
    pub const fn predicted(rate: Hertz, clock: Hertz) -> Self {
        Self {
            predicts: true,
            ..Self::measured(rate, clock)
        }
    }
}

/// State of [`Dvrk`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DvrkState {
    anchor: Count,
    /// Time since the newest edge, control periods.
    run: f32,
    /// Times between edges, the newest first, control periods.
    quarters: [f32; 5],
    /// Bit k is set if edge k, the newest first, was forward.
    forward: u8,
}

impl DvrkState {
    /// Takes an edge, `quarter` after the one before.
    #[inline(always)]
    fn push(&mut self, quarter: f32, forward: bool) {
        let [a, b, c, d, _] = self.quarters;
        self.quarters = [quarter, a, b, c, d];
        self.forward = (self.forward << 1) | u8::from(forward);
    }
}

impl VelocityEstimator for Dvrk {
    type State = DvrkState;
    const NEEDS: Signals = Signals {
        edge: true,
        ..Signals::COUNT
    };

    fn start(&self, first: &Sample) -> DvrkState {
        DvrkState {
            anchor: first.count,
            run: self.longest,
            quarters: [self.longest; 5],
            forward: 0,
        }
    }

    #[inline(always)]
    fn update(&self, state: &mut DvrkState, sample: &Sample) -> CountsPerTick {
        let step = (sample.count - state.anchor).0;
        state.anchor = sample.count;
        let before = state.run;
        state.run = before + 1.0;
        if step != 0 {
            let age = match sample.edge {
                Some(edge) => edge.age.0 as f32 * self.per_clock,
                None => 0.0,
            };
            state.run = age;
            let edges = step.unsigned_abs();
            let quarter = (before + 1.0 - age) / edges as f32;
            // The queue holds five.
            for _ in 0..edges.min(5) {
                state.push(quarter, step > 0);
            }
        }
        if state.run > self.longest {
            state.run = self.longest;
        }
        CountsPerTick(self.velocity(state))
    }
}

impl Dvrk {
    #[inline(always)]
    fn velocity(&self, state: &DvrkState) -> f32 {
        let [q1, q2, q3, q4, q5] = state.quarters;
        let cycle = q1 + q2 + q3 + q4;
        let last = state.forward & 0b1111;
        if cycle > self.longest || (last != 0 && last != 0b1111) {
            return 0.0;
        }
        let speed = 4.0 / cycle;
        let mut predicted = speed;
        if self.predicts {
            let fifth = (state.forward & 0b1_0000) != 0;
            if fifth == (last != 0) && q1 >= self.shortest {
                let previous = if q5 >= self.longest {
                    self.longest
                } else {
                    q2 + q3 + q4 + q5
                };
                let acceleration = 8.0 * (q5 - q1) / (cycle * previous * (q5 + q1));
                predicted = speed + acceleration * (0.5 * cycle + state.run);
            }
            if predicted < 0.0 {
                predicted = 0.0;
            }
            if predicted * state.run > 1.0 {
                predicted = 1.0 / state.run;
            }
        }
        if last == 0 { -predicted } else { predicted }
    }
}
