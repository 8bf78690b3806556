//! `host-sim replay`.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use clap::Args;

use crate::failure::Failure;
use crate::output::{is_stdout, note, print_bytes, write_whole, write_with};
use crate::recording::{BoardColumns, Recording};
use crate::table::layout::terminal_width;
use crate::{replay, rows, table};

use super::arguments::{DeviceFile, ParameterOptions, kinds};
use super::page::one_to_stdout;

#[derive(Debug, Args)]
pub(super) struct Replay {
    /// Recording: CSV with columns t (s) and counts_large, optionally counts_small, current (A),
    /// edge_tick (84 MHz), edge_bound, true_omega (rad/s); others are ignored
    #[arg(value_name = "TRACE.csv")]
    pub(super) trace: PathBuf,
    /// Estimator to run; repeatable [default: all that the columns suffice for]
    #[arg(long = "estimator", value_name = "NAME")]
    pub(super) estimators: Vec<String>,
    #[command(flatten)]
    pub(super) device: DeviceFile,
    #[command(flatten)]
    pub(super) parameters: ParameterOptions,
    /// Write t and a column for each estimator (rad/s) to FILE; - is standard output [default: -,
    /// or none with --json -]
    #[arg(long, value_name = "FILE.csv")]
    pub(super) out: Option<PathBuf>,
    /// Write the scores against true_omega as JSON to FILE; - is standard output, with nothing else
    /// there
    #[arg(long, value_name = "FILE")]
    pub(super) json: Option<PathBuf>,
}

pub(super) fn run(options: &Replay) -> Result<(), Failure> {
    one_to_stdout(&[("--out", &options.out), ("--json", &options.json)])?;
    let kinds = kinds(&options.estimators)?;
    let device = options.device.load()?;
    let parameters = options.parameters.load()?;
    let name = replay::name(&options.trace);
    let recording = Recording::read(&options.trace)?;
    let board = board_columns(options)?;
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
    note_left_out(&name, &replayed);
    warn_uneven(&name, &recording);
    for line in replay::of_the_board(&recording, &board, &device) {
        note(format_args!("{name}: {line}"));
    }
    let json_to_stdout = options.json.as_deref().is_some_and(is_stdout);
    let out = match &options.out {
        None if json_to_stdout => None,
        out => Some(out.as_deref().unwrap_or(Path::new("-"))),
    };
    if let Some(out) = out {
        write_with(out, |to| replay::csv(to, &recording.t, &replayed.estimates))?;
    }
    let rows = &replayed.rows;
    if let Some(path) = &options.json {
        write_whole(path, &rows::json(rows)?)?;
    }
    if json_to_stdout || out.is_some_and(is_stdout) {
        return Ok(());
    }
    print_bytes(table::details(rows, &[], terminal_width()).as_bytes())
}

/// What the board made of its samples; nothing where no board that says how sure it is made the
/// recording, whose other columns may then be anything.
fn board_columns(options: &Replay) -> Result<BoardColumns, Failure> {
    let path = options.trace.display().to_string();
    let text = std::fs::read(&options.trace)
        .map_err(|error| Failure::Input(format!("{path}: cannot read: {error}")))?;
    match BoardColumns::are_in(&text) {
        true => BoardColumns::parse(text.as_slice(), &path),
        false => Ok(BoardColumns::default()),
    }
}

/// Says who was left out, in a line for each column that is not there.
pub(super) fn note_left_out(name: &str, replayed: &replay::Replay) {
    let mut columns: BTreeMap<&str, Vec<&str>> = BTreeMap::new();
    for (estimator, column) in &replayed.left_out {
        columns.entry(column).or_default().push(estimator);
    }
    for (column, estimators) in columns {
        let names = estimators.join(", ");
        note(format_args!(
            "{name}: no column {column}; left out: {names}"
        ));
    }
}

/// Says where estimators cannot know how long a tick was.
pub(super) fn warn_uneven(name: &str, recording: &Recording) {
    if recording.uneven_steps > 0 {
        note(format_args!(
            "{name}: {} of {} steps of t differ by more than 10 % from 1/{} s; estimators take \
             every step for one tick",
            recording.uneven_steps,
            recording.t.len() - 1,
            recording.trace.rate_hz,
        ));
    }
}
