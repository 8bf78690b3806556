//! The page around sections, figures and tables.

use maud::{DOCTYPE, Markup, PreEscaped, html};

use super::canvas::Svg;
use super::version::VERSION;

/// A page that loads no other file.
pub(super) struct Document<'a> {
    pub(super) title: &'a str,
    /// Below the title.
    pub(super) intro: Markup,
    /// The command line that made the page.
    pub(super) command: &'a str,
    /// Further names and values of what was run; a fact without value is left out, and the version
    /// is added.
    pub(super) facts: Vec<(&'static str, String)>,
    /// Below the facts.
    pub(super) notes: Markup,
    /// Links to the sections; `None` without a navigation.
    pub(super) contents: Option<Markup>,
    pub(super) body: Markup,
}

impl Document<'_> {
    pub(super) fn html(&self) -> String {
        let version = ("version", VERSION.to_owned());
        let facts = self.facts.iter().chain([&version]);
        // Neither file contains text from outside, and `>` and quotes are part of their syntax.
        let style = PreEscaped(include_str!("page.css"));
        let script = PreEscaped(include_str!("page.js"));
        let page = html! {
            (DOCTYPE)
            html lang="en" {
                head {
                    meta charset="utf-8";
                    meta name="viewport" content="width=device-width, initial-scale=1";
                    title { (self.title) }
                    style { (style) }
                }
                body {
                    header {
                        h1 { (self.title) }
                        (self.intro)
                        dl {
                            @if !self.command.is_empty() {
                                div { dt { "command" } dd { code { (self.command) } } }
                            }
                            @for (name, value) in facts.filter(|(_, value)| !value.is_empty()) {
                                div { dt { (name) } dd { (value) } }
                            }
                        }
                        (self.notes)
                    }
                    @if let Some(contents) = &self.contents {
                        nav aria-label="Contents" { (contents) }
                    }
                    main { (self.body) }
                    script { (script) }
                }
            }
        };
        page.into_string()
    }
}

/// What a command was asked for and what it printed.
#[derive(Clone, Copy, Debug, Default)]
pub struct Printout<'a> {
    /// The command line.
    pub command: &'a str,
    /// Name of the device; empty where the page does not show it.
    pub device: &'a str,
    /// The table as text.
    pub table: &'a str,
}

impl Printout<'_> {
    /// A page of figures without navigation, below them the table.
    pub(super) fn page(&self, title: &str, intro: &str, figures: &[Svg]) -> String {
        Document {
            title,
            intro: html! { p { (intro) } },
            command: self.command,
            facts: vec![("device", self.device.to_owned())],
            notes: Markup::default(),
            contents: None,
            body: html! {
                @for figure in figures { (figure) }
                pre.scroll { (self.table) }
            },
        }
        .html()
    }
}
