//! Any parameters into every design.

use stress::course::Course;
use stress::designs::{design, kinds};

use crate::bytes::Bytes;

/// Ticks an accepted design has to survive.
const TICKS: usize = 300;

/// Designs with the parameters in `data`, over any bits of a float.
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

/// The same with numbers of a likely size.
///
/// # Panics
/// As [`run`].
pub fn try_one(kind: u8, rate: f64, counts: u32, parameter: f64) {
    let kinds = kinds();
    let kind = kinds[usize::from(kind) % kinds.len()];
    let Ok(mut pair) = design(kind, rate, counts, parameter) else {
        return;
    };
    let mut course = Course::new(u64::from(counts), 1000.0);
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
