//! `host-sim plot`.

use std::path::PathBuf;

use clap::Args;

use catalogue::estimators::DIFFERENCE;
use experiments::compare::interval;
use experiments::replay;
use recordings::arguments::{DeviceFile, RecordingOptions, Whole};
use report::{self, RecordingView};
use terminal::failure::Failure;
use terminal::output::{is_stdout, note, print_bytes, write_whole};

use super::arguments::{ParameterOptions, kinds};
use super::files::refuse_input;
use super::replay::{About, refuse_left_out};
use experiments::uneven::{Chosen, Recorded};
use recordings::log::{Log, is_stdin, short_name};

/// Estimators that are drawn by default.
const ESTIMATORS: [&str; 2] = [DIFFERENCE, "kalman-triple-steady"];

#[derive(Debug, Args)]
pub(super) struct Plot {
    /// Recording: CSV as for host-sim replay; - is standard input
    #[arg(value_name = "RECORDING.csv")]
    pub(super) recording: PathBuf,
    /// Estimator to draw, see host-sim estimators; repeatable [default: finite-difference and
    /// kalman-triple-steady]
    #[arg(long = "estimator", value_name = "NAME")]
    pub(super) estimators: Vec<String>,
    /// Start of the plot, s [default: start of the recording]
    #[arg(long, value_name = "S")]
    pub(super) from: Option<f64>,
    /// End of the plot, s [default: end of the recording]
    #[arg(long, value_name = "S")]
    pub(super) to: Option<f64>,
    #[command(flatten)]
    pub(super) read: RecordingOptions,
    #[command(flatten)]
    pub(super) device: DeviceFile,
    #[command(flatten)]
    pub(super) parameters: ParameterOptions,
    /// Write the plot to FILE; - is standard output [default: the recording's name with .svg, or -
    /// if the recording is standard input]
    #[arg(long, value_name = "FILE.svg")]
    pub(super) out: Option<PathBuf>,
}

pub(super) fn run(options: &Plot) -> Result<(), Failure> {
    let beside = match is_stdin(&options.recording) {
        true => PathBuf::from("-"),
        false => options.recording.with_extension("svg"),
    };
    let out = options.out.as_ref().unwrap_or(&beside);
    refuse_input("--out", out, &options.recording)?;
    let kinds = match options.estimators.as_slice() {
        [] => kinds(&ESTIMATORS.map(str::to_owned))?,
        names => kinds(names)?,
    };
    let parameters = options.parameters.load(&kinds)?;
    let log = Log::open(&options.recording)?;
    let path = log.name();
    let Whole {
        recording,
        device,
        stated,
    } = options.read.whole(&log, &options.device)?;
    let recorded = Recorded::new(log.name(), &recording, &device, &parameters);
    let chosen = Chosen::new(&kinds, !options.estimators.is_empty(), &recorded)?;
    let [first, .., last] = recording.t[..] else {
        unreachable!("a recording has at least two rows");
    };
    let window = [options.from.unwrap_or(first), options.to.unwrap_or(last)];
    let shown = recording
        .t
        .iter()
        .filter(|t| (window[0]..=window[1]).contains(*t));
    if shown.count() < 2 {
        let [from, to] = window;
        return Err(Failure::Input(format!(
            "{path}: fewer than two rows from {from} to {to} s; it has {first} to {last} s, \
             choose --from and --to there"
        )));
    }
    let replayed = replay::replay(
        &recording,
        path,
        &chosen.kinds,
        &device,
        &parameters,
        &|| (),
    )?;
    if !options.estimators.is_empty() {
        refuse_left_out(path, &replayed.left_out)?;
    }
    let svg = report::recording(&RecordingView {
        name: &short_name(&options.recording),
        recording: &recording,
        estimates: &replayed.estimates,
        counts_per_rev: [
            device.stages.large.counts_per_rev,
            device.stages.small.counts_per_rev,
        ],
        interval: interval(&device),
        window,
    })?;
    write_whole(out, svg.as_bytes())?;
    let about = About {
        notes: recording.notes.clone(),
        clock: chosen.notes(&recorded),
        left_out: &replayed.left_out,
        mismatched_presets: &replayed.mismatched_presets,
    };
    for line in &stated {
        note(line);
    }
    about.note(path);
    if options.out.is_some() || is_stdout(out) {
        return Ok(());
    }
    print_bytes(format!("{}\n", out.display()).as_bytes())
}
