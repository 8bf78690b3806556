//! Frequency response of the rendered torque: gain, phase and coherence.

use maud::{Markup, html};

use super::super::canvas::{Key, Svg};
use super::super::palette::Palette;
use super::super::plot::Axis;
use super::super::score_tables::{cell, label, no_value};
use super::super::text::{number, plant, rate, tactile_band};
use super::ClosedLoop;
use super::charts::{Curve, Green, Panel, panels};
use catalogue::parameters::PlantKind;
use experiments::transparency::{Response, Swept, bandwidth_hz};
use scoring::score::TACTILE_BAND_HZ;

/// A row of panels: title, value, range of the axis, and step by which the axis is extended
/// downwards to the smallest value.
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
pub(super) fn figures(closed: &ClosedLoop, palette: &Palette) -> Result<Option<Svg>, String> {
    let swept = shown(closed);
    let names = closed.drawn_sources();
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
    let band = format!("felt as roughness, {}", tactile_band());
    let keys: Vec<Key> = (names.iter())
        .map(|name| Key::Line(palette.style(name), name))
        .chain([Key::Band(&band)])
        .collect();
    let plant = plant(first.plant == PlantKind::Friction);
    let title = format!("Frequency response of the rendered torque, handle clamped, plant {plant}");
    panels(&title, &keys, swept.len(), 150.0, &all).map(Some)
}

/// Bandwidth, largest deviation of gain and least coherence in the tactile band; `None` without a
/// sweep.
pub(super) fn table(closed: &ClosedLoop, palette: &Palette) -> Option<Markup> {
    let swept = shown(closed);
    let heads = [
        ("bandwidth", "\u{2212}3 dB, Hz".to_owned()),
        ("largest gain error", format!("{}, dB", tactile_band())),
        ("lowest coherence", tactile_band()),
    ];
    (!swept.is_empty()).then(|| {
        html! {
            div.scroll {
                table.scores {
                    caption { "Torque rendered into a clamped handle" }
                    thead {
                        tr {
                            th { "controlled by" }
                            @for swept in &swept {
                                @for (what, unit) in &heads {
                                    th { (what) small { (rate(swept.rate_hz)) ", " (unit) } }
                                }
                            }
                        }
                    }
                    tbody {
                        @for name in closed.velocity_sources() {
                            tr {
                                th scope="row" { (label(name, palette)) }
                                @for swept in &swept {
                                    @match swept.runs.iter().find(|(n, _)| *n == name) {
                                        Some((_, responses)) => (cells(responses)),
                                        None => { td {} td {} td {} }
                                    }
                                }
                            }
                        }
                    }
                }
            }
        }
    })
}

fn cells(responses: &[Response]) -> Markup {
    let last = responses.last().map_or(0.0, |r| r.hz);
    let [low, high] = TACTILE_BAND_HZ;
    let tactile = || responses.iter().filter(|r| (low..=high).contains(&r.hz));
    let gains = tactile().map(|r| 20.0 * r.gain.log10());
    let worst = gains.max_by(|a, b| a.abs().total_cmp(&b.abs()));
    let coherence = tactile().map(|r| r.coherence).reduce(f64::min);
    html! {
        @match bandwidth_hz(responses) {
            Some(hz) => (cell(&number(hz), hz, false)),
            None => (cell(&format!("above {}", number(last)), f64::INFINITY, false)),
        }
        @for value in [worst, coherence] {
            (value.map_or_else(no_value, |value| cell(&number(value), value, false)))
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn gain_is_drawn_in_decibels_for_the_lowest_and_the_highest_rate() {
        let [(_, gain, ..), (_, phase, ..), (_, coherence, ..)] = SHOWN;
        let response = Response {
            hz: 100.0,
            gain: 10.0,
            phase_deg: -45.0,
            coherence: 0.9,
        };
        let shown = [gain, phase, coherence].map(|of| of(&response));
        assert_eq!(shown, [20.0, -45.0, 0.9]);
        let swept = |rate_hz| Swept {
            rate_hz,
            plant: PlantKind::Friction,
            runs: Vec::new(),
        };
        let closed = ClosedLoop {
            swept: [2e3, 5e3, 1e3, 1e4].map(swept).into(),
            ..ClosedLoop::default()
        };
        let rates: Vec<_> = super::shown(&closed).iter().map(|s| s.rate_hz).collect();
        assert_eq!(rates, [1e3, 1e4]);
    }

    #[test]
    fn cells_have_the_gain_farthest_from_1_in_decibels() {
        // Of the band from 50 to 500 Hz alone: 6 and -20 dB.
        let responses = [
            (20.0, 30.0, 0.1),
            (100.0, 2.0, 0.9),
            (200.0, 0.1, 0.75),
            (1000.0, 0.001, 0.2),
        ]
        .map(|(hz, gain, coherence)| Response {
            hz,
            gain,
            phase_deg: 0.0,
            coherence,
        });
        let cells = cells(&responses).into_string();
        let shown: Vec<_> = (cells.split('>').skip(1).step_by(2))
            .map(|rest| rest.split('<').next().unwrap())
            .collect();
        assert_eq!(shown[1..], ["\u{2212}20.0", "0.750"], "{cells}");
    }
}
