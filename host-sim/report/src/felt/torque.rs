//! How fast torque is rendered: gain, phase and coherence against frequency.

use std::fmt::Write as _;

use super::super::canvas::Key;
use super::super::palette::Palette;
use super::super::plot::Axis;
use super::super::score_tables::{cell, label};
use super::super::text::{number, plant, rate};
use super::ClosedLoop;
use super::charts::{Curve, Green, Panel, panels};
use catalogue::parameters::PlantKind;
use experiments::transparency::{Response, Swept, bandwidth_hz};
use scoring::score::TACTILE_BAND_HZ;

/// What a row of panels shows: its axis covers this range, and in steps of the last number as
/// much more below as there is.
type Shown = (&'static str, fn(&Response) -> f64, [f64; 2], f64);

const SHOWN: [Shown; 3] = [
    (
        "gain, dB",
        |r| 20.0 * r.gain.max(0.1).log10(),
        [-6.0, 6.0],
        3.0,
    ),
    (
        "phase, degrees",
        |r| r.phase_deg.max(-720.0),
        [-90.0, 30.0],
        30.0,
    ),
    ("coherence", |r| r.coherence, [0.8, 1.0], 0.1),
];

/// Lowest and highest rate.
fn shown(closed: &ClosedLoop) -> Vec<&Swept> {
    let mut swept: Vec<&Swept> = closed.swept.iter().collect();
    swept.sort_by(|a, b| a.rate_hz.total_cmp(&b.rate_hz));
    if swept.len() > 2 {
        swept.drain(1..swept.len() - 1);
    }
    swept
}

/// One figure, if there is a sweep.
pub(super) fn figures(closed: &ClosedLoop, palette: &Palette) -> Result<Option<String>, String> {
    let swept = shown(closed);
    let names = closed.drawn();
    let Some(first) = swept.first() else {
        return Ok(None);
    };
    let mut all = Vec::new();
    for (y_title, of, [low, high], step) in SHOWN {
        let responses = swept.iter().flat_map(|s| &s.runs).flat_map(|(_, r)| r);
        let lowest = responses.map(of).fold(low, f64::min);
        let low = (lowest / step - 1e-9).floor() * step;
        for swept in &swept {
            let mut curves = Vec::new();
            let mut ends = [f64::INFINITY, 0.0_f64];
            for name in &names {
                let Some((_, responses)) = swept.runs.iter().find(|(n, _)| n == name) else {
                    continue;
                };
                for response in responses {
                    ends = [ends[0].min(response.hz), ends[1].max(response.hz)];
                }
                let points = responses.iter().map(|r| (r.hz, of(r))).collect();
                curves.push(Curve::new(palette.style(name), points));
            }
            if ends[0] >= ends[1] {
                return Ok(None);
            }
            all.push(Panel {
                heading: rate(swept.rate_hz),
                x: Axis::log_exact(ends),
                y: Axis::linear([low, high]),
                ticks: [0, 4],
                x_title: "frequency, Hz",
                y_title,
                green: Green::Across(TACTILE_BAND_HZ),
                curves,
            });
        }
    }
    let keys: Vec<Key> = (names.iter())
        .map(|name| Key::Line(palette.style(name), name))
        .chain([Key::Band("felt as roughness, 50 to 500 Hz")])
        .collect();
    let plant = plant(first.plant == PlantKind::Friction);
    let title = format!("Torque felt over torque wanted, handle clamped, plant {plant}");
    panels(&title, &keys, swept.len(), 150.0, &all).map(Some)
}

/// Bandwidth, largest deviation of gain and least coherence in the tactile band.
pub(super) fn table(closed: &ClosedLoop, palette: &Palette) -> String {
    let swept = shown(closed);
    if swept.is_empty() {
        return String::new();
    }
    let mut html = String::from(
        "<div class=\"scroll\"><table class=\"scores\"><caption>Torque rendered into a clamped \
         handle</caption>\n<thead><tr><th>controlled by</th>",
    );
    for swept in &swept {
        let rate = rate(swept.rate_hz);
        for (what, unit) in [
            ("\u{2212}3 dB", "Hz"),
            ("worst gain", "50\u{2013}500 Hz, dB"),
            ("least coherence", "50\u{2013}500 Hz"),
        ] {
            let _ = write!(html, "<th>{what}<small>{rate}, {unit}</small></th>");
        }
    }
    html += "</tr></thead><tbody>\n";
    for name in closed.closers() {
        let _ = write!(html, "<tr><th scope=\"row\">{}</th>", label(name, palette));
        for swept in &swept {
            let run = swept.runs.iter().find(|(n, _)| *n == name);
            html += &run.map_or_else(|| "<td></td>".repeat(3), |(_, r)| cells(r));
        }
        html += "</tr>\n";
    }
    html + "</tbody></table></div>\n"
}

fn cells(responses: &[Response]) -> String {
    let last = responses.last().map_or(0.0, |r| r.hz);
    let bandwidth = bandwidth_hz(responses).map_or_else(
        || cell(&format!("above {}", number(last)), f64::INFINITY, false),
        |hz| cell(&number(hz), hz, false),
    );
    let [low, high] = TACTILE_BAND_HZ;
    let tactile = || responses.iter().filter(|r| (low..=high).contains(&r.hz));
    let gains = tactile().map(|r| 20.0 * r.gain.log10());
    let worst = gains.max_by(|a, b| a.abs().total_cmp(&b.abs()));
    let coherence = tactile().map(|r| r.coherence).reduce(f64::min);
    let shown = |value: Option<f64>| {
        let none = || "<td class=\"none\">\u{2013}</td>".to_owned();
        value.map_or_else(none, |v| cell(&number(v), v, false))
    };
    bandwidth + &shown(worst) + &shown(coherence)
}
