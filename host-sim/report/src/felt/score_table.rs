//! The closed loop's scores in numbers.

use std::fmt::Write as _;

use super::super::palette::Palette;
use super::super::score_tables::{head, label, score_cell};
use super::super::sections::words;
use super::super::text::{escape, plant, rate};
use super::{ClosedLoop, has_loop};
use catalogue::parameters::PlantKind;
use experiments::transparency::table::velocity_fields;
use experiments::transparency::{Outcome, Parasitic, Run};

const SCORES: &str = "The best estimator of each scene is bold on green; the reference encoder \
    does not compete. Force is the parasitic force at the fingertip: RMS, the force that is exceeded \
    for 1\u{a0}% of the time, and the RMS from 50 to 500 Hz. Unnoticed is the share of time in which \
    it is below the fingertip\u{2019}s threshold. The last column is the RMS error of the velocity \
    that the loop used.";

/// The columns: parasitic forces, then the velocity that the loop used.
fn heads() -> String {
    let forces = Parasitic::FIELDS.iter().map(head).collect::<String>();
    forces + &velocity_fields(&[]).map(head).collect::<String>()
}

/// One table a rate, scenes as its blocks.
pub(super) fn tables(closed: &ClosedLoop, palette: &Palette) -> String {
    let same =
        |a: &Outcome, b: &Outcome| a.case.rate_hz == b.case.rate_hz && a.case.plant == b.case.plant;
    let tables = closed.outcomes.chunk_by(same);
    words(SCORES)
        + &tables
            .map(|outcomes| table(outcomes, palette))
            .collect::<String>()
}

fn table(outcomes: &[Outcome], palette: &Palette) -> String {
    let case = &outcomes[0].case;
    let mut html = format!(
        "<div class=\"scroll\"><table class=\"scores sortable\"><caption>{}, plant {}, loop \
         closed</caption>\n<thead><tr><th>controlled by</th>",
        rate(case.rate_hz),
        plant(case.plant == PlantKind::Friction)
    );
    html += &heads();
    html += "</tr></thead>\n";
    for outcome in outcomes {
        html += &block(outcome, palette);
    }
    html + "</table></div>\n"
}

fn block(outcome: &Outcome, palette: &Palette) -> String {
    let mut html = format!(
        "<tbody><tr class=\"scenario\"><th colspan=\"{}\" scope=\"rowgroup\">{}</th></tr>\n",
        Parasitic::FIELDS.len() + velocity_fields(&[]).count() + 1,
        escape(outcome.case.scene.name())
    );
    let competes = |run: &&Run| run.controlled_by != experiments::transparency::REFERENCE;
    for run in &outcome.runs {
        let mut name = if has_loop(outcome) {
            label(run.controlled_by, palette)
        } else {
            escape(run.controlled_by)
        };
        if let Some(cause) = run.stopped {
            let _ = write!(name, " <em class=\"bad\">stopped: {cause}</em>");
        }
        let _ = write!(html, "<tr><th scope=\"row\">{name}</th>");
        let runs = outcome.runs.iter().filter(competes);
        for field in Parasitic::FIELDS {
            let all = runs.clone().filter_map(|run| (field.of)(&run.parasitic));
            let value = (field.of)(&run.parasitic);
            html += &score_cell(field, value, all, competes(&run));
        }
        for field in velocity_fields(&[]) {
            let of = |run: &Run| run.velocity.as_ref().and_then(field.of);
            let value = of(run);
            let all = runs.clone().filter_map(of);
            html += &score_cell(field, value, all, competes(&run));
        }
        html += "</tr>\n";
    }
    html + "</tbody>\n"
}
