//! Power spectral density by Welch's method, and the power of a signal within a band.
//!
//! Segments of [`SEGMENT_S`] overlap by half and have a Hann window; bins are 4 Hz wide at every
//! sample rate. The density is normalised by the window's power, so that its sum is the signal's mean
//! square. With overlapping segments every part of the trace has the same weight, unlike with one
//! window over the whole trace. A tail shorter than half a segment is left out.

use std::f64::consts::TAU;
use std::sync::Arc;

use rustfft::num_complex::Complex;
use rustfft::{Fft, FftPlanner};

/// Length of one segment, s.
pub const SEGMENT_S: f64 = 0.25;

/// A one-sided power spectral density.
#[derive(Clone, Debug, PartialEq)]
pub struct Density {
    /// Distance between bins, Hz; bin `i` is at `i * bin_hz`.
    pub bin_hz: f64,
    /// Density of each bin from 0 Hz to half the sample rate, squared unit of the signal per Hz.
    pub power_per_hz: Vec<f64>,
}

impl Density {
    /// RMS of the signal's components from `low` to `high`, Hz, in the signal's unit; `None` unless `low` is
    /// below half the sample rate.
    ///
    /// A bin at the limit of the band has the weight of its part inside.
    #[must_use]
    pub fn rms_within(&self, [low, high]: [f64; 2]) -> Option<f64> {
        let nyquist = self.bin_hz * (self.power_per_hz.len() - 1) as f64;
        if low >= nyquist {
            return None;
        }
        let mean_square: f64 = self
            .power_per_hz
            .iter()
            .enumerate()
            .map(|(i, &density)| {
                let left = ((i as f64 - 0.5) * self.bin_hz).max(low).max(0.0);
                let right = ((i as f64 + 0.5) * self.bin_hz).min(high).min(nyquist);
                density * (right - left).max(0.0)
            })
            .sum();
        Some(mean_square.sqrt())
    }
}

/// Welch's method for one sample rate, with the prepared transform and window.
pub struct Welch {
    rate_hz: f64,
    window: Vec<f64>,
    fft: Arc<dyn Fft<f64>>,
}

impl Welch {
    /// Prepares the method for signals sampled at `rate_hz`.
    #[must_use]
    pub fn new(rate_hz: f64) -> Self {
        // An even length has a bin at half the rate.
        let segment = 2 * ((0.5 * SEGMENT_S * rate_hz).round() as usize).max(4);
        Self {
            rate_hz,
            window: (0..segment)
                .map(|i| 0.5 - 0.5 * (TAU * i as f64 / segment as f64).cos())
                .collect(),
            fft: FftPlanner::new().plan_fft_forward(segment),
        }
    }

    /// The density of `signal`; `None` if it is shorter than one segment.
    ///
    /// Two real segments are the real and the imaginary part of one complex transform. The sum of
    /// their powers at a frequency is half of the transform's power at this frequency and its
    /// negative.
    #[must_use]
    pub fn density(&self, signal: &[f64]) -> Option<Density> {
        let segment = self.window.len();
        let half = segment / 2;
        if signal.len() < segment {
            return None;
        }
        let count = (signal.len() - segment) / half + 1;
        let mut powers = vec![0.0; half + 1];
        let mut buffer = vec![Complex::default(); segment];
        let mut scratch = vec![Complex::default(); self.fft.get_inplace_scratch_len()];
        for first in (0..count).step_by(2) {
            let real = &signal[first * half..][..segment];
            if first + 1 < count {
                let imaginary = &signal[(first + 1) * half..][..segment];
                for (i, point) in buffer.iter_mut().enumerate() {
                    let weight = self.window[i];
                    *point = Complex::new(weight * real[i], weight * imaginary[i]);
                }
            } else {
                for (i, point) in buffer.iter_mut().enumerate() {
                    *point = Complex::new(self.window[i] * real[i], 0.0);
                }
            }
            self.fft.process_with_scratch(&mut buffer, &mut scratch);
            powers[0] += buffer[0].norm_sqr();
            powers[half] += buffer[half].norm_sqr();
            for k in 1..half {
                powers[k] += 0.5 * (buffer[k].norm_sqr() + buffer[segment - k].norm_sqr());
            }
        }
        // A one-sided density has a factor of 2. The first and last bin are half as wide, so that
        // the factor holds for them too.
        let window_power: f64 = self.window.iter().map(|w| w * w).sum();
        let scale = 2.0 / (count as f64 * window_power * self.rate_hz);
        Some(Density {
            bin_hz: self.rate_hz / segment as f64,
            power_per_hz: powers.into_iter().map(|power| scale * power).collect(),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand_distr::{Distribution, StandardNormal};
    use rand_xoshiro::Xoshiro256PlusPlus;
    use rand_xoshiro::rand_core::SeedableRng;

    fn sine(rate_hz: f64, hz: f64, n: usize) -> Vec<f64> {
        (0..n)
            .map(|i| (TAU * hz * i as f64 / rate_hz).sin())
            .collect()
    }

    #[test]
    fn sine_has_its_power_at_its_frequency_at_every_rate() {
        for rate_hz in [1000.0, 10_000.0, 11_600.0] {
            let welch = Welch::new(rate_hz);
            let density = welch
                .density(&sine(rate_hz, 200.0, 4 * rate_hz as usize))
                .unwrap();
            assert!((density.bin_hz - 4.0).abs() < 1e-9);
            let highest = (0..density.power_per_hz.len())
                .max_by(|&a, &b| density.power_per_hz[a].total_cmp(&density.power_per_hz[b]));
            assert_eq!(highest, Some(50), "200 Hz at {rate_hz} Hz");
            let rms = |band| density.rms_within(band).unwrap();
            assert!((rms([50.0, 500.0]) - 0.5_f64.sqrt()).abs() < 1e-6);
            assert!((rms([0.0, rate_hz]) - 0.5_f64.sqrt()).abs() < 1e-6);
            assert!(rms([220.0, 500.0]) < 1e-3, "{}", rms([220.0, 500.0]));
        }
    }

    #[test]
    fn white_noise_is_flat_at_two_variances_over_the_rate() {
        let rate_hz = 1000.0;
        let mut draws = Xoshiro256PlusPlus::seed_from_u64(7);
        let noise: Vec<f64> = (0..200_000)
            .map(|_| {
                let value: f64 = StandardNormal.sample(&mut draws);
                3.0 * value
            })
            .collect();
        let density = Welch::new(rate_hz).density(&noise).unwrap();
        // 1600 half-overlapping segments: the error of a bin is about 3 %.
        for (i, power) in density.power_per_hz.iter().enumerate().skip(1) {
            let relative = power / (2.0 * 9.0 / rate_hz);
            let spread = if i == density.power_per_hz.len() - 1 {
                0.2
            } else {
                0.15
            };
            assert!((relative - 1.0).abs() < spread, "bin {i}: {relative}");
        }
        let within = density.rms_within([50.0, 300.0]).unwrap();
        assert!((within - 3.0 * 0.5_f64.sqrt()).abs() < 0.03, "{within}");
    }

    #[test]
    fn last_of_an_odd_number_of_segments_is_included() {
        let (rate_hz, hz) = (1000.0, 100.0);
        for n in [250, 374, 375, 500, 625] {
            let density = Welch::new(rate_hz).density(&sine(rate_hz, hz, n)).unwrap();
            let rms = density.rms_within([0.0, 500.0]).unwrap();
            assert!((rms - 0.5_f64.sqrt()).abs() < 1e-6, "{n} samples: {rms}");
        }
    }

    /// The first and the last bin, which are half as wide as the others.
    #[test]
    fn mean_and_alternation_have_their_power_at_the_ends_of_the_spectrum() {
        let constant = vec![3.0; 1000];
        let alternating: Vec<f64> = (0..1000)
            .map(|i| 2.0 * f64::from(1 - 2 * (i % 2)))
            .collect();
        for (signal, band, wanted) in [
            (constant, [0.0, 6.0], 3.0),
            (alternating, [494.0, 500.0], 2.0),
        ] {
            let density = Welch::new(1000.0).density(&signal).unwrap();
            let rms = density.rms_within(band).unwrap();
            assert!((rms - wanted).abs() < 1e-9, "{band:?} Hz: {rms}");
        }
    }

    #[test]
    fn density_is_none_if_the_signal_is_too_short_or_the_rate_too_low() {
        assert_eq!(Welch::new(1000.0).density(&[0.0; 249]), None);
        let slow = Welch::new(100.0).density(&[0.0; 1000]).unwrap();
        assert_eq!(slow.rms_within([50.0, 500.0]), None);
        assert_eq!(slow.rms_within([40.0, 500.0]), Some(0.0));
    }

    #[test]
    fn density_is_the_mean_of_those_of_half_overlapping_segments() {
        let welch = Welch::new(1000.0);
        // Louder from segment to segment, so that none can stand for another.
        let wave = sine(1000.0, 100.0, 500);
        let signal: Vec<f64> = wave.iter().enumerate().map(|(i, x)| i as f64 * x).collect();
        let starts = [0, 125, 250];
        let parts = starts.map(|start| welch.density(&signal[start..start + 250]).unwrap());
        for (count, samples) in [(1, 374), (2, 375), (3, 500)] {
            let whole = welch.density(&signal[..samples]).unwrap();
            for (bin, power) in whole.power_per_hz.iter().enumerate() {
                let sum: f64 = parts[..count]
                    .iter()
                    .map(|part| part.power_per_hz[bin])
                    .sum();
                let mean = sum / count as f64;
                assert!(
                    (power - mean).abs() <= 1e-9 * mean.max(1.0),
                    "{count}: bin {bin}"
                );
            }
        }
    }
}
