//! What commands that score have in common: a bar while they work, a page, JSON, a table.

use std::path::{Path, PathBuf};

use indicatif::{ProgressBar, ProgressStyle};

use crate::failure::Failure;
use crate::output::{print_bytes, write_whole};
use crate::report;

use super::arguments::is_stdout;

/// A progress bar on standard error, if that is a terminal.
pub(super) fn progress(length: usize, doing: &'static str) -> ProgressBar {
    let style = ProgressStyle::with_template("{msg} {wide_bar} {pos}/{len} {eta}");
    ProgressBar::new(length as u64)
        .with_style(style.unwrap_or_else(|_| ProgressStyle::default_bar()))
        .with_message(doing)
}

/// Folder of the page: `--out`, or `usual` unless the JSON goes to standard output.
pub(super) fn folder<'a>(
    out: Option<&'a Path>,
    json: Option<&Path>,
    usual: &'static str,
) -> Option<&'a Path> {
    match out {
        None if json.is_some_and(is_stdout) => None,
        out => Some(out.unwrap_or(Path::new(usual))),
    }
}

/// Writes the page as `index.html`, and its figures beside it.
pub(super) fn write(folder: &Path, page: &str) -> Result<PathBuf, Failure> {
    for (i, figure) in report::figures(page).enumerate() {
        let name = format!("figures/{:02}.svg", i + 1);
        write_whole(&folder.join(name), figure.as_bytes())?;
    }
    let index = folder.join("index.html");
    write_whole(&index, page.as_bytes())?;
    Ok(index)
}

/// The JSON to its file and `text` to standard output, or the JSON alone to standard output.
pub(super) fn print(json_file: Option<&Path>, json: &[u8], text: &str) -> Result<(), Failure> {
    match json_file {
        Some(path) if is_stdout(path) => return print_bytes(json),
        Some(path) => write_whole(path, json)?,
        None => {}
    }
    print_bytes(text.as_bytes())
}
