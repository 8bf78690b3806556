//! `host-sim replay`.

use crate::failure::Failure;
use crate::output::{print_bytes, write_whole};
use crate::recording::Recording;
use crate::{replay, rows, table};

use super::arguments::{Replay, is_stdout, kinds};

pub(super) fn run(options: &Replay) -> Result<(), Failure> {
    let kinds = kinds(&options.estimators)?;
    let device = options.device.load()?;
    let parameters = options.parameters.load()?;
    let name = replay::name(&options.trace);
    let recording = Recording::read(&options.trace)?;
    if options.json.is_some() && recording.trace.true_omega.is_none() {
        return Err(Failure::Input(format!(
            "{}: line 1: no column true_omega, which the scores of --json are against",
            options.trace.display()
        )));
    }
    let replayed = replay::replay(&recording, &name, &kinds, &device, &parameters)?;

    if let (true, Some((estimator, column))) =
        (replayed.estimates.is_empty(), replayed.left_out.first())
    {
        return Err(Failure::Input(format!(
            "{}: line 1: no column {column}, which {estimator} needs; see host-sim estimators",
            options.trace.display()
        )));
    }
    for (estimator, column) in &replayed.left_out {
        eprintln!("{name}: {estimator} left out: no column {column}");
    }
    warn_uneven(&name, &recording);
    let csv = replay::csv(&recording.t, &replayed.estimates);
    match (options.out.as_deref(), options.json.as_deref()) {
        (Some(out), Some(json)) if is_stdout(out) && is_stdout(json) => {
            return Err(Failure::Input(
                "--out - and --json -: only one of them can go to standard output".to_owned(),
            ));
        }
        (Some(out), _) if !is_stdout(out) => write_whole(out, &csv)?,
        (None, Some(json)) if is_stdout(json) => {}
        _ => print_bytes(&csv)?,
    }
    let rows = &replayed.rows;
    match &options.json {
        Some(path) if is_stdout(path) => return print_bytes(&rows::json(rows)?),
        Some(path) => write_whole(path, &rows::json(rows)?)?,
        None => {}
    }
    match &options.out {
        Some(out) if !is_stdout(out) => print_bytes(table::details(rows).as_bytes()),
        _ => Ok(()),
    }
}

/// Says where estimators cannot know how long a tick was.
pub(super) fn warn_uneven(name: &str, recording: &Recording) {
    if recording.uneven_steps > 0 {
        eprintln!(
            "{name}: {} of {} steps of t differ by more than 10 % from 1/{} s; estimators take \
             every step for one tick",
            recording.uneven_steps,
            recording.t.len() - 1,
            recording.trace.rate_hz,
        );
    }
}
