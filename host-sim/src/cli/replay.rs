//! `host-sim replay`.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use clap::Args;

use experiments::replay;
use experiments::rows;
use experiments::table::layout::terminal_width;
use recordings::recording::{BoardColumns, Recording};
use terminal::failure::Failure;
use terminal::output::{is_stdout, note, print_bytes, write_whole, write_with};
use terminal::wording::wrapped;

use super::arguments::{DeviceFile, ParameterOptions, RecordingOptions, kinds};
use super::input::{Log, called, short_name};
use super::page::{one_to_stdout, progress};

#[derive(Debug, Args)]
pub(super) struct Replay {
    /// Recording: CSV with the columns t (s) and counts_large; optional columns: counts_small,
    /// current (A), edge_tick (periods of 84 MHz), edge_bound, true_omega (rad/s); other columns
    /// are ignored. Logs of moteus, ODrive, VESC Tool, SimpleFOC and PlotJuggler are read by their
    /// own names, other logs with --column; - is standard input
    #[arg(value_name = "TRACE.csv")]
    pub(super) trace: PathBuf,
    /// Estimator to run, see host-sim estimators; repeatable [default: all whose needed columns are
    /// present]
    #[arg(long = "estimator", value_name = "NAME")]
    pub(super) estimators: Vec<String>,
    #[command(flatten)]
    pub(super) recording: RecordingOptions,
    #[command(flatten)]
    pub(super) device: DeviceFile,
    #[command(flatten)]
    pub(super) parameters: ParameterOptions,
    /// Write t and one column per estimator (rad/s) to FILE; - is standard output [default: -;
    /// nothing with --json -]
    #[arg(long, value_name = "FILE.csv")]
    pub(super) out: Option<PathBuf>,
    /// Write the scores against true_omega as JSON to FILE; - is standard output, which then has
    /// nothing else
    #[arg(long, value_name = "FILE")]
    pub(super) json: Option<PathBuf>,
}

pub(super) fn run(options: &Replay) -> Result<(), Failure> {
    one_to_stdout(&[("--out", &options.out), ("--json", &options.json)])?;
    let kinds = kinds(&options.estimators)?;
    let device = options.device.load()?;
    let parameters = options.parameters.load()?;
    let name = short_name(&options.trace);
    let log = Log::open(&options.trace)?;
    let recording = options.recording.read(&log, &device)?;
    recording.check_even(log.name())?;
    // Rows of another rate are not those of the board.
    let board = match options.recording.keeps_rows() {
        true => board(&log)?,
        false => BoardColumns::default(),
    };
    if options.json.is_some() && recording.trace.true_omega.is_none() {
        return Err(Failure::Input(format!(
            "{}: line 1: no column true_omega, which --json needs for the scores; add it or leave out \
             --json",
            called(&options.trace)
        )));
    }
    let bar = progress(kinds.len(), "estimating");
    let replayed = replay::replay(&recording, &name, &kinds, &device, &parameters, || {
        bar.inc(1);
    })?;
    bar.finish_and_clear();

    if let (true, Some((estimator, column))) =
        (replayed.estimates.is_empty(), replayed.left_out.first())
    {
        return Err(Failure::Input(format!(
            "{}: line 1: no column {column}, which {estimator} needs; see host-sim estimators",
            called(&options.trace)
        )));
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
    note_about(&name, &recording, &replayed);
    for line in replay::board_summary(&recording, &board, &device) {
        note(format_args!("{name}: {line}"));
    }
    let device_name = match options.device.is_given() {
        true => options.device.name(),
        false => "the default device: no --device given".to_owned(),
    };
    let header = replay::header(&recording, &device, &device_name, &parameters);
    let header = wrapped(&format!("{name}: {header}"), 2);
    if json_to_stdout || out.is_some_and(is_stdout) {
        note(header);
        return Ok(());
    }
    let with_coupler = recording.trace.counts_small.is_some();
    let table = replay::table(rows, with_coupler, terminal_width());
    print_bytes(format!("{header}\n{table}").as_bytes())
}

/// The columns with the board's own estimates. A recording without the board's column `sigma` is from
/// another source: its further columns are not read.
fn board(log: &Log) -> Result<BoardColumns, Failure> {
    match BoardColumns::are_in(&log.head()?) {
        true => BoardColumns::parse(log.reader()?, log.name()),
        false => Ok(BoardColumns::default()),
    }
}

/// Prints notes: those of the reader, one line per missing column with the estimators left out,
/// parameters that were tuned for another encoder or rate, and an uneven clock.
pub(super) fn note_about(name: &str, recording: &Recording, replayed: &replay::Replay) {
    for line in &recording.notes {
        note(format_args!("{name}: {line}"));
    }
    let mut columns: BTreeMap<&str, Vec<&str>> = BTreeMap::new();
    for (estimator, column) in &replayed.left_out {
        columns.entry(column).or_default().push(estimator);
    }
    for (column, estimators) in columns {
        let names = estimators.join(", ");
        note(format_args!(
            "{name}: no column {column}; estimators left out: {names}"
        ));
    }
    for line in &replayed.mismatched_presets {
        note(format_args!("{name}: {line}"));
    }
    // The estimators assume a constant period.
    if let Some(uneven) = recording.unevenness() {
        note(format_args!(
            "{name}: {uneven}; the estimators assume a constant step of 1/{0} s; --resample {0:.0} makes \
             the rows even",
            recording.trace.rate_hz,
        ));
    }
}
