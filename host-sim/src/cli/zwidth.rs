//! `host-sim zwidth`.

use std::path::PathBuf;

use clap::Args;

use catalogue::estimators::Kind;
use experiments::rows::{csv, json};
use experiments::table::layout::{NARROW, terminal_width};
use experiments::zwidth::{BOUNDS_A_CASE, LoopSetup, Settings, boundaries, rows, table};
use recordings::arguments::DeviceFile;
use report::{self, Printout};
use terminal::failure::Failure;
use terminal::output::Folder;

use super::arguments::{ParameterOptions, kinds, rates};
use super::page::{self, progress};

/// Default folder of the page.
const PAGE: &str = "target/zwidth";

#[derive(Debug, Args)]
pub(super) struct Zwidth {
    /// Estimator of the large motor's velocity, see host-sim estimators; repeatable [default: all
    /// without edge time stamps, except those with a steady gain]
    #[arg(long = "estimator", value_name = "NAME")]
    pub(super) estimators: Vec<String>,
    /// Estimator of the handle's velocity [default: that of the large motor, or kalman-triple if
    /// that one needs the current]
    #[arg(long, value_name = "NAME")]
    pub(super) handle: Option<String>,
    /// Control rate, 100 to 100000 Hz; repeatable [default: 1000, 10000 and 11600]
    #[arg(long = "rate", value_name = "HZ", allow_negative_numbers = true)]
    pub(super) rates: Vec<f64>,
    /// Number of lines of the large encoder, 1 to 1000000; repeatable [default: 256, 1024 and 5000]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=1_000_000))]
    pub(super) lines: Vec<u32>,
    /// Seed of the encoders' phases and of the disc's errors
    #[arg(long, value_name = "N", default_value_t = 1)]
    pub(super) seed: u64,
    #[command(flatten)]
    pub(super) device: DeviceFile,
    #[command(flatten)]
    pub(super) parameters: ParameterOptions,
    /// Folder of index.html, figures as SVG, zwidth.csv, zwidth.json [default: target/zwidth; no
    /// folder with --json -]
    #[arg(long, value_name = "DIR")]
    pub(super) out: Option<PathBuf>,
    /// Write the bounds as JSON to FILE; - is standard output, which then has nothing else
    #[arg(long, value_name = "FILE")]
    pub(super) json: Option<PathBuf>,
}

pub(super) fn run(options: &Zwidth, command_line: &str) -> Result<(), Failure> {
    let settings = Settings {
        device: options.device.load()?,
        parameters: options.parameters.load()?,
        seed: options.seed,
    };
    let cases = cases(options)?;
    let folder = page::folder(options.out.as_deref(), options.json.as_deref(), PAGE)?;
    let bar = progress(cases.len() * BOUNDS_A_CASE, "searching");
    let boundaries = boundaries(&cases, &settings, || bar.inc(1))?;
    bar.finish_and_clear();

    let rows = rows::rows(&cases, &boundaries, settings.seed);
    let json = json(&rows)?;
    let mut text = table::table(&cases, &boundaries, terminal_width());
    if let Some(folder) = folder {
        let printout = Printout {
            command: command_line,
            device: &options.device.name(),
            table: &table::table(&cases, &boundaries, NARROW),
        };
        let page = report::zwidth(&rows, &printout)?;
        let mut files = Folder::new(folder);
        files.add("zwidth.json", json.as_slice());
        files.add("zwidth.csv", csv(&rows)?);
        let index = page::write(files, &page)?;
        text.push_str(&format!("\nPage: {}\n", index.display()));
    }
    page::print(options.json.as_deref(), &json, &text)
}

/// All combinations of rate, encoder and estimator, in the order of the table.
fn cases(options: &Zwidth) -> Result<Vec<LoopSetup>, Failure> {
    let mut estimators = kinds(&options.estimators)?;
    if options.estimators.is_empty() {
        // A filter with a steady gain is identical to the full filter once it has settled.
        estimators.retain(|kind| !kind.name.ends_with("-steady") && !kind.needs.edge);
    }
    if let Some(kind) = estimators.iter().find(|kind| kind.needs.edge) {
        return Err(Failure::Input(format!(
            "{}: needs edge time stamps, which the closed loop does not have; choose another estimator",
            kind.name
        )));
    }
    let handle = options.handle.as_deref().map(Kind::named).transpose()?;
    let triple = Kind::named("kalman-triple")?;
    let mut lines = Vec::new();
    for &n in if options.lines.is_empty() {
        &[256, 1024, 5000][..]
    } else {
        &options.lines
    } {
        if !lines.contains(&n) {
            lines.push(n);
        }
    }
    let mut cases = Vec::new();
    for rate_hz in rates(&options.rates, &[1e3, 10e3, 11.6e3]) {
        simulation::simulate::ticks(rate_hz, 1.0)?;
        for &lines in &lines {
            cases.extend(estimators.iter().map(|&large| LoopSetup {
                large,
                handle: handle.unwrap_or(if large.needs.current { triple } else { large }),
                rate_hz,
                lines,
            }));
        }
    }
    Ok(cases)
}
