//! `host-sim replay`.

mod passes;
mod referenced;

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use clap::{Args, ValueEnum};

use experiments::replay::{self, Against, Run};
use experiments::rows;
use experiments::table::layout::terminal_width;
use recordings::arguments::{DeviceFile, RecordingOptions};
use recordings::recording::Parts;
use terminal::failure::Failure;
use terminal::output::{is_stdout, note, print_text, write_whole};
use terminal::wording::wrapped;

use super::arguments::{ParameterOptions, kinds};
use super::page::one_to_stdout;
use experiments::uneven::{Chosen, Recorded};
use recordings::log::{Log, short_name};

use passes::{Passes, write_rows};
use referenced::{Referenced, reference, unscored};

#[derive(Debug, Args)]
pub(super) struct Replay {
    /// Recording: CSV with the columns t (s) and counts_large; optional columns: counts_small,
    /// current (A), current_measured (A, mean since the row before; used instead of current),
    /// edge_tick (periods of 84 MHz), edge_bound, true_omega (rad/s); other columns are ignored. Logs of moteus, ODrive, VESC Tool, SimpleFOC and PlotJuggler are read by their
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
    /// Write beside each velocity of --out its standard deviation as column NAME_sd (rad/s), if the
    /// estimator reports one
    #[arg(long)]
    pub(super) deviations: bool,
    /// Write the scores as JSON to FILE; - is standard output, which then has nothing else. They are
    /// against true_omega, or against the reference
    #[arg(long, value_name = "FILE")]
    pub(super) json: Option<PathBuf>,
    /// Velocity smoothed from the counts in both directions of time: for the scores of a recording
    /// without true_omega; or also as columns reference_rad_s and reference_sd_rad_s of --out. It
    /// needs the whole recording in memory [default: scores, up to 2 million rows]
    #[arg(long, value_name = "USE")]
    pub(super) reference: Option<ReferenceUse>,
}

/// What a reference is computed for.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(super) enum ReferenceUse {
    /// Nothing: a recording without true_omega has no scores
    Off,
    /// The scores of a recording without true_omega
    Scores,
    /// The same, and two columns of --out for every recording
    Columns,
}

pub(super) fn run(options: &Replay) -> Result<(), Failure> {
    let out = options.velocities_to()?;
    let kinds = kinds(&options.estimators)?;
    let loaded = options.device.loaded()?;
    let parameters = options.parameters.load(&kinds)?;
    let log = Log::open(&options.trace)?;
    let name = log.name();
    let logs = std::slice::from_ref(&log);
    let counted = options.recording.counted(loaded, logs)?;
    let device = counted.device;
    let (read, survey) = options.recording.survey(&log, &device)?;
    survey.check_times(name)?;
    let recorded = Recorded {
        path: name,
        trace: &survey.columns,
        unevenness: survey.unevenness(),
        device: &device,
        parameters: &parameters,
    };
    let chosen = Chosen::new(&kinds, !options.estimators.is_empty(), &recorded)?;
    let Referenced {
        reference,
        without,
        interruptions,
    } = reference(options, &log, &survey, &device)?;
    let columns = &survey.columns;
    let against = match &reference {
        Some(reference) if columns.true_omega.is_none() => Against::Reference(reference),
        _ => Against::Truth,
    };
    let file = short_name(&options.trace);
    let mut run = Run::new(
        columns,
        survey.rows,
        &file,
        &chosen.kinds,
        &device,
        &parameters,
    )?;
    if !options.estimators.is_empty() || run.estimates.is_empty() {
        refuse_left_out(name, &run.left_out)?;
    }
    let parts = Parts::open(log.reader()?, name, &read, &survey)?;
    let reference = reference.as_ref();
    let parts = (parts, survey.rows);
    let mut passes = Passes::new(options, parts, &run, &device, &against, reference);
    match out {
        Some(out) => write_rows(out, &mut passes, &mut run)?,
        None => while passes.step(&mut run)? {},
    }
    passes.bar.finish_and_clear();

    let rows = run.rows();
    if let Some(path) = &options.json {
        write_whole(path, &rows::json(&against.scored(&rows, columns))?)?;
    }
    for line in &counted.lines {
        note(line);
    }
    let about = About {
        notes: [survey.notes.clone(), passes.parts.notes()].concat(),
        clock: chosen.notes(&Recorded {
            unevenness: passes.parts.unevenness(),
            ..recorded
        }),
        left_out: &run.left_out,
        mismatched_presets: &run.mismatched_presets,
    };
    about.note(name);
    passes.note(name, &device, interruptions);
    if options.deviations && run.estimates.iter().all(|e| e.deviation.is_none()) {
        note("--deviations: none of these estimators reports a standard deviation");
    }
    let without = without.or_else(|| unscored(&survey).filter(|_| !rows.is_empty()));
    if let Some(why) = &without {
        note(format_args!("{name}: no scores: {why}"));
    }
    let size = (survey.rows, columns.rate_hz);
    let device_name = device_name(options, counted.is_stated);
    let header = replay::header(size, &device, &device_name, &parameters);
    let motion = passes.motion.line(device.stages.large.counts_per_rev);
    let against = noted(&against, name, columns.rate_hz);
    let header = wrapped(&format!("{name}: {header}; {motion}{against}"), 2);
    if [out, options.json.as_deref()]
        .into_iter()
        .flatten()
        .any(is_stdout)
    {
        note(header);
        return Ok(());
    }
    let with_coupler = columns.counts_small.is_some();
    let table = match without {
        Some(_) => String::new(),
        None => replay::table(&rows, with_coupler, terminal_width()),
    };
    print_text(&format!("{header}\n{table}"))
}

impl Replay {
    /// Where the velocities are written, if they are.
    ///
    /// # Errors
    /// [`Failure::Input`] where two outputs have one place, and for deviations of velocities that are not written.
    fn velocities_to(&self) -> Result<Option<&Path>, Failure> {
        one_to_stdout(&[("--out", &self.out), ("--json", &self.json)])?;
        let out = self.out.as_deref();
        if !self.json.as_deref().is_some_and(is_stdout) {
            return Ok(Some(out.unwrap_or(Path::new("-"))));
        }
        if self.deviations && out.is_none() {
            let why = "--deviations: --json - writes no velocities; give --out FILE.csv";
            return Err(Failure::Input(why.to_owned()));
        }
        Ok(out)
    }
}

/// What the header says of the scores of the recording `name`, after a note on the limits of a reference.
fn noted(against: &Against, name: &str, rate_hz: f64) -> &'static str {
    let Against::Reference(reference) = against else {
        return "";
    };
    let limits = reference.limits(rate_hz);
    let line = format!("{name}: no column true_omega; scores are against a reference: {limits}");
    note(wrapped(&line, 2));
    ", scores against a reference computed from the recording itself"
}

/// Where the device comes from, and where its counts per revolution do if they are not its own: `is_stated` if the
/// file states them.
fn device_name(options: &Replay, is_stated: bool) -> String {
    let counts_of = match options.recording.encoder.counts_per_rev {
        Some(_) => "of --counts-per-rev; ",
        None if is_stated => "of the file; ",
        None => "",
    };
    let device_name = match options.device.is_given() {
        true => options.device.name(),
        false => "the default device: no --device given".to_owned(),
    };
    format!("{counts_of}{device_name}")
}

/// Refuses a recording, called `name`, without a column that an estimator needs.
///
/// # Errors
/// [`Failure::Input`] that names the first of the estimators that are `left_out`, and its column.
pub(super) fn refuse_left_out(
    name: &str,
    left_out: &[(&'static str, &'static str)],
) -> Result<(), Failure> {
    left_out.first().map_or(Ok(()), |(estimator, column)| {
        Err(Failure::Input(format!(
            "{name}: line 1: no column {column}, which {estimator} needs; see host-sim estimators"
        )))
    })
}

/// What is said about a recording and the estimators that ran on it.
pub(super) struct About<'a> {
    /// Notes of the reader.
    pub(super) notes: Vec<String>,
    /// What is said about uneven steps and the rate.
    pub(super) clock: Vec<String>,
    pub(super) left_out: &'a [(&'static str, &'static str)],
    pub(super) mismatched_presets: &'a [String],
}

impl About<'_> {
    /// Prints notes: those of the reader, one line per missing column with the estimators left out,
    /// parameters that were tuned for another encoder or rate, and the clock.
    pub(super) fn note(&self, name: &str) {
        for line in &self.notes {
            note(format_args!("{name}: {line}"));
        }
        let mut columns: BTreeMap<&str, Vec<&str>> = BTreeMap::new();
        for (estimator, column) in self.left_out {
            columns.entry(column).or_default().push(estimator);
        }
        for (column, estimators) in columns {
            let names = estimators.join(", ");
            note(format_args!(
                "{name}: no column {column}; estimators left out: {names}"
            ));
        }
        for line in self.mismatched_presets {
            note(format_args!("{name}: {line}"));
        }
        for line in &self.clock {
            note(wrapped(&format!("{name}: {line}"), 2));
        }
    }
}
