//! `host-sim feel`.

use std::path::PathBuf;

use clap::Args;

use catalogue::estimators::Kind;
use experiments::closed_loop::loop_ticks;
use experiments::feel::rows::{self, FeelRow};
use experiments::feel::{Case, Settings, Without, feel, table::table, without_spectrum};
use experiments::rows::{csv, json};
use experiments::table::layout::{NARROW, terminal_width};
use haptic_control::SceneKind;
use recordings::arguments::DeviceFile;
use report::{self, Printout};
use terminal::failure::Failure;
use terminal::output::{Folder, note};
use terminal::wording::wrapped;

use super::arguments::{ParameterOptions, distinct, handle_help};
use super::closed_loop;
use super::compare::longer_than_skipped;
use super::page::{self, progress};
use super::rates::{USUAL_HZ, loop_rate_help, repeatable};

/// Default folder of the page.
pub(super) const PAGE: &str = "target/feel";

/// Help text of `--scene`, with the names of the scenes.
fn scene_help() -> String {
    let scenes: Vec<_> = SceneKind::environments().map(SceneKind::name).collect();
    format!(
        "Scene to run: {}; repeatable [default: all]",
        scenes.join(", ")
    )
}

#[derive(Debug, Args)]
pub(super) struct Feel {
    #[arg(long = "scene", visible_alias = "scenario", value_name = "NAME", help = scene_help())]
    pub(super) scenes: Vec<String>,
    #[arg(long = "rate", value_name = "HZ", help = loop_rate_help() + &repeatable(&USUAL_HZ))]
    pub(super) rates: Vec<f64>,
    /// Estimator of the large motor's velocity, see host-sim estimators; repeatable [default: all
    /// without edge time stamps]
    #[arg(long = "estimator", value_name = "NAME")]
    pub(super) estimators: Vec<String>,
    #[arg(long, value_name = "NAME", help = handle_help(""))]
    pub(super) handle_estimator: Option<String>,
    /// Seed of all random numbers
    #[arg(long, value_name = "N", default_value_t = 1)]
    pub(super) seed: u64,
    /// Duration of each run, s
    #[arg(long, value_name = "S", default_value_t = 10.0)]
    pub(super) seconds: f64,
    /// Only divide the force among its causes; switch nothing off
    #[arg(long)]
    pub(super) causes_only: bool,
    /// Switch nothing off; instead run controllers that know more than a board: the bounds of the force
    #[arg(long, conflicts_with = "causes_only")]
    pub(super) bounds: bool,
    #[command(flatten)]
    pub(super) device: DeviceFile,
    #[command(flatten)]
    pub(super) parameters: ParameterOptions,
    /// Folder of index.html, figures as SVG, causes.csv, switched-off.csv, feel.json [default:
    /// target/feel; no folder with --json -]
    #[arg(long, value_name = "DIR")]
    pub(super) out: Option<PathBuf>,
    /// Write causes and scores as JSON to FILE; - is standard output, which then has nothing else
    #[arg(long, value_name = "FILE")]
    pub(super) json: Option<PathBuf>,
}

pub(super) fn run(options: &Feel, command_line: &str) -> Result<(), Failure> {
    let handle = closed_loop::handle(options.handle_estimator.as_deref())?;
    let estimators = closed_loop::estimators(&options.estimators, handle)?;
    let settings = Settings {
        device: options.device.load_to_simulate()?,
        parameters: options
            .parameters
            .load(&closed_loop::with_handle(&estimators, handle))?,
        handle,
        seed: options.seed,
        seconds: options.seconds,
        without: match (options.causes_only, options.bounds) {
            (true, _) => Vec::new(),
            (_, true) => Without::BOUNDS.to_vec(),
            _ => Without::ALL.to_vec(),
        },
    };
    longer_than_skipped(options.seconds)?;
    let scenes = closed_loop::scenes(&options.scenes, handle)?;
    let cases = cases(
        &distinct(&options.rates, &USUAL_HZ),
        &scenes,
        &estimators,
        options.seconds,
    )?;
    let folder = page::folder(options.out.as_deref(), options.json.as_deref(), PAGE)?;
    let left_out = settings.left_out();
    if let Some(line) = &left_out {
        note(format_args!("note: {line}"));
    }
    let bar = progress(experiments::feel::runs(&cases, &settings), "closing loops");
    let felt = feel(&cases, &settings, &|| bar.inc(1))?;
    bar.finish_and_clear();
    let short = without_spectrum(&felt);
    if let Some(line) = &short {
        note(format_args!("note: {line}"));
    }

    let (causes, without) = (
        rows::causes(&felt, &settings),
        rows::without(&felt, &settings),
    );
    let both: Vec<FeelRow> = (causes.iter().cloned().map(FeelRow::Cause))
        .chain(without.iter().cloned().map(FeelRow::Without))
        .collect();
    let json = json(&both)?;
    let mut text = table(&felt, &settings, terminal_width());
    if let Some(folder) = folder {
        let lines = left_out.iter().chain(&short);
        let below: String = lines
            .map(|line| format!("\n{}\n", wrapped(line, 0)))
            .collect();
        let printout = Printout {
            command: command_line,
            device: &options.device.name(),
            table: &(table(&felt, &settings, NARROW) + &below),
        };
        let threshold_mn = 1e3 * settings.device.interval.threshold_n;
        let page = report::feel(&felt, threshold_mn, &printout)?;
        let mut files = Folder::new(folder);
        files.add("feel.json", json.as_slice());
        files.add("causes.csv", csv(&causes)?);
        files.add("switched-off.csv", csv(&without)?);
        let index = page::write(files, &page)?;
        text.push_str(&format!("\nPage: {}\n", index.display()));
    }
    page::print(options.json.as_deref(), &json, &text)
}

/// The cases, rate by rate and scene by scene.
fn cases(
    rates: &[f64],
    scenes: &[SceneKind],
    estimators: &[&'static Kind],
    seconds: f64,
) -> Result<Vec<Case>, Failure> {
    let mut cases = Vec::new();
    for &rate_hz in rates {
        loop_ticks(rate_hz, seconds)?;
        for &scene in scenes {
            let case = |estimator| Case {
                scene,
                rate_hz,
                estimator,
            };
            match scene.facts().needs.continuous {
                true => cases.extend(estimators.iter().map(|kind| case(Some(*kind)))),
                false => cases.push(case(None)),
            }
        }
    }
    Ok(cases)
}
