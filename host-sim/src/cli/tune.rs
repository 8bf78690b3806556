//! `host-sim tune`.

use std::path::{Path, PathBuf};

use clap::Args;

use catalogue::estimators::Kind;
use catalogue::parameters::{Parameters, PlantKind, Presets};
use device_files::{decimal, to_digits};
use experiments::tune::{
    FIRST_SEED, Group, LogFile, LogPlan, LogSearch, LogTuned, Plan, Tuned, Wishes, image_section,
};
use recordings::arguments::{DeviceFile, RecordingOptions};
use shards::{Experiment, Part};
use terminal::failure::Failure;
use terminal::output::{check_place, is_stdout, note, print_text, write_whole};

use super::arguments::{check_rates, distinct, kinds, open_logs, scenarios};
use super::rates::{TUNED_HZ, rate_help, repeatable};
use super::shard::{self, Outputs};
use experiments::uneven::{Chosen, Recorded};
use recordings::log::short_name;

/// Default presets file.
const PRESETS: &str = "target/presets.toml";

/// Default folder of a shard's file.
const PARTS: &str = "target/tune";

/// Text before the progress bar.
const DOING: &str = "tuning";

#[derive(Debug, Args)]
pub(super) struct Tune {
    /// Recording to tune on instead of simulated motion: CSV as for host-sim replay, with the columns
    /// that the estimators need, at least 4 s. Every second of it in turn is tuned on and held out;
    /// the found parameters are written if their RMS error in the held-out seconds is smaller. The
    /// errors are those against true_omega, or without this column against a smoother of the log;
    /// repeatable; - is standard input
    #[arg(value_name = "RECORDING", conflicts_with_all =
        ["perturbed", "scenarios", "rates", "seeds", "seconds", "frictionless"])]
    pub(super) recordings: Vec<PathBuf>,
    #[command(flatten)]
    pub(super) read: RecordingOptions,
    /// Average the cost over the true and perturbed device constants, with the errors of host-sim
    /// sensitivity [default: only for observers, and only without --scenario]
    #[arg(long = "perturbed", visible_alias = "doubting")]
    pub(super) perturbed: bool,
    /// Scenario to tune on, see host-sim scenarios; repeatable [default: step, permanent, track;
    /// observers: all with friction except heating]
    #[arg(long = "scenario", value_name = "NAME")]
    pub(super) scenarios: Vec<String>,
    #[arg(long = "rate", value_name = "HZ", help = rate_help() + &repeatable(&TUNED_HZ))]
    pub(super) rates: Vec<f64>,
    /// Estimator to tune, see host-sim estimators; repeatable [default: all that have parameters]
    #[arg(long = "estimator", value_name = "NAME")]
    pub(super) estimators: Vec<String>,
    /// Number of tuning seeds, 1 to 1000; they start at 2^32. The seed after the last one decides
    /// between the result and the shipped parameters [default: 3; observers: 1]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u64).range(1..=1000))]
    pub(super) seeds: Option<u64>,
    /// Duration of each run, s [default: 10; observers: 4]
    #[arg(long, value_name = "S")]
    pub(super) seconds: Option<f64>,
    /// Tune only on the plant without Coulomb friction [default: on both plants]
    #[arg(long)]
    pub(super) frictionless: bool,
    #[command(flatten)]
    pub(super) device: DeviceFile,
    /// Run only every Nth search (rate, plant, estimator; on recordings estimator) from the Kth on, for
    /// example 1/4, and write a file for host-sim merge, no presets. A search is not divided: its finer
    /// grids follow the coarser ones
    #[arg(long, value_name = "K/N")]
    pub(super) shard: Option<Part>,
    /// Write the parameters to FILE, a presets file for other commands; - is standard output. The
    /// section [image] of an existing FILE is kept. With --shard the folder of the shard's file
    /// [default: target/presets.toml; with --shard target/tune]
    #[arg(long, value_name = "FILE.toml")]
    pub(super) out: Option<PathBuf>,
}

impl Tune {
    fn plan(&self, kinds: &[&Kind]) -> Result<Plan, Failure> {
        let wishes = Wishes {
            scenarios: scenarios(&self.scenarios, &[])?,
            seeds: self.seeds,
            seconds: self.seconds,
            perturbed: self.perturbed.then_some(true),
        };
        let rates_hz = distinct(&self.rates, &TUNED_HZ);
        check_rates(&rates_hz, self.seconds)?;
        Ok(Plan {
            device: self.device.load_to_simulate()?,
            groups: wishes.groups(kinds),
            rates_hz,
            plants: match self.frictionless {
                true => vec![PlantKind::Frictionless],
                false => vec![PlantKind::Friction, PlantKind::Frictionless],
            },
        })
    }
}

pub(super) fn run(options: &Tune, run_line: &str) -> Result<(), Failure> {
    let named = kinds(&options.estimators)?;
    let (kinds, fixed): (Vec<&Kind>, Vec<&Kind>) =
        named.into_iter().partition(|kind| kind.is_tunable());
    if kinds.is_empty() {
        return Err(Failure::Input(
            "nothing to tune: the named estimators have no parameters; see host-sim estimators"
                .to_owned(),
        ));
    }
    if !options.estimators.is_empty() && !fixed.is_empty() {
        let names: Vec<_> = fixed.iter().map(|kind| kind.name).collect();
        note(format_args!(
            "note: left out, without parameters to tune: {}",
            names.join(", ")
        ));
    }
    let outputs = Outputs {
        run_line,
        out: options.out.as_deref(),
        json: None,
    };
    // The default output too is refused before the search.
    if options.shard.is_none() && !is_stdout(file(outputs)) {
        check_place(file(outputs))?;
    }
    match options.recordings.is_empty() {
        true => {
            options.read.check_unused("RECORDING")?;
            searched(options, &options.plan(&kinds)?, outputs, finish)
        }
        false => searched(options, &log_plan(options, kinds)?, outputs, finish_logs),
    }
}

/// Runs a part of the searches and writes its file, or runs all of them and passes the results to
/// `finish`.
fn searched<E: Experiment>(
    options: &Tune,
    plan: &E,
    outputs: Outputs<'_>,
    finish: impl FnOnce(&E, &[E::Row], Outputs<'_>) -> Result<(), Failure>,
) -> Result<(), Failure> {
    if let Some(part) = options.shard {
        let folder = outputs.out.unwrap_or(Path::new(PARTS));
        return shard::run_part(plan, part, outputs.run_line, folder, DOING);
    }
    let searches = plan.jobs()?;
    kept_section(file(outputs))?;
    finish(plan, &shard::rows(plan, &searches, DOING)?, outputs)
}

/// Writes the presets of all searches, whether they were run now or merged.
pub(super) fn finish(plan: &Plan, tuned: &[Tuned], outputs: Outputs<'_>) -> Result<(), Failure> {
    let tuned_on: String = plan.groups.iter().map(tuned_on).collect();
    write(outputs, &tuned_on, plan.presets(tuned)?, "")
}

/// Writes the presets of all searches on recordings, and prints their errors.
pub(super) fn finish_logs(
    plan: &LogPlan,
    tuned: &[LogTuned],
    outputs: Outputs<'_>,
) -> Result<(), Failure> {
    let names: Vec<_> = plan.logs().iter().map(|log| log.name.as_str()).collect();
    let tuned_on = format!("# Tuned on every second second of {}.\n", names.join(", "));
    let table = error_table(&plan.jobs()?, tuned);
    write(outputs, &tuned_on, plan.presets(tuned), &table)
}

/// The presets file.
fn file<'a>(outputs: Outputs<'a>) -> &'a Path {
    outputs.out.unwrap_or(Path::new(PRESETS))
}

/// The section [image] of an existing presets file.
fn kept_section(file: &Path) -> Result<String, Failure> {
    match is_stdout(file) {
        true => Ok(String::new()),
        false => image_section(file).map_err(Failure::Input),
    }
}

/// Writes the presets file with its comments, and prints the notes, `table` and the path of the file.
fn write(
    outputs: Outputs<'_>,
    tuned_on: &str,
    (presets, notes): (Presets, Vec<String>),
    table: &str,
) -> Result<(), Failure> {
    if outputs.json.is_some() {
        return Err(Failure::Input(
            "--json: tune has no rows; its presets file is --out FILE.toml".to_owned(),
        ));
    }
    let file = file(outputs);
    let kept = kept_section(file)?;
    let mut text = format!("# {}\n{tuned_on}", outputs.command_line());
    for line in notes {
        note(format_args!("note: {line}"));
        text += &format!("# {line}\n");
    }
    text += &format!("\n{}", presets.to_toml().map_err(Failure::Input)?);
    if !kept.is_empty() {
        text += &format!("\n{kept}");
    }
    write_whole(file, text.as_bytes())?;
    match is_stdout(file) {
        true => Ok(()),
        false => print_text(&format!("{table}{}\n", file.display())),
    }
}

/// The searches on recordings.
fn log_plan(options: &Tune, mut kinds: Vec<&'static Kind>) -> Result<LogPlan, Failure> {
    let loaded = options.device.loaded()?;
    let logs = open_logs("RECORDING", &options.recordings)?;
    let counted = options.read.counted(loaded, &logs)?;
    let (device, mut notes) = (counted.device, counted.lines);
    let are_counts_known = !notes.is_empty() || options.read.encoder.counts_per_rev.is_some();
    let parameters = Parameters::default();
    let mut recordings = Vec::new();
    for log in &logs {
        let name = short_name(log.path());
        let recording = options.read.read(log, &device)?;
        recording.check_times(log.name())?;
        let are_named = !options.estimators.is_empty();
        let recorded = Recorded::new(log.name(), &recording, &device, &parameters);
        let chosen = Chosen::new(&kinds, are_named, &recorded)?;
        let clock = chosen.notes(&recorded);
        let lines = recording.notes.iter().chain(&clock);
        notes.extend(lines.map(|line| format!("{name}: {line}")));
        kinds = chosen.kinds;
        let sum = format!("{:016x}", log.sum()?);
        recordings.push((LogFile { name, sum }, recording));
    }
    if !options.device.is_given() {
        let counts = device.stages.large.counts_per_rev;
        notes.extend(assumed(counts, are_counts_known, &kinds));
    }
    let plan = LogPlan::new(recordings, device, &kinds, &parameters)?;
    Ok(plan.with_notes(notes))
}

/// What is assumed without a device file: the counts per revolution unless they are known, and the constants if one
/// of `kinds` has a model with them.
fn assumed(counts_per_rev: u32, are_counts_known: bool, kinds: &[&Kind]) -> Option<String> {
    let has_model = |kind: &&Kind| kind.is_observer() || kind.needs.current || kind.needs.coupled;
    let counts = format!("{counts_per_rev} counts/rev");
    match (are_counts_known, kinds.iter().any(has_model)) {
        (true, false) => None,
        (false, false) => Some(format!(
            "{counts} assumed: give --counts-per-rev or --device"
        )),
        (true, true) => Some("constants of the default device assumed: give --device".to_owned()),
        (false, true) => Some(format!(
            "{counts} and constants of the default device assumed: give --device"
        )),
    }
}

/// The errors on recordings as a table.
fn error_table(searches: &[LogSearch], tuned: &[LogTuned]) -> String {
    let mut table = format!(
        "{:<24}{:>22}{:>22}\n{:<24}{:>11}{:>11}{:>11}{:>11}\n",
        "RMS error, rad/s",
        "tuned seconds",
        "held-out seconds",
        "",
        "before",
        "found",
        "before",
        "found"
    );
    for (search, row) in searches.iter().zip(tuned) {
        let [seen, unseen] = [0, 1].map(|half| [row.before[half], row.found[half]]);
        let numbers: String = [seen, unseen]
            .concat()
            .iter()
            .map(|rms| format!("{:>11}", shown(*rms)))
            .collect();
        let verdict = if row.kept { "  kept" } else { "" };
        table += &format!("{:<24}{numbers}{verdict}\n", search.estimator);
    }
    table
}

/// An error with four decimals, or with four digits if it is small.
fn shown(rms: f64) -> String {
    match rms < 0.1 {
        true => decimal(to_digits(rms, 4)),
        false => format!("{rms:.4}"),
    }
}

/// Comment line of the presets file: the tuning set of these estimators.
fn tuned_on(group: &Group) -> String {
    let constants = match group.perturbed {
        true => "right and wrong constants",
        false => "right constants",
    };
    format!(
        "# {}: tuned on {}, {} s each, {constants}, seeds {FIRST_SEED} to {}.\n",
        group.estimators.join(", "),
        group.scenarios.join(", "),
        group.seconds,
        FIRST_SEED + group.seeds - 1,
    )
}
