//! Parasitic force in free air against the handle's velocity and acceleration.

use super::super::canvas::{Key, Svg};
use super::super::palette::{INK, Palette, TRUTH};
use super::super::plot::Axis;
use super::super::style::{Dash, Style};
use super::super::text::{plant, rate};
use super::charts::{Curve, Green, Panel, panels};
use super::{ClosedLoop, find};
use catalogue::parameters::PlantKind;
use experiments::transparency::{Outcome, Signals};
use scoring::score::{HALF_SPAN_S, skipped};
use simulation::device::Device;

/// Bins across each axis, and the least share of the ticks that a bin needs to be drawn.
const BINS: usize = 32;
const LEAST_SHARE: f64 = 0.002;
/// Where the force axis begins, mN.
const LOWEST_MN: f64 = 1.0;

/// One figure, velocity above acceleration, rates side by side; `None` without scene `free-air`.
pub(super) fn figures(
    closed: &ClosedLoop,
    palette: &Palette,
    device: &Device,
) -> Result<Option<Svg>, String> {
    let outcomes = closed.of("free-air");
    let names = closed.drawn_sources();
    let Some(first) = outcomes.first() else {
        return Ok(None);
    };
    let off = |outcome: &Outcome| {
        let runs = closed
            .outcomes
            .iter()
            .filter(|o| o.case.scene.name() == "off");
        let mut runs = runs.filter(|o| o.case.rate_hz == outcome.case.rate_hz);
        runs.next().and_then(|o| o.runs.first()?.signals.as_ref())
    };
    let mn_per_rad_s2 = first.fingertip.mn_per_nm * device.stages.small.inertia;
    let mut all = Vec::new();
    for (what, x_title) in [
        (omega as Motion, "velocity of the handle, rad/s"),
        (
            acceleration,
            "acceleration of the handle over 4 ms, rad/s\u{b2}",
        ),
    ] {
        let is_acceleration = all.len() >= outcomes.len();
        let Some(widest) = range(first, what).filter(|widest| *widest > 0.0) else {
            return Ok(None);
        };
        for outcome in &outcomes {
            let rate_hz = outcome.case.rate_hz;
            let curve = |style: Style, signals: &Signals| {
                let x = what(signals, rate_hz);
                Curve::new(style, bins(&x, signals, rate_hz, widest))
            };
            let mut curves: Vec<Curve> = Vec::new();
            for name in &names {
                let signals = find(outcome, name).and_then(|run| run.signals.as_ref());
                curves.extend(signals.map(|signals| curve(palette.style(name), signals)));
            }
            curves.extend(off(outcome).map(|signals| Curve {
                width: 2.2,
                ..curve(TRUTH.into(), signals)
            }));
            if is_acceleration {
                curves.push(inertia(widest, mn_per_rad_s2));
            }
            all.push(Panel {
                heading: rate(rate_hz),
                x: Axis::linear([-widest, widest]),
                y: Axis::log_exact([LOWEST_MN, 10.0 * LOWEST_MN]),
                ticks: [7, 0],
                x_title,
                y_title: "parasitic force, RMS, mN",
                green: Green::Up([LOWEST_MN, 1e3 * device.interval.threshold_n]),
                curves,
            });
        }
    }
    let values = all.iter().flat_map(|panel| &panel.curves);
    let values = values.flat_map(|curve| &curve.points).map(|(_, y)| *y);
    let highest = values.fold(10.0 * LOWEST_MN, f64::max);
    for panel in &mut all {
        panel.y = Axis::log_exact([LOWEST_MN, 1.3 * highest]);
    }
    let has_off = outcomes.iter().any(|outcome| off(outcome).is_some());
    let keys: Vec<Key> = (names.iter())
        .map(|name| Key::Line(palette.style(name), name))
        .chain(has_off.then_some(Key::Line(TRUTH.into(), "motors off")))
        .chain([Key::Band("below the threshold of a fingertip")])
        .collect();
    let plant = plant(first.case.plant == PlantKind::Friction);
    let title = format!("Parasitic force in free air by motion of the handle, plant {plant}");
    panels(&title, &keys, outcomes.len(), 190.0, &all).map(Some)
}

/// A motion of the handle at each tick; its second argument is the control rate, Hz.
type Motion = fn(&Signals, f64) -> Vec<f64>;

/// Range of a motion's axis, which all rates share: that of the first reference or estimator of the lowest rate, up to
/// its quantile of 99.5 %.
fn range(first: &Outcome, motion: Motion) -> Option<f64> {
    let signals = (first.runs.iter().rev()).find_map(|run| run.signals.as_ref())?;
    let mut sizes: Vec<f64> = motion(signals, first.case.rate_hz)
        .iter()
        .map(|v| v.abs())
        .collect();
    sizes.sort_by(f64::total_cmp);
    let place = sizes.len().saturating_sub(1) * 995 / 1000;
    Some(sizes.get(place).copied().unwrap_or(1.0))
}

/// The force of the handle's inertia against its acceleration, up to `widest`, rad/s².
fn inertia(widest: f64, mn_per_rad_s2: f64) -> Curve {
    let force = |i: i32| {
        let x = widest * f64::from(i) / 40.0;
        (x, (mn_per_rad_s2 * x.abs()).max(1e-3))
    };
    let dashed = Style {
        dash: Dash::Dashed,
        ..INK.into()
    };
    Curve::new(dashed, (-40..=40).map(force).collect())
}

fn omega(signals: &Signals, _: f64) -> Vec<f64> {
    signals.handle_rad_s.iter().map(|&w| w.into()).collect()
}

/// Central difference over 4 ms; 0 at both ends.
fn acceleration(signals: &Signals, rate_hz: f64) -> Vec<f64> {
    let omega = &signals.handle_rad_s;
    let half = ((HALF_SPAN_S * rate_hz).round() as usize).max(1);
    let at = |k: usize| match (k.checked_sub(half), omega.get(k + half)) {
        (Some(before), Some(after)) => {
            f64::from(after - omega[before]) * rate_hz / (2 * half) as f64
        }
        _ => 0.0,
    };
    (0..omega.len()).map(at).collect()
}

/// RMS of the parasitic force in even bins of `x` from `-widest` to `widest`.
fn bins(x: &[f64], signals: &Signals, rate_hz: f64, widest: f64) -> Vec<(f64, f64)> {
    let mut sums = [(0_usize, 0.0_f64); BINS];
    let skip = skipped(rate_hz);
    let forces = signals.felt_mn.iter().zip(&signals.wanted_mn);
    for (x, (felt, wanted)) in x.iter().zip(forces).skip(skip) {
        let part = (x / widest + 1.0) / 2.0;
        if !(0.0..1.0).contains(&part) {
            continue;
        }
        let bin = &mut sums[(part * BINS as f64) as usize];
        bin.0 += 1;
        bin.1 += f64::from(felt - wanted).powi(2);
    }
    let least = (LEAST_SHARE * x.len() as f64).max(1.0);
    let middle = |i: usize| widest * ((2 * i + 1) as f64 / BINS as f64 - 1.0);
    (sums.iter().enumerate())
        .filter(|(_, (n, _))| *n as f64 >= least)
        .map(|(i, (n, sum))| (middle(i), (sum / *n as f64).sqrt()))
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_bin_has_the_rms_of_its_own_ticks() {
        // Velocity rises from -1 to 1; the force is 3 mN on the left and 5 on the right.
        let omega = |k: usize| k as f32 / 1000.0 - 1.0;
        let signals = Signals {
            wanted_mn: vec![2.0; 2000],
            felt_mn: (0..2000)
                .map(|k| if k < 1000 { 5.0 } else { -3.0 })
                .collect(),
            handle_rad_s: (0..2000).map(omega).collect(),
        };
        let x = super::omega(&signals, 1000.0);
        let bins = bins(&x, &signals, 1000.0, 1.0);
        // The first 0.1 s are not scored: a bin and a half of 62 ticks each.
        assert_eq!(bins.len(), BINS - 1);
        for (x, rms) in bins {
            assert_eq!(rms, if x < 0.0 { 3.0 } else { 5.0 }, "{x}");
        }
        let acceleration = acceleration(&signals, 1000.0);
        assert!((acceleration[700] - 1.0).abs() < 1e-3 && acceleration[1] == 0.0);
    }
}
