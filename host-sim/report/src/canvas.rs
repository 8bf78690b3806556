//! Drawing surface of a figure: sizes in CSS pixels, lines, areas, text and legends.
//!
//! The SVG backend rounds to whole units, so a figure is drawn at [`FINE`] units a pixel and
//! shown at that much less.

use maud::{Markup, PreEscaped, Render, html};
use plotters::backend::SVGBackend;
use plotters::coord::Shift;
use plotters::drawing::{DrawingArea, IntoDrawingArea};
use plotters::element::{PathElement, Polygon, Rectangle, Text};
use plotters::style::text_anchor::{HPos, Pos, VPos};
use plotters::style::{Color, FontTransform, IntoFont, RGBColor, TextStyle, WHITE};

use super::palette::{BAND, INK};
use super::style::{Strokes as _, Style};

/// Width of every figure, px.
pub(super) const WIDTH: f64 = 900.0;
/// SVG units a pixel.
const FINE: f64 = 4.0;
/// Factor by which the backend shrinks fonts.
const FONT_SHRINK: f64 = 1.24;

/// Font sizes, px.
pub(super) const TITLE: f64 = 14.0;
pub(super) const LABEL: f64 = 11.5;

/// Where a text has its anchor.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Anchor {
    Left,
    Centre,
    Right,
    /// Centred, reads upwards.
    Upwards,
}

/// A chip of a legend and its text.
pub(super) enum Key<'a> {
    Line(Style, &'a str),
    Band(&'a str),
}

/// Drawing surface of a figure.
pub(super) struct Canvas<'a>(DrawingArea<SVGBackend<'a>, Shift>);

fn fine((x, y): (f64, f64)) -> (i32, i32) {
    ((x * FINE).round() as i32, (y * FINE).round() as i32)
}

/// Estimated width of a text, px; slightly too wide for most fonts.
pub(super) fn text_width(text: &str, size: f64) -> f64 {
    0.58 * size * text.chars().count() as f64
}

/// An SVG image that [`figure`] made.
#[derive(Debug)]
pub(super) struct Svg(pub(super) String);

impl Render for Svg {
    fn render(&self) -> Markup {
        // An image is markup already: its own texts were escaped when it was drawn.
        html! { figure { (PreEscaped(&self.0)) } }
    }
}

/// An SVG image of [`WIDTH`] by `height` px; screen readers read `title` out.
pub(super) fn figure(
    height: f64,
    title: &str,
    draw: impl FnOnce(&Canvas) -> Result<(), String>,
) -> Result<Svg, String> {
    let mut svg = String::new();
    let (width, fine_height) = fine((WIDTH, height));
    {
        let size = (width.unsigned_abs(), fine_height.unsigned_abs());
        let area = SVGBackend::with_string(&mut svg, size).into_drawing_area();
        area.fill(&WHITE).map_err(|e| e.to_string())?;
        draw(&Canvas(area.clone()))?;
        area.present().map_err(|e| e.to_string())?;
    }
    // Shown at its size in pixels, or narrower with its proportions kept.
    let own = format!("width=\"{width}\" height=\"{fine_height}\"");
    let shown = format!("width=\"{WIDTH}\" height=\"{height}\" role=\"img\"");
    let svg = svg.replacen(&own, &shown, 1);
    let svg = svg.replace(
        "font-family=\"sans-serif\"",
        "font-family=\"system-ui, sans-serif\"",
    );
    let title = html! { title { (title) } }.into_string();
    Ok(Svg(svg.replacen(">\n", &format!(">\n{title}\n"), 1)))
}

impl Canvas<'_> {
    /// A polyline of `width` px.
    pub(super) fn line(
        &self,
        points: &[(f64, f64)],
        style: impl Into<Style>,
        width: f64,
    ) -> Result<(), String> {
        let Style { colour, dash } = style.into();
        let stroke = colour.stroke_width((width * FINE).round() as u32);
        for piece in dash.pieces(points) {
            let points: Vec<_> = piece.into_iter().map(fine).collect();
            self.0
                .draw(&PathElement::new(points, stroke))
                .map_err(|e| e.to_string())?;
        }
        Ok(())
    }

    /// A filled area.
    pub(super) fn polygon(&self, points: &[(f64, f64)], colour: RGBColor) -> Result<(), String> {
        let points: Vec<_> = points.iter().copied().map(fine).collect();
        self.0
            .draw(&Polygon::new(points, colour.filled()))
            .map_err(|e| e.to_string())
    }

    /// A rectangle between two corners, filled, or striped from left to right.
    pub(super) fn rectangle(
        &self,
        [(left, top), (right, bottom)]: [(f64, f64); 2],
        style: impl Into<Style>,
    ) -> Result<(), String> {
        let Style { colour, dash } = style.into();
        for [left, right] in dash.spans(left, right) {
            let corners = [(left, top), (right, bottom)].map(fine);
            self.0
                .draw(&Rectangle::new(corners, colour.filled()))
                .map_err(|e| e.to_string())?;
        }
        Ok(())
    }

    /// A text whose middle line is at `y`.
    pub(super) fn text(
        &self,
        text: &str,
        (x, y): (f64, f64),
        anchor: Anchor,
        size: f64,
        colour: RGBColor,
    ) -> Result<(), String> {
        let (horizontal, transform) = match anchor {
            Anchor::Left => (HPos::Left, FontTransform::None),
            Anchor::Centre => (HPos::Center, FontTransform::None),
            Anchor::Right => (HPos::Right, FontTransform::None),
            Anchor::Upwards => (HPos::Center, FontTransform::Rotate270),
        };
        let font = ("sans-serif", size * FINE * FONT_SHRINK).into_font();
        let style = TextStyle::from(font.transform(transform))
            .color(&colour)
            .pos(Pos::new(horizontal, VPos::Center));
        self.0
            .draw(&Text::new(text.to_owned(), fine((x, y)), style))
            .map_err(|e| e.to_string())
    }

    /// A legend from (x, y) on, that breaks its lines before the right edge.
    pub(super) fn legend(&self, keys: &[Key], (x, y): (f64, f64)) -> Result<(), String> {
        for (key, (x, y)) in keys.iter().zip(legend_places(keys, x)).map(|(key, at)| {
            let (dx, row) = at;
            (key, (dx, y + LEGEND_ROW * row as f64))
        }) {
            let name = match key {
                Key::Line(style, name) => {
                    self.line(&[(x, y), (x + CHIP, y)], *style, 3.0)?;
                    name
                }
                Key::Band(name) => {
                    self.rectangle([(x, y - 5.0), (x + CHIP, y + 5.0)], BAND)?;
                    name
                }
            };
            self.text(name, (x + CHIP + 6.0, y), Anchor::Left, LABEL, INK)?;
        }
        Ok(())
    }
}

/// Width of a legend's chip and height of its rows, px.
const CHIP: f64 = 20.0;
const LEGEND_ROW: f64 = 18.0;

/// Height of a legend that begins at `x`, px.
pub(super) fn legend_height(keys: &[Key], x: f64) -> f64 {
    let last_row = legend_places(keys, x).last().map_or(0, |(_, row)| row);
    LEGEND_ROW * (last_row + 1) as f64
}

/// Left end and row of each entry.
fn legend_places(keys: &[Key], left: f64) -> impl Iterator<Item = (f64, usize)> {
    let (mut x, mut row) = (left, 0);
    keys.iter().map(move |key| {
        let (Key::Line(_, name) | Key::Band(name)) = key;
        let width = CHIP + 6.0 + text_width(name, LABEL) + 14.0;
        if x > left && x + width > WIDTH {
            (x, row) = (left, row + 1);
        }
        let place = (x, row);
        x += width;
        place
    })
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;

    /// Values of the attributes of each element of this name and colour.
    fn elements(svg: &str, name: &str, colour: RGBColor, attributes: &[&str]) -> Vec<Vec<String>> {
        let hex = format!("\"#{:02X}{:02X}{:02X}\"", colour.0, colour.1, colour.2);
        let begin = format!("<{name}");
        let tags = svg
            .split(&begin)
            .skip(1)
            .filter_map(|rest| rest.split('>').next());
        let of = |tag: &str| -> Vec<String> {
            let value = |name: &&str| {
                let from = tag.split(&format!(" {name}=\"")).nth(1).expect(name);
                from.split('"').next().unwrap_or_default().to_owned()
            };
            attributes.iter().map(value).collect()
        };
        tags.filter(|tag| tag.contains(&hex)).map(of).collect()
    }

    /// Left end, top, width and height of each rectangle of a colour, px.
    pub(crate) fn rectangles(svg: &str, colour: RGBColor) -> Vec<[f64; 4]> {
        let found = elements(svg, "rect", colour, &["x", "y", "width", "height"]);
        let number = |text: &String| text.parse::<f64>().expect("a number") / FINE;
        let of = |values: Vec<String>| [0, 1, 2, 3].map(|n| number(&values[n]));
        found.into_iter().map(of).collect()
    }

    /// Points of each element of this name, `polyline` or `polygon`, and colour, px.
    pub(crate) fn points(svg: &str, name: &str, colour: RGBColor) -> Vec<Vec<(f64, f64)>> {
        let point = |text: &str| {
            let (x, y) = text.split_once(',').expect("a point");
            let [x, y] = [x, y].map(|text| text.parse::<f64>().expect("a number") / FINE);
            (x, y)
        };
        let found = elements(svg, name, colour, &["points"]);
        let of = |values: Vec<String>| values[0].split_whitespace().map(point).collect();
        found.into_iter().map(of).collect()
    }

    #[test]
    fn figure_has_its_size_its_title_and_escaped_text() {
        let svg = figure(120.0, "a < b", |canvas| {
            canvas.text("<x> & \"y\"", (10.0, 10.0), Anchor::Left, LABEL, INK)?;
            canvas.line(&[(0.0, 0.0), (0.25, 30.0)], INK, 1.0)
        })
        .unwrap()
        .0;
        assert!(svg.starts_with(
            "<svg width=\"900\" height=\"120\" role=\"img\" viewBox=\"0 0 3600 480\""
        ));
        assert!(svg.contains("<title>a &lt; b</title>"));
        assert!(svg.contains("&lt;x&gt; &amp; &quot;y&quot;"), "{svg}");
        assert!(svg.contains("points=\"0,0 1,120"), "{svg}");
        assert!(svg.trim_end().ends_with("</svg>"));
    }

    #[test]
    fn long_legend_breaks_before_the_edge() {
        let names: Vec<String> = (0..20).map(|i| format!("estimator-{i}")).collect();
        let keys: Vec<Key> = names
            .iter()
            .map(|name| Key::Line(INK.into(), name))
            .collect();
        for (x, _) in legend_places(&keys, 50.0) {
            assert!(x + CHIP + 6.0 + text_width("estimator-19", LABEL) <= WIDTH);
        }
        assert!(legend_height(&keys, 50.0) > 2.0 * LEGEND_ROW);
        assert!((legend_height(&keys[..2], 50.0) - LEGEND_ROW).abs() < 1e-9);
    }
}
