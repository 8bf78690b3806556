//! Simulation of a scenario on a device at a control rate, sampled as a [`Trace`].

use crate::device::{Device, Disc, LONGEST_STEP_S};
use crate::encoder::{DiscErrors, EdgeObserver, Encoder};
use crate::plant::{Plant, Pose, steps_per_tick};
use crate::scenario::{Drive, EncoderCounts, Scenario, ScenarioName, build, draw};
use crate::trace::{Columns, EDGE_CLOCK_HZ, EdgeStamp, Trace};
use device_files::{decimal, six_digits};
use rand_distr::{Distribution, StandardNormal};
use rand_xoshiro::{
    Xoshiro256PlusPlus,
    rand_core::{Rng, SeedableRng},
};
use std::f64::consts::TAU;

/// Lowest and highest control rate, Hz.
pub const RATES_HZ: (f64, f64) = (100.0, 100_000.0);

/// Longest run, ticks: a trace has some 60 bytes a tick, and its text as many again.
const MOST_TICKS: f64 = 2e7;

/// Number of ticks of a run.
///
/// # Errors
/// One line that names a rate or a duration out of range, and the range.
pub fn ticks(rate_hz: f64, seconds: f64) -> Result<usize, String> {
    if !(RATES_HZ.0..=RATES_HZ.1).contains(&rate_hz) {
        return Err(format!(
            "rate {} Hz: must be from {} to {} Hz",
            decimal(rate_hz),
            RATES_HZ.0,
            RATES_HZ.1
        ));
    }
    let ticks = (rate_hz * seconds).round();
    if !(2.0..=MOST_TICKS).contains(&ticks) {
        return Err(format!(
            "duration {} s: must be from {} to {} s at {rate_hz} Hz",
            decimal(seconds),
            six_digits(2.0 / rate_hz),
            six_digits(MOST_TICKS / rate_hz)
        ));
    }
    Ok(ticks as usize)
}

/// Number of plant steps of a run, for statistics.
///
/// # Errors
/// As [`ticks`].
pub fn plant_steps(rate_hz: f64, seconds: f64) -> Result<u64, String> {
    let ticks = ticks(rate_hz, seconds)? as u64;
    Ok(ticks * u64::from(steps_per_tick(1.0 / rate_hz)))
}

/// Runs a scenario for `seconds` at `rate_hz`.
///
/// At each tick the encoders are sampled first. Then the scenario computes its currents, which are
/// applied at once. `current` is the large motor's command after saturation, from its tick to the
/// next; `true_omega` is the large motor's true velocity at the tick, rad/s. The seed draws the
/// first counts. The age of an edge is the difference of two readings of a clock of
/// [`EDGE_CLOCK_HZ`], one at the edge and one at the tick, each rounded down, as in a capture unit.
///
/// ```
/// use simulation::device::Device;
/// use simulation::scenario::ScenarioName;
/// use simulation::simulate::simulate;
/// use simulation::trace::Columns;
/// let trace = simulate(
///     &Device::default(), ScenarioName::Step, 1000.0, 1, 0.5, Columns::default(),
/// ).unwrap();
/// assert_eq!(trace.len(), 500);
/// assert!(trace.edges.is_none());
/// ```
///
/// # Errors
/// One line on an invalid device, or on a rate or a duration out of range.
pub fn simulate(
    device: &Device,
    scenario: ScenarioName,
    rate_hz: f64,
    seed: u64,
    seconds: f64,
    columns: Columns,
) -> Result<Trace, String> {
    device.validate()?;
    let ticks = ticks(rate_hz, seconds)?;
    let run = Run::new(device, scenario, rate_hz, seed, columns);
    Ok(if columns.edges {
        run.record(ticks, LastEdge::default())
    } else {
        run.record(ticks, ())
    })
}

/// Recorder of the latest edge for the trace; `()` records none.
trait Stamps: EdgeObserver {
    /// Column of the trace; `None` if no edges are recorded.
    fn column(ticks: usize) -> Option<Vec<Option<EdgeStamp>>>;
    /// Called before a step of `step_s` that begins at `t`, s.
    fn step(&mut self, t: f64, step_s: f64);
    /// Records the edge known at a tick at `t`, s.
    fn read(&self, t: f64) -> Option<EdgeStamp>;
}

impl Stamps for () {
    fn column(_: usize) -> Option<Vec<Option<EdgeStamp>>> {
        None
    }
    fn step(&mut self, _: f64, _: f64) {}
    fn read(&self, _: f64) -> Option<EdgeStamp> {
        None
    }
}

/// The latest edge in periods of the edge clock.
#[derive(Default)]
struct LastEdge {
    t: f64,
    step: f64,
    edge: Option<(f64, u32)>,
}

impl EdgeObserver for LastEdge {
    fn edge(&mut self, boundary: u32, part: impl FnOnce() -> f64) {
        let clock = ((self.t + part() * self.step) * EDGE_CLOCK_HZ).floor();
        self.edge = Some((clock, boundary));
    }
}

impl Stamps for LastEdge {
    fn column(ticks: usize) -> Option<Vec<Option<EdgeStamp>>> {
        Some(Vec::with_capacity(ticks))
    }
    fn step(&mut self, t: f64, step_s: f64) {
        self.t = t;
        self.step = step_s;
    }
    fn read(&self, t: f64) -> Option<EdgeStamp> {
        self.edge.map(|(clock, boundary)| EdgeStamp {
            age_s: ((t * EDGE_CLOCK_HZ).floor() - clock).max(0.0) / EDGE_CLOCK_HZ,
            boundary,
        })
    }
}

/// State of the simulation.
struct Run {
    rate_hz: f64,
    period: f64,
    steps: u32,
    step: f64,
    damping: f64,
    plant: Plant,
    scenario: Box<dyn Scenario>,
    large: Encoder,
    small: Option<Encoder>,
    reference: Option<Encoder>,
    keep_small: bool,
    random: Xoshiro256PlusPlus,
}

impl Run {
    fn new(device: &Device, name: ScenarioName, rate_hz: f64, seed: u64, columns: Columns) -> Self {
        let device = if name.linear_plant() {
            linear(device)
        } else {
            device.clone()
        };
        let period = 1.0 / rate_hz;
        let steps = steps_per_tick(period);
        let step = period / f64::from(steps);
        debug_assert!(step <= LONGEST_STEP_S * 1.000_001);

        // The shifted seed is independent of the scenario's own draws.
        let mut random = Xoshiro256PlusPlus::seed_from_u64(name.mix(seed).rotate_left(32));
        let scenario = build(name, &device, period, seed);
        let start = Pose {
            angle: draw(&mut random, 0.0, TAU),
            omega: 0.0,
        };
        let mut plant = Plant::new(&device, step);
        plant.place(start, scenario.start());

        let disc = DiscErrors::new(
            &device.disc,
            device.stages.large.counts_per_rev,
            random.next_u64(),
        );
        let mut encoder = |counts_per_rev: u32, angle: f64, disc: DiscErrors| {
            let first = random.next_u64() as u32;
            let phase = draw(&mut random, 0.0, 1.0);
            Encoder::new(counts_per_rev, first, phase, angle, disc)
        };
        // All three are always drawn, so that the values of a column do not depend on which other
        // columns exist.
        let large = encoder(device.stages.large.counts_per_rev, start.angle, disc);
        let handle = plant.small().angle;
        let small = encoder(
            device.stages.small.counts_per_rev,
            handle,
            DiscErrors::none(),
        );
        let reference = encoder(
            device.reference.counts_per_rev,
            start.angle,
            DiscErrors::none(),
        );
        Self {
            rate_hz,
            period,
            steps,
            step,
            damping: device.stages.damping,
            plant,
            scenario,
            large,
            small: (name.reads_small() || columns.counts_small).then_some(small),
            reference: name.reads_reference().then_some(reference),
            keep_small: columns.counts_small,
            random,
        }
    }

    fn record<S: Stamps>(mut self, ticks: usize, mut stamps: S) -> Trace {
        let column = || Vec::with_capacity(ticks);
        let (mut counts, mut current) = (Vec::with_capacity(ticks), column());
        let (mut omega, mut damping) = (column(), column());
        let mut counts_small = self.keep_small.then(|| Vec::with_capacity(ticks));
        let mut edges = S::column(ticks);
        for k in 0..ticks {
            let t = k as f64 * self.period;
            counts.push(self.large.count());
            omega.push(self.plant.large().omega);
            if let Some(column) = &mut counts_small {
                column.push(self.loop_counts().small);
            }
            if let Some(column) = &mut edges {
                column.push(stamps.read(t));
            }
            let drive = self.tick(k as u64, self.loop_counts(), t, &mut stamps);
            damping.push(self.damping * drive.damping_part);
            current.push(self.plant.commands().0);
        }
        Trace {
            rate_hz: self.rate_hz,
            counts_large: counts,
            counts_small,
            current: Some(current),
            edges,
            true_omega: Some(omega),
            known: None,
            true_damping: Some(damping),
            periods: None,
        }
    }

    /// Counts for the scenario's own loop.
    fn loop_counts(&self) -> EncoderCounts {
        let count = |encoder: &Option<Encoder>| encoder.as_ref().map_or(0, Encoder::count);
        EncoderCounts {
            reference: count(&self.reference),
            small: count(&self.small),
        }
    }

    /// Simulates from the tick at `t` to the next one. Returns the inputs that the scenario
    /// applied.
    fn tick<S: Stamps>(&mut self, k: u64, counts: EncoderCounts, t: f64, stamps: &mut S) -> Drive {
        let drive = self.scenario.tick(k, counts);
        self.plant.command(drive.large_a, drive.small_a);
        self.plant.set_damping(self.damping * drive.damping_part);
        let noise = (self.scenario.torque_intensity() / self.step).sqrt();
        for j in 0..self.steps {
            let since = f64::from(j) * self.step;
            let disturbance = if noise == 0.0 {
                0.0
            } else {
                let draw: f64 = StandardNormal.sample(&mut self.random);
                noise * draw
            };
            let (large, handle) = (self.plant.large(), self.plant.small());
            self.plant.step(&drive.grip, since, disturbance);
            stamps.step(t + since, self.step);
            let (to, handle_to) = (self.plant.large(), self.plant.small());
            self.large.follow(large, to, self.step, stamps);
            if let Some(reference) = &mut self.reference {
                reference.follow(large, to, self.step, &mut ());
            }
            if let Some(small) = &mut self.small {
                small.follow(handle, handle_to, self.step, &mut ());
            }
        }
        drive
    }
}

/// The device without friction, ripple and disc errors.
fn linear(device: &Device) -> Device {
    let mut device = device.frictionless();
    device.large_ripple.torque = 0.0;
    device.small_ripple.torque = 0.0;
    device.disc = Disc::default();
    device
}

#[cfg(test)]
mod tests;
