//! Row of one run, for CSV and JSON.

use device_files::six_digits;
use haptic_control::Stop;
use serde::{Deserialize, Serialize};

use super::judge::{Judge, Reason, Verdict};
use super::variation::Variation;
use super::{Job, Settings};

/// Result of one run: a scene on one device.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct RobustRow {
    /// Name of the scene.
    pub scene: String,
    /// Index of the drawn device, or the corner's name.
    pub device: String,
    /// Verdict.
    pub verdict: Verdict,
    /// The exceeded limit of a violation.
    pub reason: Option<Reason>,
    /// Reason of the monitor's stop.
    pub stop: Option<String>,
    /// Time of the stop, s.
    pub stop_s: Option<f64>,
    /// Largest speed of the handle before a stop, rad/s.
    pub handle_rad_s: f64,
    /// Largest speed of the large motor, rad/s.
    pub large_rad_s: f64,
    /// Largest torque on the hand before a stop, N.m.
    pub felt_nm: f64,
    /// Largest force at the fingertip before a stop, N.
    pub felt_n: f64,
    /// Largest parasitic force at the fingertip, N.
    pub parasitic_n: f64,
    /// Residual oscillation, N.m RMS; `None` for a stopped run.
    pub oscillation_nm: Option<f64>,
    /// Largest speed of the handle after the stop, rad/s.
    pub after_handle_rad_s: Option<f64>,
    /// Largest torque on the hand after the stop, N.m.
    pub after_felt_nm: Option<f64>,
    /// Deviations of the simulated device from the nominal one, within the limits of a device.
    pub variation: Variation,
}

impl RobustRow {
    pub(super) fn new(
        settings: &Settings,
        (scene, subject): Job,
        variation: Variation,
        judge: &Judge,
        cause: Option<Stop>,
    ) -> Self {
        let (verdict, reason) = judge.verdict();
        let radius = settings.device.handle.diameter_m / 2.0;
        let stopped = judge.stopped.is_some();
        Self {
            scene: scene.to_string(),
            device: subject.to_string(),
            verdict,
            reason,
            stop: cause.map(|cause| cause.as_str().to_owned()),
            stop_s: judge.stopped.map(|tick| tick as f64 / settings.rate_hz),
            handle_rad_s: finite(judge.before.handle_rad_s),
            large_rad_s: finite(judge.before.large_rad_s),
            felt_nm: finite(judge.before.felt_nm),
            felt_n: finite(judge.before.felt_nm / radius),
            parasitic_n: finite(judge.before.parasitic_nm / radius),
            oscillation_nm: judge.oscillation_nm().map(finite),
            after_handle_rad_s: stopped.then(|| finite(judge.after.handle_rad_s)),
            after_felt_nm: stopped.then(|| finite(judge.after.felt_nm)),
            variation,
        }
    }
}

/// `value` with six significant digits; the largest f64 if it is not finite, which JSON does not have.
fn finite(value: f64) -> f64 {
    if !value.is_finite() {
        return f64::MAX;
    }
    six_digits(value)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::robust::variation::Subject;
    use haptic_control::SceneKind;

    fn row() -> RobustRow {
        let (variation, _) = Subject::Drawn(3).variation(7, SceneKind::FreeAir);
        RobustRow {
            scene: "free-air".into(),
            device: "3".into(),
            verdict: Verdict::Violated,
            reason: Some(Reason::SpeedAfterStop),
            stop: Some("jump".into()),
            stop_s: Some(0.1),
            handle_rad_s: finite(1.0 / 3.0),
            large_rad_s: finite(f64::NAN),
            felt_nm: 0.0,
            felt_n: 0.0,
            parasitic_n: 1e-9,
            oscillation_nm: None,
            after_handle_rad_s: Some(1.5),
            after_felt_nm: None,
            variation,
        }
    }

    /// A run that is stopped in its fourth tick at 2 kHz, on a handle of 70 mm.
    #[test]
    fn row_has_the_peaks_before_and_after_the_stop_with_their_units() {
        let settings = crate::robust::tests::settings(&["free-air"], 0);
        let mut judge = Judge::new(&haptic_control::FreeAir.into(), settings.rate_hz, 6);
        for (k, size) in [0.1, 0.2, 0.3, 1.0, 2.0, 0.5].into_iter().enumerate() {
            judge.see(&crate::robust::judge::Instant {
                handle_rad_s: 7.0 * size,
                large_rad_s: 50.0 * size,
                felt_nm: 0.04 * size,
                rendered_nm: 0.03 * size,
                wanted_nm: 0.01 * size,
                stopped: k >= 3,
            });
        }
        let (variation, _) = Subject::Drawn(3).variation(7, SceneKind::FreeAir);
        let job = (SceneKind::FreeAir, Subject::Drawn(3));
        let row = RobustRow::new(&settings, job, variation, &judge, Some(Stop::Jump));
        assert_eq!((row.scene.as_str(), row.device.as_str()), ("free-air", "3"));
        assert_eq!((row.verdict, row.reason), (Verdict::Stopped, None));
        assert_eq!(row.stop.as_deref(), Some(Stop::Jump.as_str()));
        assert_eq!(row.stop_s, Some(1.5e-3));
        let before = [row.handle_rad_s, row.large_rad_s, row.felt_nm];
        assert_eq!(before, [2.1, 15.0, 0.012]);
        // 12 mN.m felt, of which 6 mN.m are not wanted, at 35 mm.
        assert_eq!([row.felt_n, row.parasitic_n], [0.342_857, 0.171_429]);
        assert_eq!(row.after_handle_rad_s, Some(14.0));
        assert_eq!(row.after_felt_nm, Some(0.08));
        assert_eq!(row.oscillation_nm, None);
    }

    #[test]
    fn row_is_unchanged_after_writing_and_reading() {
        for i in 0..200 {
            let (variation, _) = Subject::Drawn(i).variation(1, SceneKind::Off);
            let row = RobustRow { variation, ..row() };
            let text = serde_json::to_string(&row).unwrap();
            assert_eq!(
                serde_json::from_str::<RobustRow>(&text).unwrap(),
                row,
                "{text}"
            );
        }
        assert_eq!(row().handle_rad_s, 0.333_333);
    }
}
