//! `host-sim identify`.

use std::f64::consts::TAU;
use std::path::PathBuf;

use clap::Args;

use experiments::identify::{self, Known, Quantity};
use recordings::arguments::{DeviceFile, RecordingOptions};
use report::{self, Printout};
use terminal::failure::Failure;
use terminal::output::{Folder, is_stdout, note, print_text, write_whole};

use super::arguments::open_logs;
use super::page;
use recordings::log::short_name;

#[derive(Debug, Args)]
pub(super) struct Identify {
    /// Recording with the motor current, of scene excite or of any motion that speeds up, slows down
    /// and reverses: CSV as for host-sim replay, with the columns current and counts_small. With
    /// column current_small and a free handle, the handle is identified too. Measured currents in the
    /// columns current_measured and current_small_measured are used in the place of the commands.
    /// Several recordings of one device are fitted together; - is standard input
    #[arg(value_name = "RECORDING", required = true)]
    recordings: Vec<PathBuf>,
    #[command(flatten)]
    read: RecordingOptions,
    #[command(flatten)]
    device: DeviceFile,
    /// Constant with a known value, from which the others follow: large.torque_constant_nm_per_a,
    /// large.inertia_kg_m2 or coupler.damping_nms_per_rad [default: the device's torque constant]
    #[arg(long, value_name = "KEY=VALUE")]
    known: Option<String>,
    /// State that the handle was clamped, or that there is none, in recordings without column
    /// counts_small
    #[arg(long)]
    clamped: bool,
    /// Write a device file with the identified constants; it keeps the other keys and comments of
    /// the given device file, which may be the same; - is standard output
    #[arg(long, value_name = "FILE.toml")]
    out: Option<PathBuf>,
    /// Write index.html to DIR: model and measurement, residuals and confidence intervals
    #[arg(long, value_name = "DIR")]
    report: Option<PathBuf>,
    /// Write the identified constants as JSON to FILE; - is standard output, which then has nothing
    /// else
    #[arg(long, value_name = "FILE")]
    json: Option<PathBuf>,
}

pub(super) fn run(options: &Identify, command_line: &str) -> Result<(), Failure> {
    page::one_to_stdout(&[("--out", &options.out), ("--json", &options.json)])?;
    if let Some(folder) = &options.report {
        Folder::check("--report", folder)?;
    }
    let loaded = options.device.loaded()?;
    let logs = open_logs("RECORDING", &options.recordings)?;
    let counted = options.read.counted(loaded, &logs)?;
    let (device, mut notes) = (counted.device, counted.lines);
    let known = match &options.known {
        Some(text) => {
            let known = Known::parse(text)?;
            known.check(&device)?;
            known
        }
        None => Known::TorqueConstant(device.stages.large.torque_constant),
    };
    let (mut recordings, mut current_options) = (Vec::new(), Vec::new());
    let counts_are_known = !notes.is_empty() || options.read.encoder.counts_per_rev.is_some();
    for log in &logs {
        let name = log.name().to_owned();
        let recording = options.read.read(log, &device)?;
        notes.extend(recording.notes.iter().map(|line| format!("{name}: {line}")));
        recordings.push((name, recording));
        current_options.push(options.read.current_option(log, &device)?);
    }
    let clamped = options.clamped;
    let mut found = identify::identify(&recordings, &current_options, &device, known, clamped)?;
    if !options.device.is_given() {
        let mut traces = recordings.iter().map(|(_, recording)| &recording.trace);
        let has_small = traces.any(|trace| trace.counts_small.is_some());
        let assumed = identify::default_counts(&device, !counts_are_known, has_small);
        found.assumed.splice(0..0, assumed);
        found.is_default = true;
    }
    let mut updated = None;
    if let Some(out) = &options.out {
        let identified = |quantity: &Quantity| quantity.rejected.is_none();
        if !found.quantities.iter().any(identified) {
            let reason = found.quantities.first().and_then(|q| q.rejected.as_deref());
            return Err(Failure::Input(format!(
                "--out {}: no constant is identified: {}",
                out.display(),
                reason.unwrap_or_default()
            )));
        }
        let text = options.device.text()?;
        let names: Vec<_> = logs.iter().map(|log| short_name(log.path())).collect();
        let given = options.known.is_some();
        let counts = device.stages.large.counts_per_rev;
        let names = names.join(", ");
        let text = identify::updated(&text, &found.quantities, known, given, counts, &names)
            .map_err(|error| Failure::Input(format!("{}: {error}", out.display())))?;
        updated = Some((out, text));
    }
    if let Some(folder) = &options.report {
        let counts = f64::from(device.stages.large.counts_per_rev);
        let count_rad_s = TAU / counts / identify::SPAN_S;
        let printout = Printout {
            command: command_line,
            table: &identify::text(&found),
            ..Printout::default()
        };
        let page = report::identify(&found, count_rad_s, &printout)?;
        let mut files = Folder::new(folder);
        files.add("index.html", page);
        files.write()?;
    }
    if let Some(path) = &options.json {
        let mut json = serde_json::to_vec_pretty(&identify::json(&found))
            .map_err(|error| Failure::Input(format!("{}: {error}", path.display())))?;
        json.push(b'\n');
        write_whole(path, &json)?;
    }
    // Last, because it may replace the user's own file: where another output fails, that file is kept.
    if let Some((out, text)) = updated {
        write_whole(out, text.as_bytes())?;
    }
    for line in notes {
        note(line);
    }
    if [&options.out, &options.json]
        .into_iter()
        .flatten()
        .any(|path| is_stdout(path))
    {
        return Ok(());
    }
    print_text(&identify::text(&found))
}
