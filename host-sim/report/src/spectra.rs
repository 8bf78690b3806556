//! Spectra of the velocity errors.

use super::canvas::{Anchor, Canvas, Key, LABEL, Svg, TITLE, WIDTH, figure, legend_height};
use super::palette::{BAND, INK, MUTED, Palette};
use super::plot::{Axis, Plot};
use super::text::{rate, tactile_band};
use super::{CaseReport, Traces};
use scoring::score::{TACTILE_BAND_HZ, skipped};
use scoring::spectrum::Welch;

const LEFT: f64 = 68.0;
/// Points a decade of frequency; the bins in between are averaged.
const POINTS_PER_DECADE: f64 = 60.0;

struct Curve {
    name: String,
    /// Frequency, Hz, and amplitude density of the error, rad/s per square root of Hz.
    points: Vec<(f64, f64)>,
}

/// Amplitude spectral density of every estimator's error, one panel for each case.
///
/// `None` if no case has signals long enough.
pub(super) fn spectra(
    title: &str,
    cases: &[&CaseReport],
    palette: &Palette,
) -> Result<Option<Svg>, String> {
    let panels: Vec<(f64, Vec<Curve>)> = cases
        .iter()
        .filter_map(|case| Some((case.rate_hz, curves(case.traces.as_ref()?))))
        .filter(|(_, curves)| !curves.is_empty())
        .collect();
    let all = || {
        panels
            .iter()
            .flat_map(|(_, curves)| curves)
            .flat_map(|curve| &curve.points)
    };
    let high = all().map(|p| p.1).fold(0.0, f64::max);
    if high <= 0.0 {
        return Ok(None);
    }
    // Values below 1e-5 of the largest would only stretch the axis.
    let positive = all().map(|p| p.1).filter(|power| *power > 1e-5 * high);
    let y = Axis::log([positive.fold(high, f64::min), high]);
    let band = format!("felt as roughness, {}", tactile_band());
    let keys: Vec<Key> = palette
        .names()
        .filter(|name| {
            panels
                .iter()
                .any(|(_, curves)| curves.iter().any(|c| c.name == *name))
        })
        .map(|name| Key::Line(palette.style(name), name))
        .chain([Key::Band(&band)])
        .collect();
    let top = 34.0 + legend_height(&keys, LEFT) + 26.0;
    let gap = 56.0;
    let width = (WIDTH - LEFT - 16.0 - (panels.len() - 1) as f64 * gap) / panels.len() as f64;
    figure(top + 300.0 + 40.0, title, |canvas| {
        canvas.text(title, (LEFT, 16.0), Anchor::Left, TITLE, INK)?;
        canvas.legend(&keys, (LEFT, 40.0))?;
        for (i, (rate_hz, curves)) in panels.iter().enumerate() {
            let left = LEFT + i as f64 * (width + gap);
            let plot = Plot {
                left,
                top,
                right: left + width,
                bottom: top + 300.0,
                x: Axis::log_exact([4.0, 0.5 * rate_hz]),
                y,
            };
            canvas.text(&rate(*rate_hz), (left, top - 12.0), Anchor::Left, 12.5, INK)?;
            panel(canvas, &plot, curves, palette)?;
            if i == 0 {
                let middle = (14.0, top + 150.0);
                let label = "error, rad/s per \u{221a}Hz";
                canvas.text(label, middle, Anchor::Upwards, LABEL, INK)?;
            }
        }
        Ok(())
    })
    .map(Some)
}

fn panel(canvas: &Canvas, plot: &Plot, curves: &[Curve], palette: &Palette) -> Result<(), String> {
    let [low, high] = TACTILE_BAND_HZ.map(|hz| plot.at((hz, plot.y.low)).0);
    let high = high.min(plot.right);
    if low < high {
        canvas.rectangle([(low, plot.top), (high, plot.bottom)], BAND)?;
    }
    plot.grid(canvas, 0, 0)?;
    for curve in curves {
        let points = curve.points.iter().copied();
        plot.curve(canvas, points, palette.style(&curve.name), 1.5)?;
    }
    plot.edges(canvas)?;
    // The axis begins and ends between decades: its ends are labelled if there is room.
    let ends = [plot.x.low, plot.x.high];
    for end in ends {
        let (x, _) = plot.at((end, plot.y.low));
        let tick_near = plot
            .x
            .ticks(0)
            .iter()
            .any(|t| (plot.at((*t, 1.0)).0 - x).abs() < 34.0);
        if !tick_near {
            let at = (x, plot.bottom + 10.0);
            canvas.text(&format!("{end:.0}"), at, Anchor::Centre, LABEL, MUTED)?;
        }
    }
    plot.x_title(canvas, "frequency, Hz")
}

fn curves(traces: &Traces) -> Vec<Curve> {
    let welch = Welch::new(traces.rate_hz);
    let skip = skipped(traces.rate_hz);
    let skip = skip.min(traces.truth.len());
    let curve = |(name, estimate): &(String, Vec<f32>)| {
        let pairs = estimate[skip..].iter().zip(&traces.truth[skip..]);
        let errors: Vec<f64> = pairs.map(|(&e, w)| f64::from(e) - w).collect();
        if errors.iter().any(|e| !e.is_finite()) {
            return None;
        }
        let density = welch.density(&errors)?;
        Some(Curve {
            name: name.clone(),
            points: average(density.bin_hz, &density.power_per_hz),
        })
    };
    traces.estimates.iter().filter_map(curve).collect()
}

/// Amplitude density over frequency without 0 Hz, powers averaged within each log step.
pub(super) fn average(bin_hz: f64, power_per_hz: &[f64]) -> Vec<(f64, f64)> {
    let step = |bin: usize| ((bin as f64).log10() * POINTS_PER_DECADE).floor() as i64;
    let bins: Vec<usize> = (1..power_per_hz.len()).collect();
    bins.chunk_by(|&a, &b| step(a) == step(b))
        .map(|bins| {
            let n = bins.len() as f64;
            let mean = bins.iter().map(|&bin| power_per_hz[bin]).sum::<f64>() / n;
            let middle = bins.iter().sum::<usize>() as f64 / n;
            (middle * bin_hz, mean.sqrt())
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn averaging_keeps_a_flat_density_and_all_low_frequencies() {
        let points = average(4.0, &[9.0; 1451]);
        assert!(points.len() < 160, "{}", points.len());
        assert!(points.iter().all(|p| (p.1 - 3.0).abs() < 1e-12));
        assert_eq!(points[..3], [(4.0, 3.0), (8.0, 3.0), (12.0, 3.0)]);
    }

    #[test]
    fn non_finite_estimate_has_no_curve() {
        let traces = Traces {
            rate_hz: 1000.0,
            truth: vec![0.0; 1000],
            estimates: vec![
                ("good".into(), vec![1.0; 1000]),
                ("bad".into(), vec![f32::NAN; 1000]),
            ],
        };
        let curves = curves(&traces);
        assert_eq!(curves.len(), 1);
        assert_eq!(curves[0].name, "good");
    }
}
