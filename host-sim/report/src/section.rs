//! One part of a page: a heading with its anchor, figures, tables and their explanation.

use maud::{Markup, html};

use super::canvas::Svg;

/// A part of the page that the navigation links to.
pub(super) struct Section {
    id: &'static str,
    title: &'static str,
    body: Markup,
}

impl Section {
    /// `None` without a body: the page leaves such a section out.
    pub(super) fn new(id: &'static str, title: &'static str, body: Option<Markup>) -> Option<Self> {
        body.map(|body| Self { id, title, body })
    }

    /// Link of the navigation.
    pub(super) fn link(&self) -> Markup {
        html! { a href={ "#" (self.id) } { (self.title) } }
    }

    /// Heading and body.
    pub(super) fn markup(&self) -> Markup {
        html! { section id=(self.id) { h2 { (self.title) } (self.body) } }
    }
}

/// Explanation of figures or tables.
pub(super) fn explanation(text: &str) -> Markup {
    html! { p.look { (text) } }
}

/// Figures and below them their explanation; `None` without a figure.
pub(super) fn explained(figures: impl IntoIterator<Item = Svg>, text: &str) -> Option<Markup> {
    let figures: Vec<Svg> = figures.into_iter().collect();
    (!figures.is_empty())
        .then(|| html! { @for figure in &figures { (figure) } (explanation(text)) })
}

/// The parts that are there, one below the other; `None` if there is none.
pub(super) fn joined(parts: impl IntoIterator<Item = Option<Markup>>) -> Option<Markup> {
    let parts = parts.into_iter().flatten();
    parts.reduce(|above, below| html! { (above) (below) })
}
