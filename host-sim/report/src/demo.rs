//! Artificial comparison: quantised motion and moving averages in place of estimators.

use std::f64::consts::TAU;

use super::{CaseReport, EstimatorRow, ReportInput, Traces};
use experiments::compare::interval;
use scoring::score::{Truth, Wanted};
use simulation::device::Device;

const STEP_S: f64 = 0.5;

/// A moving average of the finite difference over `span_s`, or that difference itself.
fn average(counts: &[f64], rate_hz: f64, span_s: f64) -> Vec<f32> {
    let span = ((span_s * rate_hz) as usize).max(1);
    let factor = TAU / 4096.0 * rate_hz / span as f64;
    (0..counts.len())
        .map(|i| (factor * (counts[i] - counts[i.saturating_sub(span)])) as f32)
        .collect()
}

fn case(
    device: &Device,
    scenario: &str,
    rate_hz: f64,
    friction: bool,
    extra: &[&str],
) -> CaseReport {
    let omega = |t: f64| -> f64 {
        match scenario {
            "step" => {
                let since = t.rem_euclid(STEP_S);
                let level = [2.0, 9.0, 22.0, 5.0][(t / STEP_S) as usize % 4];
                let before = [5.0, 2.0, 9.0, 22.0][(t / STEP_S) as usize % 4];
                level + (before - level) * (-since / 0.012).exp()
            }
            "permanent" => 3.1 + 4.0 * (t / 0.7).floor(),
            "hold" => 0.0,
            _ => 6.0 * (TAU * (0.5 + 2.0 * t) * t).sin(),
        }
    };
    let n = (2.0 * rate_hz) as usize;
    let truth: Vec<f64> = (0..n).map(|i| omega(i as f64 / rate_hz)).collect();
    let mut angle = 0.0;
    let counts: Vec<f64> = truth
        .iter()
        .map(|w| {
            angle += w / rate_hz;
            (angle / TAU * 4096.0).floor()
        })
        .collect();
    let worse = if friction { 1.6 } else { 1.0 };
    let spans = [
        ("finite-difference", 0.0),
        ("low-pass", 0.004 * worse),
        ("foaw-end-fit", 0.010),
        ("foaw-best-fit", 0.014),
        ("kalman-triple", 0.006 * worse),
        ("kalman-motor", 0.003 * worse),
        ("pll", 0.020),
    ];
    let more = extra
        .iter()
        .enumerate()
        .map(|(i, name)| (*name, 0.03 + 0.01 * i as f64));
    let estimates: Vec<(String, Vec<f32>)> = spans
        .into_iter()
        .chain(more)
        .map(|(name, span)| (name.to_string(), average(&counts, rate_hz, span)))
        .collect();
    let prepared = Truth::new(&truth, rate_hz, interval(device), Wanted::ALL).unwrap();
    let reference = prepared.score(&estimates[0].1);
    let rows = estimates
        .iter()
        .map(|(name, estimate)| EstimatorRow {
            estimator: name.clone(),
            score: prepared.score(estimate).relative_to(&reference),
            instructions: None,
        })
        .collect();
    drop(prepared);
    CaseReport {
        scenario: scenario.into(),
        rate_hz,
        friction,
        seed: 1,
        rows,
        traces: Some(Traces {
            rate_hz,
            truth,
            estimates,
        }),
        damping: None,
    }
}

/// Four scenarios, two rates, both plants, and estimators of the names `extra` besides the usual.
pub(super) fn report(extra: &[&str]) -> ReportInput {
    let device = Device::default();
    let mut cases = Vec::new();
    for friction in [false, true] {
        for rate_hz in [1000.0, 11_600.0] {
            for scenario in ["step", "permanent", "track", "hold"] {
                cases.push(case(&device, scenario, rate_hz, friction, extra));
            }
        }
    }
    ReportInput {
        command: "host-sim compare --seed 1".into(),
        device_name: "default device".into(),
        device,
        notes: vec!["Made-up signals: this page shows what a report looks like.".into()],
        cases,
        ..ReportInput::default()
    }
}
