//! Frequency response from commanded torque to rendered torque, measured with a multisine on a
//! clamped handle.
//!
//! The scene commands a constant torque, so that the large motor never reverses, plus sines whose
//! frequencies are multiples of [`1 / PERIOD_S`](PERIOD_S). The torque on the hand is sampled at
//! every step of the plant, also between ticks. Gain and phase are those of the mean over
//! [`PERIODS`] periods, relative to the commanded sines. Coherence is the share of the power at a
//! frequency that repeats from period to period; the rest is noise.

use std::f64::consts::{FRAC_1_SQRT_2, TAU};

use estimator_core::{Amps, Count, Hertz, Sample, Skip};
use haptic_control::{Controller, Handle, LoopPoles, NewtonMetres, Radians, Rig, Scene, Wanted};
use rustfft::FftPlanner;
use rustfft::num_complex::Complex;

use super::compare::{LoopSettings, device};
use super::run::estimator;
use super::{Fingertip, REFERENCE};
use crate::parallel::in_order;
use catalogue::estimators::{Estimator, Kind};
use catalogue::parameters::PlantKind;
use simulation::device::Device;
use simulation::encoder::{DiscErrors, Encoder};
use simulation::plant::{Grip, Plant, steps_per_tick};
use terminal::failure::Failure;

/// Length of a period, s; the lowest frequency is its inverse.
pub const PERIOD_S: f64 = 0.5;
/// Number of averaged periods.
pub const PERIODS: usize = 8;
/// Number of periods before the averaged ones.
const SETTLE: usize = 4;
/// Speed of the large motor under the constant torque, turns/s. Errors that repeat once a turn have
/// frequencies between the sines and average out over the periods.
const TURNS_PER_S: f64 = 1.5;
/// Sines per decade.
const PER_DECADE: f64 = 13.0;
/// Highest frequency of a sine, as a fraction of the rate and in Hz: the lower one holds.
const HIGHEST: (f64, f64) = (0.45, 3000.0);

/// Response at one frequency.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Response {
    /// Frequency, Hz.
    pub hz: f64,
    /// Torque on the hand over commanded torque.
    pub gain: f64,
    /// Phase, degrees, unwrapped from the lowest frequency on; a lag is negative.
    pub phase_deg: f64,
    /// Share of the power that repeats from period to period, 0 to 1.
    pub coherence: f64,
}

/// Responses at one rate.
#[derive(Clone, Debug)]
pub struct Swept {
    /// Control rate, Hz.
    pub rate_hz: f64,
    /// Plant.
    pub plant: PlantKind,
    /// Estimator that closed the loop, and its responses in order of frequency.
    pub runs: Vec<(&'static str, Vec<Response>)>,
}

/// Lowest frequency at which the gain has fallen by 3 dB, Hz: the first one if it is below from there on. `None`
/// if it never falls so far.
#[must_use]
pub fn bandwidth_hz(responses: &[Response]) -> Option<f64> {
    let first = responses.first()?;
    if first.gain < FRAC_1_SQRT_2 {
        return Some(first.hz);
    }
    let pair = responses
        .windows(2)
        .find(|pair| pair[0].gain >= FRAC_1_SQRT_2 && pair[1].gain < FRAC_1_SQRT_2)?;
    let part = (pair[0].gain - FRAC_1_SQRT_2) / (pair[0].gain - pair[1].gain);
    Some(pair[0].hz * (pair[1].hz / pair[0].hz).powf(part))
}

/// Measures the response with every estimator in the loop, then with the reference encoder.
///
/// # Errors
/// [`Failure::Input`] where estimator or loop cannot be built.
pub fn sweep(settings: &LoopSettings, rate_hz: f64, plant: PlantKind) -> Result<Swept, Failure> {
    let device = device(settings, plant);
    let build = |kind: &Kind, counts| estimator(kind, settings, counts, rate_hz, plant);
    let handle = build(settings.handle, device.stages.small.counts_per_rev)?;
    let mut candidates = Vec::new();
    for kind in &settings.common.estimators {
        let counts = device.stages.large.counts_per_rev;
        candidates.push((kind.name, build(kind, counts)?, counts));
    }
    let counts = device.reference.counts_per_rev;
    let usual = Kind::named(super::compare::DEFAULT_ESTIMATOR)?;
    candidates.push((REFERENCE, build(usual, counts)?, counts));
    let rig = SweepRig::new(&device, rate_hz);
    let runs = in_order(&candidates, |(name, large, counts)| {
        Ok::<_, Failure>((*name, rig.run(large, &handle, *counts)?))
    })?;
    Ok(Swept {
        rate_hz,
        plant,
        runs,
    })
}

/// Scene that repeats the torques of one period, one per tick.
struct Sweep(Vec<f32>);

impl Scene for Sweep {
    type Velocity = Skip;
    type Acceleration = Skip;
    type Continuous = Wanted;
    type Transient = Wanted;
    /// Number of the tick.
    type State = usize;

    fn start(&self, _: Radians) -> usize {
        0
    }

    fn torque(&self, tick: &mut usize, _: &Handle<()>) -> NewtonMetres {
        let torque = self.0[*tick % self.0.len()];
        *tick += 1;
        NewtonMetres(torque)
    }
}

/// Plant, controller and multisine of one sweep.
struct SweepRig<'a> {
    device: &'a Device,
    rate_hz: f64,
    /// Ticks per period.
    ticks: usize,
    /// For each sine its cycles per period and its amplitude with phase, N.m.
    lines: Vec<(usize, Complex<f64>)>,
    bias: f64,
}

impl<'a> SweepRig<'a> {
    fn new(device: &'a Device, rate_hz: f64) -> Self {
        let ticks = (PERIOD_S * rate_hz).round() as usize;
        let base_hz = rate_hz / ticks as f64;
        let most = (HIGHEST.0 * rate_hz).min(HIGHEST.1) / base_hz;
        let mut numbers: Vec<usize> = (0..)
            .map(|i| 10_f64.powf(f64::from(i) / PER_DECADE))
            .take_while(|number| *number <= most)
            .map(|number| number.round() as usize)
            .collect();
        numbers.dedup();
        let fingertip = Fingertip::new(device);
        // The RMS of all sines together is the fingertip's threshold. Schroeder phases keep the
        // peaks low.
        let rms = fingertip.threshold_mn / fingertip.mn_per_nm;
        let amplitude = rms * (2.0 / numbers.len() as f64).sqrt();
        let phase = |i: usize| -std::f64::consts::PI * (i * i) as f64 / numbers.len() as f64;
        Self {
            device,
            rate_hz,
            ticks,
            lines: (numbers.iter().enumerate())
                .map(|(i, &number)| (number, Complex::from_polar(amplitude, phase(i))))
                .collect(),
            bias: device.stages.damping * TAU * TURNS_PER_S,
        }
    }

    fn wanted(&self) -> Vec<f32> {
        let torque = |tick: usize| {
            let sines = self.lines.iter().map(|(number, amplitude)| {
                let turn = (number * tick % self.ticks) as f64 / self.ticks as f64;
                (amplitude * Complex::from_polar(1.0, TAU * turn)).re
            });
            (self.bias + sines.sum::<f64>()) as f32
        };
        (0..self.ticks).map(torque).collect()
    }

    fn run(
        &self,
        large: &Estimator,
        handle: &Estimator,
        counts_per_rev: u32,
    ) -> Result<Vec<Response>, Failure> {
        let rate = Hertz(self.rate_hz);
        let refused = |error: &dyn std::fmt::Display| {
            Failure::Input(format!("control at {} Hz: {error}", self.rate_hz))
        };
        let mut rig = Rig::new(&self.device.stages, rate, LoopPoles::DEFAULT)
            .map_err(|error| refused(&error))?;
        rig.large_scale =
            estimator_core::Scale::new(counts_per_rev, rate).map_err(|error| refused(&error))?;
        let controller = Controller::new(Sweep(self.wanted()), large.clone(), handle.clone(), &rig);

        let period = 1.0 / self.rate_hz;
        let steps = steps_per_tick(period);
        let step = period / f64::from(steps);
        let mut plant = Plant::new(self.device, step);
        let mut encoder = Encoder::new(counts_per_rev, 0, 0.5, 0.0, DiscErrors::none());
        let mut sample = Sample::default();
        let mut state = controller.start(&sample);
        let mut felt = Vec::with_capacity(PERIODS * self.ticks * steps as usize);
        for tick in 0..(SETTLE + PERIODS) * self.ticks {
            let currents = controller.step(&mut state, &sample).currents;
            plant.command(currents.large.get().into(), currents.small.get().into());
            for _ in 0..steps {
                if tick >= SETTLE * self.ticks {
                    let torque = plant.handle_torque(&Grip::Clamped, 0.0);
                    felt.push(Complex::new(torque, 0.0));
                }
                let from = plant.large();
                plant.step(&Grip::Clamped, 0.0, 0.0);
                encoder.follow(from, plant.large(), step, &mut ());
            }
            let current = Amps::new(currents.large.get());
            sample = Sample::new(Count(encoder.count())).with_current(current);
        }
        Ok(self.responses(felt))
    }

    fn responses(&self, mut felt: Vec<Complex<f64>>) -> Vec<Response> {
        let period = felt.len() / PERIODS;
        let fft = FftPlanner::new().plan_fft_forward(period);
        fft.process(&mut felt);
        let mut last_phase = 0.0;
        let of_line = |&(number, amplitude): &(usize, Complex<f64>)| {
            let ratio = |of: usize| felt[of * period + number] * 2.0 / period as f64 / amplitude;
            let mean: Complex<f64> = (0..PERIODS).map(ratio).sum::<Complex<f64>>() / PERIODS as f64;
            let power = (0..PERIODS).map(|of| ratio(of).norm_sqr()).sum::<f64>() / PERIODS as f64;
            let turns = (mean.arg().to_degrees() - last_phase) / 360.0;
            last_phase += 360.0 * (turns - turns.round());
            Response {
                hz: number as f64 * self.rate_hz / self.ticks as f64,
                gain: mean.norm(),
                phase_deg: last_phase,
                coherence: mean.norm_sqr() / power,
            }
        };
        self.lines.iter().map(of_line).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sines_of_a_sweep_have_the_threshold_of_a_fingertip_together() {
        let device = Device::default();
        for rate_hz in [1e3, 11_600.0] {
            let rig = SweepRig::new(&device, rate_hz);
            let wanted = rig.wanted();
            let squares = wanted
                .iter()
                .map(|torque| (f64::from(*torque) - rig.bias).powi(2));
            let rms = (squares.sum::<f64>() / wanted.len() as f64).sqrt();
            let fingertip = Fingertip::new(&device);
            let part = rms * fingertip.mn_per_nm / fingertip.threshold_mn;
            assert!((part - 1.0).abs() < 1e-3, "{rate_hz} Hz: {part}");
        }
    }

    /// A torque that has the commanded sine in each second period alone, with a lag of a quarter of its cycle.
    #[test]
    fn coherence_is_the_share_of_the_power_that_repeats() {
        let device = Device::default();
        let rig = SweepRig::new(&device, 1000.0);
        let (number, amplitude) = rig.lines[3];
        let of = |k: usize| {
            let turn = (number * k) as f64 / rig.ticks as f64 - 0.25;
            let there = if (k / rig.ticks).is_multiple_of(2) {
                1.0
            } else {
                0.0
            };
            there * (amplitude * Complex::from_polar(1.0, TAU * turn)).re
        };
        let felt = (0..PERIODS * rig.ticks).map(|k| Complex::new(of(k), 0.0));
        let response = rig.responses(felt.collect())[3];
        assert!((response.hz - number as f64 / PERIOD_S).abs() < 1e-9);
        // Half of the mean amplitude, and a quarter of the power of the half of the periods.
        assert!((response.gain - 0.5).abs() < 1e-9, "{response:?}");
        assert!((response.coherence - 0.5).abs() < 1e-9, "{response:?}");
        assert!((response.phase_deg + 90.0).abs() < 1e-6, "{response:?}");
    }

    /// A torque that is two ticks late: at 450 Hz of 1 kHz by 324 degrees.
    #[test]
    fn phase_of_a_delay_falls_beyond_half_a_turn() {
        let device = Device::default();
        let rig = SweepRig::new(&device, 1000.0);
        let wanted = rig.wanted();
        let late = |k: usize| f64::from(wanted[(k + rig.ticks - 2) % rig.ticks]);
        let felt = (0..PERIODS * rig.ticks).map(|k| Complex::new(late(k), 0.0));
        for response in rig.responses(felt.collect()) {
            let expected = -360.0 * response.hz * 2e-3;
            assert!(
                (response.phase_deg - expected).abs() < 0.1,
                "{response:?}: {expected}"
            );
        }
    }

    #[test]
    fn bandwidth_is_the_first_frequency_below_3_db() {
        let of = |gains: &[f64]| {
            let responses = gains.iter().enumerate().map(|(i, &gain)| Response {
                hz: 10_f64.powi(i as i32),
                gain,
                phase_deg: 0.0,
                coherence: 1.0,
            });
            bandwidth_hz(&responses.collect::<Vec<_>>())
        };
        assert_eq!(of(&[1.0, 0.9]), None);
        assert_eq!(of(&[]), None);
        assert_eq!(of(&[0.6, 0.9, 0.6]), Some(1.0));
        // Halfway between the gains, in the logarithm of the frequency.
        let half = of(&[1.0, FRAC_1_SQRT_2 + 0.1, FRAC_1_SQRT_2 - 0.1, 0.9, 0.1]);
        assert!(
            (half.unwrap() / 10_f64.powf(1.5) - 1.0).abs() < 1e-9,
            "{half:?}"
        );
    }
}
