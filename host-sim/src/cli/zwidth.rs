//! `host-sim zwidth`.

use std::ops::RangeInclusive;

use clap::Args;

use catalogue::estimators::Kind;
use experiments::closed_loop::loop_ticks;
use experiments::designed::with_friction;
use experiments::rows::{csv, json};
use experiments::table::layout::{NARROW, terminal_width};
use experiments::zwidth::{Boundary, HANDLE, Plan, Settings, rows, table, with_lines};
use recordings::arguments::DeviceFile;
use report::{self, Printout};
use shards::Experiment as _;
use simulation::device::{COUNTS_PER_REV, Device};
use terminal::failure::Failure;
use terminal::output::{Folder, note};

use super::arguments::{ParameterOptions, distinct, kinds, kinds_at};
use super::closed_loop::with_handle;
use super::page;
use super::rates::{TUNED_HZ, loop_rate_help, repeatable};
use super::shard::{Outputs, ShardOptions};

/// Default folder of the page.
pub(super) const PAGE: &str = "target/zwidth";

/// Text before the progress bar.
const DOING: &str = "searching";

/// Lines of an encoder of a device: a line is four counts.
const LINES: RangeInclusive<i64> =
    *COUNTS_PER_REV.start() as i64 / 4..=*COUNTS_PER_REV.end() as i64 / 4;

#[derive(Debug, Args)]
pub(super) struct Zwidth {
    /// Estimator of the large motor's velocity, see host-sim estimators; repeatable [default: all
    /// without edge time stamps, except those with a steady gain]
    #[arg(long = "estimator", value_name = "NAME")]
    pub(super) estimators: Vec<String>,
    /// Estimator of the handle's velocity [default: that of the large motor, or kalman-triple if
    /// that one needs the current]
    #[arg(
        long = "handle-estimator",
        visible_alias = "handle",
        value_name = "NAME"
    )]
    pub(super) handle: Option<String>,
    /// Search also with the true velocities of both motors in the place of estimates
    #[arg(long)]
    pub(super) exact: bool,
    #[arg(long = "rate", value_name = "HZ", help = loop_rate_help() + &repeatable(&TUNED_HZ))]
    pub(super) rates: Vec<f64>,
    /// Number of lines of the large encoder, 4 to 1000000; repeatable [default: 256, 1024 and 5000; with
    /// --device those of the device, a quarter of its counts per revolution]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(LINES))]
    pub(super) lines: Vec<u32>,
    /// Seed of the encoders' phases and of the disc's errors
    #[arg(long, value_name = "N", default_value_t = 1)]
    pub(super) seed: u64,
    #[command(flatten)]
    pub(super) device: DeviceFile,
    #[command(flatten)]
    pub(super) parameters: ParameterOptions,
    #[command(flatten)]
    pub(super) outputs: ShardOptions,
}

pub(super) fn run(options: &Zwidth, run_line: &str) -> Result<(), Failure> {
    let plan = plan(options)?;
    let asked = options.outputs.asked(run_line, PAGE, DOING);
    asked.run(&plan, finish)
}

/// Prints the table and writes page and JSON of all boundaries, whether they were found now or merged.
pub(super) fn finish(
    plan: &Plan,
    boundaries: &[Boundary],
    outputs: Outputs<'_>,
) -> Result<(), Failure> {
    let cases = plan.jobs()?;
    let rows = rows::rows(&cases, boundaries, plan.settings.seed);
    let json = json(&rows)?;
    let mut text = table::table(&cases, boundaries, terminal_width());
    if let Some(folder) = outputs.folder(PAGE)? {
        let printout = Printout {
            command: &outputs.command_line(),
            device: &plan.device_name,
            table: &table::table(&cases, boundaries, NARROW),
        };
        let page = report::zwidth(&rows, &printout)?;
        let mut files = Folder::new(folder);
        files.add("zwidth.json", json.as_slice());
        files.add("zwidth.csv", csv(&rows)?);
        let index = page::write(files, &page)?;
        text.push_str(&format!("\nPage: {}\n", index.display()));
    }
    page::print(outputs.json, &json, &text)
}

/// The lines of the device's own encoder. A note says which counts they are, if others than the device's and no
/// lines are `given`.
fn own_lines(device: &Device, given: &[u32]) -> u32 {
    let counts = device.stages.large.counts_per_rev;
    let lines = counts / 4;
    if given.is_empty() && 4 * lines != counts {
        note(format_args!(
            "note: large.counts_per_rev = {counts} is no whole number of lines; {lines} lines, {} counts, are used",
            4 * lines
        ));
    }
    lines
}

/// All combinations of rate, encoder and estimator, in the order of the table.
fn plan(options: &Zwidth) -> Result<Plan, Failure> {
    let device = options.device.load_to_simulate()?;
    let handle = Kind::named(options.handle.as_deref().unwrap_or(HANDLE))?;
    let run = with_handle(&kinds(&options.estimators)?, handle);
    let parameters = options.parameters.load(&run)?;
    let rates_hz = distinct(&options.rates, &TUNED_HZ);
    for &rate_hz in &rates_hz {
        loop_ticks(rate_hz, 1.0)?;
    }
    let lines = match options.device.is_given() {
        true => distinct(&options.lines, &[own_lines(&device, &options.lines)]),
        false => distinct(&options.lines, &[256, 1024, 5000]),
    };
    let mut places = Vec::new();
    for &lines in &lines {
        let device = with_lines(&device, lines);
        places.extend(rates_hz.iter().map(|&hz| with_friction(&device, hz)));
    }
    let mut estimators = kinds_at(&options.estimators, &parameters, &places)?;
    if options.estimators.is_empty() {
        // A filter with a steady gain is identical to the full filter once it has settled.
        estimators.retain(|kind| !kind.name.ends_with("-steady") && !kind.needs.edge);
    }
    let settings = Settings {
        device,
        parameters,
        seed: options.seed,
    };
    Ok(Plan {
        estimators: estimators.iter().map(|kind| kind.name.to_owned()).collect(),
        handle: options.handle.clone(),
        exact: options.exact,
        rates_hz,
        lines,
        settings,
        device_name: options.device.name(),
    })
}
