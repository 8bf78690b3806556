//! The page of a comparison: its head, its facts and its sections.

use catalogue::parameters::PlantKind;
use maud::{Markup, html};

use super::ReportInput;
use super::page::Document;
use super::palette::Palette;
use super::section::Section;
use super::sections::sections;
use super::text::{plant, rate};
use super::verdict::verdict;

/// The whole document.
pub(super) fn page(report: &ReportInput) -> Result<String, String> {
    let palette = Palette::new(report);
    let sections = sections(report, &palette)?;
    let each =
        |part: fn(&Section) -> Markup| html! { @for section in &sections { (part(section)) } };
    Ok(Document {
        title: "Velocity estimators compared",
        intro: html! {
            @if let Some(text) = verdict(report, &palette) { p.verdict { (text) } }
        },
        command: &report.command,
        facts: facts(report),
        notes: html! { @for note in &report.notes { p { (note) } } },
        contents: Some(each(Section::link)),
        body: each(Section::markup),
    }
    .html())
}

/// Plants, rates and seeds of the runs.
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
        ("device", report.device_name.clone()),
        ("plant", plants.join(" and ")),
        (
            "sample rates",
            list(rates.iter().map(|hz| rate(*hz)).collect()),
        ),
        ("seeds", list(seeds.iter().map(u64::to_string).collect())),
    ]
}

#[cfg(test)]
mod tests {
    use super::super::CaseReport;
    use super::*;

    #[test]
    fn facts_name_every_rate_seed_and_plant_once_and_in_order() {
        let case = |rate_hz, friction, seed| CaseReport {
            rate_hz,
            friction,
            seed,
            ..CaseReport::default()
        };
        let mut report = ReportInput {
            device_name: "mine.toml".to_owned(),
            cases: vec![
                case(11_600.0, true, 10),
                case(1000.0, true, 2),
                case(1000.0, true, 10),
                case(1000.0, true, 1),
            ],
            ..ReportInput::default()
        };
        let told = |report: &ReportInput| {
            facts(report)
                .into_iter()
                .map(|(_, value)| value)
                .collect::<Vec<_>>()
        };
        let rates = "1 kHz, 11.6 kHz";
        assert_eq!(
            told(&report),
            ["mine.toml", "with friction", rates, "1, 2, 10"]
        );
        report.cases.push(case(1000.0, false, 1));
        assert_eq!(told(&report)[1], "without friction and with friction");
    }

    #[test]
    fn every_note_is_on_the_page() {
        let report = ReportInput {
            notes: ["first note", "second note"].map(str::to_owned).to_vec(),
            ..ReportInput::default()
        };
        let page = page(&report).unwrap();
        assert!(
            report
                .notes
                .iter()
                .all(|note| page.contains(&format!("<p>{note}</p>")))
        );
    }
}
