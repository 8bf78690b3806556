//! The designed velocity loop: Nyquist and Bode plots, and its margins.

use std::f64::consts::TAU;

use maud::{Markup, html};
use plotters::style::RGBColor;

use super::super::canvas::{Anchor, Canvas, Key, LABEL, Svg, TITLE, WIDTH, figure};
use super::super::palette::{BAND, GRID, INK, MUTED, TRUTH};
use super::super::plot::{Axis, Plot};
use super::super::text::{number, rate};
use experiments::transparency::Design;

/// Colours of the rates; they repeat after the last.
const COLOURS: [RGBColor; 4] = [
    RGBColor(0x00, 0x72, 0xb2),
    RGBColor(0xd5, 0x5e, 0x00),
    RGBColor(0x00, 0x9e, 0x73),
    RGBColor(0xcc, 0x79, 0xa7),
];
/// Sizes, px.
const LEFT: f64 = 62.0;
const TOP: f64 = 84.0;
const SIDE: f64 = 400.0;

/// One figure, if there is a design.
fn drawn(designs: &[Design]) -> Result<Svg, String> {
    let title = "Open loop of the large motor\u{2019}s velocity, as designed";
    let names: Vec<String> = designs.iter().map(|design| rate(design.rate_hz)).collect();
    let colours = || COLOURS.iter().copied().cycle();
    let keys: Vec<Key> = (names.iter().zip(colours()))
        .map(|(name, colour)| Key::Line(colour.into(), name))
        .chain([Key::Band("modulus margin around \u{2212}1")])
        .collect();
    let bottom = TOP + SIDE;
    let nyquist = Plot {
        left: LEFT,
        top: TOP,
        right: LEFT + SIDE,
        bottom,
        x: Axis::linear([-2.2, 1.0]),
        y: Axis::linear([-1.6, 1.6]),
    };
    let lowest = designs
        .iter()
        .map(|d| d.margins.crossover_hz)
        .fold(f64::INFINITY, f64::min);
    let highest = designs.iter().map(|d| d.rate_hz).fold(0.0, f64::max);
    let x = Axis::log_exact([(lowest / 30.0).max(0.1), 0.5 * highest]);
    let bode = |top: f64, range| Plot {
        left: LEFT + SIDE + 72.0,
        top,
        right: WIDTH - 16.0,
        bottom: top + 164.0,
        x,
        y: Axis::linear(range),
    };
    let (gain, phase) = (
        bode(TOP, [-60.0, 40.0]),
        bode(bottom - 164.0, [-360.0, -90.0]),
    );
    figure(bottom + 40.0, title, |canvas| {
        canvas.text(title, (LEFT, 16.0), Anchor::Left, TITLE, INK)?;
        canvas.legend(&keys, (LEFT, 40.0))?;
        polar(canvas, &nyquist, designs)?;
        for (plot, ticks, heading) in [(&gain, 5, "gain, dB"), (&phase, 4, "phase, degrees")] {
            plot.grid(canvas, 0, ticks)?;
            let at = (plot.left, plot.top - 12.0);
            canvas.text(heading, at, Anchor::Left, 12.5, INK)?;
        }
        for (design, colour) in designs.iter().zip(colours()) {
            let open = || design.open_loop.iter();
            let points: Vec<_> = open().map(|(_, l)| (l.re, l.im)).collect();
            nyquist_curve(canvas, &nyquist, &points, colour)?;
            let points = open().map(|(hz, l)| (*hz, 20.0 * l.norm().log10()));
            gain.curve(canvas, points.filter(|p| p.0 >= x.low), colour, 1.8)?;
            let mut last = -90.0;
            let points: Vec<_> = open()
                .map(|(hz, l)| {
                    let turns = (l.arg().to_degrees() - last) / 360.0;
                    last += 360.0 * (turns - turns.round());
                    (*hz, last)
                })
                .filter(|p| p.0 >= x.low)
                .collect();
            phase.curve(canvas, points.into_iter(), colour, 1.8)?;
        }
        for plot in [&nyquist, &gain, &phase] {
            plot.edges(canvas)?;
        }
        nyquist.x_title(canvas, "real part")?;
        let middle = (14.0, TOP + 0.5 * SIDE);
        canvas.text("imaginary part", middle, Anchor::Upwards, LABEL, INK)?;
        phase.x_title(canvas, "frequency, Hz")
    })
}

/// As [`drawn`]; none without a design.
pub(super) fn figure_or_none(designs: &[Design]) -> Result<Option<Svg>, String> {
    (!designs.is_empty()).then(|| drawn(designs)).transpose()
}

/// Grid, unit circle, and the least distance from -1.
fn polar(canvas: &Canvas, plot: &Plot, designs: &[Design]) -> Result<(), String> {
    let modulus = designs
        .iter()
        .map(|d| d.margins.modulus)
        .fold(1.0, f64::min);
    let circle = |centre: f64, radius: f64| -> Vec<(f64, f64)> {
        (0..=120)
            .map(|i| (TAU * f64::from(i) / 120.0).sin_cos())
            .map(|(sin, cos)| plot.at((centre + radius * cos, radius * sin)))
            .collect()
    };
    canvas.polygon(&circle(-1.0, modulus), BAND)?;
    plot.grid(canvas, 6, 6)?;
    canvas.line(&circle(0.0, 1.0), MUTED, 1.0)?;
    for axis in [[(-2.2, 0.0), (1.0, 0.0)], [(0.0, -1.6), (0.0, 1.6)]] {
        canvas.line(&axis.map(|at| plot.at(at)), GRID, 2.0)?;
    }
    let (x, y) = plot.at((-1.0, 0.0));
    canvas.line(&[(x - 5.0, y), (x + 5.0, y)], TRUTH, 2.0)?;
    canvas.line(&[(x, y - 5.0), (x, y + 5.0)], TRUTH, 2.0)?;
    canvas.text("\u{2212}1", (x + 8.0, y - 10.0), Anchor::Left, LABEL, INK)
}

/// A curve whose x may turn back: the pieces that lie in the frame.
fn nyquist_curve(
    canvas: &Canvas,
    plot: &Plot,
    points: &[(f64, f64)],
    colour: RGBColor,
) -> Result<(), String> {
    let inside = |&(x, y): &(f64, f64)| {
        (plot.x.low..=plot.x.high).contains(&x) && (plot.y.low..=plot.y.high).contains(&y)
    };
    for piece in points.chunk_by(|a, b| inside(a) == inside(b)) {
        if inside(&piece[0]) && piece.len() > 1 {
            let places: Vec<_> = piece.iter().map(|&at| plot.at(at)).collect();
            canvas.line(&places, colour, 1.8)?;
        }
    }
    Ok(())
}

/// Table of the margins; `None` without a design.
pub(super) fn table(designs: &[Design]) -> Option<Markup> {
    let row = |design: &Design| {
        let margins = &design.margins;
        [
            margins.modulus,
            margins.gain,
            margins.phase_deg(),
            1e3 * margins.delay_s,
            margins.crossover_hz,
            1e3 * design.estimator_delay_s,
        ]
    };
    (!designs.is_empty()).then(|| {
        html! {
            div.scroll {
                table.scores {
                    caption { "Margins of the velocity loop" }
                    thead {
                        tr {
                            th { "sample rate" }
                            th { "modulus margin" small { "distance from \u{2212}1" } }
                            th { "gain margin" small { "factor" } }
                            th { "phase margin" small { "degrees" } }
                            th { "delay margin" small { "ms" } }
                            th { "crossover" small { "Hz" } }
                            th { "estimator delay" small { "ms" } }
                        }
                    }
                    tbody {
                        @for design in designs {
                            tr {
                                th scope="row" { (rate(design.rate_hz)) }
                                @for value in row(design) { td { (number(value)) } }
                            }
                        }
                    }
                }
            }
        }
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use haptic_control::Margins;

    /// An open loop of a gain of 10 and of 1, whose phase falls through half a turn.
    #[test]
    fn curves_have_gain_in_decibels_and_a_continuous_phase_and_the_circle_is_around_minus_1() {
        use crate::canvas::tests::points;
        let device = haptic_control::DualStage::DEFAULT;
        let poles = haptic_control::LoopPoles::DEFAULT;
        let mut design = Design::new(&device, 1000.0, poles).unwrap();
        design.open_loop.truncate(3);
        let values = [
            (10.0, 10.0, -150.0_f64),
            (100.0, 1.0, -210.0),
            (400.0, 0.1, -300.0),
        ];
        for (point, (hz, gain, degrees)) in design.open_loop.iter_mut().zip(values) {
            let (sin, cos) = degrees.to_radians().sin_cos();
            (point.0, point.1.re, point.1.im) = (hz, gain * cos, gain * sin);
        }
        let design = Design {
            margins: Margins {
                modulus: 0.5,
                gain: 3.0,
                cos_phase: 0.95,
                crossover_hz: 30.0,
                delay_s: 0.0025,
            },
            ..design
        };
        let svg = drawn(&[design]).unwrap().0;
        let curves = points(&svg, "polyline", COLOURS[0]);
        // The last two are gain and phase, on frames of 164 px for 100 dB and 270 degrees.
        let [.., gain, phase] = &curves[..] else {
            panic!("{curves:?}");
        };
        let falls = |curve: &[(f64, f64)], px: f64, of: &[f64]| {
            for (pair, part) in curve.windows(2).zip(of) {
                assert!((pair[1].1 - pair[0].1 - px * part).abs() < 0.5, "{curve:?}");
            }
        };
        falls(gain, 164.0 / 100.0, &[20.0, 20.0]);
        falls(phase, 164.0 / 270.0, &[60.0, 90.0]);
        // -1 lies at 1.2 of the 3.2 units of the frame.
        let circles = points(&svg, "polygon", BAND);
        let xs = circles[0].iter().map(|(x, _)| *x);
        let (low, high) = xs.fold((f64::INFINITY, 0.0_f64), |(low, high), x| {
            (low.min(x), high.max(x))
        });
        assert!(
            (0.5 * (low + high) - (LEFT + 1.2 / 3.2 * SIDE)).abs() < 1.0,
            "{low} {high}"
        );
        assert!((high - low - SIDE / 3.2).abs() < 1.0, "{low} {high}");
    }

    #[test]
    fn table_has_the_delays_in_milliseconds() {
        let design = Design {
            rate_hz: 1000.0,
            margins: Margins {
                modulus: 0.5,
                gain: 3.0,
                cos_phase: 0.95,
                crossover_hz: 20.0,
                delay_s: 0.0025,
            },
            estimator_delay_s: 0.0125,
            open_loop: Vec::new(),
        };
        let table = table(&[design]).unwrap().into_string();
        let cells: Vec<_> = (table.split("<td>").skip(1))
            .map(|rest| rest.split('<').next().unwrap().parse::<f64>().unwrap())
            .collect();
        // 2.5 ms of 50 ms are 18 degrees.
        assert_eq!(cells, [0.5, 3.0, 18.0, 2.5, 20.0, 12.5]);
        assert!(super::table(&[]).is_none());
    }
}
