//! Criterion of a rendered scene that is passive and free of limit cycles.
//!
//! Both parts of the criterion use the threshold torque of a fingertip, `F_shd D / 2`, 0.35 mN.m on
//! the default device.
//!
//! - **Limit cycle**: while the hand rests, the torque on it oscillates with an amplitude (`√2` RMS
//!   about its mean) above the threshold in the second half of the rest, and with at least half of
//!   the amplitude of the first half. A decaying oscillation is no limit cycle. In a stable wall the
//!   quantisation of encoders with 1024 lines causes less than half of the threshold, so the
//!   criterion has no allowance for it.
//! - **Energy**: in contact, the device transfers to handle and hand the energy
//!   `E = ∫ felt ω dt + Δ(J_S ω² / 2)`, summed over all contacts. When the handle has left the
//!   scene, and at the end, `E <= 0` for a passive device. The criterion allows the threshold torque
//!   times the angle turned in contact, which corresponds to a mean torque below the threshold. `E`
//!   is not checked during contact, where it contains torque errors of the estimator.

use serde::{Deserialize, Serialize};

/// Reason for which a scene fails.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Violation {
    /// The torque on a resting hand has a sustained oscillation.
    LimitCycle,
    /// The scene transferred energy to the hand.
    Energy,
    /// The monitor stopped the device.
    Stopped,
}

impl Violation {
    /// Name in tables and files.
    #[must_use]
    pub const fn as_str(self) -> &'static str {
        match self {
            Self::LimitCycle => "limit cycle",
            Self::Energy => "energy",
            Self::Stopped => "stopped",
        }
    }
}

/// Smallest ratio of the amplitude in the second half to that in the first half of a sustained
/// oscillation.
const SUSTAINED: f64 = 0.5;

/// Smallest angle that the energy criterion assumes for a contact, rad: ten counts of the default
/// handle. It allows 1 µJ, a tenth of the kinetic energy of a handle at 2 rad/s.
const LEAST_ANGLE: f64 = 3e-3;

/// Input of the criterion at one tick.
#[derive(Clone, Copy, Debug)]
pub struct ContactTick {
    /// Whether the hand rests on the scene.
    pub resting: bool,
    /// Whether the handle is in contact with the scene.
    pub contact: bool,
    /// Torque on the hand, N.m.
    pub felt: f64,
    /// Velocity of the handle, rad/s.
    pub omega: f64,
    /// Whether the monitor has stopped the device.
    pub stopped: bool,
}

/// Evaluates the criterion tick by tick.
#[derive(Clone, Debug)]
pub struct Evaluator {
    threshold: f64,
    period: f64,
    inertia: f64,
    last: Option<ContactTick>,
    energy: f64,
    angle: f64,
    gave: bool,
    stopped: bool,
    rest: Vec<f64>,
}

impl Evaluator {
    /// A criterion with the torque threshold `threshold` (N.m), for ticks of `period_s` and a
    /// handle of `inertia` (kg.m2).
    #[must_use]
    pub fn new(threshold: f64, period_s: f64, inertia: f64) -> Self {
        Self {
            threshold,
            period: period_s,
            inertia,
            last: None,
            energy: 0.0,
            angle: 0.0,
            gave: false,
            stopped: false,
            rest: Vec::new(),
        }
    }

    /// Evaluates one tick.
    pub fn update(&mut self, now: ContactTick) {
        self.stopped |= now.stopped;
        if now.resting {
            self.rest.push(now.felt);
        }
        if let Some(last) = self.last.replace(now)
            && (last.contact || now.contact)
        {
            let work = 0.5 * self.period * (last.felt * last.omega + now.felt * now.omega);
            let kinetic = 0.5 * self.inertia * (now.omega * now.omega - last.omega * last.omega);
            self.energy += work + kinetic;
            self.angle += 0.5 * self.period * (last.omega + now.omega).abs();
            self.gave |= !now.contact && self.is_active();
        }
    }

    fn is_active(&self) -> bool {
        self.energy > self.threshold * self.angle.max(LEAST_ANGLE)
    }

    /// The failure, `None` if the run passes.
    #[must_use]
    pub fn violation(&self) -> Option<Violation> {
        if self.stopped {
            Some(Violation::Stopped)
        } else if is_limit_cycle(&self.rest, self.threshold) {
            Some(Violation::LimitCycle)
        } else {
            (self.gave || self.is_active()).then_some(Violation::Energy)
        }
    }
}

/// Whether a torque (N.m, evenly sampled) has a sustained oscillation above `threshold`.
#[must_use]
pub(crate) fn is_limit_cycle(felt: &[f64], threshold: f64) -> bool {
    let (first, second) = felt.split_at(felt.len() / 2);
    let (first, second) = (amplitude(first), amplitude(second));
    second > threshold && second >= SUSTAINED * first
}

/// Amplitude of a sine with the signal's RMS about its mean.
fn amplitude(signal: &[f64]) -> f64 {
    if signal.is_empty() {
        return 0.0;
    }
    let n = signal.len() as f64;
    let mean = signal.iter().sum::<f64>() / n;
    let square = signal.iter().map(|x| (x - mean).powi(2)).sum::<f64>() / n;
    (2.0 * square).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::TAU;

    const THRESHOLD: f64 = 0.35e-3;

    fn signal(at: impl Fn(f64) -> f64) -> Vec<f64> {
        (0..400).map(|k| at(f64::from(k) * 1e-3)).collect()
    }

    #[test]
    fn sustained_or_growing_oscillation_is_a_limit_cycle_and_a_decaying_one_is_not() {
        let ring = |size: f64, per_s: f64| {
            signal(move |t| 0.03 + size * (per_s * t).exp() * (TAU * 80.0 * t).sin())
        };
        assert!(is_limit_cycle(&ring(1.1 * THRESHOLD, 0.0), THRESHOLD));
        assert!(!is_limit_cycle(&ring(0.9 * THRESHOLD, 0.0), THRESHOLD));
        assert!(is_limit_cycle(&ring(0.1 * THRESHOLD, 15.0), THRESHOLD));
        // The second half is ten times the threshold, but decays.
        let decaying = ring(100.0 * THRESHOLD, -10.0);
        assert!(amplitude(&decaying[200..]) > 5.0 * THRESHOLD);
        assert!(!is_limit_cycle(&decaying, THRESHOLD));
        assert!(!is_limit_cycle(&[], THRESHOLD));
    }

    /// A hand that turns the handle 0.2 rad into a spring that acts `late_s` late, and back.
    fn spring_contact(late_s: f64) -> Option<Violation> {
        let angle = |t: f64| 0.1 * (1.0 - (TAU * t).cos());
        let mut evaluator = Evaluator::new(THRESHOLD, 1e-3, 0.0);
        for k in 0..=1000 {
            let t = f64::from(k) * 1e-3;
            evaluator.update(ContactTick {
                resting: false,
                contact: true,
                felt: -0.3 * angle((t - late_s).max(0.0)),
                omega: 0.1 * TAU * (TAU * t).sin(),
                stopped: false,
            });
        }
        evaluator.violation()
    }

    #[test]
    fn delayed_spring_gives_energy_and_one_without_delay_does_not() {
        assert_eq!(spring_contact(0.0), None);
        // ∮ felt dθ = π K a² sin(2π late) = 0.35 mN.m · 0.4 rad at 2.4 ms.
        assert_eq!(spring_contact(1.5e-3), None);
        assert_eq!(spring_contact(4e-3), Some(Violation::Energy));
    }

    #[test]
    fn free_handle_that_leaves_faster_than_it_came_has_gained_energy() {
        let bounce = |out: f64| {
            let mut evaluator = Evaluator::new(THRESHOLD, 1e-3, 5e-6);
            for k in 0..20 {
                let contact = (5..15).contains(&k);
                let omega = if k < 10 { 2.0 } else { -out };
                evaluator.update(ContactTick {
                    resting: false,
                    contact,
                    felt: 0.0,
                    omega,
                    stopped: false,
                });
            }
            evaluator.violation()
        };
        assert_eq!(bounce(2.0), None);
        // J (out² - 4) / 2 is 0.35 mN.m times the angle, 10 mrad in and 5 ms out, at 2.72 rad/s.
        assert_eq!(bounce(2.65), None);
        assert_eq!(bounce(2.8), Some(Violation::Energy));
    }

    /// A handle that moves 1 mrad in contact gains as much as the threshold does over 3 mrad.
    #[test]
    fn energy_over_a_small_angle_is_compared_with_that_over_3_mrad() {
        let gained = |share: f64| {
            let mut evaluator = Evaluator::new(THRESHOLD, 1e-3, 0.0);
            for _ in 0..=10 {
                evaluator.update(ContactTick {
                    resting: false,
                    contact: true,
                    felt: share * 3.0 * THRESHOLD,
                    omega: 0.1,
                    stopped: false,
                });
            }
            evaluator.violation()
        };
        assert_eq!(gained(0.99), None);
        assert_eq!(gained(1.01), Some(Violation::Energy));
    }

    /// Of 0.35 mN.m the handle gains twice as much over 20 mrad, and loses it in the next contact.
    #[test]
    fn energy_that_is_lost_in_a_later_contact_was_gained() {
        let contacts = |gained: f64| {
            let mut evaluator = Evaluator::new(THRESHOLD, 1e-3, 0.0);
            for k in 0..60 {
                let contact = !(20..40).contains(&k);
                let share = if k < 20 { gained } else { -6.0 };
                evaluator.update(ContactTick {
                    resting: false,
                    contact,
                    felt: if contact { share * THRESHOLD } else { 0.0 },
                    omega: 1.0,
                    stopped: false,
                });
            }
            evaluator.violation()
        };
        assert_eq!(contacts(0.5), None);
        assert_eq!(contacts(2.0), Some(Violation::Energy));
    }

    #[test]
    fn stop_by_the_monitor_fails() {
        let mut evaluator = Evaluator::new(THRESHOLD, 1e-3, 0.0);
        evaluator.update(ContactTick {
            resting: true,
            contact: true,
            felt: 0.0,
            omega: 0.0,
            stopped: true,
        });
        assert_eq!(evaluator.violation(), Some(Violation::Stopped));
    }
}
