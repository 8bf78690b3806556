//! Any parameters into every design.

use stress::course::{Course, EDGE_CLOCK_HZ};
use stress::designs::{design, kinds};

use crate::bytes::Bytes;

/// Ticks an accepted design has to survive.
const TICKS: usize = 300;

/// Tries designs whose rates and parameters are any 64 bits of `data`, read as floats.
///
/// # Panics
/// If a design is accepted and its output is no finite number, or core and twin disagree.
pub fn run(data: &[u8]) {
    let mut bytes = Bytes(data);
    while let Some(kind) = bytes.byte() {
        let (Some(rate), Some(counts), Some(parameter)) = (bytes.f64(), bytes.u32(), bytes.f64())
        else {
            return;
        };
        try_one(kind, rate, counts, parameter);
    }
}

/// Tries one design: the kind by its number, the rate in Hz, the counts per revolution, and the first
/// parameter.
///
/// # Panics
/// As [`run`].
pub fn try_one(kind: u8, rate: f64, counts: u32, parameter: f64) {
    let kinds = kinds();
    let kind = kinds[usize::from(kind) % kinds.len()];
    let Ok(mut pair) = design(kind, rate, counts, parameter) else {
        return;
    };
    let mut course = course(u64::from(counts), rate);
    pair.start(&course.shown());
    for _ in 0..TICKS {
        if course.is_over() {
            course.move_on();
        }
        let (output, _) = pair.update(&course.step());
        assert!(
            output.is_finite(),
            "{kind}, {rate} Hz, {counts} counts, {parameter:e}: {output}"
        );
        assert_eq!(
            pair.fault(),
            None,
            "{kind}, {rate} Hz, {counts} counts, {parameter:e}"
        );
    }
}

/// The course of a seed at the rate of a design, within a second and one tick of the edge clock.
fn course(seed: u64, rate_hz: f64) -> Course {
    Course::new(seed, rate_hz.clamp(1.0, EDGE_CLOCK_HZ))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ages_of_edges_are_within_a_period_of_the_rate() {
        for rate in [0.1, 1.0, 100.0, 1e5, EDGE_CLOCK_HZ, 1e12] {
            let period = EDGE_CLOCK_HZ / rate.clamp(1.0, EDGE_CLOCK_HZ);
            let mut course = course(1, rate);
            let mut oldest = 0;
            for _ in 0..10_000 {
                if course.is_over() {
                    course.move_on();
                }
                let before = course.shown().large;
                let shown = course.step();
                if let Some((_, age)) = shown.edge.filter(|_| shown.large != before) {
                    oldest = oldest.max(age);
                }
            }
            // Of hundreds of ages that are drawn uniformly, the largest is in the last tenth.
            let oldest = f64::from(oldest + 1);
            assert!(
                (0.9 * period..=period).contains(&oldest),
                "{rate} Hz: {oldest} of {period}"
            );
        }
    }
}
