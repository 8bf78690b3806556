//! One colour and dash for each estimator, the same in every figure.

use estimator_catalogue::{Colour, Dash, ROWS};
use experiments::transparency::{Cause, REFERENCE};
use plotters::style::RGBColor;

use super::ReportInput;
use super::style::Style;

/// The truth, and the interval around it.
pub(super) const TRUTH: RGBColor = RGBColor(0x11, 0x11, 0x11);
pub(super) const BAND: RGBColor = RGBColor(0xd9, 0xe8, 0xd2);
pub(super) const BAND_EDGE: RGBColor = RGBColor(0x9c, 0xbb, 0x8c);
pub(super) const INK: RGBColor = RGBColor(0x33, 0x33, 0x33);
pub(super) const MUTED: RGBColor = RGBColor(0x77, 0x77, 0x77);
pub(super) const GRID: RGBColor = RGBColor(0xe6, 0xe6, 0xe6);

/// Style of the reference encoder in an estimator's place.
const OF_REFERENCE: (Colour, Dash) = (Colour::BROWN, Dash::Solid);

/// Style of an estimator, from its row of the catalogue; `None` for a name that is no estimator's.
fn known(name: &str) -> Option<Style> {
    let row = ROWS.iter().find(|row| row.name == name);
    let of_row = row.map(|row| (row.colour, row.dash));
    let (Colour(r, g, b), dash) = of_row.or((name == REFERENCE).then_some(OF_REFERENCE))?;
    let colour = RGBColor(r, g, b);
    Some(Style { colour, dash })
}

/// Style of a cause of parasitic force: the colours of Okabe and Ito, told apart with every kind of
/// colour vision. A cause that is small in most runs has the colour of another one, striped.
pub(super) fn cause_style(cause: Cause) -> Style {
    let (r, g, b, dash) = match cause {
        Cause::Inertia => (0x00, 0x72, 0xb2, Dash::Solid),
        Cause::Friction => (0xd5, 0x5e, 0x00, Dash::Solid),
        Cause::Ripple => (0xd5, 0x5e, 0x00, Dash::Dotted),
        Cause::Slip => (0x00, 0x9e, 0x73, Dash::Solid),
        Cause::Estimate => (0xf0, 0xe4, 0x42, Dash::Solid),
        Cause::HandleEstimate => (0xcc, 0x79, 0xa7, Dash::Solid),
        Cause::Amplifier => (0x56, 0xb4, 0xe9, Dash::Dotted),
        Cause::Sampling => (0x56, 0xb4, 0xe9, Dash::Solid),
        Cause::Dac => (0x55, 0x55, 0x55, Dash::Solid),
        Cause::Limits => (0x55, 0x55, 0x55, Dash::Dotted),
    };
    let colour = RGBColor(r, g, b);
    Style { colour, dash }
}

/// Estimators of a page in order of appearance, and their styles.
pub(super) struct Palette {
    names: Vec<String>,
    /// Number of names in the open-loop comparison; they come first.
    compared: usize,
}

impl Palette {
    pub(super) fn new(report: &ReportInput) -> Self {
        let names = report.cases.iter().flat_map(|case| {
            let drawn = case.traces.iter().flat_map(|t| &t.estimates);
            let rows = case.rows.iter().map(|row| &row.estimator);
            rows.chain(drawn.map(|(name, _)| name)).map(String::as_str)
        });
        let closed = report.closed_loop.velocity_sources().into_iter();
        Self::named(
            names
                .map(|name| (name, true))
                .chain(closed.map(|name| (name, false))),
        )
    }

    pub(super) fn of<'a>(names: impl Iterator<Item = &'a str>) -> Self {
        Self::named(names.map(|name| (name, true)))
    }

    /// Names by order of appearance, and whether each is in the open-loop comparison.
    fn named<'a>(names: impl Iterator<Item = (&'a str, bool)>) -> Self {
        let mut all: Vec<String> = Vec::new();
        let mut compared = 0;
        for (name, is_compared) in names {
            if !all.iter().any(|known| known == name) {
                compared += usize::from(is_compared);
                all.push(name.to_owned());
            }
        }
        Self {
            names: all,
            compared,
        }
    }

    /// Style of an estimator; ink for a name that is no estimator's.
    pub(super) fn style(&self, estimator: &str) -> Style {
        known(estimator).unwrap_or_else(|| INK.into())
    }

    /// Every estimator of the open-loop comparison, in order of first appearance.
    pub(super) fn names(&self) -> impl Iterator<Item = &str> {
        self.names[..self.compared].iter().map(String::as_str)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use catalogue::estimators::Kind;

    /// Smallest accepted distance of two colours with the same dash, in OKLab; a distance of 0.02 is
    /// just visible side by side.
    const LEAST: f64 = 0.06;

    /// Linear RGB as seen with normal, protanopic and deuteranopic vision: Machado,
    /// Oliveira and Fernandes (2009), severity 1.
    const VISIONS: [[[f64; 3]; 3]; 3] = [
        [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
        [
            [0.152_286, 1.052_583, -0.204_868],
            [0.114_503, 0.786_281, 0.099_216],
            [-0.003_882, -0.048_116, 1.051_998],
        ],
        [
            [0.367_322, 0.860_646, -0.227_968],
            [0.280_085, 0.672_501, 0.047_413],
            [-0.011_820, 0.042_940, 0.968_881],
        ],
    ];

    fn times(matrix: &[[f64; 3]; 3], [x, y, z]: [f64; 3]) -> [f64; 3] {
        matrix.map(|[a, b, c]| a * x + b * y + c * z)
    }

    /// Ottosson's OKLab of a linear RGB colour.
    fn oklab(rgb: [f64; 3]) -> [f64; 3] {
        let cones = times(
            &[
                [0.412_221_470_8, 0.536_332_536_3, 0.051_445_992_9],
                [0.211_903_498_2, 0.680_699_545_1, 0.107_396_956_6],
                [0.088_302_461_9, 0.281_718_837_6, 0.629_978_700_5],
            ],
            rgb.map(|part| part.clamp(0.0, 1.0)),
        );
        times(
            &[
                [0.210_454_255_3, 0.793_617_785_0, -0.004_072_046_8],
                [1.977_998_495_1, -2.428_592_205_0, 0.450_593_709_9],
                [0.025_904_037_1, 0.782_771_766_2, -0.808_675_766_0],
            ],
            cones.map(f64::cbrt),
        )
    }

    /// Smallest distance of two colours over the kinds of vision.
    fn distance(a: RGBColor, b: RGBColor) -> f64 {
        let linear = |RGBColor(r, g, b): RGBColor| {
            [r, g, b].map(|part| {
                let part = f64::from(part) / 255.0;
                match part <= 0.040_45 {
                    true => part / 12.92,
                    false => ((part + 0.055) / 1.055).powf(2.4),
                }
            })
        };
        let (a, b) = (linear(a), linear(b));
        VISIONS
            .iter()
            .map(|vision| {
                let [a, b] = [a, b].map(|rgb| oklab(times(vision, rgb)));
                let squares = a.iter().zip(b).map(|(a, b)| (a - b).powi(2));
                squares.sum::<f64>().sqrt()
            })
            .fold(f64::INFINITY, f64::min)
    }

    #[test]
    fn colour_distance_is_the_smallest_over_the_kinds_of_vision() {
        let [black, white] = [RGBColor(0, 0, 0), RGBColor(255, 255, 255)];
        assert!((distance(black, white) - 1.0).abs() < 1e-3);
        // A red and a green of equal lightness: similar with a colour vision deficiency alone.
        assert!(distance(RGBColor(163, 60, 0), RGBColor(84, 100, 0)) < 0.08);
    }

    #[test]
    fn styles_of_causes_can_be_told_apart() {
        for (i, a) in Cause::ALL.iter().enumerate() {
            for b in &Cause::ALL[..i] {
                let [of_a, of_b] = [*a, *b].map(cause_style);
                let apart = distance(of_a.colour, of_b.colour);
                assert!(
                    of_a.dash != of_b.dash || apart > LEAST,
                    "{a:?}, {b:?}: {apart:.3}"
                );
            }
        }
    }

    #[test]
    fn styles_of_estimators_can_be_told_apart() {
        let mut names: Vec<&str> = Kind::all().iter().map(|kind| kind.name).collect();
        names.push(REFERENCE);
        let palette = Palette::of(names.iter().copied());
        for (i, a) in names.iter().enumerate() {
            let style = palette.style(a);
            assert!(known(a).is_some(), "{a}");
            for b in &names[..i] {
                let other = palette.style(b);
                let apart = distance(style.colour, other.colour);
                assert!(
                    style.dash != other.dash || apart > LEAST,
                    "{a} and {b}: {apart:.3} apart, both {:?}",
                    style.dash
                );
            }
        }
    }

    #[test]
    fn unknown_name_is_drawn_in_ink() {
        assert_eq!(Palette::of(["mine"].into_iter()).style("mine"), INK.into());
    }
}
