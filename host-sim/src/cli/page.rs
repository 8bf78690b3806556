//! Output that several commands share: progress bar, page, JSON and table.

use std::path::{Path, PathBuf};
use std::time::Duration;

use indicatif::{ProgressBar, ProgressStyle};

use report;
use terminal::failure::Failure;
use terminal::output::{Folder, is_stdout, print_bytes, print_text, write_whole};

/// Period at which a spinner turns.
const SPIN: Duration = Duration::from_millis(200);

/// A progress bar on standard error, with the time that has passed and the time that is left. It is hidden if
/// standard error is not a terminal.
pub(super) fn progress(length: usize, doing: &'static str) -> ProgressBar {
    let style = ProgressStyle::with_template("{msg} {wide_bar} {pos}/{len} {elapsed} {eta}");
    let bar = ProgressBar::new(length as u64)
        .with_style(style.unwrap_or_else(|_| ProgressStyle::default_bar()))
        .with_message(doing);
    // One step can take minutes.
    bar.enable_steady_tick(SPIN);
    bar
}

/// A sign of life with the time that has passed, on standard error, for work whose steps are not known.
pub(super) fn working(doing: &'static str) -> ProgressBar {
    let style = ProgressStyle::with_template("{spinner} {msg} {elapsed}");
    let bar = ProgressBar::new_spinner()
        .with_style(style.unwrap_or_else(|_| ProgressStyle::default_spinner()))
        .with_message(doing);
    bar.enable_steady_tick(SPIN);
    bar
}

/// Folder of the page: `--out`, or `usual` unless the JSON goes to standard output.
///
/// # Errors
/// [`Failure::Input`] if `--out` is standard output.
pub(super) fn folder<'a>(
    out: Option<&'a Path>,
    json: Option<&Path>,
    usual: &'static str,
) -> Result<Option<&'a Path>, Failure> {
    match out {
        None if json.is_some_and(is_stdout) => Ok(None),
        out => {
            let folder = out.unwrap_or(Path::new(usual));
            Folder::check("--out", folder)?;
            Ok(Some(folder))
        }
    }
}

/// Adds the page as `index.html` and its figures, and writes the folder.
pub(super) fn write(mut folder: Folder, page: &str) -> Result<PathBuf, Failure> {
    for (i, figure) in report::figures(page).enumerate() {
        folder.add(format!("figures/{:02}.svg", i + 1), figure);
    }
    folder.add("index.html", page);
    let index = folder.file("index.html");
    folder.write()?;
    Ok(index)
}

/// Writes the JSON to its file and `text` to standard output, or only the JSON to standard output.
pub(super) fn print(json_file: Option<&Path>, json: &[u8], text: &str) -> Result<(), Failure> {
    match json_file {
        Some(path) if is_stdout(path) => return print_bytes(json),
        Some(path) => write_whole(path, json)?,
        None => {}
    }
    print_text(text)
}

/// Refuses more than one file on standard output. A file is given by its option and its path.
///
/// # Errors
/// [`Failure::Input`] that names both options.
pub(super) fn one_to_stdout(options: &[(&str, &Option<PathBuf>)]) -> Result<(), Failure> {
    let to_stdout = |(_, path): &&(&str, &Option<PathBuf>)| path.as_deref().is_some_and(is_stdout);
    let names: Vec<_> = options
        .iter()
        .filter(to_stdout)
        .map(|(name, _)| *name)
        .collect();
    if names.len() < 2 {
        return Ok(());
    }
    Err(Failure::Input(format!(
        "{} -: only one of them can go to standard output",
        names.join(" - and ")
    )))
}
