//! The page around the sections.

use super::ReportInput;
use super::palette::Palette;
use super::sections::sections;
use super::text::{escape, plant, rate};
use super::verdict::verdict;
use crate::version::VERSION;
use catalogue::parameters::PlantKind;

/// The whole document.
pub(super) fn page(report: &ReportInput) -> Result<String, String> {
    let palette = Palette::new(report);
    let sections = sections(report, &palette)?;
    let links: String = sections
        .iter()
        .map(|section| format!("<a href=\"#{}\">{}</a>\n", section.id, section.title))
        .collect();
    let body: String = sections
        .iter()
        .map(|s| {
            format!(
                "<section id=\"{}\"><h2>{}</h2>\n{}</section>\n",
                s.id, s.title, s.body
            )
        })
        .collect();
    let verdict = verdict(report, &palette)
        .map(|text| format!("<p class=\"verdict\">{}</p>\n", escape(&text)))
        .unwrap_or_default();
    let notes: String = report
        .notes
        .iter()
        .map(|note| format!("<p>{}</p>\n", escape(note)))
        .collect();
    Ok(Document {
        title: "Velocity estimators compared",
        intro: verdict,
        facts: facts(report),
        notes,
        contents: links,
        body,
    }
    .html())
}

/// A page that loads nothing from anywhere.
pub(super) struct Document<'a> {
    pub(super) title: &'a str,
    /// HTML below the title.
    pub(super) intro: String,
    /// Names and values of what was run; the version is added.
    pub(super) facts: Vec<(&'a str, String)>,
    /// HTML below the facts.
    pub(super) notes: String,
    /// HTML of the links to sections; empty without.
    pub(super) contents: String,
    /// HTML of the page itself.
    pub(super) body: String,
}

impl Document<'_> {
    pub(super) fn html(&self) -> String {
        let Self {
            title,
            intro,
            notes,
            contents,
            body,
            ..
        } = self;
        let (style, script) = (include_str!("page.css"), include_str!("page.js"));
        let version = ("version", VERSION.to_owned());
        let facts: String = (self.facts.iter().chain([&version]))
            .filter(|(_, value)| !value.is_empty())
            .map(|(what, value)| {
                let value = match *what {
                    "command" => format!("<code>{}</code>", escape(value)),
                    _ => escape(value),
                };
                format!("<div><dt>{what}</dt><dd>{value}</dd></div>\n")
            })
            .collect();
        let nav = match contents.is_empty() {
            true => String::new(),
            false => format!("<nav aria-label=\"Contents\">{contents}</nav>\n"),
        };
        format!(
            "<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\">\n\
             <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n\
             <title>{title}</title>\n<style>\n{style}</style></head>\n<body>\n\
             <header><h1>{title}</h1>\n{intro}<dl>{facts}</dl>\n{notes}</header>\n\
             {nav}<main>\n{body}</main>\n<script>\n{script}</script>\n</body></html>\n"
        )
    }
}

/// A table as it is printed.
pub(super) fn printed(table: &str) -> String {
    format!("<pre class=\"scroll\">{}</pre>\n", escape(table))
}

/// What was run.
fn facts(report: &ReportInput) -> Vec<(&'static str, String)> {
    let closed = || report.closed_loop.outcomes.iter().map(|o| &o.case);
    let compared = report.cases.iter().map(|case| case.rate_hz);
    let mut rates: Vec<f64> = compared.chain(closed().map(|case| case.rate_hz)).collect();
    rates.sort_by(f64::total_cmp);
    rates.dedup();
    let compared = report.cases.iter().map(|case| case.seed);
    let mut seeds: Vec<u64> = compared.chain(closed().map(|case| case.seed)).collect();
    seeds.sort_unstable();
    seeds.dedup();
    let plants: Vec<&str> = [false, true]
        .into_iter()
        .filter(|&friction| {
            let closed_with =
                |case: &experiments::transparency::LoopCase| case.plant == PlantKind::Friction;
            report.cases.iter().any(|case| case.friction == friction)
                || closed().any(|case| closed_with(case) == friction)
        })
        .map(plant)
        .collect();
    let list = |items: Vec<String>| items.join(", ");
    vec![
        ("command", report.command.clone()),
        ("device", report.device.name.clone()),
        ("plant", plants.join(" and ")),
        (
            "sample rates",
            list(rates.iter().map(|hz| rate(*hz)).collect()),
        ),
        ("seeds", list(seeds.iter().map(u64::to_string).collect())),
    ]
}
