//! `host-sim robust` and `host-sim merge`.

use std::path::{Path, PathBuf};

use crate::closed_loop::SceneName;
use crate::estimators::Kind;
use crate::failure::Failure;
use crate::output::{print_bytes, write_whole};
use crate::robust::row::{self, Row};
use crate::robust::{Experiment, Settings, shard, summary};
use crate::{report, rows};

use super::arguments::{Merge, Robust, is_stdout};
use super::compare::progress;

/// Where the report goes unless told otherwise.
const REPORT: &str = "target/robust";

pub(super) fn run(options: &Robust) -> Result<(), Failure> {
    let settings = settings(options)?;
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

    let folder = options.out.as_deref();
    if let Some(part) = options.shard {
        let folder = folder.unwrap_or(Path::new(REPORT));
        let path = folder.join(part.file_name());
        write_whole(&path, &shard::write(&settings, part, &rows)?)?;
        print_bytes(format!("{}\n", path.display()).as_bytes())?;
        return judged(&settings, &rows);
    }
    let json_on_stdout = options.json.as_deref().is_some_and(is_stdout);
    let folder = match folder {
        None if options.only.is_some() || json_on_stdout => None,
        folder => Some(folder.unwrap_or(Path::new(REPORT))),
    };
    finish(&settings, &rows, folder, options.json.as_deref())
}

pub(super) fn merge(options: &Merge) -> Result<(), Failure> {
    let (settings, rows) = shard::merge(&options.shards)?;
    let folder = options.out.as_deref().unwrap_or(Path::new(REPORT));
    finish(&settings, &rows, Some(folder), options.json.as_deref())
}

fn settings(options: &Robust) -> Result<Settings, Failure> {
    let kind = Kind::named(&options.estimator)?;
    let device = options.device.load()?;
    let parameters = options.parameters.load()?;
    let mut scenes: Vec<SceneName> = Vec::new();
    for name in &options.scenes {
        let scene = name.parse()?;
        if !scenes.contains(&scene) {
            scenes.push(scene);
        }
    }
    if scenes.is_empty() {
        scenes.extend(SceneName::all_with(kind));
    }
    Ok(Settings {
        version: env!("CARGO_PKG_VERSION").to_owned(),
        scenes: scenes.iter().map(SceneName::to_string).collect(),
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
    let mut text = summary::table(settings, &scenes);
    if let Some(folder) = folder {
        let page = report::robust(&summary::heading(settings), &scenes, &text)?;
        write_whole(&folder.join("robust.csv"), &rows::csv(rows, row::COLUMNS)?)?;
        write_whole(&folder.join("robust.json"), &json)?;
        for figure in report::figures(&page) {
            write_whole(&folder.join("summary.svg"), figure.as_bytes())?;
        }
        let page_path: PathBuf = folder.join("index.html");
        write_whole(&page_path, page.as_bytes())?;
        text.push_str(&format!("Report: {}\n", page_path.display()));
    }
    match json_file {
        Some(path) if is_stdout(path) => print_bytes(&json)?,
        Some(path) => {
            write_whole(path, &json)?;
            print_bytes(text.as_bytes())?;
        }
        None => print_bytes(text.as_bytes())?,
    }
    judged(settings, rows)
}

/// A violation is a check that failed.
fn judged(settings: &Settings, rows: &[Row]) -> Result<(), Failure> {
    summary::complaint(settings, rows).map_or(Ok(()), |said| Err(Failure::Check(said)))
}
