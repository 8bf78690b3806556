//! When a rendered scene counts as passive and free of limit cycles.
//!
//! Two observers watch the handle. Both measure against one torque: what a fingertip notices,
//! `F_shd D / 2`, 0.35 mN.m on the default device.
//!
//! - **Limit cycle**: while the hand rests, the felt torque oscillates with an amplitude
//!   (`√2` RMS about its mean) above that torque in the second half of the rest, and with at least
//!   half the amplitude of the first: what dies out is no limit cycle. With 1024 lines the encoders
//!   make less than half of it in a stable wall, so that nothing is allowed for quantisation.
//! - **Energy**: in contact, the device gives the handle and the hand
//!   `E = ∫ felt ω dt + Δ(J_S ω² / 2)`, summed over all contacts so far. Whenever the handle has
//!   left the scene, and at the end, a passive device has given nothing: E is not above zero. Here
//!   it may be up to that torque times the way turned in contact: a surplus that is, on average, a
//!   torque nobody notices. (Inside, E is not judged: a blip of the coupler's torque while the
//!   wall is entered is an estimator's noise, not energy that the wall makes.)

/// Why a scene does not count.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Fault {
    /// The torque on a resting hand goes on oscillating.
    LimitCycle,
    /// The scene gave energy.
    Energy,
    /// The monitor stopped the device.
    Stopped,
}

impl Fault {
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

/// An oscillation is sustained if its second half has at least this part of the first half's
/// amplitude.
const SUSTAINED: f64 = 0.5;

/// A way that is granted to every contact, rad: ten counts of the default handle, worth 1 µJ
/// there, a tenth of what a handle thrown at 2 rad/s carries.
const LEAST_WAY: f64 = 3e-3;

/// One tick of a run.
#[derive(Clone, Copy, Debug)]
pub struct Seen {
    /// Whether the hand has come to rest on the scene and means to stay.
    pub resting: bool,
    /// Whether the scene may act on the handle.
    pub contact: bool,
    /// Torque felt on the handle, N.m.
    pub felt: f64,
    /// Velocity of the handle, rad/s.
    pub omega: f64,
    /// Whether the monitor has stopped the device.
    pub stopped: bool,
}

/// Watches a run tick by tick.
#[derive(Clone, Debug)]
pub struct Observer {
    threshold: f64,
    period: f64,
    inertia: f64,
    last: Option<Seen>,
    energy: f64,
    way: f64,
    gave: bool,
    stopped: bool,
    rest: Vec<f64>,
}

impl Observer {
    /// An observer to whom torques below `threshold` (N.m) do not matter; ticks last `period_s`,
    /// the handle's inertia is `inertia` (kg.m2).
    #[must_use]
    pub fn new(threshold: f64, period_s: f64, inertia: f64) -> Self {
        Self {
            threshold,
            period: period_s,
            inertia,
            last: None,
            energy: 0.0,
            way: 0.0,
            gave: false,
            stopped: false,
            rest: Vec::new(),
        }
    }

    /// Takes in one tick.
    pub fn see(&mut self, now: Seen) {
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
            self.way += 0.5 * self.period * (last.omega + now.omega).abs();
            self.gave |= !now.contact && self.is_active();
        }
    }

    fn is_active(&self) -> bool {
        self.energy > self.threshold * self.way.max(LEAST_WAY)
    }

    /// What was wrong, if anything.
    #[must_use]
    pub fn fault(&self) -> Option<Fault> {
        if self.stopped {
            Some(Fault::Stopped)
        } else if is_limit_cycle(&self.rest, self.threshold) {
            Some(Fault::LimitCycle)
        } else {
            (self.gave || self.is_active()).then_some(Fault::Energy)
        }
    }
}

/// Whether a torque (N.m, evenly sampled) goes on oscillating with more than `threshold`.
#[must_use]
pub fn is_limit_cycle(felt: &[f64], threshold: f64) -> bool {
    let (first, second) = felt.split_at(felt.len() / 2);
    let (first, second) = (amplitude(first), amplitude(second));
    second > threshold && second >= SUSTAINED * first
}

/// Amplitude of the sine with the same RMS about the mean.
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
    fn a_sustained_or_growing_oscillation_is_a_limit_cycle_a_decaying_one_is_not() {
        let ring = |size: f64, per_s: f64| {
            signal(move |t| 0.03 + size * (per_s * t).exp() * (TAU * 80.0 * t).sin())
        };
        assert!(is_limit_cycle(&ring(1.1 * THRESHOLD, 0.0), THRESHOLD));
        assert!(!is_limit_cycle(&ring(0.9 * THRESHOLD, 0.0), THRESHOLD));
        assert!(is_limit_cycle(&ring(0.1 * THRESHOLD, 15.0), THRESHOLD));
        // Still ten times the threshold in its second half, and yet dying out.
        let decaying = ring(100.0 * THRESHOLD, -10.0);
        assert!(amplitude(&decaying[200..]) > 5.0 * THRESHOLD);
        assert!(!is_limit_cycle(&decaying, THRESHOLD));
        assert!(!is_limit_cycle(&[], THRESHOLD));
    }

    /// A hand that turns the handle 0.2 rad into a spring that acts `late_s` late, and back.
    fn push(late_s: f64) -> Option<Fault> {
        let angle = |t: f64| 0.1 * (1.0 - (TAU * t).cos());
        let mut observer = Observer::new(THRESHOLD, 1e-3, 0.0);
        for k in 0..=1000 {
            let t = f64::from(k) * 1e-3;
            observer.see(Seen {
                resting: false,
                contact: true,
                felt: -0.3 * angle((t - late_s).max(0.0)),
                omega: 0.1 * TAU * (TAU * t).sin(),
                stopped: false,
            });
        }
        observer.fault()
    }

    #[test]
    fn a_late_spring_gives_energy_a_prompt_one_does_not() {
        assert_eq!(push(0.0), None);
        // ∮ felt dθ = π K a² sin(2π late) = 0.35 mN.m · 0.4 rad at 2.4 ms.
        assert_eq!(push(1.5e-3), None);
        assert_eq!(push(4e-3), Some(Fault::Energy));
    }

    #[test]
    fn a_free_handle_that_leaves_faster_than_it_came_was_given_energy() {
        let bounce = |out: f64| {
            let mut observer = Observer::new(THRESHOLD, 1e-3, 5e-6);
            for k in 0..20 {
                let contact = (5..15).contains(&k);
                let omega = if k < 10 { 2.0 } else { -out };
                observer.see(Seen {
                    resting: false,
                    contact,
                    felt: 0.0,
                    omega,
                    stopped: false,
                });
            }
            observer.fault()
        };
        assert_eq!(bounce(2.0), None);
        assert_eq!(bounce(3.5), Some(Fault::Energy));
    }

    #[test]
    fn a_stop_is_a_fault_whatever_else_was_seen() {
        let mut observer = Observer::new(THRESHOLD, 1e-3, 0.0);
        observer.see(Seen {
            resting: true,
            contact: true,
            felt: 0.0,
            omega: 0.0,
            stopped: true,
        });
        assert_eq!(observer.fault(), Some(Fault::Stopped));
    }
}
