//! Scores of a run: parasitic force, and cost of the control task.

use crate::run::{ControlTick, HAND_HZ, Outcome, PlantState};

/// Parasitic force at the fingertip.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Parasitic {
    /// Root mean square, mN.
    pub rms_mn: f64,
    /// Largest, mN.
    pub max_mn: f64,
    /// Number of samples.
    pub samples: usize,
}

impl Parasitic {
    /// The scores of pairs of torque on the hand and commanded torque, N.m, on a handle of
    /// `diameter_m`.
    #[must_use]
    pub fn of(pairs: impl Iterator<Item = (f64, f64)>, diameter_m: f64) -> Option<Self> {
        let (mut sum, mut max_mn, mut samples) = (0.0, 0.0_f64, 0);
        for (felt, wanted) in pairs {
            let force = 2e3 * (felt - wanted) / diameter_m;
            sum += force * force;
            max_mn = max_mn.max(force.abs());
            samples += 1;
        }
        (samples > 0).then(|| Self {
            rms_mn: (sum / samples as f64).sqrt(),
            max_mn,
            samples,
        })
    }
}

/// Smallest, mean and largest of some numbers.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Range {
    /// Smallest.
    pub min: u64,
    /// Mean.
    pub mean: f64,
    /// Largest.
    pub max: u64,
}

impl Range {
    /// The statistics of `numbers`; `None` if there are no numbers.
    #[must_use]
    pub fn of(numbers: impl Iterator<Item = u64>) -> Option<Self> {
        let (mut min, mut max, mut sum, mut n) = (u64::MAX, 0, 0, 0_u64);
        for number in numbers {
            (min, max, sum, n) = (min.min(number), max.max(number), sum + number, n + 1);
        }
        (n > 0).then(|| Self {
            min,
            mean: sum as f64 / n as f64,
            max,
        })
    }
}

impl Outcome {
    /// Parasitic force after `from_s`: the force on the hand less that of the torque in the frames.
    #[must_use]
    pub fn parasitic(&self, from_s: f64, diameter_m: f64) -> Option<Parasitic> {
        let pairs = self.telemetry.frames.iter().filter_map(|frame| {
            let tick = self.tick(frame)?;
            let late = tick.at_ns as f64 * 1e-9 >= from_s;
            late.then(|| (tick.felt, f64::from(frame.torque)))
        });
        Parasitic::of(pairs, diameter_m)
    }

    /// Instructions of the control task while the amplifiers are enabled.
    #[must_use]
    pub fn instructions(&self) -> Option<Range> {
        let running = self.ticks.iter().filter(|tick| tick.enabled == [true; 2]);
        Range::of(running.map(|tick| u64::from(tick.instructions)))
    }

    /// Time from one start of the control task to the next, ns.
    #[must_use]
    pub fn periods(&self) -> Option<Range> {
        let period = |pair: &[ControlTick]| pair[1].at_ns - pair[0].at_ns;
        Range::of(self.ticks.windows(2).map(period))
    }

    /// Time from `since_s` until both amplifiers stay off, s; `None` if they do not.
    #[must_use]
    pub fn off_after(&self, since_s: f64) -> Option<f64> {
        let (at_ns, last) = self.enables.last()?;
        (*last == [false; 2]).then(|| (*at_ns as f64 * 1e-9 - since_s).max(0.0))
    }

    /// Largest difference of the force on the hand from that of a `healthy` run with the same seed,
    /// from `since_s` to `until_s`, mN at the fingertip.
    #[must_use]
    pub fn spurious_mn(&self, healthy: &Self, since_s: f64, until_s: f64, diameter_m: f64) -> f64 {
        let states = self
            .plant_states
            .iter()
            .zip(&healthy.plant_states)
            .enumerate();
        let inside = states.filter(|(k, _)| {
            let t = *k as f64 / HAND_HZ;
            t >= since_s && t <= until_s
        });
        let difference = |(_, (mine, other)): (usize, (&PlantState, &PlantState))| {
            2e3 * (mine.felt - other.felt).abs() / diameter_m
        };
        inside.map(difference).fold(0.0, f64::max)
    }
}
