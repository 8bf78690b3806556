//! One colour an estimator, the same in every figure.

use plotters::style::RGBColor;

use super::ReportInput;

/// The truth, and the interval around it.
pub(super) const TRUTH: RGBColor = RGBColor(0x11, 0x11, 0x11);
pub(super) const BAND: RGBColor = RGBColor(0xd9, 0xe8, 0xd2);
pub(super) const BAND_EDGE: RGBColor = RGBColor(0x9c, 0xbb, 0x8c);
pub(super) const INK: RGBColor = RGBColor(0x33, 0x33, 0x33);
pub(super) const MUTED: RGBColor = RGBColor(0x77, 0x77, 0x77);
pub(super) const GRID: RGBColor = RGBColor(0xe6, 0xe6, 0xe6);

/// Okabe and Ito's colours, told apart with any colour vision.
const NAMED: [(&str, RGBColor); 12] = [
    ("finite-difference", RGBColor(0x8c, 0x8c, 0x8c)),
    ("low-pass", RGBColor(0xe6, 0x9f, 0x00)),
    ("foaw-end-fit", RGBColor(0x56, 0xb4, 0xe9)),
    ("foaw-best-fit", RGBColor(0x00, 0x72, 0xb2)),
    ("kalman-triple", RGBColor(0x00, 0x9e, 0x73)),
    ("kalman-motor", RGBColor(0xd5, 0x5e, 0x00)),
    ("pll", RGBColor(0xcc, 0x79, 0xa7)),
    ("observer", RGBColor(0x5d, 0x3a, 0x9b)),
    ("observer-edge", RGBColor(0x1a, 0x1a, 0x6e)),
    ("adaptive", RGBColor(0xc0, 0x00, 0x3a)),
    ("adaptive-edge", RGBColor(0x00, 0x4d, 0x40)),
    ("reference", RGBColor(0x7a, 0x52, 0x30)),
];

/// For the others, by first appearance: Tol's muted scheme, darker than the above.
const OTHERS: [RGBColor; 6] = [
    RGBColor(0x33, 0x22, 0x88),
    RGBColor(0x88, 0x22, 0x55),
    RGBColor(0x99, 0x99, 0x33),
    RGBColor(0x66, 0x11, 0x00),
    RGBColor(0x44, 0xaa, 0x99),
    RGBColor(0xaa, 0x44, 0x99),
];

/// Names in order of appearance, and their colours.
pub(super) struct Palette {
    colours: Vec<(String, RGBColor)>,
    /// How many of them are in the open-loop comparison.
    compared: usize,
}

impl Palette {
    pub(super) fn new(report: &ReportInput) -> Self {
        let names = report.cases.iter().flat_map(|case| {
            let drawn = case.traces.iter().flat_map(|t| &t.estimates);
            let rows = case.rows.iter().map(|row| &row.estimator);
            rows.chain(drawn.map(|(name, _)| name)).map(String::as_str)
        });
        let closed = report.closed_loop.closers().into_iter();
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
        let mut colours: Vec<(String, RGBColor)> = Vec::new();
        let mut compared = 0;
        let mut others = OTHERS.iter().cycle();
        for (name, is_compared) in names {
            if colours.iter().any(|(known, _)| known == name) {
                continue;
            }
            compared += usize::from(is_compared);
            let colour = NAMED
                .iter()
                .find(|(known, _)| *known == name)
                .map_or_else(|| others.next().copied(), |(_, colour)| Some(*colour));
            colours.push((name.to_owned(), colour.unwrap_or(INK)));
        }
        Self { colours, compared }
    }

    pub(super) fn colour(&self, estimator: &str) -> RGBColor {
        self.colours
            .iter()
            .find(|(name, _)| name == estimator)
            .map_or(INK, |(_, colour)| *colour)
    }

    /// Every estimator of the open-loop comparison, in order of first appearance.
    pub(super) fn names(&self) -> impl Iterator<Item = &str> {
        self.colours[..self.compared]
            .iter()
            .map(|(name, _)| name.as_str())
    }
}

#[cfg(test)]
mod tests {
    use super::super::{CaseReport, Row};
    use super::*;

    fn report(names: &[&str]) -> ReportInput {
        let rows = names.iter().map(|name| Row {
            estimator: (*name).to_string(),
            ..Row::default()
        });
        ReportInput {
            cases: vec![CaseReport {
                rows: rows.collect(),
                ..CaseReport::default()
            }],
            ..ReportInput::default()
        }
    }

    #[test]
    fn a_name_has_its_colour_whoever_else_is_there() {
        let few = Palette::new(&report(&["pll", "mine"]));
        let many = Palette::new(&report(&["low-pass", "mine", "foaw-end-fit", "pll"]));
        assert_eq!(few.colour("pll"), many.colour("pll"));
        assert_eq!(few.colour("mine"), many.colour("mine"));
    }

    #[test]
    fn named_and_other_estimators_have_colours_of_their_own() {
        let names: Vec<&str> = NAMED.iter().map(|(name, _)| *name).collect();
        let all = [names.as_slice(), &["a", "b", "c", "d", "e", "f"]].concat();
        let palette = Palette::new(&report(&all));
        let mut colours: Vec<_> = all
            .iter()
            .map(|name| palette.colour(name))
            .map(|RGBColor(r, g, b)| (r, g, b))
            .collect();
        colours.sort_unstable();
        colours.dedup();
        assert_eq!(colours.len(), NAMED.len() + OTHERS.len());
    }
}
