//! `host-sim real`.

use std::path::PathBuf;

use clap::Args;

use experiments::designed::with_friction;
use experiments::real::cases::{Case, Recordings};
use experiments::real::peers::{self, PEERS, Tuned};
use experiments::real::run::{Row, Settings, run as run_all};
use experiments::real::table::table;
use experiments::real::wanted::{phase, rate, seconds};
use experiments::rows::{csv, json};
use experiments::table::layout::{NARROW, terminal_width};
use recordings::arguments::DeviceFile;
use report::{self, Printout};
use simulation::device::parsed_counts_per_rev;
use terminal::failure::Failure;
use terminal::output::{Folder, is_stdout, note, print_bytes, write_whole};

use super::arguments::{ParameterOptions, distinct, kinds, kinds_at};
use super::page::{self, one_to_stdout, progress};
use super::rates::recording_rate_help;

/// Default folder of the recordings.
const DATA: &str = "tests/data/real";

/// Default phases: two, so that no result depends on where a boundary lies.
const PHASES: [f64; 2] = [0.37, 0.81];

#[derive(Debug, Args)]
pub(super) struct Real {
    /// Folder of the recordings with its list recordings.toml
    #[arg(long, value_name = "DIR", default_value = DATA)]
    data: PathBuf,
    /// Counts per revolution to which recordings of a fine encoder are coarsened, a comma between
    /// two; those of a coarse encoder keep their own
    #[arg(long, value_name = "C,...", value_delimiter = ',', default_value = "4096",
        value_parser = parsed_counts_per_rev)]
    counts_per_rev: Vec<u32>,
    #[arg(long, value_name = "HZ,...", value_delimiter = ',', default_value = "1000",
        help = recording_rate_help("Rate of the ticks",
            ", a comma between two; recordings of a coarse encoder run at their own rate only"))]
    rate: Vec<f64>,
    /// Positions of the coarse encoder's boundaries, coarse counts, a comma between two; scores are
    /// means over them [default: 0.37,0.81]
    #[arg(long, value_name = "COUNTS,...", value_delimiter = ',')]
    phase: Vec<f64>,
    /// Part of each recording that is used, s from its start
    #[arg(long, value_name = "S", default_value_t = 10.0)]
    seconds: f64,
    /// Estimator to run, see host-sim estimators; repeatable [default: all]
    #[arg(long = "estimator", value_name = "NAME")]
    estimators: Vec<String>,
    /// Also run the velocity algorithms of other projects, rows peer:*, on recordings of a fine encoder:
    /// with the defaults of the project, and tuned on the recordings that choose constants; not on the
    /// page of --out
    #[arg(long)]
    peers: bool,
    /// Print every score on each recording
    #[arg(long)]
    details: bool,
    #[command(flatten)]
    device: DeviceFile,
    #[command(flatten)]
    parameters: ParameterOptions,
    /// Write the scores of each run as JSON to FILE; - is standard output, which then has nothing else
    #[arg(long, value_name = "FILE")]
    json: Option<PathBuf>,
    /// Write the scores of each run as CSV to FILE; - is standard output, which then has nothing else
    #[arg(long, value_name = "FILE")]
    csv: Option<PathBuf>,
    /// Folder of index.html, figures as SVG, real.csv, real.json; the velocities and the ranking are of
    /// the middle resolution and rate [default: no folder]
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// No recording is given by itself: the error says which command reads one
    #[arg(hide = true)]
    recording: Option<PathBuf>,
}

pub(super) fn run(options: &Real, command_line: &str) -> Result<(), Failure> {
    if let Some(path) = &options.recording {
        let path = path.display();
        return Err(Failure::Input(format!(
            "{path}: real runs the recordings of a list, see --data; the estimators for a recording \
             of yours are ranked by: host-sim recommend {path}"
        )));
    }
    one_to_stdout(&[("--json", &options.json), ("--csv", &options.csv)])?;
    if let Some(folder) = &options.out {
        Folder::check("--out", folder)?;
    }
    let mut settings = settings(options)?;
    let recordings = Recordings::read(&options.data, &settings.device, settings.seconds)?;
    for line in recordings.notes() {
        note(line);
    }
    let cases = recordings.cases(&settings);
    if cases.is_empty() {
        return Err(Failure::Input(format!(
            "{}: no recording has these rates and resolves these counts per revolution; ask for a \
             lower --rate or --counts-per-rev",
            options.data.display()
        )));
    }
    let place = |case: &Case| with_friction(&case.device(&settings.device), case.rate_hz);
    let places: Vec<_> = cases.iter().map(place).collect();
    settings.estimators = kinds_at(&options.estimators, &settings.parameters, &places)?;
    // The first phase alone is drawn.
    let shown = (middle(&settings.counts_per_rev), middle(&settings.rates_hz));
    let keep = |case: &Case| {
        let is_first = case.phase.is_none_or(|phase| phase == settings.phases[0]);
        let coarsened = case.phase.is_none() || case.counts_per_rev == shown.0;
        options.out.is_some() && is_first && coarsened && case.rate_hz == shown.1
    };
    let bar = progress(cases.len(), "estimating");
    let outcomes = run_all(&recordings, &cases, &settings, keep, &|| bar.inc(1))?;
    bar.finish_and_clear();

    let (kept, rows): (Vec<_>, Vec<_>) = (outcomes.into_iter())
        .map(|mut outcome| {
            let rows = std::mem::take(&mut outcome.rows);
            (outcome, rows)
        })
        .unzip();
    let mut rows: Vec<Row> = rows.into_iter().flatten().collect();
    let mut names: Vec<_> = settings.estimators.iter().map(|kind| kind.name).collect();
    if rows.is_empty() {
        return Err(Failure::Input(format!(
            "{}: no recording has the columns that {} reads; see host-sim estimators",
            options.data.display(),
            names.join(", ")
        )));
    }
    let (own_rows, own_names) = (rows.clone(), names.clone());
    let mut tuned = Vec::new();
    if options.peers {
        tuned = peers::tune(&recordings, &cases, &settings, PEERS)?;
        rows.extend(peers::rows(&recordings, &cases, &settings, PEERS, &tuned)?);
        names.extend(peers::names(PEERS, &tuned));
    }
    let mut text = table(&rows, &names, options.details, terminal_width());
    text.push_str(&tuned_lines(&tuned));
    if let Some(folder) = &options.out {
        let printout = Printout {
            command: command_line,
            device: &options.device.name(),
            table: &table(&own_rows, &own_names, true, NARROW),
        };
        let page = report::real(&own_rows, &own_names, shown, &kept, &printout)?;
        let mut files = Folder::new(folder);
        files.add("real.json", json(&rows)?);
        files.add("real.csv", csv(&rows)?);
        let index = page::write(files, &page)?;
        text.push_str(&format!("Page: {}\n", index.display()));
    }
    if let Some(path) = &options.csv {
        let bytes = csv(&rows)?;
        match is_stdout(path) {
            true => return print_bytes(&bytes),
            false => write_whole(path, &bytes)?,
        }
    }
    page::print(options.json.as_deref(), &json(&rows)?, &text)
}

/// The tuned values of the peers, a line for each.
fn tuned_lines(tuned: &[Tuned]) -> String {
    let line = |tuned: &Tuned| {
        format!(
            "{}-tuned at {} counts/rev and {} Hz: {}\n",
            tuned.peer,
            tuned.counts_per_rev,
            tuned.rate_hz,
            peers::shown(PEERS, tuned)
        )
    };
    tuned.iter().map(line).collect()
}

/// The middle one of several values, in the order in which they were given.
fn middle<T: Copy>(values: &[T]) -> T {
    values[values.len() / 2]
}

fn settings(options: &Real) -> Result<Settings, Failure> {
    let rates = distinct(&options.rate, &[]);
    rates.iter().try_for_each(|hz| rate(*hz).map(drop))?;
    options
        .phase
        .iter()
        .try_for_each(|counts| phase(*counts).map(drop))?;
    let estimators = kinds(&options.estimators)?;
    Ok(Settings {
        parameters: options.parameters.load(&estimators)?,
        estimators,
        device: options.device.load()?,
        counts_per_rev: distinct(&options.counts_per_rev, &[]),
        rates_hz: rates,
        phases: distinct(&options.phase, &PHASES),
        seconds: seconds(options.seconds)?,
    })
}
