//! Limits of a safe run, and the verdict on a run.

use serde::{Deserialize, Serialize};

use haptic_control::AnyScene;

use super::high_pass::HighPass;
use super::variation::CONSTANT;

/// Largest allowed speed of the handle, rad/s: 2.1 m/s at the fingertip of the default handle, with
/// an energy of 9 mJ, that of a small coin dropped from 15 cm. It is twice the monitor's limit over
/// its window of 5 ms, because a stop is up to one window late.
pub const HANDLE_RAD_S: f64 = 60.0;
/// Largest allowed torque on the hand, N.m: 4.3 N at the fingertip, which a hand can resist. The
/// spring of a scene produces at most 0.13 N.m on a stiff hand. The device can produce 0.2 N.m
/// (1.5 A in the small motor, and a slip of 150 rad/s, where the monitor stops).
pub const FELT_NM: f64 = 0.150;
/// Largest allowed residual oscillation besides that of the scene itself, N.m RMS: 29 mN at the
/// fingertip, three times its threshold. Friction at reversals of a hand's motion causes half of it.
pub(crate) const OSCILLATION_NM: f64 = 1e-3;
/// Lowest frequency of an oscillation of the loop, Hz; below it are the hand's motion and tremor.
pub(crate) const OSCILLATION_HZ: f64 = 20.0;

/// Largest allowed residual oscillation of a scene, N.m RMS.
///
/// A texture is a vibration. Detents cause one if a hand moves the handle across them.
#[must_use]
pub fn oscillation_limit_nm(scene: &AnyScene) -> f64 {
    let own = f64::from(scene.vibration().0);
    // The vibration is as much too large as the torque constant.
    OSCILLATION_NM + CONSTANT.1 * own / std::f64::consts::SQRT_2
}

/// One instant of a run.
#[derive(Clone, Copy, Debug, Default)]
pub struct Instant {
    /// Velocity of the handle, rad/s.
    pub handle_rad_s: f64,
    /// Velocity of the large motor, rad/s.
    pub large_rad_s: f64,
    /// Torque on the hand, N.m.
    pub felt_nm: f64,
    /// Torque of the device on the handle, N.m.
    pub rendered_nm: f64,
    /// Torque of the scene, N.m.
    pub wanted_nm: f64,
    /// Whether the monitor has stopped the device.
    pub stopped: bool,
}

/// Largest magnitudes in a run.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Peaks {
    /// Velocity of the handle, rad/s.
    pub handle_rad_s: f64,
    /// Velocity of the large motor, rad/s.
    pub large_rad_s: f64,
    /// Torque that the hand feels, N.m.
    pub felt_nm: f64,
    /// Torque on the handle that the scene did not command, N.m.
    pub parasitic_nm: f64,
}

/// Verdict on a run.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Verdict {
    /// Not stopped, within all limits.
    Stable,
    /// Stopped by the monitor, within all limits before and after the stop.
    Stopped,
    /// Beyond a limit.
    Violated,
}

/// The limit that a run exceeded.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Reason {
    /// The handle was faster than [`HANDLE_RAD_S`] before a stop.
    Speed,
    /// The torque on the hand was above [`FELT_NM`] before a stop.
    Torque,
    /// The handle was faster than [`HANDLE_RAD_S`] after the monitor's stop.
    SpeedAfterStop,
    /// The torque on the hand was above [`FELT_NM`] after the monitor's stop.
    TorqueAfterStop,
    /// The residual oscillation was above [`oscillation_limit_nm`].
    Oscillation,
    /// A signal was not a number.
    NotFinite,
}

/// Evaluates a run tick by tick.
#[derive(Clone, Debug)]
pub struct Judge {
    /// Peaks before a stop.
    pub before: Peaks,
    /// Peaks after the stop.
    pub after: Peaks,
    /// Tick of the stop.
    pub stopped: Option<usize>,
    limit_nm: f64,
    not_finite: bool,
    ticks: usize,
    settled: usize,
    high_pass: HighPass,
    squares: f64,
}

impl Judge {
    /// A judge for a run of `scene` with `ticks` ticks at `rate_hz`. The residual oscillation is that
    /// of the last quarter.
    #[must_use]
    pub fn new(scene: &AnyScene, rate_hz: f64, ticks: usize) -> Self {
        Self {
            limit_nm: oscillation_limit_nm(scene),
            before: Peaks::default(),
            after: Peaks::default(),
            stopped: None,
            not_finite: false,
            ticks: 0,
            settled: ticks - ticks / 4,
            high_pass: HighPass::new(OSCILLATION_HZ, rate_hz),
            squares: 0.0,
        }
    }

    /// Evaluates the next tick.
    pub fn see(&mut self, now: &Instant) {
        let stopped = self.stopped.is_some() || now.stopped;
        if stopped && self.stopped.is_none() {
            self.stopped = Some(self.ticks);
        }
        let peaks = if stopped {
            &mut self.after
        } else {
            &mut self.before
        };
        for (peak, value) in [
            (&mut peaks.handle_rad_s, now.handle_rad_s),
            (&mut peaks.large_rad_s, now.large_rad_s),
            (&mut peaks.felt_nm, now.felt_nm),
            (&mut peaks.parasitic_nm, now.rendered_nm - now.wanted_nm),
        ] {
            *peak = peak.max(value.abs());
            self.not_finite |= !value.is_finite();
        }
        let residual = self.high_pass.update(now.rendered_nm);
        if self.ticks >= self.settled {
            self.squares += residual * residual;
        }
        self.ticks += 1;
    }

    /// Residual oscillation, N.m RMS; `None` for a stopped run.
    #[must_use]
    pub fn oscillation_nm(&self) -> Option<f64> {
        let over = self.ticks.saturating_sub(self.settled);
        (self.stopped.is_none() && over > 0).then(|| (self.squares / over as f64).sqrt())
    }

    /// The verdict, and the exceeded limit of a violation.
    #[must_use]
    pub fn verdict(&self) -> (Verdict, Option<Reason>) {
        let reason = if self.not_finite {
            Reason::NotFinite
        } else if self.before.handle_rad_s > HANDLE_RAD_S {
            Reason::Speed
        } else if self.before.felt_nm > FELT_NM {
            Reason::Torque
        } else if self.after.handle_rad_s > HANDLE_RAD_S {
            Reason::SpeedAfterStop
        } else if self.after.felt_nm > FELT_NM {
            Reason::TorqueAfterStop
        } else if self.oscillation_nm().is_some_and(|rms| rms > self.limit_nm) {
            Reason::Oscillation
        } else if self.stopped.is_some() {
            return (Verdict::Stopped, None);
        } else {
            return (Verdict::Stable, None);
        };
        (Verdict::Violated, Some(reason))
    }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::TAU;

    use super::*;

    const RATE: f64 = 1000.0;

    fn judged(ticks: usize, at: impl Fn(usize, f64) -> Instant) -> Judge {
        let mut judge = Judge::new(&haptic_control::FreeAir.into(), RATE, ticks);
        for k in 0..ticks {
            judge.see(&at(k, k as f64 / RATE));
        }
        judge
    }

    fn sine(amplitude: f64, hz: f64, t: f64) -> f64 {
        amplitude * (TAU * hz * t).sin()
    }

    /// The amplitude of a texture as an RMS, with the largest torque constant.
    #[test]
    fn vibration_of_a_scene_is_allowed_with_the_largest_torque_constant() {
        let texture = crate::closed_loop::usual(
            haptic_control::SceneKind::Texture,
            &haptic_control::DualStage::DEFAULT,
            10e3,
        )
        .unwrap();
        let own = f64::from(texture.vibration().0) * 0.5_f64.sqrt();
        assert!(own > 0.0);
        let limit = oscillation_limit_nm(&texture);
        assert!((limit - (1e-3 + 1.2 * own)).abs() < 1e-12, "{limit}");
        assert_eq!(oscillation_limit_nm(&haptic_control::FreeAir.into()), 1e-3);
    }

    #[test]
    fn motion_of_the_hand_alone_is_stable() {
        let judge = judged(2000, |_, t| Instant {
            handle_rad_s: sine(20.0, 1.0, t),
            felt_nm: sine(0.1, 4.0, t),
            rendered_nm: sine(0.02, 2.0, t),
            ..Instant::default()
        });
        assert_eq!(judge.verdict(), (Verdict::Stable, None));
        assert!(judge.oscillation_nm().unwrap() < 0.2e-3);
        assert!((judge.before.handle_rad_s - 20.0).abs() < 1e-3);
    }

    #[test]
    fn sustained_oscillation_violates_and_decaying_one_does_not() {
        let stays = |amplitude: f64| {
            judged(2000, move |_, t| Instant {
                rendered_nm: sine(amplitude, 80.0, t),
                ..Instant::default()
            })
        };
        let rms = stays(0.0012).oscillation_nm().unwrap();
        assert!((rms - 0.0012 / 2_f64.sqrt()).abs() < 1e-5, "{rms}");
        assert_eq!(stays(0.0012).verdict().0, Verdict::Stable);
        assert_eq!(
            stays(0.0016).verdict(),
            (Verdict::Violated, Some(Reason::Oscillation))
        );
        let decays = judged(2000, |_, t| Instant {
            rendered_nm: sine(0.1 * (-10.0 * t).exp(), 80.0, t),
            ..Instant::default()
        });
        assert_eq!(decays.verdict(), (Verdict::Stable, None));
    }

    #[test]
    fn residual_oscillation_is_that_of_the_last_quarter() {
        let burst = |from: usize, to: usize| {
            let judge = judged(2000, move |k, t| Instant {
                rendered_nm: match (from..to).contains(&k) {
                    true => sine(0.01, 80.0, t),
                    false => 0.0,
                },
                ..Instant::default()
            });
            judge.oscillation_nm().unwrap()
        };
        // A burst that ends 0.1 s before the last quarter, and one that fills it.
        assert!(burst(100, 1400) < 1e-6, "{}", burst(100, 1400));
        let rms = burst(1500, 2000);
        assert!((rms / (0.01 / 2_f64.sqrt()) - 1.0).abs() < 0.02, "{rms}");
    }

    #[test]
    fn stopped_run_violates_if_a_limit_is_exceeded_before_or_after_the_stop() {
        let runs_away = |stop: usize, coast: f64| {
            judged(100, move |k, _| Instant {
                handle_rad_s: if k < stop { k as f64 } else { coast },
                stopped: k == stop,
                ..Instant::default()
            })
        };
        let in_time = runs_away(31, 40.0);
        assert_eq!(in_time.verdict(), (Verdict::Stopped, None));
        assert_eq!(in_time.stopped, Some(31));
        assert_eq!(in_time.oscillation_nm(), None);
        assert_eq!(in_time.before.handle_rad_s, 30.0);
        assert_eq!(in_time.after.handle_rad_s, 40.0);
        let late = (Verdict::Violated, Some(Reason::Speed));
        assert_eq!(runs_away(62, 0.0).verdict(), late);
        assert_eq!(runs_away(100, 0.0).verdict(), late);
        let coasts = (Verdict::Violated, Some(Reason::SpeedAfterStop));
        assert_eq!(runs_away(31, -61.0).verdict(), coasts);
    }

    #[test]
    fn large_torque_and_nan_violate() {
        let felt = |nm: f64, stopped| {
            judged(10, move |_, _| Instant {
                felt_nm: nm,
                stopped,
                ..Instant::default()
            })
            .verdict()
            .1
        };
        assert_eq!(felt(0.149, false), None);
        assert_eq!(felt(-0.151, false), Some(Reason::Torque));
        assert_eq!(felt(0.151, true), Some(Reason::TorqueAfterStop));
        assert_eq!(felt(f64::NAN, false), Some(Reason::NotFinite));
    }
}
