//! The page around the sections.

use super::ReportInput;
use super::palette::Palette;
use super::sections::sections;
use super::text::{escape, plant, rate};
use super::verdict::verdict;
use crate::parameters::PlantKind;

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
    let style = include_str!("page.css");
    let script = include_str!("page.js");
    Ok(format!(
        "<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\">\n\
         <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n\
         <title>Velocity estimators compared</title>\n<style>\n{style}</style></head>\n<body>\n\
         <header><h1>Velocity estimators compared</h1>\n{verdict}{}{notes}</header>\n\
         <nav aria-label=\"Contents\">{links}</nav>\n<main>\n{body}</main>\n\
         <script>\n{script}</script>\n</body></html>\n",
        run(report)
    ))
}

/// What was run.
fn run(report: &ReportInput) -> String {
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
            let closed_with = |case: &crate::felt::Case| case.plant == PlantKind::Friction;
            report.cases.iter().any(|case| case.friction == friction)
                || closed().any(|case| closed_with(case) == friction)
        })
        .map(plant)
        .collect();
    let list = |items: Vec<String>| items.join(", ");
    let facts = [
        (
            "command",
            format!("<code>{}</code>", escape(&report.command)),
            report.command.is_empty(),
        ),
        ("device", escape(&report.device.name), false),
        ("plant", plants.join(" and "), plants.is_empty()),
        (
            "sample rates",
            list(rates.iter().map(|hz| rate(*hz)).collect()),
            rates.is_empty(),
        ),
        (
            "seeds",
            list(seeds.iter().map(u64::to_string).collect()),
            seeds.is_empty(),
        ),
    ];
    let facts = facts.into_iter().filter(|(_, _, is_empty)| !is_empty);
    let facts: String = facts
        .map(|(what, value, _)| format!("<div><dt>{what}</dt><dd>{value}</dd></div>\n"))
        .collect();
    format!("<dl>{facts}</dl>\n")
}
