//! Intended motions of hands, and the scenarios `free-air` and `hold` with zero desired torque.

use super::{
    Drive, EncoderCounts, Scenario, draw,
    servo::{Servo, Tuning},
};
use crate::device::Device;
use crate::plant::{Grip, HandMotion, Pose};
use rand_xoshiro::Xoshiro256PlusPlus;
use std::f64::consts::TAU;

/// Parameters of the loop while a hand moves the handle. The friction that is fed forward takes its
/// direction from a measured velocity, which is noisy near zero.
pub(super) const TUNING: Tuning = Tuning {
    bandwidth_hz: 30.0,
    integral_per_s: 0.0,
    coulomb_at_rad_s: 0.3,
};

/// Amplitude of each of the two sines of a tremor, rad: 0.1 to 0.2 mm at the rim. The friction of
/// the small motor reduces the amplitude of the handle by 1.6 mrad.
const TREMOR_RAD: (f64, f64) = (2.5e-3, 5e-3);

/// Velocity at which Coulomb friction is fed forward in full under a tremor alone, rad/s. With the
/// higher value of [`TUNING`], friction would hold the large motor at rest.
const HOLD_COULOMB_AT: f64 = 0.05;

/// Intended motion of a hand: a sum of sines around a centre.
#[derive(Clone, Debug)]
pub struct Intent {
    period: f64,
    centre: f64,
    sines: Vec<Sine>,
    reached: Option<(u64, Pose)>,
}

#[derive(Clone, Copy, Debug)]
struct Sine {
    amplitude: f64,
    rad_per_s: f64,
    phase: f64,
}

impl Intent {
    /// A hand at rest at the angle `centre` (rad), for a control period in s.
    pub const fn about(centre: f64, period_s: f64) -> Self {
        Self {
            period: period_s,
            centre,
            sines: Vec::new(),
            reached: None,
        }
    }

    /// Adds a sine of random frequency, amplitude and phase, with frequency (Hz) and amplitude
    /// (rad) within bounds.
    pub fn sine(
        self,
        random: &mut Xoshiro256PlusPlus,
        hz: (f64, f64),
        amplitude: (f64, f64),
    ) -> Self {
        self.sine_from(random, hz, amplitude, (0.0, TAU))
    }

    /// Adds a sine of random frequency (Hz), amplitude (rad) and phase (rad), all within bounds.
    pub fn sine_from(
        mut self,
        random: &mut Xoshiro256PlusPlus,
        hz: (f64, f64),
        amplitude: (f64, f64),
        phase: (f64, f64),
    ) -> Self {
        self.sines.push(Sine {
            amplitude: draw(random, amplitude.0, amplitude.1),
            rad_per_s: TAU * draw(random, hz.0, hz.1),
            phase: draw(random, phase.0, phase.1),
        });
        self
    }

    /// Adds physiological tremor of 8 to 12 Hz.
    pub fn tremor(self, random: &mut Xoshiro256PlusPlus) -> Self {
        self.sine(random, (8.0, 10.0), TREMOR_RAD)
            .sine(random, (10.0, 12.0), TREMOR_RAD)
    }

    fn at(&self, t: f64) -> Pose {
        let still = Pose {
            angle: self.centre,
            omega: 0.0,
        };
        self.sines.iter().fold(still, |pose, sine| {
            let (sin, cos) = (sine.rad_per_s * t + sine.phase).sin_cos();
            Pose {
                angle: pose.angle + sine.amplitude * sin,
                omega: pose.omega + sine.amplitude * sine.rad_per_s * cos,
            }
        })
    }

    /// Angle and velocity at the start.
    pub fn start(&self) -> Pose {
        self.at(0.0)
    }

    /// Motion of the hand during tick `k`.
    pub fn grip(&mut self, k: u64) -> Grip {
        let at = |k: u64| self.at(k as f64 * self.period);
        // The pose at the end of a tick is that at the start of the next one: computed once.
        let from = match self.reached {
            Some((tick, pose)) if tick == k => pose,
            _ => at(k),
        };
        let to = at(k + 1);
        self.reached = Some((k + 1, to));
        Grip::Hand(HandMotion::between(from, to, self.period))
    }
}

/// A hand in free air: the desired slip and the desired torque are zero.
pub(super) struct FreeHand {
    intent: Intent,
    servo: Servo,
}

/// A hand that moves at 0.3 to 4 Hz.
pub(super) fn free_air(device: &Device, period_s: f64, mut random: Xoshiro256PlusPlus) -> FreeHand {
    let intent = Intent::about(draw(&mut random, -0.5, 0.5), period_s)
        .sine(&mut random, (0.3, 0.8), (0.3, 0.6))
        .sine(&mut random, (1.0, 2.0), (0.05, 0.15))
        .sine(&mut random, (2.5, 4.0), (0.02, 0.06))
        .tremor(&mut random);
    FreeHand {
        intent,
        servo: Servo::new(device, period_s, TUNING),
    }
}

/// A hand that keeps the handle at one angle, apart from tremor.
pub(super) fn hold(device: &Device, period_s: f64, mut random: Xoshiro256PlusPlus) -> FreeHand {
    let intent = Intent::about(draw(&mut random, -0.5, 0.5), period_s).tremor(&mut random);
    let tuning = Tuning {
        coulomb_at_rad_s: HOLD_COULOMB_AT,
        ..TUNING
    };
    FreeHand {
        intent,
        servo: Servo::new(device, period_s, tuning),
    }
}

impl Scenario for FreeHand {
    fn start(&self) -> Pose {
        self.intent.start()
    }

    fn tick(&mut self, k: u64, seen: EncoderCounts) -> Drive {
        let currents = self.servo.update(seen, 0.0, 0.0, 0.0);
        Drive {
            grip: self.intent.grip(k),
            ..Drive::clamped(currents.large_a, currents.small_a)
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand_xoshiro::rand_core::SeedableRng;

    /// The description of `hold`: a hand trembling at 8 to 12 Hz.
    #[test]
    fn tremor_has_a_sine_of_8_to_10_hz_and_one_of_10_to_12_hz() {
        let mut highest = 0.0_f64;
        for seed in 0..100 {
            let mut random = Xoshiro256PlusPlus::seed_from_u64(seed);
            let sines = Intent::about(0.0, 1e-3).tremor(&mut random).sines;
            assert_eq!(sines.len(), 2);
            for (sine, hz) in sines.iter().zip([8.0..10.0, 10.0..12.0]) {
                assert!(hz.contains(&(sine.rad_per_s / TAU)), "{sine:?}");
                assert!((2.5e-3..5e-3).contains(&sine.amplitude), "{sine:?}");
                assert!((0.0..TAU).contains(&sine.phase), "{sine:?}");
                highest = highest.max(sine.rad_per_s / TAU);
            }
        }
        assert!(highest > 11.9, "{highest} Hz");
    }
}
