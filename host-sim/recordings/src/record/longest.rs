//! The file of a session that may have several runs.

use std::path::Path;

use terminal::failure::Failure;
use terminal::output::{is_stdout, note, write_whole};

use super::{choose, report};
use crate::telemetry::{Run, Telemetry};

/// Writes the longest run of a session to the file `out`, and tells on standard error what the file lacks.
/// `csv` gives the text of a run.
///
/// # Errors
/// [`Failure::Input`] if there are fewer than two frames, or the file cannot be written;
/// [`Failure::Check`] after a start of the firmware, as the other runs are lost.
pub fn write_longest(
    telemetry: &Telemetry,
    out: &Path,
    csv: impl Fn(&Run) -> String,
) -> Result<(), Failure> {
    let name = match is_stdout(out) {
        true => "standard output".to_owned(),
        false => out.display().to_string(),
    };
    let runs = telemetry.runs();
    if runs.is_empty() {
        return Err(Failure::Input(format!(
            "{name}: not written: no telemetry frame came; record for longer"
        )));
    }
    let run = choose(&runs, None)
        .map_err(|error| Failure::Input(format!("{name}: not written: {error}")))?;
    write_whole(out, csv(run).as_bytes())?;
    for line in report(telemetry, &runs, run, "") {
        note(format_args!("{name}: {line}"));
    }
    match runs.len() {
        1 => Ok(()),
        starts => Err(Failure::Check(format!(
            "{name}: the firmware started {starts} times, and only the longest run is in the file; find the \
             cause of the reset, then record again"
        ))),
    }
}
