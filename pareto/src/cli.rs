//! The command line.

use std::ffi::OsString;
use std::path::Path;
use std::time::Duration;

use clap::{Parser, Subcommand};
use indicatif::{ProgressBar, ProgressStyle};
use measured::Table;
use measured::tables::{CONTROL, EVIDENCE_COST, PARETO};
use terminal::failure::Failure;
use terminal::output::{print_bytes, write_whole};
use terminal::parse::parsed;
use terminal::wording::WIDTH;

use crate::{control, measure, peer_tuning, plot, table};

/// Period at which the spinner turns.
const TURN: Duration = Duration::from_millis(200);

/// Measures the run time and the error of every estimator on the emulated board, and the run time of
/// the control task in every scene.
///
/// Prints the tables and writes them as CSV, JSON and plots to target/pareto. With UPDATE_GOLDEN=1 in
/// the environment, also writes measured/*.csv and the tables and plots of docs/.
#[derive(Debug, Parser)]
#[command(
    name = "cargo pareto",
    bin_name = "cargo pareto",
    version,
    max_term_width = WIDTH,
    after_help = "Examples:\n  cargo pareto\n  cargo pareto tune-peers"
)]
struct Arguments {
    #[command(subcommand)]
    command: Option<Command>,
}

#[derive(Clone, Copy, Debug, Subcommand)]
enum Command {
    /// Tune the parameters of other libraries' filters on tuning seeds and print them
    TunePeers,
}

/// Runs the command line `arguments`, the program's name first.
///
/// # Errors
/// A [`Failure`] with its exit status.
pub fn run(arguments: impl IntoIterator<Item = OsString>) -> Result<(), Failure> {
    let arguments = match parsed::<Arguments>(arguments) {
        Ok(arguments) => arguments,
        Err(error) => return terminal::explain(&error, "cargo pareto"),
    };
    match arguments.command {
        None => everything(),
        Some(Command::TunePeers) => {
            let report = busy("tuning", peer_tuning::report)?;
            print_bytes(report.as_bytes())
        }
    }
}

/// Does `work` with a sign of life and the time that has passed on standard error, if that is a terminal.
fn busy<T>(doing: &'static str, work: impl FnOnce() -> T) -> T {
    let style = ProgressStyle::with_template("{spinner} {msg} {elapsed}");
    let bar = ProgressBar::new_spinner()
        .with_style(style.unwrap_or_else(|_| ProgressStyle::default_spinner()))
        .with_message(doing);
    bar.enable_steady_tick(TURN);
    let done = work();
    bar.finish_and_clear();
    done
}

fn everything() -> Result<(), Failure> {
    let found = busy("measuring estimators", measure::measure);
    let (mut rows, comparators) = measure::split(found.map_err(Failure::Check)?);
    let tasks = busy("measuring the control task", control::measure);
    let tasks = tasks.map_err(Failure::Check)?;
    control::rate(&mut rows, &tasks);
    let estimators = Report {
        name: "pareto",
        table: &PARETO,
        cells: table::cells(&rows),
        csv: table::csv(&rows),
        json: json(&rows)?,
        plot: plot::svg(&rows)?,
    };
    let control = Report {
        name: "control-rate",
        table: &CONTROL,
        cells: control::table::cells(&tasks),
        csv: control::table::csv(&tasks),
        json: json(&tasks)?,
        plot: control::plot::svg(&tasks)?,
    };
    let comparators = table::cost_cells(&comparators);
    let shown = [&estimators, &control].map(|one| one.table.markdown(&[], &one.cells));
    let shown = [&shown[..], &[EVIDENCE_COST.markdown(&[], &comparators)]].concat();
    print_bytes(shown.join("\n").as_bytes())?;
    if measured::update() {
        EVIDENCE_COST
            .write(&[], &comparators)
            .map_err(Failure::Input)?;
    }
    estimators.write()?;
    control.write()
}

fn json(rows: &impl serde::Serialize) -> Result<String, Failure> {
    serde_json::to_string_pretty(rows).map_err(|error| Failure::Check(error.to_string()))
}

/// Results of a measurement.
struct Report {
    /// Name of the files, without extension.
    name: &'static str,
    table: &'static Table,
    cells: Vec<Vec<String>>,
    csv: String,
    json: String,
    plot: String,
}

impl Report {
    /// Writes the files to target/pareto, and with UPDATE_GOLDEN=1 table and plot to docs/.
    fn write(&self) -> Result<(), Failure> {
        let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
        let folder = root.join("target/pareto");
        let files = [
            (&self.csv, "csv"),
            (&self.json, "json"),
            (&self.plot, "svg"),
        ];
        for (text, extension) in files {
            let file = folder.join(self.name).with_extension(extension);
            write_whole(&file, text.as_bytes())?;
        }
        if measured::update() {
            self.table.write(&[], &self.cells).map_err(Failure::Input)?;
            let plot = root.join("docs").join(self.name).with_extension("svg");
            write_whole(&plot, self.plot.as_bytes())?;
        }
        Ok(())
    }
}
