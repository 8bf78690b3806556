//! File of one part: a heading, the rows of the part, one a line, and a last line with the checksum of
//! all bytes before it.

use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};
use serde_json::Value;

use crate::{Experiment, Part};
use terminal::checksum::sum;
use terminal::failure::Failure;
use terminal::output::write_whole;
use terminal::wording::quoted;

/// The run that a part belongs to.
#[derive(Clone, Copy, Debug)]
pub struct Run<'a> {
    /// Version of the program.
    pub version: &'a str,
    /// Command line of the whole run, without the options that name a part or an output.
    pub command: &'a str,
}

/// First line of the file.
#[derive(Clone, Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Heading {
    /// [`Experiment::COMMAND`].
    pub(crate) shard_of: String,
    pub(crate) version: String,
    pub(crate) command: String,
    pub(crate) part: Part,
    /// Number of jobs of all parts together.
    pub(crate) jobs: usize,
    /// The experiment.
    pub(crate) settings: Value,
}

/// Last line of the file.
#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct End {
    rows: usize,
    /// Checksum of all bytes before this line, in hexadecimal digits.
    sum: String,
}

/// A part that was read.
#[derive(Debug)]
pub(crate) struct File {
    pub(crate) path: PathBuf,
    pub(crate) heading: Heading,
    /// The lines of the rows.
    pub(crate) rows: String,
}

/// The content of a part's file; `jobs` is the number of jobs of all parts together.
///
/// # Errors
/// [`Failure::Input`] if the rows cannot be serialised.
pub fn write<E: Experiment>(
    experiment: &E,
    run: Run<'_>,
    part: Part,
    jobs: usize,
    rows: &[E::Row],
) -> Result<Vec<u8>, Failure> {
    let failed = |error: serde_json::Error| Failure::Input(error.to_string());
    let heading = Heading {
        shard_of: E::COMMAND.to_owned(),
        version: run.version.to_owned(),
        command: run.command.to_owned(),
        part,
        jobs,
        settings: serde_json::to_value(experiment).map_err(failed)?,
    };
    let mut text = serde_json::to_vec(&heading).map_err(failed)?;
    text.push(b'\n');
    for row in rows {
        serde_json::to_writer(&mut text, row).map_err(failed)?;
        text.push(b'\n');
    }
    let end = End {
        rows: rows.len(),
        sum: format!("{:016x}", sum(&text)),
    };
    serde_json::to_writer(&mut text, &end).map_err(failed)?;
    text.push(b'\n');
    Ok(text)
}

/// Runs a part of an experiment, writes its file to `folder` and returns the path of the file. `done`
/// is called after each step of a job.
///
/// # Errors
/// [`Failure::Input`] of a job that cannot be run, or that names the file.
pub fn run_part<E: Experiment>(
    experiment: &E,
    run: Run<'_>,
    part: Part,
    folder: &Path,
    done: &(dyn Fn() + Sync),
) -> Result<PathBuf, Failure> {
    let all = experiment.jobs()?;
    let rows = experiment.rows(&part.of(&all), done)?;
    let path = folder.join(part.file_name());
    write_whole(&path, &write(experiment, run, part, all.len(), &rows)?)?;
    Ok(path)
}

impl File {
    /// Reads a part and checks that it is whole and unchanged.
    ///
    /// # Errors
    /// [`Failure::Input`] that names the file and the remedy.
    pub(crate) fn read(path: &Path) -> Result<Self, Failure> {
        let name = path.display();
        let refused = |said: String| Failure::Input(format!("{name}: {said}"));
        let foreign = |said: String| refused(format!("{said}; give the files that --shard wrote"));
        let text = std::fs::read_to_string(path)
            .map_err(|error| foreign(format!("cannot read: {error}")))?;
        let (first, rest) = text.split_once('\n').unwrap_or((&text, ""));
        let heading: Heading = serde_json::from_str(first)
            .map_err(|error| foreign(format!("line 1: not a shard: {error}")))?;
        if !heading.part.is_valid() {
            return Err(foreign(format!("line 1: no shard {}", heading.part)));
        }
        let again = heading.again(heading.part, path);
        let whole = rest.strip_suffix('\n').and_then(|lines| {
            let last = lines.rfind('\n').map_or(0, |end| end + 1);
            let end: End = serde_json::from_str(&lines[last..]).ok()?;
            Some((end, &rest[..last]))
        });
        let Some((end, rows)) = whole else {
            return Err(refused(format!("its end is missing; {again}")));
        };
        let found = format!(
            "{:016x}",
            sum(&text.as_bytes()[..first.len() + 1 + rows.len()])
        );
        let wanted = heading.part.count(heading.jobs);
        if found != end.sum {
            return Err(refused(format!(
                "changed after it was written: the checksum is {found}, not {}; {again}",
                end.sum
            )));
        }
        let counted = rows.lines().count();
        if end.rows != wanted || counted != wanted {
            return Err(refused(format!(
                "has {counted} rows and states {}, where shard {} of {} jobs has {wanted}; {again}",
                end.rows, heading.part, heading.jobs
            )));
        }
        let rows = rows.to_owned();
        Ok(Self {
            path: path.to_owned(),
            heading,
            rows,
        })
    }
}

impl Heading {
    /// How to run a part again, into the folder of `path`, as a shell reads it.
    pub(crate) fn again(&self, part: Part, path: &Path) -> String {
        let folder = path
            .parent()
            .filter(|folder| !folder.as_os_str().is_empty());
        let folder = quoted(folder.unwrap_or(Path::new(".")).as_os_str());
        format!("run {} --shard {part} --out {folder}", self.command)
    }
}
