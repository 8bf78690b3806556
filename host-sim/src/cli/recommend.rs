//! `host-sim recommend`.

use std::path::PathBuf;

use clap::Args;

use catalogue::estimators::Kind;
use experiments::recommend::{self, Settings, recommend};
use experiments::reference::ShaftMotion;
use experiments::rows::json;
use experiments::table::layout::{NARROW, terminal_width};
use recordings::arguments::{DeviceFile, RecordingOptions};
use recordings::recording::Recording;
use report::Printout;
use terminal::failure::Failure;
use terminal::output::{Folder, is_stdout, note};
use terminal::wording::wrapped;

use super::arguments::{ParameterOptions, kinds, open_logs};
use super::page::{self, progress};
use experiments::uneven::{Chosen, Recorded};
use recordings::log::Log;

/// Default budget of the cheap estimator, instructions per update.
const BUDGET: f64 = 100.0;

#[derive(Debug, Args)]
pub(super) struct Recommend {
    /// Recordings of the device, as of host-sim replay: t (s) and counts_large; optional: current
    /// (A), edge_tick and edge_bound, true_omega (rad/s). Without true_omega the scores are against a
    /// reference that is smoothed from the counts; - is standard input
    #[arg(value_name = "LOG", required = true)]
    logs: Vec<PathBuf>,
    /// Largest number of instructions per update on a Cortex-M4 for the second, cheap estimator
    #[arg(long, value_name = "N", default_value_t = BUDGET)]
    instructions: f64,
    /// Print all estimators instead of the first eight
    #[arg(long)]
    all: bool,
    #[command(flatten)]
    recording: RecordingOptions,
    #[command(flatten)]
    device: DeviceFile,
    #[command(flatten)]
    parameters: ParameterOptions,
    /// Write one object per estimator as JSON to FILE; - is standard output, which then has nothing
    /// else
    #[arg(long, value_name = "FILE")]
    json: Option<PathBuf>,
    /// Folder of the page index.html and its figures as SVG [default: no folder]
    #[arg(long, value_name = "DIR")]
    report: Option<PathBuf>,
}

pub(super) fn run(options: &Recommend, command_line: &str) -> Result<(), Failure> {
    if let Some(folder) = &options.report {
        Folder::check("--report", folder)?;
    }
    if !(options.instructions > 0.0 && options.instructions.is_finite()) {
        return Err(Failure::Input(format!(
            "--instructions {}: must be a number above 0",
            options.instructions
        )));
    }
    let loaded = options.device.loaded()?;
    let parameters = options.parameters.load(&kinds(&[])?)?;
    let logs = open_logs("LOG", &options.logs)?;
    let counted = options.recording.counted(loaded, &logs)?;
    let device = counted.device;
    let read = |log: &Log| -> Result<(String, Recording), Failure> {
        let recording = options.recording.read(log, &device)?;
        recording.check_times(log.name())?;
        Ok((log.name().to_owned(), recording))
    };
    let logs: Vec<_> = logs.iter().map(read).collect::<Result<_, _>>()?;
    let settings = Settings {
        device: &device,
        is_known: options.device.is_given(),
        parameters: &parameters,
        budget: options.instructions,
        cost: report::measured::cost,
    };
    let bar = progress(logs.len() * Kind::all().len(), "estimating");
    let recommended = recommend(&logs, &settings, &|| bar.inc(1))?;
    bar.finish_and_clear();

    let counts_per_rev = device.stages.large.counts_per_rev;
    let mut notes = counted.lines;
    if notes.is_empty()
        && options.recording.encoder.counts_per_rev.is_none()
        && !options.device.is_given()
    {
        notes.push(format!(
            "{counts_per_rev} counts/rev assumed: give --counts-per-rev or --device"
        ));
    }
    for (name, recording) in &logs {
        let kinds: Vec<_> = Kind::all().iter().collect();
        let recorded = Recorded::new(name, recording, &device, &parameters);
        let chosen = Chosen::new(&kinds, false, &recorded)?;
        let clock = chosen.notes(&recorded);
        let all = recording.notes.iter().chain(&clock);
        notes.extend(all.map(|line| format!("{name}: {line}")));
    }
    notes.extend(recommended.notes.iter().cloned());
    notes.push(
        "instructions: of one update on the emulated board, mean and most over traces at 1 and 10 kHz \
         (cargo pareto); the mean depends on the motion"
            .to_owned(),
    );
    for line in &notes {
        note(wrapped(line, 2));
    }
    let header = |width: usize| {
        let rows: Vec<_> = logs
            .iter()
            .map(|(name, log)| {
                let motion = ShaftMotion::of(log).line(counts_per_rev);
                let rows = log.t.len();
                format!("{name}: {rows} rows at {} Hz, {motion}", log.trace.rate_hz)
            })
            .collect();
        let header = wrapped(
            &format!("{}; {counts_per_rev} counts/rev", rows.join("; ")),
            2,
        );
        let table = recommend::table(&recommended, options.all, width);
        format!("{header}\n{table}\n")
    };
    let lines = recommend::lines(&recommended, options.instructions);
    let mut text = format!("{}{lines}", header(terminal_width()));
    if let Some(folder) = &options.report {
        let device = match options.device.is_given() {
            true => options.device.name(),
            false => format!("{counts_per_rev} counts/rev"),
        };
        let printout = Printout {
            command: command_line,
            device: &device,
            table: &recommend::table(&recommended, true, NARROW),
        };
        let page = report::recommend(&recommended, &lines, &notes, &printout)?;
        let index = page::write(Folder::new(folder), &page)?;
        let line = format!("Page: {}\n", index.display());
        text.push_str(&format!("\n{line}"));
        if options.json.as_deref().is_some_and(is_stdout) {
            note(line.trim_end());
        }
    }
    page::print(options.json.as_deref(), &json(&recommended.ranked)?, &text)
}
