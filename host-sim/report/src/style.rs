//! Style of a line, a bar or a mark: a colour and a dash.

pub(super) use estimator_catalogue::Dash;
use plotters::style::RGBColor;

/// A colour and a dash.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Style {
    pub(super) colour: RGBColor,
    pub(super) dash: Dash,
}

impl From<RGBColor> for Style {
    fn from(colour: RGBColor) -> Self {
        Self {
            colour,
            dash: Dash::Solid,
        }
    }
}

/// The strokes of a dashed line, or of the stripes across a bar.
pub(super) trait Strokes {
    /// Lengths of strokes and gaps in turn, px; empty for a solid line.
    fn pattern(self) -> &'static [f64];

    /// The drawn pieces of a polyline.
    fn pieces(self, points: &[(f64, f64)]) -> Vec<Vec<(f64, f64)>>;

    /// The filled parts of a bar from `low` to `high`.
    fn spans(self, low: f64, high: f64) -> Vec<[f64; 2]>;
}

impl Strokes for Dash {
    fn pattern(self) -> &'static [f64] {
        match self {
            Self::Solid => &[],
            Self::Dashed => &[7.0, 3.0],
            Self::Dotted => &[2.0, 2.5],
            Self::Mixed => &[9.0, 2.5, 2.0, 2.5],
        }
    }

    fn pieces(self, points: &[(f64, f64)]) -> Vec<Vec<(f64, f64)>> {
        let pattern = self.pattern();
        let (Some(&first), Some(&start)) = (pattern.first(), points.first()) else {
            return vec![points.to_vec()];
        };
        let mut pieces = vec![vec![start]];
        let (mut at, mut left) = (0, first);
        for pair in points.windows(2) {
            let [from, to] = [pair[0], pair[1]];
            let length = (to.0 - from.0).hypot(to.1 - from.1);
            let mut done = 0.0;
            while length - done > left {
                done += left;
                let part = done / length;
                let end = (
                    from.0 + part * (to.0 - from.0),
                    from.1 + part * (to.1 - from.1),
                );
                if at % 2 == 0 {
                    pieces.last_mut().into_iter().for_each(|p| p.push(end));
                } else {
                    pieces.push(vec![end]);
                }
                at = (at + 1) % pattern.len();
                left = pattern[at];
            }
            left -= length - done;
            if at % 2 == 0 {
                pieces.last_mut().into_iter().for_each(|p| p.push(to));
            }
        }
        pieces
    }

    fn spans(self, low: f64, high: f64) -> Vec<[f64; 2]> {
        let pieces = self.pieces(&[(low, 0.0), (high, 0.0)]);
        let ends = |piece: &Vec<(f64, f64)>| Some([piece.first()?.0, piece.last()?.0]);
        pieces.iter().filter_map(ends).collect()
    }
}

/// Length of a polyline.
pub(super) fn length(points: &[(f64, f64)]) -> f64 {
    let steps = points.windows(2);
    steps
        .map(|p| (p[1].0 - p[0].0).hypot(p[1].1 - p[0].1))
        .sum()
}

impl Style {
    /// The background of a swatch in HTML.
    pub(super) fn css(self) -> String {
        let RGBColor(r, g, b) = self.colour;
        let colour = format!("#{r:02x}{g:02x}{b:02x}");
        let mut stops = Vec::new();
        let mut from = 0.0;
        for (i, length) in self.dash.pattern().iter().enumerate() {
            let to = from + length;
            let of = if i % 2 == 0 { &colour } else { "transparent" };
            stops.push(format!("{of} {from}px {to}px"));
            from = to;
        }
        match stops.is_empty() {
            true => colour,
            false => format!("repeating-linear-gradient(90deg,{})", stops.join(",")),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn drawn(pieces: &[Vec<(f64, f64)>]) -> f64 {
        pieces.iter().map(|piece| length(piece)).sum()
    }

    #[test]
    fn dashes_continue_around_corners() {
        let corner = [(0.0, 0.0), (30.0, 40.0), (30.0, 90.0)];
        assert_eq!(Dash::Solid.pieces(&corner), [corner.to_vec()]);
        // 100 px are ten times 7 drawn and 3 left out.
        let dashed = Dash::Dashed.pieces(&corner);
        assert!((drawn(&dashed) - 70.0).abs() < 1e-9, "{dashed:?}");
        // 16 px are 9 + 2 drawn; 96 px six times that, and 4 px more of the first.
        let both = Dash::Mixed.pieces(&corner);
        assert!((drawn(&both) - (6.0 * 11.0 + 4.0)).abs() < 1e-9);
        assert_eq!(Dash::Dashed.spans(0.0, 12.0), [[0.0, 7.0], [10.0, 12.0]]);
        assert_eq!(Dash::Dashed.spans(3.0, 3.0), [[3.0, 3.0]]);
    }

    #[test]
    fn swatch_has_colour_and_dash() {
        let style = Style::from(RGBColor(0x12, 0xab, 0));
        assert_eq!(style.css(), "#12ab00");
        let dash = Dash::Dashed;
        assert_eq!(
            Style { dash, ..style }.css(),
            "repeating-linear-gradient(90deg,#12ab00 0px 7px,transparent 7px 10px)"
        );
    }
}
