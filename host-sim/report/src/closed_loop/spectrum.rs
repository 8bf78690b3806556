//! Spectrum of the parasitic force in free air.

use super::super::canvas::{Key, Svg};
use super::super::palette::{Palette, TRUTH};
use super::super::plot::Axis;
use super::super::spectra::average;
use super::super::text::{plant, rate, tactile_band};
use super::charts::{Curve, Green, Panel, panels};
use super::{ClosedLoop, find};
use catalogue::parameters::PlantKind;
use experiments::transparency::Signals;
use scoring::score::{TACTILE_BAND_HZ, skipped};
use scoring::spectrum::Welch;

/// Amplitude spectral density for each velocity source, rates side by side; `None` without scene
/// `free-air`.
pub(super) fn figure(closed: &ClosedLoop, palette: &Palette) -> Result<Option<Svg>, String> {
    let outcomes = closed.of("free-air");
    let names = closed.drawn_sources();
    let Some(first) = outcomes.first() else {
        return Ok(None);
    };
    let mut all = Vec::new();
    let mut highest = 0.0_f64;
    for outcome in &outcomes {
        let rate_hz = outcome.case.rate_hz;
        let mut curves = Vec::new();
        for name in &names {
            let signals = find(outcome, name).and_then(|run| run.signals.as_ref());
            let points = signals.and_then(|signals| density(signals, rate_hz));
            curves.extend(points.map(|points| Curve::new(palette.style(name), points)));
        }
        let off = closed.of("off");
        let off = off.iter().find(|o| o.case.rate_hz == rate_hz);
        let off = off.and_then(|o| o.runs.first()?.signals.as_ref());
        let off = off.and_then(|signals| density(signals, rate_hz));
        curves.extend(off.map(|points| Curve {
            width: 2.2,
            ..Curve::new(TRUTH, points)
        }));
        let values = curves
            .iter()
            .flat_map(|curve| &curve.points)
            .map(|(_, y)| *y);
        highest = values.fold(highest, f64::max);
        all.push(Panel {
            heading: rate(rate_hz),
            x: Axis::log_exact([4.0, 0.5 * rate_hz]),
            y: Axis::log_exact([1.0, 10.0]),
            ticks: [0, 0],
            x_title: "frequency, Hz",
            y_title: "parasitic force, mN per \u{221a}Hz",
            green: Green::Across(TACTILE_BAND_HZ),
            curves,
        });
    }
    if highest <= 0.0 {
        return Ok(None);
    }
    for panel in &mut all {
        panel.y = Axis::log([1e-4 * highest, highest]);
    }
    let has_off = !closed.of("off").is_empty();
    let band = format!("felt as roughness, {}", tactile_band());
    let keys: Vec<Key> = (names.iter())
        .map(|name| Key::Line(palette.style(name), name))
        .chain(has_off.then_some(Key::Line(TRUTH.into(), "motors off")))
        .chain([Key::Band(&band)])
        .collect();
    let plant = plant(first.case.plant == PlantKind::Friction);
    let title = format!("Spectrum of the parasitic force in free air, plant {plant}");
    panels(&title, &keys, outcomes.len(), 260.0, &all).map(Some)
}

fn density(signals: &Signals, rate_hz: f64) -> Option<Vec<(f64, f64)>> {
    let skip = skipped(rate_hz);
    let forces = signals.felt_mn.iter().zip(&signals.wanted_mn);
    let parasitic: Vec<f64> = (forces.skip(skip))
        .map(|(felt, wanted)| f64::from(felt - wanted))
        .collect();
    let density = Welch::new(rate_hz).density(&parasitic)?;
    Some(average(density.bin_hz, &density.power_per_hz))
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::TAU;

    /// A parasitic force of 120 Hz beside a commanded one of 40 Hz.
    #[test]
    fn density_is_that_of_the_force_beside_the_command() {
        let sine = |hz: f64, k: u32| (8.0 * (TAU * hz * f64::from(k) / 1e3).sin()) as f32;
        let signals = Signals {
            wanted_mn: (0..4000).map(|k| sine(40.0, k)).collect(),
            felt_mn: (0..4000).map(|k| sine(40.0, k) + sine(120.0, k)).collect(),
            handle_rad_s: Vec::new(),
        };
        let points = density(&signals, 1e3).unwrap();
        let near = |hz: f64| {
            let near = points.iter().filter(|(at, _)| (at / hz - 1.0).abs() < 0.1);
            near.map(|(_, density)| *density).fold(0.0, f64::max)
        };
        assert!(
            near(40.0) < 1e-3 * near(120.0),
            "{} {}",
            near(40.0),
            near(120.0)
        );
    }
}
