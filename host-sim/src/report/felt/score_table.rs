//! The closed loop's scores in numbers.

use std::fmt::Write as _;

use super::super::palette::Palette;
use super::super::score_tables::{cell, label};
use super::super::sections::words;
use super::super::text::{escape, number, plant, rate, share};
use super::{ClosedLoop, has_loop};
use crate::felt::{Outcome, Run};
use crate::parameters::PlantKind;

const SCORES: &str = "The best estimator of each scene is bold on green; the reference encoder \
    does not compete. 99\u{a0}% is the force that is exceeded for 1\u{a0}% of the time. Velocity is \
    the RMS error of the velocity that the loop used.";

/// How one score is shown.
struct Column {
    head: &'static str,
    unit: &'static str,
    of: fn(&Run) -> Option<f64>,
    show: fn(f64) -> String,
    more_is_better: bool,
}

const COLUMNS: [Column; 5] = [
    Column {
        head: "parasitic force",
        unit: "rms, mN",
        of: |run| run.parasitic.parasitic_mn_rms,
        show: number,
        more_is_better: false,
    },
    Column {
        head: "99 %",
        unit: "mN",
        of: |run| run.parasitic.parasitic_mn_p99,
        show: number,
        more_is_better: false,
    },
    Column {
        head: "50\u{2013}500 Hz",
        unit: "rms, mN",
        of: |run| run.parasitic.parasitic_mn_tactile,
        show: number,
        more_is_better: false,
    },
    Column {
        head: "below threshold",
        unit: "of time",
        of: |run| run.parasitic.below_threshold,
        show: share,
        more_is_better: true,
    },
    Column {
        head: "velocity",
        unit: "rms, rad/s",
        of: |run| run.velocity_rms,
        show: number,
        more_is_better: false,
    },
];

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
    for column in &COLUMNS {
        let _ = write!(
            html,
            "<th aria-sort=\"none\"><button type=\"button\">{}<small>{}</small></button></th>",
            column.head, column.unit
        );
    }
    html += "</tr></thead>\n";
    for outcome in outcomes {
        html += &block(outcome, palette);
    }
    html + "</table></div>\n"
}

fn block(outcome: &Outcome, palette: &Palette) -> String {
    let mut html = format!(
        "<tbody><tr class=\"scenario\"><th colspan=\"{}\" scope=\"rowgroup\">{}</th></tr>\n",
        COLUMNS.len() + 1,
        escape(outcome.case.scene.as_str())
    );
    let competes = |run: &&Run| run.controlled_by != crate::felt::REFERENCE;
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
        for column in &COLUMNS {
            let sign = if column.more_is_better { -1.0 } else { 1.0 };
            let scores: Vec<f64> = (outcome.runs.iter().filter(competes))
                .filter_map(|run| Some(sign * (column.of)(run)?))
                .collect();
            let least = scores.iter().copied().reduce(f64::min);
            let alike = scores.iter().all(|score| Some(*score) == least);
            html += &match (column.of)(run) {
                Some(value) => {
                    let is_best = !alike && competes(&run) && Some(sign * value) == least;
                    cell(&(column.show)(value), value, is_best)
                }
                None => "<td class=\"none\">\u{2013}</td>".into(),
            };
        }
        html += "</tr>\n";
    }
    html + "</tbody>\n"
}
