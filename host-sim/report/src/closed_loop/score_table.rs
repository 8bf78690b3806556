//! Tables of the closed-loop scores.

use maud::{Markup, html};

use super::super::palette::Palette;
use super::super::score_tables::{block_head, head, label, score_cell};
use super::super::section::explanation;
use super::super::text::{plant, rate};
use super::{ClosedLoop, uses_velocity};
use catalogue::parameters::PlantKind;
use experiments::transparency::table::velocity_fields;
use experiments::transparency::{Outcome, Parasitic, REFERENCE, Run};

const SCORES: &str = "Bold on green marks the best estimator of each scene; the reference \
    encoder does not compete. Force is the parasitic force at the fingertip: RMS, 99th \
    percentile, and RMS of the part that is felt as roughness. Unnoticed is the share of time in which it is below \
    the threshold of a fingertip. The last column is the RMS error of the velocity that the \
    loop used.";

/// One table a rate, scenes as its blocks.
pub(super) fn tables(closed: &ClosedLoop, palette: &Palette) -> Markup {
    let same =
        |a: &Outcome, b: &Outcome| a.case.rate_hz == b.case.rate_hz && a.case.plant == b.case.plant;
    html! {
        (explanation(SCORES))
        @for outcomes in closed.outcomes.chunk_by(same) { (table(outcomes, palette)) }
    }
}

/// The columns are parasitic forces, then the velocity that the loop used.
fn table(outcomes: &[Outcome], palette: &Palette) -> Markup {
    let case = &outcomes[0].case;
    html! {
        div.scroll {
            table.scores.sortable {
                caption {
                    (rate(case.rate_hz)) ", plant " (plant(case.plant == PlantKind::Friction))
                    ", loop closed"
                }
                thead {
                    tr {
                        th { "controlled by" }
                        @for field in Parasitic::FIELDS { (head(field)) }
                        @for field in velocity_fields(&[]) { (head(field)) }
                    }
                }
                @for outcome in outcomes { (block(outcome, palette)) }
            }
        }
    }
}

fn block(outcome: &Outcome, palette: &Palette) -> Markup {
    let columns = Parasitic::FIELDS.len() + velocity_fields(&[]).count();
    html! {
        tbody {
            (block_head(outcome.case.scene.name(), columns))
            @for run in &outcome.runs {
                tr {
                    th scope="row" {
                        @if uses_velocity(outcome) {
                            (label(run.controlled_by, palette))
                        } @else {
                            (run.controlled_by)
                        }
                        @if let Some(cause) = run.stopped {
                            " " em.bad { "stopped: " (cause) }
                        }
                    }
                    (cells(run, &outcome.runs))
                }
            }
        }
    }
}

/// The values of one run among `all` of its scene.
fn cells(run: &Run, all: &[Run]) -> Markup {
    let competes = |run: &&Run| run.controlled_by != REFERENCE;
    let runs = all.iter().filter(competes);
    html! {
        @for field in Parasitic::FIELDS {
            @let of = |run: &Run| (field.of)(&run.parasitic);
            (score_cell(field, of(run), runs.clone().filter_map(of), competes(&run)))
        }
        @for field in velocity_fields(&[]) {
            @let of = |run: &Run| run.velocity.as_ref().and_then(field.of);
            (score_cell(field, of(run), runs.clone().filter_map(of), competes(&run)))
        }
    }
}
