//! The page of `recommend`: ranking, the velocity in one second of each recording, and the lines of
//! Rust.

use maud::html;

use experiments::real::sources::Role;
use experiments::recommend::Recommendation;

use super::page::{Document, Printout};
use super::palette::Palette;
use super::real::motion::{self, Signals};
use super::real::ranking::{self, Rank};

/// The page of a recommendation. `lines` say which estimators to use, with the lines of Rust.
///
/// # Errors
/// If a figure cannot be drawn.
pub fn recommend(
    recommendation: &Recommendation,
    lines: &str,
    notes: &[String],
    printout: &Printout,
) -> Result<String, String> {
    let ranked = &recommendation.ranked;
    let palette = Palette::of(ranked.iter().map(|row| row.estimator));
    let ranks: Vec<Rank> = ranked
        .iter()
        .map(|row| Rank {
            estimator: row.estimator,
            mean: row.rms_pct,
            errors: row
                .logs
                .iter()
                .map(|log| (Role::Judges, log.rms_pct))
                .collect(),
        })
        .collect();
    let title = "RMS error by recording";
    let legend =
        "mark: a recording; bar: geometric mean; a value beyond the frame stands at its edge";
    let mut figures = vec![ranking::chart(&ranks, title, legend, &palette)?];
    let drawn: Vec<_> = ranked
        .iter()
        .filter(|row| row.recommended.is_some() || row.estimator == "low-pass")
        .map(|row| row.estimator)
        .collect();
    for outcome in &recommendation.outcomes {
        let signals = Signals {
            truth: outcome.omega(),
            known: (outcome.reference.as_ref()).and_then(|reference| reference.known.as_deref()),
            called: if outcome.reference.is_some() {
                "reference"
            } else {
                "truth"
            },
            estimates: &outcome.estimates,
            rate_hz: outcome.recording.trace.rate_hz,
        };
        let title = format!("{}: the second with the largest errors", outcome.file());
        figures.push(motion::velocity(&title, &signals, &drawn, &palette)?);
    }
    let intro = "Velocity estimators on recordings of one device, as shipped. The RMS error is in % of \
        that of finite difference on the same samples.";
    Ok(Document {
        title: "Which estimator to use",
        intro: html! { p { (intro) } },
        command: printout.command,
        facts: vec![("device", printout.device.to_owned())],
        notes: html! { @for line in notes { p { (line) } } },
        contents: None,
        body: html! {
            pre.scroll { (lines) }
            @for figure in &figures { (figure) }
            pre.scroll { (printout.table) }
        },
    }
    .html())
}
