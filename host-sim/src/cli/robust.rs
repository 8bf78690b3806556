//! `host-sim robust`.

use std::path::Path;

use clap::Args;

use catalogue::estimators::Kind;
use experiments::robust::row::RobustRow;
use experiments::robust::variation::Subject;
use experiments::robust::{Settings, summary};
use experiments::rows;
use experiments::table::layout::{NARROW, terminal_width};
use experiments::transparency::compare::DEFAULT_ESTIMATOR;
use recordings::arguments::DeviceFile;
use report::{self, Printout};
use terminal::failure::Failure;
use terminal::output::{Folder, note};
use terminal::wording::wrapped;

use super::arguments::ParameterOptions;
use super::page;
use super::rates::loop_rate_help;
use super::shard::{self, Outputs, ShardOptions};

/// Default folder of the report.
pub(super) const REPORT: &str = "target/robust";

/// Text before the progress bar.
const DOING: &str = "simulating";

#[derive(Debug, Args)]
pub(super) struct Robust {
    /// Scene to run, as in compare --closed-loop; repeatable [default: all]
    #[arg(long = "scene", value_name = "NAME")]
    pub(super) scenes: Vec<String>,
    #[arg(long, value_name = "HZ", default_value_t = 10e3, help = loop_rate_help())]
    pub(super) rate: f64,
    /// Estimator of both velocities, see host-sim estimators
    #[arg(long, value_name = "NAME", default_value = DEFAULT_ESTIMATOR)]
    pub(super) estimator: String,
    /// Number of random devices per scene, 0 to 10000000; the corners of the ranges are added
    #[arg(long, value_name = "N", default_value_t = 1000, value_parser = clap::value_parser!(u64).range(0..=10_000_000))]
    pub(super) devices: u64,
    /// Seed of all random numbers
    #[arg(long, value_name = "N", default_value_t = 1)]
    pub(super) seed: u64,
    /// Duration of each run, s
    #[arg(long, value_name = "S", default_value_t = 2.0)]
    pub(super) seconds: f64,
    #[command(flatten)]
    pub(super) device: DeviceFile,
    #[command(flatten)]
    pub(super) parameters: ParameterOptions,
    /// Run only one device of each scene, given by its index, below --devices, or the name of a corner;
    /// there is no report without --out
    #[arg(long, value_name = "INDEX", conflicts_with = "shard")]
    pub(super) only: Option<Subject>,
    #[command(flatten)]
    pub(super) outputs: ShardOptions,
}

pub(super) fn run(options: &Robust, run_line: &str) -> Result<(), Failure> {
    let settings = settings(options)?;
    let asked = options.outputs.asked(run_line, REPORT, DOING);
    let Some(subject) = options.only else {
        return asked.run(&settings, finish);
    };
    if let Subject::Drawn(index) = subject
        && index >= options.devices
    {
        return Err(Failure::Input(no_device(index, options.devices)));
    }
    let outputs = asked.outputs;
    let folder = outputs.folder(REPORT)?;
    let scenes = settings.scenes()?.into_iter();
    let jobs: Vec<_> = scenes.map(|scene| (scene, subject)).collect();
    let rows = shard::rows(&settings, &jobs, DOING)?;
    // The report of a single device is only written where it is asked for.
    write(&settings, &rows, outputs, outputs.out.and(folder))
}

/// Message about an `--only` beyond the drawn devices.
fn no_device(index: u64, devices: u64) -> String {
    let there = match devices.checked_sub(1) {
        None => "no device is drawn with --devices 0".to_owned(),
        Some(last) => format!("the devices that --devices {devices} draws are 0 to {last}"),
    };
    format!("--only {index}: {there}; choose another index, a corner, or a larger --devices")
}

fn settings(options: &Robust) -> Result<Settings, Failure> {
    let kind = Kind::named(&options.estimator)?;
    let device = options.device.load_to_simulate()?;
    let parameters = options.parameters.load(&[kind])?;
    Ok(Settings {
        version: env!("CARGO_PKG_VERSION").to_owned(),
        scenes: Settings::scene_names(&options.scenes, kind)?,
        rate_hz: options.rate,
        estimator: kind.name.to_owned(),
        values: Settings::values(kind, &device, options.rate, &parameters),
        devices: options.devices,
        seed: options.seed,
        seconds: options.seconds,
        device,
        device_name: options.device.name(),
    })
}

/// Prints the table and writes report and JSON of all rows, whether they were run now or merged.
pub(super) fn finish(
    settings: &Settings,
    rows: &[RobustRow],
    outputs: Outputs<'_>,
) -> Result<(), Failure> {
    write(settings, rows, outputs, outputs.folder(REPORT)?)
}

fn write(
    settings: &Settings,
    rows: &[RobustRow],
    outputs: Outputs<'_>,
    folder: Option<&Path>,
) -> Result<(), Failure> {
    let json = rows::json(rows)?;
    let scenes = summary::summaries(rows)?;
    let limited = summary::limited(settings, rows)?;
    for line in &limited {
        note(format_args!("note: {line}"));
    }
    let mut text = summary::table(settings, &scenes, terminal_width());
    if let Some(folder) = folder {
        let below: String = (limited.iter())
            .map(|line| wrapped(line, 0) + "\n")
            .collect();
        let printout = Printout {
            command: &outputs.command_line(),
            device: &settings.device_name,
            table: &(summary::table(settings, &scenes, NARROW) + &below),
        };
        let page = report::robust(&summary::heading(settings, &scenes), &scenes, &printout)?;
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
    page::print(outputs.json, &json, &text)?;
    judged(settings, rows)
}

/// Fails with exit status 1 if a row violates a criterion.
fn judged(settings: &Settings, rows: &[RobustRow]) -> Result<(), Failure> {
    summary::complaint(settings, rows).map_or(Ok(()), |said| Err(Failure::Check(said)))
}
