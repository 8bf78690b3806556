//! A long run in parts. Each part has its own course, so that all processor cores are used and
//! finished parts can be saved.

use std::collections::hash_map::DefaultHasher;
use std::fs::{self, File, OpenOptions};
use std::hash::{Hash, Hasher};
use std::io::{ErrorKind, Write};
use std::path::Path;
use std::sync::Mutex;

use rayon::prelude::*;
use serde::{Deserialize, Serialize};

use crate::findings::Findings;
use crate::tested::TestedEstimator;
use crate::trial;

/// Ticks of a part.
const PART: u64 = 100_000_000;

/// A part that is done, a line of the file of them.
#[derive(Clone, Debug, Serialize, Deserialize)]
struct Done {
    /// Of the program that did it.
    build: u64,
    seed: u64,
    ticks: u64,
    found: Findings,
}

/// Settings of a run.
#[derive(Clone, Copy, Debug)]
pub struct Plan {
    /// Seed of the first part's course; those of the others follow.
    pub seed: u64,
    /// Ticks for each estimator.
    pub ticks: u64,
}

impl Plan {
    /// Seed and ticks of each part.
    pub(crate) fn parts(self) -> impl Iterator<Item = (u64, u64)> {
        let whole = (0..self.ticks / PART).map(|_| PART);
        let rest = Some(self.ticks % PART).filter(|rest| *rest > 0);
        let seeds = (0..).map(move |part| self.seed.wrapping_add(part));
        seeds.zip(whole.chain(rest))
    }
}

/// A part of the course of one estimator: seed and ticks.
pub(crate) type Part<'a> = (&'a TestedEstimator, (u64, u64));

/// Runs the parts on all cores and calls `done` after each. With a file `kept`, each finished part is
/// added to the file, and parts that this program build finished before are read from it.
///
/// # Errors
/// One line if the file cannot be read, understood or written.
pub(crate) fn run(
    parts: &[Part<'_>],
    kept: Option<&Path>,
    done: &(dyn Fn() + Sync),
) -> Result<Vec<Findings>, String> {
    let before = kept.map_or(Ok(Vec::new()), read)?;
    let build = build()?;
    let file = kept.map(open).transpose()?.map(Mutex::new);
    let one = |(tested, (seed, ticks)): &Part<'_>| {
        let same = |done: &&Done| {
            (done.build, done.seed, done.ticks) == (build, *seed, *ticks)
                && done.found.estimator == tested.name
                && done.found.rate_hz.to_bits() == tested.rate_hz.to_bits()
        };
        if let Some(known) = before.iter().find(same) {
            done();
            return Ok(Findings {
                bounds: tested.bounds,
                ..known.found.clone()
            });
        }
        let found = trial::run(tested, *seed, *ticks);
        if let (Some(path), Some(file)) = (kept, &file) {
            let done = Done {
                build,
                seed: *seed,
                ticks: *ticks,
                found: found.clone(),
            };
            let mut line = serde_json::to_string(&done).map_err(|error| error.to_string())?;
            line.push('\n');
            let mut file = file.lock().map_err(|error| error.to_string())?;
            let written = file.write_all(line.as_bytes());
            written.map_err(|error| format!("{}: cannot write: {error}", path.display()))?;
        }
        done();
        Ok(found)
    };
    parts.par_iter().map(one).collect()
}

fn open(path: &Path) -> Result<File, String> {
    let opened = OpenOptions::new().append(true).create(true).open(path);
    opened.map_err(|error| format!("{}: cannot write: {error}", path.display()))
}

fn read(path: &Path) -> Result<Vec<Done>, String> {
    // A device may have no end.
    if fs::metadata(path).is_ok_and(|there| !there.is_file()) {
        return Err(format!(
            "{}: is no file; choose the name of a file",
            path.display()
        ));
    }
    let text = match fs::read_to_string(path) {
        Ok(text) => text,
        Err(error) if error.kind() == ErrorKind::NotFound => return Ok(Vec::new()),
        Err(error) => return Err(format!("{}: cannot read: {error}", path.display())),
    };
    let lines = text.lines().enumerate();
    let parts = lines.map(|(line, text)| {
        serde_json::from_str(text).map_err(|error| {
            let (path, line) = (path.display(), line + 1);
            format!("{path}: line {line}: not a part of a run ({error}); delete the line")
        })
    });
    parts.collect()
}

/// Tells builds apart: parts of another estimator are not parts of this run.
///
/// # Errors
/// One line if the program cannot be read.
pub fn build() -> Result<u64, String> {
    let program = std::env::current_exe().and_then(fs::read);
    let program = program.map_err(|error| format!("cannot read the program itself: {error}"))?;
    let mut hasher = DefaultHasher::new();
    program.hash(&mut hasher);
    Ok(hasher.finish())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tested::at;

    #[test]
    fn parts_have_all_ticks_of_the_course() {
        let plan = |ticks| Plan { seed: 7, ticks };
        assert_eq!(plan(5).parts().collect::<Vec<_>>(), [(7, 5)]);
        let parts: Vec<_> = plan(2 * PART + 1).parts().collect();
        assert_eq!(parts, [(7, PART), (8, PART), (9, 1)]);
    }

    #[test]
    fn saved_parts_are_skipped_and_others_are_run() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("kept.jsonl");
        let tested_estimators: Vec<_> = at(1000.0).into_iter().take(2).collect();
        let run = |seed| {
            let parts = tested_estimators.iter().map(|one| (one, (seed, 1000)));
            super::run(&parts.collect::<Vec<_>>(), Some(&path), &|| ())
        };
        let lines = || fs::read_to_string(&path).unwrap().lines().count();
        let first = run(1).unwrap();
        assert_eq!(lines(), 2);
        let again = run(1).unwrap();
        assert_eq!(lines(), 2);
        assert_eq!(format!("{first:?}"), format!("{again:?}"));
        run(2).unwrap();
        assert_eq!(lines(), 4);
        // Another build's parts do not count; a broken line is named.
        let mut other = String::new();
        for mut done in read(&path).unwrap() {
            done.build ^= 1;
            other += &(serde_json::to_string(&done).unwrap() + "\n");
        }
        fs::write(&path, other).unwrap();
        run(1).unwrap();
        assert_eq!(lines(), 6);
        fs::write(&path, "{").unwrap();
        let said = run(1).unwrap_err();
        assert!(said.contains("kept.jsonl: line 1: "), "{said}");
        // Reading a device without an end would not end.
        #[cfg(target_os = "linux")]
        for place in ["/dev/full", "/"] {
            let said = read(Path::new(place)).unwrap_err();
            assert_eq!(
                said,
                format!("{place}: is no file; choose the name of a file")
            );
        }
    }
}
