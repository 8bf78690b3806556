//! The closed loop's scores for a terminal.

use std::fmt::Write as _;

use super::Outcome;
use crate::table::number;

/// One block a case, one line a run.
#[must_use]
pub fn details(outcomes: &[Outcome]) -> String {
    let mut text = String::new();
    for outcome in outcomes {
        let case = &outcome.case;
        let (scene, rate_hz, plant) = (case.scene, case.rate_hz, case.plant.name());
        let _ = writeln!(
            text,
            "{scene} at {rate_hz} Hz, plant with {plant}, loop closed"
        );
        let threshold = format!("{} mN, %", outcome.fingertip.threshold_mn);
        let line = |cells: [&str; 6]| {
            let [by, rms, p99, tactile, below, velocity] = cells;
            format!("  {by:<22}{rms:>10}{p99:>10}{tactile:>10}{below:>10}{velocity:>10}")
        };
        let _ = writeln!(
            text,
            "{}",
            line(["", "parasitic", "99 %", "50-500 Hz", "below", "velocity"])
        );
        let _ = writeln!(
            text,
            "{}",
            line([
                "controlled by",
                "rms, mN",
                "mN",
                "rms, mN",
                &threshold,
                "rms rad/s"
            ])
        );
        for run in &outcome.runs {
            let score = &run.parasitic;
            let numbers = [
                score.parasitic_mn_rms,
                score.parasitic_mn_p99,
                score.parasitic_mn_tactile,
                score.below_threshold.map(|share| 100.0 * share),
                run.velocity_rms,
            ]
            .map(number);
            let [rms, p99, tactile, below, velocity] = numbers.each_ref().map(String::as_str);
            let stopped = run.stopped.map(|cause| format!("  stopped: {cause}"));
            let shown = line([run.controlled_by, rms, p99, tactile, below, velocity]);
            let _ = writeln!(text, "{shown}{}", stopped.unwrap_or_default());
        }
    }
    text
}
