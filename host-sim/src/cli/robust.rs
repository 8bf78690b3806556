//! `host-sim robust` and `host-sim merge`.

use std::path::{Path, PathBuf};

use clap::Args;

use catalogue::estimators::Kind;
use experiments::closed_loop::{environments_with, named};
use experiments::robust::row::Row;
use experiments::robust::shard::Part;
use experiments::robust::variation::Subject;
use experiments::robust::{Experiment, Settings, shard, summary};
use experiments::rows;
use experiments::table::layout::{NARROW, terminal_width};
use haptic_control::SceneKind;
use report;
use terminal::failure::Failure;
use terminal::output::{Folder, print_bytes, write_whole};

use super::arguments::{DeviceFile, ParameterOptions};
use super::page::{self, progress};

/// Where the report goes unless told otherwise.
const REPORT: &str = "target/robust";

#[derive(Debug, Args)]
pub(super) struct Robust {
    /// Scene to run; repeatable [default: all]
    #[arg(long = "scene", value_name = "NAME")]
    pub(super) scenes: Vec<String>,
    /// Control rate, Hz
    #[arg(
        long,
        value_name = "HZ",
        default_value_t = 10e3,
        allow_negative_numbers = true
    )]
    pub(super) rate: f64,
    /// Estimator of both velocities
    #[arg(long, value_name = "NAME", default_value = "kalman-triple-steady")]
    pub(super) estimator: String,
    /// How many devices are drawn for each scene, beside the corners
    #[arg(long, value_name = "N", default_value_t = 1000, value_parser = clap::value_parser!(u64).range(0..=10_000_000))]
    pub(super) devices: u64,
    /// Seed of everything random
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
    /// Run one device of each scene alone: its index, or a corner's name
    #[arg(long, value_name = "INDEX", conflicts_with = "shard")]
    pub(super) only: Option<Subject>,
    /// Run part K of N, and write a file for host-sim merge instead of the report
    #[arg(long, value_name = "K/N", conflicts_with = "json")]
    pub(super) shard: Option<Part>,
    /// Folder for index.html, summary.svg, robust.csv, robust.json, or for the shard's file
    /// [default: target/robust; with --json - or --only none]
    #[arg(long, value_name = "DIR")]
    pub(super) out: Option<PathBuf>,
    /// Write the rows as JSON to FILE; - is standard output, with nothing else there
    #[arg(long, value_name = "FILE")]
    pub(super) json: Option<PathBuf>,
}

#[derive(Debug, Args)]
pub(super) struct Merge {
    /// Files that host-sim robust --shard wrote, all of one run, in any order
    #[arg(value_name = "SHARD", required = true)]
    pub(super) shards: Vec<PathBuf>,
    /// Folder for what the run would have written in one piece [default: target/robust]
    #[arg(long, value_name = "DIR")]
    pub(super) out: Option<PathBuf>,
    /// Write the rows as JSON to FILE; - is standard output, with nothing else there
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

/// Everything that comes of all rows, the same whether they were run here or merged.
fn finish(
    settings: &Settings,
    rows: &[Row],
    folder: Option<&Path>,
    json_file: Option<&Path>,
) -> Result<(), Failure> {
    let json = rows::json(rows)?;
    let scenes = summary::summaries(rows)?;
    let mut text = summary::table(settings, &scenes, terminal_width());
    if let Some(folder) = folder {
        let page = report::robust(
            &summary::heading(settings),
            &scenes,
            &summary::table(settings, &scenes, NARROW),
            &summary::command(settings),
        )?;
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

/// A violation is a check that failed.
fn judged(settings: &Settings, rows: &[Row]) -> Result<(), Failure> {
    summary::complaint(settings, rows).map_or(Ok(()), |said| Err(Failure::Check(said)))
}
