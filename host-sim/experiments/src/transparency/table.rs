//! The closed-loop scores as text for a terminal.

use std::fmt::Write as _;

use super::{Outcome, Parasitic};
use crate::table::layout::{Column, table};
use crate::table::{columns, number};
use device_files::six_digits;
use scoring::score::{Field, Score};

/// Velocity score that is shown by default.
const VELOCITY: &str = "rms_rad_s";

/// One table per case with one line per run, in lines of `width` characters: parasitic forces, then
/// the scores `asked` of the velocity that the loop used.
#[must_use]
pub fn details(outcomes: &[Outcome], asked: &[&Field<Score>], width: usize) -> String {
    let mut text = String::new();
    for outcome in outcomes {
        let case = &outcome.case;
        let (scene, rate_hz, plant) = (case.scene, case.rate_hz, case.plant.phrase());
        let _ = writeln!(
            text,
            "{scene} at {rate_hz} Hz, plant {plant}, loop closed; unnoticed: below {} mN",
            six_digits(outcome.fingertip.threshold_mn)
        );
        let loops = outcome.runs.iter().map(|run| run.controlled_by.to_owned());
        let forces = || outcome.runs.iter().map(|run| &run.parasitic);
        let mut all: Vec<_> = columns(Parasitic::FIELDS, &[], forces()).collect();
        all.extend(velocity_fields(asked).map(|field| {
            let scores = outcome.runs.iter().map(|run| run.velocity.as_ref());
            let cells = scores.map(|score| number(score.and_then(|score| field.shown(score))));
            let head = format!("velocity {}", field.head);
            Column::numbers(&head, field.unit, cells)
        }));
        if outcome.runs.iter().any(|run| run.stopped.is_some()) {
            let causes = outcome.runs.iter().map(|run| run.stopped.unwrap_or("-"));
            all.push(Column::text("", "stopped", causes.map(str::to_owned)));
        }
        text += &table(&Column::text("", "controlled by", loops), &all, width);
    }
    text
}

/// The scores of the velocity that tables of the closed loop show.
pub fn velocity_fields<'a>(
    asked: &'a [&Field<Score>],
) -> impl Iterator<Item = &'static Field<Score>> + 'a {
    Score::FIELDS.iter().filter(move |field| match asked {
        [] => field.name == VELOCITY,
        asked => asked.iter().any(|of| of.name == field.name),
    })
}
