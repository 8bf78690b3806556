//! The memory that the image shares with the emulator.
//!
//! The image says that it is ready by calling `ready`; the emulator answers by writing here. All
//! words are atomic, so that no access is optimised away and none needs `unsafe`.

use core::sync::atomic::{AtomicU32, Ordering::Relaxed};

use estimator_core::{Amps, ClockTicks, Count, Edge, Sample};

/// Most samples of a trace.
pub const SAMPLES: usize = 4096;

/// Words of a sample: large, small, current (f32), edge's boundary, edge's age plus one or zero.
pub const WORDS: usize = 5;

/// Index of the subject to run, samples to run it over.
pub static JOB: [AtomicU32; 2] = [const { AtomicU32::new(0) }; 2];

/// The trace.
pub static TRACE: [AtomicU32; SAMPLES * WORDS] = [const { AtomicU32::new(0) }; SAMPLES * WORDS];

/// The velocities of the last run, f32.
pub static VELOCITIES: [AtomicU32; SAMPLES] = [const { AtomicU32::new(0) }; SAMPLES];

/// A sample as it lies in the trace.
#[must_use]
pub fn encode(sample: &Sample) -> [u32; WORDS] {
    let edge = sample.edge.unwrap_or_default();
    let age = sample.edge.map_or(0, |edge| edge.age.0.saturating_add(1));
    let current = sample.current.get().to_bits();
    [
        sample.count.0,
        sample.coupled.0,
        current,
        edge.boundary.0,
        age,
    ]
}

/// The sample that lies there so.
#[must_use]
pub fn decode(words: [u32; WORDS]) -> Sample {
    let [large, small, current, boundary, age] = words;
    Sample {
        count: Count(large),
        coupled: Count(small),
        current: Amps::new(f32::from_bits(current)),
        edge: age.checked_sub(1).map(|age| Edge {
            boundary: Count(boundary),
            age: ClockTicks(age),
        }),
    }
}

/// Runs the job that was asked for.
pub fn run_job() {
    let [subject, samples] = JOB.each_ref().map(|word| word.load(Relaxed) as usize);
    let Some(subject) = crate::SUBJECTS.get(subject) else {
        return;
    };
    let mut trace = TRACE
        .as_chunks()
        .0
        .iter()
        .take(samples)
        .map(|words: &[_; WORDS]| {
            decode(words.each_ref().map(|word: &AtomicU32| word.load(Relaxed)))
        });
    let mut out = VELOCITIES.iter();
    (subject.run)(&mut trace, &mut |velocity| {
        if let Some(word) = out.next() {
            word.store(velocity.to_bits(), Relaxed);
        }
    });
}
