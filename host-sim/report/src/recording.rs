//! A recording as one figure: position, velocity, velocity error, currents and torque over one time
//! axis.

mod changes;
mod panel;

use plotters::style::RGBColor;

use changes::states;
use panel::{Curve, Panel, range};

use super::canvas::{Anchor, Key, TITLE, WIDTH, figure, legend_height};
use super::palette::{INK, Palette, TRUTH};
use super::plot::{Axis, Plot};
use catalogue::estimators::DIFFERENCE;
use recordings::recording::Recording;
use scoring::evaluation::Estimate;
use scoring::score::HapticInterval;
use simulation::trace::continued;

/// Sizes, px.
const LEFT: f64 = 70.0;
const RIGHT: f64 = 14.0;
const TOP: f64 = 52.0;
const PANEL: f64 = 132.0;
const GAP: f64 = 22.0;
const LARGE: RGBColor = RGBColor(0x00, 0x72, 0xb2);
const SMALL: RGBColor = RGBColor(0xd5, 0x5e, 0x00);
const BOARD: RGBColor = RGBColor(0xb0, 0x00, 0x20);

/// Content of the figure of a recording.
#[derive(Clone, Copy, Debug)]
pub struct RecordingView<'a> {
    /// Title of the figure.
    pub name: &'a str,
    /// The recording.
    pub recording: &'a Recording,
    /// Estimates of the large motor's velocity.
    pub estimates: &'a [Estimate],
    /// Counts per revolution of the large motor's and of the handle's encoder.
    pub counts_per_rev: [u32; 2],
    /// Haptic interval: velocity errors that a fingertip does not feel.
    pub interval: HapticInterval,
    /// Time shown, s.
    pub window: [f64; 2],
}

/// The figure as SVG.
///
/// # Errors
/// If the figure cannot be drawn.
pub fn recording(view: &RecordingView) -> Result<String, String> {
    let panels = panels(view);
    let ranges: Vec<_> = panels.iter().map(|panel| range(panel, view)).collect();
    let named = |(panel, ends): (&Panel, &[f64; 2])| panel.names(view, *ends);
    let names: Vec<Vec<String>> = panels.iter().zip(&ranges).map(named).collect();
    let keys: Vec<Vec<Key>> = (panels.iter().zip(&names))
        .map(|(panel, names)| keys(panel, names))
        .collect();
    let heads: Vec<f64> = keys.iter().map(|keys| head(keys)).collect();
    let height: f64 = TOP + heads.iter().map(|head| head + PANEL + GAP).sum::<f64>() + 20.0;
    figure(height, view.name, |canvas| {
        canvas.text(view.name, (LEFT, 16.0), Anchor::Left, TITLE, INK)?;
        let mut top = TOP;
        for (i, (panel, head)) in panels.iter().zip(&heads).enumerate() {
            canvas.legend(&keys[i], (LEFT, top + 8.0))?;
            let plot = Plot {
                left: LEFT,
                top: top + head,
                right: WIDTH - RIGHT,
                bottom: top + head + PANEL,
                x: Axis::linear(view.window),
                y: Axis::linear(ranges[i]),
            };
            panel.draw(canvas, &plot, view)?;
            states(canvas, &plot, view, i == 0)?;
            top = plot.bottom + GAP;
            if i + 1 == panels.len() {
                plot.x_title(canvas, "time, s")?;
            }
        }
        Ok(())
    })
    .map(|svg| svg.0)
}

fn keys<'a>(panel: &Panel, names: &'a [String]) -> Vec<Key<'a>> {
    let lines = panel.curves.iter().zip(names);
    let mut keys: Vec<_> = lines.map(|(c, name)| Key::Line(c.style, name)).collect();
    if panel.band.is_some() {
        keys.push(Key::Band("haptic interval"));
    }
    keys
}

fn head(keys: &[Key]) -> f64 {
    legend_height(keys, LEFT) + 2.0
}

fn panels(view: &RecordingView) -> Vec<Panel> {
    let trace = &view.recording.trace;
    let mut panels = Vec::new();
    let mut add = |unit, curves: Vec<Curve>, band| {
        if !curves.is_empty() {
            panels.push(Panel { unit, curves, band });
        }
    };
    let mut angles = vec![angle(
        "large motor",
        LARGE,
        &trace.counts_large,
        view.counts_per_rev[0],
    )];
    if let Some(small) = &trace.counts_small {
        angles.push(angle("handle", SMALL, small, view.counts_per_rev[1]));
    }
    add("angle, rad", angles, None);

    let velocities = velocities(view);
    let errors = trace.true_omega.as_ref().map(|truth| {
        let error = |curve: &Curve| Curve {
            name: format!("{} minus truth", curve.name),
            values: curve.values.iter().zip(truth).map(|(e, w)| e - w).collect(),
            ..*curve
        };
        let band = truth.iter().map(|w| view.interval.tolerance(*w)).collect();
        (velocities.iter().map(error).collect(), band)
    });
    let truth = trace.true_omega.iter();
    let truth = truth.map(|truth| Curve::new("truth", TRUTH, truth).wide());
    add(
        "velocity, rad/s",
        velocities.into_iter().chain(truth).collect(),
        None,
    );
    if let Some((errors, band)) = errors {
        add("error, rad/s", errors, Some(band));
    }

    let board = &view.recording.board;
    let currents = [
        ("large motor", LARGE, trace.current.as_deref()),
        (
            "small motor",
            SMALL,
            view.recording.current_small.as_deref(),
        ),
    ];
    let currents = currents.into_iter();
    let there = currents.filter_map(|(n, c, v)| Some(Curve::new(n, c, v?)));
    add("current, A", there.collect(), None);
    let torque = board.column("torque").into_iter().map(|torque| {
        let torque: Vec<_> = torque.iter().map(|torque| 1e3 * torque).collect();
        Curve::new("commanded at the handle", INK, &torque)
    });
    add("torque, mN\u{b7}m", torque.collect(), None);
    panels
}

/// Estimates, then the estimate of the board if the recording has it.
fn velocities(view: &RecordingView) -> Vec<Curve> {
    let palette = Palette::of(view.estimates.iter().map(|estimate| estimate.estimator));
    let mut curves: Vec<_> = view
        .estimates
        .iter()
        .map(|estimate| {
            let values: Vec<_> = estimate.velocity.iter().map(|w| f64::from(*w)).collect();
            let colour = palette.style(estimate.estimator);
            let mut curve = Curve::new(estimate.estimator, colour, &values);
            // The axis follows the other estimates: quantisation of this one would hide their
            // differences.
            curve.sizes = estimate.estimator != DIFFERENCE;
            curve
        })
        .collect();
    if let Some(own) = view.recording.board.column("velocity_large") {
        curves.push(Curve::new("estimate of the board", BOARD, own));
    }
    if curves.iter().all(|curve| !curve.sizes) {
        curves.iter_mut().for_each(|curve| curve.sizes = true);
    }
    curves
}

fn angle(name: &str, colour: RGBColor, counts: &[u32], per_rev: u32) -> Curve {
    let continued = continued(counts);
    let angles = (continued.iter())
        .map(|count| (count - continued[0]) as f64 / f64::from(per_rev) * std::f64::consts::TAU);
    Curve::new(name, colour, &angles.collect::<Vec<_>>())
}

#[cfg(test)]
mod tests {
    use recordings::recording::ReadOptions;

    use super::*;

    fn view(recording: &Recording) -> RecordingView<'_> {
        RecordingView {
            name: "r.csv",
            recording,
            estimates: &[],
            counts_per_rev: [4096, 20_000],
            interval: HapticInterval::new(0.05, 0.010, 0.070, 0.96e-3),
            window: [0.0, 0.006],
        }
    }

    const TEXT: &str = "t,counts_large,state,cause\n0,4294967295,1,0\n0.001,0,1,0\n0.002,1,2,0\n\
        0.005,5,2,0\n0.006,6,3,5\n";

    #[test]
    fn curves_end_at_gaps_and_counts_continue_over_their_wrap() {
        let options = ReadOptions::default();
        let recording = Recording::parse_with_board(TEXT.as_bytes(), "r", &options).unwrap();
        let view = view(&recording);
        assert_eq!(panel::segments(&view), [0..3, 3..5]);
        let angle = angle("", INK, &recording.trace.counts_large, 4096);
        let count = std::f64::consts::TAU / 4096.0;
        assert!((angle.values[4] - 7.0 * count).abs() < 1e-12);
        assert_eq!(
            changes::changes(&view),
            [
                (0.002, "running".to_owned()),
                (0.006, "safe, cause 5".to_owned())
            ]
        );
    }

    #[test]
    fn change_of_the_cause_alone_is_named_and_none_outside_the_window() {
        let text = "t,counts_large,state,cause\n0,0,3,5\n0.001,1,3,6\n0.002,2,1,0\n";
        let options = ReadOptions::default();
        let recording = Recording::parse_with_board(text.as_bytes(), "r", &options).unwrap();
        let view = RecordingView {
            window: [0.0, 0.001],
            ..view(&recording)
        };
        let changes = changes::changes(&view);
        assert_eq!(changes, [(0.001, "safe, cause 6".to_owned())]);
    }

    #[test]
    fn each_curve_has_its_own_column_in_its_unit() {
        let text = "t,counts_large,counts_small,current,current_small,torque\n\
            0,10,20,0.5,-0.25,0.01\n0.001,11,25,0.75,0.125,-0.02\n";
        let options = ReadOptions::default();
        let recording = Recording::parse_with_board(text.as_bytes(), "r", &options).unwrap();
        let panels = panels(&view(&recording));
        let found: Vec<_> = (panels.iter())
            .map(|panel| {
                let curves = panel.curves.iter().map(|curve| curve.values[1]);
                (panel.unit, curves.collect::<Vec<_>>())
            })
            .collect();
        let tau = std::f64::consts::TAU;
        let expected = [
            // Of 4096 and of 20 000 counts a turn.
            ("angle, rad", vec![tau / 4096.0, 5.0 * tau / 20_000.0]),
            ("current, A", vec![0.75, 0.125]),
            ("torque, mN\u{b7}m", vec![-20.0]),
        ];
        assert_eq!(found.len(), expected.len(), "{found:?}");
        for ((unit, found), (wanted, values)) in found.iter().zip(&expected) {
            assert_eq!((unit, found.len()), (wanted, values.len()));
            assert!(
                found.iter().zip(values).all(|(a, b)| (a - b).abs() < 1e-12),
                "{found:?}"
            );
        }
    }

    /// The axis of velocities leaves out the jumps of a finite difference, and that of errors has both edges of the
    /// interval.
    #[test]
    fn axis_has_the_band_and_the_curves_but_for_finite_difference() {
        let text = "t,counts_large,true_omega\n0,0,1\n0.001,0,1\n";
        let recording = Recording::parse(text.as_bytes(), "r").unwrap();
        let estimate = |estimator, velocity| Estimate {
            estimator,
            velocity: vec![velocity; 2],
            deviation: None,
            damping_ratio: None,
        };
        let estimates = [estimate("finite-difference", 50.0), estimate("pll", 1.25)];
        let view = RecordingView {
            estimates: &estimates,
            ..view(&recording)
        };
        let panels = panels(&view);
        let [low, high] = panel::range(&panels[1], &view);
        assert!(low < 1.0 && high > 1.25 && high < 1.5, "{low} {high}");
        let tolerance = view.interval.tolerance(1.0);
        assert!(tolerance > 0.25);
        let [low, high] = panel::range(&panels[2], &view);
        assert!(
            (low + high).abs() < 1e-12 && high > 1.5 * tolerance,
            "{low} {high}"
        );
        // A finite difference alone has an axis.
        let view = RecordingView {
            estimates: &estimates[..1],
            ..view
        };
        let panels = super::panels(&view);
        assert!(panel::range(&panels[1], &view)[1] > 50.0);
    }

    #[test]
    fn missing_signals_have_no_panel() {
        let text = "t,counts_large\n0,0\n0.001,1\n";
        let recording = Recording::parse(text.as_bytes(), "r").unwrap();
        let view = view(&recording);
        let units: Vec<_> = panels(&view).iter().map(|panel| panel.unit).collect();
        assert_eq!(units, ["angle, rad"]);
        assert!(
            super::recording(&view)
                .unwrap()
                .contains("<title>r.csv</title>")
        );
        let text = "t,counts_large,true_omega,current\n0,0,1,0\n0.001,1,1,0\n";
        let recording = Recording::parse(text.as_bytes(), "r").unwrap();
        let estimate = [Estimate {
            estimator: "pll",
            velocity: vec![0.5, 1.5],
            deviation: None,
            damping_ratio: None,
        }];
        let view = RecordingView {
            recording: &recording,
            estimates: &estimate,
            ..view
        };
        let panels = panels(&view);
        let units: Vec<_> = panels.iter().map(|panel| panel.unit).collect();
        assert_eq!(
            units,
            [
                "angle, rad",
                "velocity, rad/s",
                "error, rad/s",
                "current, A"
            ]
        );
        assert_eq!(panels[2].curves[0].values, [-0.5, 0.5]);
        assert_eq!(panels[2].names(&view, [-1.0, 1.0]), ["pll minus truth"]);
        assert_eq!(
            panels[2].names(&view, [-1.0, 0.0]),
            ["pll minus truth, 50\u{a0}% off scale"]
        );
    }
}
