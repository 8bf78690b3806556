//! The velocity that a recording without a truth is scored against.

use experiments::reference::{Reference, interruptions};
use recordings::log::{Log, called};
use recordings::recording::Survey;
use scoring::score::{SKIP_S, skipped};
use simulation::device::Device;
use terminal::failure::Failure;

use super::{ReferenceUse, Replay};

/// Largest number of rows of which a reference is computed unasked.
const UNASKED: usize = 2_000_000;

/// What was computed of a whole recording.
#[derive(Default)]
pub(super) struct Referenced {
    /// The reference, if it is needed.
    pub(super) reference: Option<Reference>,
    /// Why a recording without a truth has no scores.
    pub(super) without: Option<String>,
    /// The rows that are no motion.
    pub(super) interruptions: Option<String>,
}

/// The reference, if it is needed.
pub(super) fn reference(
    options: &Replay,
    log: &Log,
    survey: &Survey,
    device: &Device,
) -> Result<Referenced, Failure> {
    let without = |why| Referenced {
        without: Some(why),
        ..Referenced::default()
    };
    let has_truth = survey.columns.true_omega.is_some();
    let called = called(&options.trace);
    match options.reference {
        Some(ReferenceUse::Off) if !has_truth && options.json.is_some() => {
            return Err(Failure::Input(format!(
                "{called}: line 1: no column true_omega, which --json needs for the scores with \
                 --reference off; add it or leave out --reference off"
            )));
        }
        Some(ReferenceUse::Off) => return Ok(Referenced::default()),
        None | Some(ReferenceUse::Scores) if has_truth => return Ok(Referenced::default()),
        None if survey.rows > UNASKED && options.json.is_none() => {
            let why = format!(
                "no column true_omega, and {} rows; --reference scores computes a reference of them",
                survey.rows
            );
            return Ok(without(why));
        }
        _ => {}
    }
    let unscored = unscored(survey);
    let in_columns = options.reference == Some(ReferenceUse::Columns);
    let recording = options.recording.read(log, device)?;
    match Reference::of(&recording, device.stages.large.counts_per_rev) {
        Ok(_) if unscored.is_some() && options.json.is_none() && !in_columns => Ok(Referenced {
            without: unscored,
            ..Referenced::default()
        }),
        Ok(reference) => Ok(Referenced {
            interruptions: interruptions(&recording, (!has_truth).then_some(&reference)),
            reference: Some(reference),
            without: None,
        }),
        // Velocities alone need no reference.
        Err(why) if options.json.is_none() && !in_columns => {
            Ok(without(format!("{why}; --reference off computes none")))
        }
        Err(why) => Err(Failure::Input(format!(
            "{called}: {why}; --reference off without --json writes velocities alone"
        ))),
    }
}

/// Why a recording has no scores that ends before they begin.
pub(super) fn unscored(survey: &Survey) -> Option<String> {
    let (rows, rate_hz) = (survey.rows, survey.columns.rate_hz);
    let is_short = rows <= skipped(rate_hz);
    is_short.then(|| format!("{rows} rows at {rate_hz} Hz; scores begin after {SKIP_S} s"))
}
