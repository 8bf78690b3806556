//! Every type of observer and the M/T method, and the samples that they are tried with.

use estimator_core::{
    Amps, ClockTicks, Count, CoupledMotor, Edge, Hertz, MOverT, ObserverDesign, Sample, Signals,
    VelocityEstimator,
};

use super::{CLOCK, RATES, UNSURE};
use crate::motion::{Draws, Motion};

type Runner = Box<dyn Fn(&[Sample]) -> Vec<f32> + Send + Sync>;

pub(super) struct Case {
    pub(super) name: String,
    pub(super) needs: Signals,
    pub(super) run: Runner,
}

pub(super) fn case<E>(name: &str, rate: f64, estimator: E) -> Case
where
    E: VelocityEstimator + Send + Sync + 'static,
{
    Case {
        name: format!("{name} at {rate} Hz"),
        needs: E::NEEDS,
        run: Box::new(move |samples| {
            let mut state = estimator.start(&samples[0]);
            let update = |sample| estimator.update(&mut state, sample).0;
            samples[1..].iter().map(update).collect()
        }),
    }
}

/// Every type of observer, and M/T, at this rate.
pub(super) fn at(rate: f64) -> Vec<Case> {
    let hertz = Hertz(rate);
    let device = CoupledMotor::DCX35L;
    let counts = ObserverDesign::new(&device, hertz, &UNSURE);
    let quantised = ObserverDesign::quantised(&device, hertz, &UNSURE);
    let edges = counts.with_edges(CLOCK);
    let blind = ObserverDesign::blind(&device, hertz, CLOCK, &UNSURE);
    vec![
        case("M/T", rate, MOverT::new(CLOCK, hertz).expect("valid")),
        case("observer", rate, counts.build().expect("valid")),
        case(
            "observer, held",
            rate,
            counts.held().build().expect("valid"),
        ),
        case(
            "observer, quantised",
            rate,
            quantised.build().expect("valid"),
        ),
        case(
            "adaptive, quantised",
            rate,
            quantised.adaptive().build().expect("valid"),
        ),
        case("observer, edges", rate, edges.build().expect("valid")),
        case(
            "observer, edges, held",
            rate,
            edges.held().build().expect("valid"),
        ),
        case(
            "adaptive, held",
            rate,
            counts.held().widely_adaptive().build().expect("valid"),
        ),
        case(
            "adaptive, edges, held",
            rate,
            edges.held().widely_adaptive().build().expect("valid"),
        ),
        case(
            "observer, edges, blind",
            rate,
            blind.build().expect("valid"),
        ),
        case("adaptive", rate, counts.adaptive().build().expect("valid")),
        case(
            "adaptive, edges",
            rate,
            edges.adaptive().build().expect("valid"),
        ),
    ]
}

pub(super) fn everywhere() -> Vec<Case> {
    RATES.iter().flat_map(|&rate| at(rate)).collect()
}

/// The motion with a coupled shaft that follows and an edge wherever a count changed, at a drawn age.
pub(super) fn dressed(motion: &Motion, start: u32, rate: f64, direction: i64) -> Vec<Sample> {
    let mut draws = Draws(77);
    let period = (CLOCK.0 / rate) as u64;
    let (mut edge, mut stamped) = (None, 0u64);
    let mut samples = Vec::new();
    for (tick, (&count, &amps)) in motion.counts.iter().zip(&motion.amps).enumerate() {
        let now = period * (tick as u64 + 1);
        // The same draws whatever the direction.
        let (instant, coupled) = (now - draws.bits() % period, draws.within(3));
        let before = if tick == 0 {
            count
        } else {
            motion.counts[tick - 1]
        };
        if count != before {
            stamped = instant;
            edge = Some(if count > before { count } else { count + 1 });
        }
        let age = ClockTicks(u32::try_from(now - stamped).unwrap_or(u32::MAX));
        let place = |count: i64| ((direction * count) as u32).wrapping_add(start);
        let mut sample = Sample::new(Count(place(count)))
            .with_coupled(Count(place(4 * count + coupled)))
            .with_current(Amps::new(direction as f32 * amps));
        if let Some(boundary) = edge {
            // Boundary e lies between counts e - 1 and e: turned round, it is 1 - e.
            let turned = if direction < 0 {
                boundary - 1
            } else {
                boundary
            };
            sample = sample.with_edge(Edge {
                boundary: Count(place(turned)),
                age,
            });
        }
        samples.push(sample);
    }
    samples
}

pub(super) fn bits(values: &[f32]) -> Vec<u32> {
    // Adding zero turns the negative zero into the positive one.
    values.iter().map(|value| (value + 0.0).to_bits()).collect()
}
