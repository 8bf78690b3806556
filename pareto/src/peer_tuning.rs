//! Tuning of the other libraries' filters like `host-sim tune`: same scenarios, seeds and cost. A
//! filter with the model of an estimator of the catalogue uses the parameters of that estimator.

use std::fmt::Write as _;

use bench_image::Measured;
use bench_image::peers::{IdspLowPass, IdspPll};
use catalogue::estimators::sample;
use device_files::to_digits;
use estimator_core::{Hertz, Signals};
use experiments::compare::interval;
use experiments::tune::{FILTER_SECONDS, FILTER_SEEDS, FIRST_SEED, RMS_WEIGHT};
use scoring::score::{Truth, Wanted};
use simulation::device::Device;
use simulation::scenario::{Role, ScenarioName};
use simulation::simulate::simulate;
use simulation::trace::{Columns, Trace};

use crate::traces::{COUNTS_PER_REV, RATES_HZ, counts_per_tick};

/// Points of a grid, and number of grids, each between the neighbours of the best point.
const GRID: usize = 25;
const ROUNDS: usize = 3;

/// A simulated trace and the scores' reference.
type Track<'a> = (&'a Trace, Truth<'a>);

fn traces(device: &Device, rate_hz: f64) -> Result<Vec<Trace>, String> {
    let seeds = FIRST_SEED..FIRST_SEED + FILTER_SEEDS;
    let runs = ScenarioName::of(&[Role::Tuning])
        .into_iter()
        .flat_map(|scenario| seeds.clone().map(move |seed| (scenario, seed)));
    let columns = Columns::default();
    runs.map(|(scenario, seed)| simulate(device, scenario, rate_hz, seed, FILTER_SECONDS, columns))
        .collect()
}

fn truth<'a>(device: &Device, trace: &'a Trace) -> Result<Truth<'a>, String> {
    let wanted = Wanted {
        rms: true,
        distance: true,
        ..Wanted::NONE
    };
    let omega = trace.true_omega.as_deref().unwrap_or_default();
    Truth::new(omega, trace.rate_hz, interval(device), wanted)
}

/// The cost that `host-sim tune` minimises.
fn cost(estimator: &impl Measured, scale: f64, tracks: &[Track<'_>]) -> f64 {
    let of = |(trace, truth): &Track<'_>| {
        let sample = |k| sample(Signals::COUNT, trace, k);
        let mut state = estimator.start(&sample(0));
        let rest = (1..trace.len()).map(|k| estimator.update(&mut state, &sample(k)));
        let estimates: Vec<f32> = std::iter::once(0.0)
            .chain(rest.map(|velocity| (f64::from(velocity) * scale) as f32))
            .collect();
        let score = truth.score(&estimates);
        score.distance_rad_s.unwrap_or(f64::INFINITY)
            + RMS_WEIGHT * score.rms_rad_s.unwrap_or(f64::INFINITY)
    };
    tracks.iter().map(of).sum::<f64>() / tracks.len() as f64
}

/// The frequency with the smallest cost between two fractions of the rate, Hz, with three digits.
fn best<E: Measured>(
    make: fn(Hertz, Hertz) -> E,
    [mut low, mut high]: [f64; 2],
    rate: Hertz,
    tracks: &[Track<'_>],
) -> f64 {
    let scale = counts_per_tick(COUNTS_PER_REV, rate.0);
    let mut best = low;
    for _ in 0..ROUNDS {
        let step = (high / low).powf(1.0 / (GRID - 1) as f64);
        let costs = (0..GRID).map(|k| {
            let share = low * step.powi(k as i32);
            let estimator = make(Hertz(share * rate.0), rate);
            (cost(&estimator, scale, tracks), share)
        });
        let least = costs.min_by(|a, b| a.0.total_cmp(&b.0));
        best = least.map_or(low, |(_, share)| share);
        (low, high) = (best / step, best * step);
    }
    to_digits(best * rate.0, 3)
}

/// One line per rate with the parameters for `bench-image/src/estimators.rs`.
///
/// # Errors
/// One line on a trace that cannot be simulated.
pub(crate) fn report() -> Result<String, String> {
    let device = Device::default();
    let mut text = String::new();
    for rate_hz in RATES_HZ {
        let rate = Hertz(f64::from(rate_hz));
        let traces = traces(&device, rate.0)?;
        let tracks: Result<Vec<_>, String> = traces
            .iter()
            .map(|trace| Ok((trace, truth(&device, trace)?)))
            .collect();
        let tracks = tracks?;
        // As far as the loop is stable, and as the low-pass's gain fits.
        let pll = best(IdspPll::new, [1e-4, 0.1], rate, &tracks);
        let low_pass = best(IdspLowPass::new, [1e-3, 0.159], rate, &tracks);
        // Writing to a string cannot fail.
        let _ = writeln!(
            text,
            "{rate_hz} Hz: idsp: pll {pll} Hz, idsp: low-pass {low_pass} Hz"
        );
    }
    Ok(text)
}
