//! The traces of the measurement.

use catalogue::estimators::sample;
use estimator_core::{Amps, ClockTicks, Count, Edge, Sample, Signals};
use recordings::recording::Recording;
use simulation::device::Device;
use simulation::scenario::ScenarioName;
use simulation::simulate::simulate;
use simulation::trace::{Columns, Trace};
use stress::course::Course;

/// Name of the trace with all frequencies and reversals of a hand.
pub(crate) const CHIRP: &str = "chirp and reversals";

/// Samples of each trace.
const SAMPLES: usize = 2500;

/// Ticks between two stretches of a stress course.
const STRETCH: usize = 128;

/// Simulated traces begin here, s: scenarios have settled.
const FROM_S: f64 = 1.0;

/// A seed that is not used for tuning.
const SEED: u64 = 7;

/// All signals that estimators read.
const EVERYTHING: Signals = Signals {
    current: true,
    coupled: true,
    edge: true,
};
const COLUMNS: Columns = Columns {
    counts_small: true,
    edges: true,
};

/// Counts per revolution of the large encoder.
pub(crate) const COUNTS_PER_REV: u32 = 4096;

/// Control rates, Hz.
pub const RATES_HZ: [u32; 2] = [1000, 10_000];

/// A trace with its true velocity.
#[derive(Clone, Debug)]
pub struct BenchTrace {
    /// Name of the trace.
    pub name: &'static str,
    /// Its rate, Hz.
    pub rate_hz: u32,
    /// Input of the estimators.
    pub samples: Vec<Sample>,
    /// True velocity at each sample, counts per tick; `None` if errors are not computed.
    pub truth: Option<Vec<f64>>,
    /// rad/s of one count a tick.
    pub scale: f64,
}

/// All traces.
///
/// # Errors
/// One line on a recording that cannot be read.
pub fn all() -> Result<Vec<BenchTrace>, String> {
    let device = Device::default();
    let mut traces = Vec::new();
    for rate_hz in RATES_HZ {
        let rate = f64::from(rate_hz);
        traces.push(BenchTrace {
            name: "still",
            rate_hz,
            samples: vec![Sample::new(Count(12_345)); SAMPLES],
            truth: None,
            scale: counts_per_tick(COUNTS_PER_REV, rate),
        });
        for (name, scenario) in [
            ("creep", ScenarioName::Creep),
            ("constant", ScenarioName::Permanent),
            ("steps", ScenarioName::Step),
            (CHIRP, ScenarioName::Track),
            ("texture", ScenarioName::Texture),
        ] {
            let first = (FROM_S * rate) as usize;
            let seconds = (first + SAMPLES) as f64 / rate;
            let trace = simulate(&device, scenario, rate, SEED, seconds, COLUMNS)?;
            traces.push(bench_trace(name, rate_hz, &trace, first, COUNTS_PER_REV));
        }
    }
    // Hall states of a motor: their edges are too coarse for a truth.
    let path = concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/../tests/data/back-and-forth.csv"
    );
    let recording = Recording::read(path.as_ref()).map_err(|error| error.to_string())?;
    traces.push(bench_trace("recording", 1000, &recording.trace, 0, 90));
    traces.last_mut().expect("just pushed").truth = None;
    Ok(traces)
}

/// Traces in which only the bits are compared: rest, top speed, ties of the quantiser, wraps of the
/// counter, random 32-bit counts, currents that are not numbers.
#[must_use]
pub fn hostile(rate_hz: u32) -> Vec<Sample> {
    let mut course = Course::new(SEED, f64::from(rate_hz));
    let mut samples = Vec::with_capacity(bench_image::mailbox::SAMPLES);
    for k in 0..samples.capacity() {
        if k % STRETCH == 0 {
            course.move_on();
        }
        let shown = course.step();
        let stamp = |(boundary, age)| Edge {
            boundary: Count(boundary),
            age: ClockTicks(age),
        };
        samples.push(Sample {
            count: Count(shown.large),
            coupled: Count(shown.small),
            current: Amps::new(shown.amps),
            edge: shown.edge.map(stamp),
        });
    }
    samples
}

/// rad/s of one count a tick.
pub(crate) fn counts_per_tick(counts_per_rev: u32, rate_hz: f64) -> f64 {
    std::f64::consts::TAU * rate_hz / f64::from(counts_per_rev)
}

fn bench_trace(
    name: &'static str,
    rate_hz: u32,
    trace: &Trace,
    first: usize,
    counts_per_rev: u32,
) -> BenchTrace {
    let range = first..trace.len().min(first + SAMPLES);
    let scale = counts_per_tick(counts_per_rev, f64::from(rate_hz));
    let truth = trace.true_omega.as_ref();
    BenchTrace {
        name,
        rate_hz,
        samples: range
            .clone()
            .map(|k| sample(EVERYTHING, trace, k))
            .collect(),
        truth: truth.map(|omega| omega[range].iter().map(|w| w / scale).collect()),
        scale,
    }
}
