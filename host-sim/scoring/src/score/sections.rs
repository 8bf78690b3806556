//! Scores of a long trace from those of its sections.

use std::collections::BTreeMap;

use super::{Score, Truth};

/// Scores of one estimate of a trace that is scored in sections, so that no more than a section is in
/// memory.
///
/// The scores of a single section are its own. Those of several sections are: means of squares for
/// the RMS error, its force and the noise, means for distances, shares and chatter, each section
/// weighted by its scored samples; the largest of the largest errors; the 99th percentile from classes
/// of errors that are 0.4 % wide, so within 0.2 %; for the delay the mean weighted by the squared
/// slope of the truth, which is the least-squares shift of small delays.
#[derive(Clone, Debug, Default)]
pub struct Sections {
    sections: Vec<Section>,
    /// Number of errors by magnitude.
    errors: BTreeMap<u32, u64>,
}

/// The scores of a section, and their weights.
#[derive(Clone, Copy, Debug)]
struct Section {
    score: Score,
    scored: f64,
    in_transients: f64,
    slope: f64,
}

/// Bits of an error's magnitude in f32 that do not distinguish classes; eight bits of the mantissa do.
const SHARED_BITS: u32 = 23 - 8;

impl Sections {
    /// Adds a section with its `score`, which has all fields that depend on the section alone.
    ///
    /// `several` states whether the trace has other sections.
    ///
    /// # Panics
    /// If the estimate and the truth differ in length.
    pub fn add(&mut self, truth: &Truth, estimate: &[f32], score: Score, several: bool) {
        let in_transients: usize = truth.transients().iter().map(|range| range.len()).sum();
        self.sections.push(Section {
            score,
            scored: truth.scored() as f64,
            in_transients: in_transients as f64,
            slope: truth.slope(),
        });
        if several && score.p99_rad_s.is_some() {
            for error in truth.errors(estimate) {
                let class = (error.abs() as f32).to_bits() >> SHARED_BITS;
                *self.errors.entry(class).or_default() += 1;
            }
        }
    }

    /// The scores of the whole trace.
    #[must_use]
    pub fn score(&self) -> Score {
        let sections = &self.sections;
        if let [only] = sections.as_slice() {
            return only.score;
        }
        let mean = |of: fn(&Score) -> Option<f64>, weight: fn(&Section) -> f64, power: i32| {
            let parts = sections.iter();
            let parts = parts.filter_map(|part| Some((weight(part), of(&part.score)?)));
            let (sum, weights) = parts.fold((0.0, 0.0), |(sum, weights), (weight, value)| {
                (sum + weight * value.powi(power), weights + weight)
            });
            (weights > 0.0).then(|| (sum / weights).powf(1.0 / f64::from(power)))
        };
        let by_samples = |part: &Section| part.scored;
        let non_finite = sections.iter().map(|part| part.score.non_finite).sum();
        // A delay, a noise or a chatter of the finite samples alone would not be that of the trace.
        let finite = |value: Option<f64>| value.filter(|_| non_finite == 0);
        let largest = sections.iter().filter_map(|part| part.score.max_rad_s);
        Score {
            rms_rad_s: mean(|s| s.rms_rad_s, by_samples, 2),
            max_rad_s: largest.reduce(f64::max),
            p99_rad_s: match non_finite {
                0 => self.percentile(0.99),
                _ => (sections.iter().find_map(|part| part.score.p99_rad_s)).map(|_| f64::INFINITY),
            },
            distance_rad_s: mean(|s| s.distance_rad_s, by_samples, 1),
            distance_transient_rad_s: mean(
                |s| s.distance_transient_rad_s,
                |part| part.in_transients,
                1,
            ),
            outside: mean(|s| s.outside, by_samples, 1),
            delay_ms: finite(mean(|s| s.delay_ms, |part| part.slope, 1)),
            noise_rad_s: finite(mean(|s| s.noise_rad_s, by_samples, 2)),
            chatter_rad_s: finite(mean(|s| s.chatter_rad_s, by_samples, 1)),
            force_mn: mean(|s| s.force_mn, by_samples, 2),
            within_2_sigma: mean(|s| s.within_2_sigma, by_samples, 1),
            non_finite,
            ..Score::default()
        }
    }

    /// The percentile `share` of the magnitudes of the errors: the middle of the class with it.
    fn percentile(&self, share: f64) -> Option<f64> {
        let all: u64 = self.errors.values().sum();
        let rank = ((share * all as f64).ceil() as u64).max(1);
        let mut below = 0;
        let class = self.errors.iter().find(|(_, number)| {
            below += **number;
            below >= rank
        });
        class.map(|(class, _)| {
            let end = |class: u32| f64::from(f32::from_bits(class << SHARED_BITS));
            0.5 * (end(*class) + end(class + 1))
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::score::{HapticInterval, Wanted, skipped};

    /// A truth with transients and an estimate with a delay of 3 samples and noise.
    fn signals(samples: usize) -> (Vec<f64>, Vec<f32>) {
        let wave = |k: f64| 20.0 * (k * 0.011).sin() + 8.0 * (k * 0.0031).cos();
        let jump = |k: usize| {
            if (k / 1700).is_multiple_of(2) {
                0.0
            } else {
                6.0
            }
        };
        let truth = (0..samples).map(|k| wave(k as f64) + jump(k)).collect();
        let mut noise = 1_u32;
        let estimate = (0..samples).map(|k| {
            noise = noise.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            let noise = f64::from(noise >> 8) / f64::from(1 << 24) - 0.5;
            (wave(k as f64 - 3.0) + jump(k.saturating_sub(3)) + noise) as f32
        });
        (truth, estimate.collect())
    }

    #[test]
    fn scores_of_sections_are_those_of_the_whole_trace() {
        let (rate_hz, section) = (1000.0, 5000);
        let (truth, estimate) = signals(42_345);
        let interval = HapticInterval::new(0.05, 0.010, 0.070, 0.96e-3);
        let of = |truth| Truth::new(truth, rate_hz, interval, Wanted::ALL).unwrap();
        let whole = of(&truth).score(&estimate);
        let before = skipped(rate_hz);
        let mut sections = Sections::default();
        let mut one = Sections::default();
        one.add(&of(&truth), &estimate, whole, false);
        assert_eq!(one.score(), whole);
        let mut start = 0;
        while start < truth.len() {
            let end = truth.len().min(start + section);
            let from = start.saturating_sub(before);
            let (truth, estimate) = (&truth[from..end], &estimate[from..end]);
            let truth = of(truth);
            sections.add(&truth, estimate, truth.score(estimate), true);
            start = end;
        }
        let merged = sections.score();
        // The remainders: sums in another order, classes of errors, and at a section's end 2 ms of a
        // transient and the samples that no shift compares.
        for (name, near) in [
            ("rms_rad_s", 1e-12),
            ("max_rad_s", 0.0),
            ("p99_rad_s", 2e-3),
            ("distance_rad_s", 1e-12),
            ("distance_transient_rad_s", 0.02),
            ("outside", 1e-12),
            ("delay_ms", 0.02),
            ("noise_rad_s", 0.02),
            ("chatter_rad_s", 1e-3),
            ("force_mn", 1e-12),
        ] {
            let value = |score: &Score| (Score::field(name).unwrap().of)(score).unwrap();
            let (merged, whole) = (value(&merged), value(&whole));
            let away = (merged / whole - 1.0).abs();
            assert!(away <= near, "{name}: {merged}, {whole}");
        }
    }

    #[test]
    fn section_with_a_sample_that_is_not_finite_makes_the_scores_infinite() {
        let (truth, mut estimate) = signals(1000);
        let interval = HapticInterval::new(0.05, 0.010, 0.070, 0.96e-3);
        let truth = Truth::new(&truth, 1000.0, interval, Wanted::ALL).unwrap();
        let mut sections = Sections::default();
        sections.add(&truth, &estimate, truth.score(&estimate), true);
        estimate[500] = f32::NAN;
        sections.add(&truth, &estimate, truth.score(&estimate), true);
        let score = sections.score();
        assert_eq!(score.non_finite, 1);
        for infinite in [score.rms_rad_s, score.max_rad_s, score.p99_rad_s] {
            assert_eq!(infinite, Some(f64::INFINITY));
        }
        let unknown = [score.delay_ms, score.noise_rad_s, score.chatter_rad_s];
        assert_eq!(unknown, [None; 3]);
    }

    /// A section at rest has no delay, and one of twice the speed has four times the weight.
    #[test]
    fn delays_of_sections_are_weighted_with_the_slope_of_the_truth() {
        let interval = HapticInterval::new(0.05, 0.010, 0.070, 0.96e-3);
        let mut sections = Sections::default();
        for (speed, delay_ms) in [(1.0, 3.0), (2.0, 8.0)] {
            let truth: Vec<f64> = (0..1000).map(|k| speed * f64::from(k)).collect();
            let estimate: Vec<f32> = truth.iter().map(|w| *w as f32).collect();
            let truth = Truth::new(&truth, 1000.0, interval, Wanted::ALL).unwrap();
            let score = Score {
                delay_ms: Some(delay_ms),
                ..truth.score(&estimate)
            };
            sections.add(&truth, &estimate, score, true);
        }
        let delay = sections.score().delay_ms.unwrap();
        assert!((delay - 7.0).abs() < 1e-12, "{delay}");
    }

    /// Sections of the same length with one and two transients.
    #[test]
    fn noises_of_sections_are_added_as_squares_and_transients_by_their_samples() {
        let interval = HapticInterval::new(0.05, 0.010, 0.070, 0.96e-3);
        let mut sections = Sections::default();
        for (ends, distance, noise) in [([400, 1000], 1.0, 1.0), ([400, 700], 4.0, 7.0)] {
            let speed = |k: usize| ends.iter().filter(|end| k >= **end).count() as f64;
            let truth: Vec<f64> = (0..1000).map(|k| 5.0 * speed(k)).collect();
            let estimate: Vec<f32> = truth.iter().map(|w| *w as f32).collect();
            let truth = Truth::new(&truth, 1000.0, interval, Wanted::ALL).unwrap();
            let score = Score {
                distance_transient_rad_s: Some(distance),
                noise_rad_s: Some(noise),
                ..truth.score(&estimate)
            };
            sections.add(&truth, &estimate, score, true);
        }
        let score = sections.score();
        // (1 + 2 4) / 3, and the root of (1 + 49) / 2.
        let distance = score.distance_transient_rad_s.unwrap();
        assert!((distance - 3.0).abs() < 1e-12, "{distance}");
        let noise = score.noise_rad_s.unwrap();
        assert!((noise - 5.0).abs() < 1e-12, "{noise}");
    }

    #[test]
    fn share_within_2_sigma_counts_every_scored_sample_once() {
        let interval = HapticInterval::new(0.05, 0.010, 0.070, 0.96e-3);
        let mut sections = Sections::default();
        // 100 samples of each section are its start, so that 900 and 300 are scored.
        for (samples, share) in [(1000, 1.0), (400, 0.6)] {
            let (truth, estimate) = signals(samples);
            let truth = Truth::new(&truth, 1000.0, interval, Wanted::ALL).unwrap();
            let score = Score {
                within_2_sigma: Some(share),
                ..truth.score(&estimate)
            };
            sections.add(&truth, &estimate, score, true);
        }
        let share = sections.score().within_2_sigma.unwrap();
        assert!((share - 0.9).abs() < 1e-12, "{share}");
    }
}
