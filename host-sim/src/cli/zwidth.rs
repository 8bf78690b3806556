//! `host-sim zwidth`.

use std::path::Path;

use crate::estimators::Kind;
use crate::failure::Failure;
use crate::output::{print_bytes, write_whole};
use crate::report;
use crate::rows::{csv, json};
use crate::zwidth::{BOUNDS_A_CASE, Case, Settings, boundaries, rows, table};

use super::arguments::{Zwidth, is_stdout, kinds, rates};
use super::compare::progress;

/// Where the page goes unless told otherwise.
const PAGE: &str = "target/zwidth";

pub(super) fn run(options: &Zwidth, command_line: &str) -> Result<(), Failure> {
    let settings = Settings {
        device: options.device.load()?,
        parameters: options.parameters.load()?,
        seed: options.seed,
    };
    let cases = cases(options)?;
    let bar = progress(cases.len() * BOUNDS_A_CASE, "searching");
    let boundaries = boundaries(&cases, &settings, || bar.inc(1))?;
    bar.finish_and_clear();

    let rows = rows::rows(&cases, &boundaries, settings.seed);
    let json = json(&rows)?;
    let json_on_stdout = options.json.as_deref().is_some_and(is_stdout);
    let folder = match &options.out {
        Some(folder) => Some(folder.as_path()),
        None if json_on_stdout => None,
        None => Some(Path::new(PAGE)),
    };
    let mut text = table::table(&cases, &boundaries);
    if let Some(folder) = folder {
        let device = options.device.name();
        let page = report::zwidth(&rows, &text, &device, command_line)?;
        let csv = csv(&rows, rows::COLUMNS)?;
        write_whole(&folder.join("zwidth.json"), &json)?;
        write_whole(&folder.join("zwidth.csv"), &csv)?;
        for (i, figure) in report::figures(&page).enumerate() {
            let name = format!("figures/{:02}.svg", i + 1);
            write_whole(&folder.join(name), figure.as_bytes())?;
        }
        write_whole(&folder.join("index.html"), page.as_bytes())?;
        text.push_str(&format!(
            "\nPage: {}\n",
            folder.join("index.html").display()
        ));
    }
    match &options.json {
        Some(_) if json_on_stdout => return print_bytes(&json),
        Some(path) => write_whole(path, &json)?,
        None => {}
    }
    print_bytes(text.as_bytes())
}

/// Rates, encoders, estimators, in this order of the table's blocks.
fn cases(options: &Zwidth) -> Result<Vec<Case>, Failure> {
    let mut estimators = kinds(&options.estimators)?;
    if options.estimators.is_empty() {
        // A steady gain is the same filter once it has settled.
        estimators.retain(|kind| !kind.name.ends_with("-steady") && !kind.needs.edge);
    }
    if let Some(kind) = estimators.iter().find(|kind| kind.needs.edge) {
        return Err(Failure::Input(format!(
            "{}: needs edge time stamps, which the closed loop does not have; take another",
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
        crate::simulate::ticks(rate_hz, 1.0)?;
        for &lines in &lines {
            cases.extend(estimators.iter().map(|&large| Case {
                large,
                handle: handle.unwrap_or(if large.needs.current { triple } else { large }),
                rate_hz,
                lines,
            }));
        }
    }
    Ok(cases)
}
