//! `host-sim robust` and `host-sim merge`.

use std::path::{Path, PathBuf};

use clap::Args;

use catalogue::estimators::Kind;
use experiments::closed_loop::{environments_with, named};
use experiments::robust::row::RobustRow;
use experiments::robust::shard::Part;
use experiments::robust::variation::Subject;
use experiments::robust::{Experiment, Settings, shard, summary};
use experiments::rows;
use experiments::table::layout::{NARROW, terminal_width};
use haptic_control::SceneKind;
use recordings::arguments::DeviceFile;
use report::{self, Printout};
use terminal::failure::Failure;
use terminal::output::{Folder, print_bytes, write_whole};

use super::arguments::ParameterOptions;
use super::page::{self, progress};

/// Default folder of the report.
const REPORT: &str = "target/robust";

#[derive(Debug, Args)]
pub(super) struct Robust {
    /// Scene to run, as in compare --closed-loop; repeatable [default: all]
    #[arg(long = "scene", value_name = "NAME")]
    pub(super) scenes: Vec<String>,
    /// Control rate, 100 to 100000 Hz
    #[arg(
        long,
        value_name = "HZ",
        default_value_t = 10e3,
        allow_negative_numbers = true
    )]
    pub(super) rate: f64,
    /// Estimator of both velocities, see host-sim estimators
    #[arg(long, value_name = "NAME", default_value = "kalman-triple-steady")]
    pub(super) estimator: String,
    /// Number of random devices per scene, 0 to 10000000; the corners of the ranges are added
    #[arg(long, value_name = "N", default_value_t = 1000, value_parser = clap::value_parser!(u64).range(0..=10_000_000))]
    pub(super) devices: u64,
    /// Seed of all random numbers
    #[arg(long, value_name = "N", default_value_t = 1)]
    pub(super) seed: u64,
    /// Duration of each run, s
    #[arg(
        long,
        value_name = "S",
        default_value_t = 2.0,
        allow_negative_numbers = true
    )]
    pub(super) seconds: f64,
    #[command(flatten)]
    pub(super) device: DeviceFile,
    #[command(flatten)]
    pub(super) parameters: ParameterOptions,
    /// Run only one device of each scene, given by its index or the name of a corner
    #[arg(long, value_name = "INDEX", conflicts_with = "shard")]
    pub(super) only: Option<Subject>,
    /// Run only part K of N, for example 1/4, and write a file for host-sim merge, no report
    #[arg(long, value_name = "K/N", conflicts_with = "json")]
    pub(super) shard: Option<Part>,
    /// Folder of index.html, summary.svg, robust.csv, robust.json, or of the shard's file
    /// [default: target/robust; no folder with --json - or --only]
    #[arg(long, value_name = "DIR")]
    pub(super) out: Option<PathBuf>,
    /// Write the rows as JSON to FILE; - is standard output, which then has nothing else
    #[arg(long, value_name = "FILE")]
    pub(super) json: Option<PathBuf>,
}

#[derive(Debug, Args)]
pub(super) struct Merge {
    /// All files that host-sim robust --shard wrote for one run, in any order
    #[arg(value_name = "SHARD", required = true)]
    pub(super) shards: Vec<PathBuf>,
    /// Folder of index.html, summary.svg, robust.csv, robust.json [default: target/robust]
    #[arg(long, value_name = "DIR")]
    pub(super) out: Option<PathBuf>,
    /// Write the rows as JSON to FILE; - is standard output, which then has nothing else
    #[arg(long, value_name = "FILE")]
    pub(super) json: Option<PathBuf>,
}

pub(super) fn run(options: &Robust) -> Result<(), Failure> {
    let settings = settings(options)?;
    let out = options.out.as_deref();
    let json_file = options.json.as_deref();
    let folder = match (options.only, options.shard) {
        (Some(_), _) => out,
        (None, Some(_)) => Some(out.unwrap_or(Path::new(REPORT))),
        (None, None) => page::folder(out, json_file, REPORT)?,
    };
    if let Some(folder) = folder {
        Folder::check("--out", folder)?;
    }
    let experiment = Experiment::new(&settings)?;
    let mut jobs = settings.jobs()?;
    if let Some(subject) = options.only {
        jobs = settings
            .scenes()?
            .into_iter()
            .map(|scene| (scene, subject))
            .collect();
    }
    if let Some(part) = options.shard {
        jobs = part.of(&jobs);
    }
    let bar = progress(jobs.len(), "simulating");
    let rows = experiment.rows(&jobs, || bar.inc(1))?;
    bar.finish_and_clear();

    if let (Some(part), Some(folder)) = (options.shard, folder) {
        let path = folder.join(part.file_name());
        write_whole(&path, &shard::write(&settings, part, &rows)?)?;
        print_bytes(format!("{}\n", path.display()).as_bytes())?;
        return judged(&settings, &rows);
    }
    finish(&settings, &rows, folder, json_file)
}

pub(super) fn merge(options: &Merge) -> Result<(), Failure> {
    let folder = options.out.as_deref().unwrap_or(Path::new(REPORT));
    Folder::check("--out", folder)?;
    let (settings, rows) = shard::merge(&options.shards)?;
    finish(&settings, &rows, Some(folder), options.json.as_deref())
}

fn settings(options: &Robust) -> Result<Settings, Failure> {
    let kind = Kind::named(&options.estimator)?;
    let device = options.device.load()?;
    let parameters = options.parameters.load()?;
    let mut scenes: Vec<SceneKind> = Vec::new();
    for name in &options.scenes {
        let scene = named(name, SceneKind::environments())?;
        if !scenes.contains(&scene) {
            scenes.push(scene);
        }
    }
    if scenes.is_empty() {
        scenes.extend(environments_with(kind));
    }
    Ok(Settings {
        version: env!("CARGO_PKG_VERSION").to_owned(),
        scenes: scenes.iter().map(ToString::to_string).collect(),
        rate_hz: options.rate,
        estimator: kind.name.to_owned(),
        values: Settings::values(kind, &device, options.rate, &parameters),
        devices: options.devices,
        seed: options.seed,
        seconds: options.seconds,
        device,
    })
}

/// Prints the table and writes report and JSON of all rows, whether they were run now or merged.
fn finish(
    settings: &Settings,
    rows: &[RobustRow],
    folder: Option<&Path>,
    json_file: Option<&Path>,
) -> Result<(), Failure> {
    let json = rows::json(rows)?;
    let scenes = summary::summaries(rows)?;
    let mut text = summary::table(settings, &scenes, terminal_width());
    if let Some(folder) = folder {
        let printout = Printout {
            command: &summary::command(settings),
            table: &summary::table(settings, &scenes, NARROW),
            ..Printout::default()
        };
        let page = report::robust(&summary::heading(settings), &scenes, &printout)?;
        let mut files = Folder::new(folder);
        files.add("robust.csv", rows::csv(rows)?);
        files.add("robust.json", json.as_slice());
        for figure in report::figures(&page) {
            files.add("summary.svg", figure);
        }
        files.add("index.html", page);
        let index = files.file("index.html");
        files.write()?;
        text.push_str(&format!("Report: {}\n", index.display()));
    }
    page::print(json_file, &json, &text)?;
    judged(settings, rows)
}

/// Fails with exit status 1 if a row violates a criterion.
fn judged(settings: &Settings, rows: &[RobustRow]) -> Result<(), Failure> {
    summary::complaint(settings, rows).map_or(Ok(()), |said| Err(Failure::Check(said)))
}
