//! The files of all parts of one run.

use std::path::{Path, PathBuf};

use serde_json::Value;

use crate::file::{File, Heading};
use crate::{Experiment, Part};
use terminal::failure::Failure;

/// All parts of one run, each once.
#[derive(Debug)]
pub struct Shards {
    /// In the order of the parts.
    files: Vec<File>,
}

/// An experiment and all its rows.
pub type Merged<E> = (E, Vec<<E as Experiment>::Row>);

impl Shards {
    /// Reads these files, given in any order. `version` is that of the program, which prints the rows.
    ///
    /// # Errors
    /// [`Failure::Input`] that names a file that is no part, is incomplete, was changed, is given twice
    /// or belongs to another run, or that names the missing parts.
    pub fn read(paths: &[PathBuf], version: &str) -> Result<Self, Failure> {
        let mut files: Vec<File> = Vec::new();
        for path in paths {
            let file = File::read(path).map_err(|error| empty(path, paths).unwrap_or(error))?;
            let said = match files.first() {
                Some(first) => file.differs_from(first),
                None if file.heading.version != version => Some(format!(
                    "written by version {}, and this is version {version}; merge with the program that \
                     wrote it",
                    file.heading.version
                )),
                None => None,
            };
            let part = file.heading.part;
            let twice = files.iter().find(|other| other.heading.part == part);
            let twice = twice.map(|other| {
                let other = other.path.display();
                format!("shard {part} is already given by {other}; give each shard once")
            });
            if let Some(said) = said.or(twice) {
                return Err(Failure::Input(format!("{}: {said}", path.display())));
            }
            files.push(file);
        }
        files.sort_by_key(|file| file.heading.part.k);
        let Some(first) = files.first() else {
            return Err(Failure::Input(
                "no shard to merge; give the files that --shard wrote".to_owned(),
            ));
        };
        let n = first.heading.part.n;
        let is_there = |k: &usize| files.iter().any(|file| file.heading.part.k == *k);
        let missing: Vec<_> = (1..=n).filter(|k| !is_there(k)).collect();
        match missing.first() {
            None => Ok(Self { files }),
            Some(&k) => {
                let again = first.heading.again(Part { k, n }, &first.path);
                let file = Part { k, n }.file_name();
                let said = match missing.len() {
                    1 => format!("shard {k}/{n} is missing; {again} and add its"),
                    _ => format!(
                        "shards {} of {n} are missing; {again}, likewise the others, and add",
                        ranges(&missing)
                    ),
                };
                Err(Failure::Input(format!("{said} {}", file.display())))
            }
        }
    }

    /// Program and command of the run.
    #[must_use]
    pub fn shard_of(&self) -> &str {
        &self.heading().shard_of
    }

    /// Command line of the run, without the options that name a part or an output.
    #[must_use]
    pub fn command(&self) -> &str {
        &self.heading().command
    }

    /// The experiment and its rows, those of a single run; `None` if the run is of another experiment.
    ///
    /// # Errors
    /// [`Failure::Input`] that names the file and the line of settings or of a row that this program
    /// does not understand.
    pub fn merge<E: Experiment>(&self) -> Result<Option<Merged<E>>, Failure> {
        if self.shard_of() != E::COMMAND {
            return Ok(None);
        }
        let refused = |file: &File, line: usize, said: &str| {
            let again = file.heading.again(file.heading.part, &file.path);
            let name = file.path.display();
            Failure::Input(format!("{name}: line {line}: {said}; {again}"))
        };
        let first = &self.files[0];
        let settings: Result<E, _> = serde_json::from_value(first.heading.settings.clone());
        let experiment = settings.map_err(|error| refused(first, 1, &error.to_string()))?;
        let (jobs, stated) = (experiment.jobs()?.len(), first.heading.jobs);
        if jobs != stated {
            let said = format!("{stated} jobs, where there are {jobs}");
            return Err(refused(first, 1, &said));
        }
        let mut lines: Vec<_> = (self.files.iter())
            .map(|file| (file, file.rows.lines().enumerate()))
            .collect();
        let n = lines.len();
        let rows = (0..jobs).filter_map(|job| {
            let (file, lines) = &mut lines[job % n];
            let (i, line) = lines.next()?;
            let row = serde_json::from_str(line);
            Some(row.map_err(|error| refused(file, i + 2, &error.to_string())))
        });
        let rows = rows.collect::<Result<_, _>>()?;
        Ok(Some((experiment, rows)))
    }

    fn heading(&self) -> &Heading {
        &self.files[0].heading
    }
}

impl File {
    /// Why this file does not belong to the run of `first`.
    fn differs_from(&self, first: &Self) -> Option<String> {
        let (own, known) = (&self.heading, &first.heading);
        let first = first.path.display();
        let other = if own.shard_of != known.shard_of {
            format!(
                "shard of {}, but {first} is one of {}",
                own.shard_of, known.shard_of
            )
        } else if own.version != known.version {
            format!(
                "written by version {}, but {first} by {}",
                own.version, known.version
            )
        } else if own.part.n != known.part.n {
            format!("shard {}, but {first} is shard {}", own.part, known.part)
        } else if let Some(what) = difference(&own.settings, &known.settings) {
            format!("settings differ from those of {first}: {what}")
        } else if own.command != known.command {
            format!(
                "command line {}, but that of {first} is {}",
                own.command, known.command
            )
        } else {
            return None;
        };
        Some(format!("{other}; merge shards of one run"))
    }
}

/// The error of an empty file, as a run leaves it that was ended: another one of `paths` has the command that
/// writes it. `None` for a file that is not empty.
fn empty(path: &Path, paths: &[PathBuf]) -> Option<Failure> {
    let metadata = std::fs::metadata(path).ok()?;
    if !metadata.is_file() || metadata.len() > 0 {
        return None;
    }
    let other = paths.iter().find_map(|other| File::read(other).ok());
    let part = path.file_name().and_then(Part::named);
    let again = match (other, part) {
        (Some(other), Some(part)) if part.n == other.heading.part.n => {
            other.heading.again(part, path)
        }
        _ => "run the command with its --shard again".to_owned(),
    };
    Some(Failure::Input(format!(
        "{}: is empty; {again}",
        path.display()
    )))
}

/// The first difference between two settings, in words.
fn difference(own: &Value, known: &Value) -> Option<String> {
    let (Value::Object(fields), Value::Object(others)) = (own, known) else {
        return (own != known).then(|| format!("{own}, not {known}"));
    };
    let null = &Value::Null;
    let names = fields.keys().chain(others.keys());
    let both = names.map(|name| {
        let of = |object: &serde_json::Map<_, _>| object.get(name).cloned();
        (name, of(fields), of(others))
    });
    both.into_iter().find_map(|(name, own, known)| {
        let own = own.as_ref().unwrap_or(null);
        let what = difference(own, known.as_ref().unwrap_or(null))?;
        let sign = if own.is_object() { "." } else { " = " };
        Some(format!("{name}{sign}{what}"))
    })
}

/// Ascending numbers as ranges: `2,5-7`.
fn ranges(numbers: &[usize]) -> String {
    let runs = numbers.chunk_by(|a, b| a + 1 == *b);
    let text = runs.map(|run| match run {
        [one] => one.to_string(),
        [first, .., last] => format!("{first}-{last}"),
        [] => String::new(),
    });
    text.collect::<Vec<_>>().join(",")
}
