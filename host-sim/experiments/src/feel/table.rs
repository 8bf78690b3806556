//! Tables for a terminal.

use std::fmt::Write as _;

use super::{Felt, Settings};
use crate::table::layout::{Column, table as laid_out};
use crate::table::{columns, number};
use crate::transparency::{Cause, Parasitic, Part};
use terminal::wording::wrapped;

/// Two tables for each case, in lines of `width` characters: the causes, and the force without each.
#[must_use]
pub fn table(all: &[Felt], settings: &Settings, width: usize) -> String {
    let mut text = wrapped(
        "What the hand feels beside the scene. Share: part of the mean square of the parasitic force that \
         goes with the cause; the shares add up to 100 %, and a cause that opposes the others has a \
         negative one.",
        0,
    );
    text.push('\n');
    for felt in all {
        let case = &felt.case;
        let _ = writeln!(
            text,
            "\n{} at {} Hz, seed {}, controlled by {}",
            case.scene,
            case.rate_hz,
            settings.seed,
            case.estimator_name()
        );
        if let Some(found) = &felt.attribution {
            let names = Cause::ALL.iter().map(|cause| cause.name().to_owned());
            let numbers = |head, unit, of: fn(&Part) -> Option<f64>| {
                let cells = found.parts.iter().map(|part| number(of(part)));
                Column::numbers(head, unit, cells)
            };
            let percent = |share: Option<f64>| share.map(|share| 100.0 * share);
            let shares = |head, of: fn(&Part) -> Option<f64>| {
                let cells = found.parts.iter().map(|part| match percent(of(part)) {
                    Some(share) => format!("{share:.1}"),
                    None => number(None),
                });
                Column::numbers(head, "%", cells)
            };
            let columns = [
                numbers("force", "rms, mN", |part| Some(part.rms_mn)),
                shares("share", |part| part.share),
                numbers("50-500 Hz", "rms, mN", |part| part.tactile_mn),
                shares("share", |part| part.tactile_share),
            ];
            text += &laid_out(&Column::text("", "cause", names), &columns, width);
        }
        let rows: Vec<(&str, Parasitic)> = std::iter::once(("nothing", felt.parasitic))
            .chain((felt.without.iter()).map(|(without, scores)| (without.name(), *scores)))
            .collect();
        let names = rows.iter().map(|(name, _)| (*name).to_owned());
        let scores = rows.iter().map(|(_, scores)| scores);
        let scores: Vec<Column> = columns(Parasitic::FIELDS, &[], scores).collect();
        text += &laid_out(&Column::text("", "without", names), &scores, width);
    }
    text
}
