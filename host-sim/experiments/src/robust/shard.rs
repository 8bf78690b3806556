//! Shards: files with the rows of a part of the devices, and their merging.

use std::fmt;
use std::path::{Path, PathBuf};
use std::str::FromStr;

use serde::{Deserialize, Serialize};

use super::row::RobustRow;
use super::{Job, Settings};
use terminal::failure::Failure;

/// Part `k` of `n`; the first part is 1.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Part {
    /// Number of the part, 1 to `n`.
    pub k: usize,
    /// Number of parts.
    pub n: usize,
}

/// First line of a shard file; the rows follow, one per line.
#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Heading {
    robust_shard: Part,
    settings: Settings,
}

impl Part {
    /// The jobs of this part: within each scene every `n`th job from the `k`th on.
    #[must_use]
    pub fn of(self, jobs: &[Job]) -> Vec<Job> {
        let scenes = jobs.chunk_by(|a, b| a.0 == b.0);
        scenes
            .flat_map(|scene| scene.iter().copied().skip(self.k - 1).step_by(self.n))
            .collect()
    }

    /// Name of the part's file.
    #[must_use]
    pub fn file_name(self) -> String {
        format!("shard-{}-of-{}.jsonl", self.k, self.n)
    }
}

impl fmt::Display for Part {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}/{}", self.k, self.n)
    }
}

impl FromStr for Part {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let part = text.split_once('/').and_then(|(k, n)| {
            let (k, n) = (k.parse().ok()?, n.parse().ok()?);
            (1 <= k && k <= n && n <= 1_000_000).then_some(Self { k, n })
        });
        part.ok_or_else(|| "must be K/N with K from 1 to N, as in 2/8".to_owned())
    }
}

/// The content of a part's file.
///
/// # Errors
/// [`Failure::Input`] if the rows cannot be serialised.
pub fn write(settings: &Settings, part: Part, rows: &[RobustRow]) -> Result<Vec<u8>, Failure> {
    let failed = |error: serde_json::Error| Failure::Input(error.to_string());
    let heading = Heading {
        robust_shard: part,
        settings: settings.clone(),
    };
    let mut text = serde_json::to_vec(&heading).map_err(failed)?;
    text.push(b'\n');
    for row in rows {
        serde_json::to_writer(&mut text, row).map_err(failed)?;
        text.push(b'\n');
    }
    Ok(text)
}

/// Merges the shards in these files, given in any order.
///
/// # Errors
/// [`Failure::Input`] that names a file that is not a shard, is incomplete, has other settings or
/// is a duplicate, or that names a missing shard.
pub fn merge(paths: &[PathBuf]) -> Result<(Settings, Vec<RobustRow>), Failure> {
    let mut settings: Option<(&Path, Settings)> = None;
    let mut parts: Vec<(&Path, Part, Vec<RobustRow>)> = Vec::new();
    for path in paths {
        let name = path.display();
        let (heading, rows) = read(path)?;
        let part = heading.robust_shard;
        match &settings {
            None => settings = Some((path, heading.settings)),
            Some((first, known)) if *known != heading.settings => {
                return Err(Failure::Input(format!(
                    "{name}: settings differ from those of {}; merge shards of one run",
                    first.display()
                )));
            }
            Some(_) => {}
        }
        for (other, known, _) in &parts {
            if known.n != part.n {
                return Err(Failure::Input(format!(
                    "{name}: shard {part}, but {} is shard {known}; merge shards of one run",
                    other.display()
                )));
            }
            if known.k == part.k {
                return Err(Failure::Input(format!(
                    "{name}: shard {part} is already given by {}; give each shard once",
                    other.display()
                )));
            }
        }
        parts.push((path, part, rows));
    }
    let (Some((_, settings)), Some((_, Part { n, .. }, _))) = (settings, parts.first()) else {
        return Err(Failure::Input(
            "no shard to merge; give the files of host-sim robust --shard".to_owned(),
        ));
    };
    let n = *n;
    if let Some(k) = (1..=n).find(|k| parts.iter().all(|(_, part, _)| part.k != *k)) {
        let missing = Part { k, n };
        return Err(Failure::Input(format!(
            "shard {missing} is missing; run host-sim robust --shard {missing} and add its {}",
            missing.file_name()
        )));
    }
    let jobs = settings.jobs()?;
    for (path, part, rows) in &parts {
        check(path, &part.of(&jobs), rows)?;
    }
    parts.sort_by_key(|(_, part, _)| part.k);
    let mut queues: Vec<_> = parts
        .into_iter()
        .map(|(_, _, rows)| rows.into_iter())
        .collect();
    let scenes = jobs.chunk_by(|a, b| a.0 == b.0);
    let turns = scenes.flat_map(|scene| (0..scene.len()).map(|i| i % n));
    let rows = turns.filter_map(|k| queues[k].next()).collect();
    Ok((settings, rows))
}

fn read(path: &Path) -> Result<(Heading, Vec<RobustRow>), Failure> {
    let name = path.display();
    let text = std::fs::read_to_string(path)
        .map_err(|error| Failure::Input(format!("{name}: cannot read: {error}")))?;
    let mut lines = text.lines();
    let heading = lines.next().unwrap_or_default();
    let heading = serde_json::from_str(heading).map_err(|error| {
        Failure::Input(format!(
            "{name}: line 1: not a shard of host-sim robust: {error}"
        ))
    })?;
    let rows = lines.enumerate().map(|(i, line)| {
        serde_json::from_str(line)
            .map_err(|error| Failure::Input(format!("{name}: line {}: {error}", i + 2)))
    });
    Ok((heading, rows.collect::<Result<_, _>>()?))
}

/// Checks that the rows are those of the jobs.
fn check(path: &Path, jobs: &[Job], rows: &[RobustRow]) -> Result<(), Failure> {
    let name = path.display();
    let is =
        |job: &Job, row: &RobustRow| row.scene == job.0.name() && row.device == job.1.to_string();
    let wrong = jobs.iter().zip(rows).position(|(job, row)| !is(job, row));
    let at = wrong.unwrap_or(jobs.len().min(rows.len()));
    match (jobs.get(at), rows.get(at)) {
        (None, None) => Ok(()),
        (Some((scene, device)), found) => Err(Failure::Input(format!(
            "{name}: line {}: scene {scene}, device {device} is missing{}; run this shard again",
            at + 2,
            found.map_or(String::new(), |row| format!(
                ", found {}, device {}",
                row.scene, row.device
            )),
        ))),
        (None, Some(row)) => Err(Failure::Input(format!(
            "{name}: line {}: scene {}, device {} is there twice or not asked for; run this shard \
             again",
            at + 2,
            row.scene,
            row.device
        ))),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::robust::tests::settings;

    #[test]
    fn every_job_is_in_exactly_one_part() {
        let jobs = settings(&["off", "wall"], 10).jobs().unwrap();
        for n in [1, 2, 3, 7, 100] {
            let mut all: Vec<Job> = (1..=n).flat_map(|k| Part { k, n }.of(&jobs)).collect();
            assert_eq!(all.len(), jobs.len());
            let place = |job: &Job| jobs.iter().position(|known| known == job).unwrap();
            all.sort_by_key(place);
            assert_eq!(all, jobs);
        }
    }

    #[test]
    fn part_is_parsed_from_its_text_and_invalid_text_is_refused() {
        let part: Part = "2/8".parse().unwrap();
        assert_eq!(
            (part, part.to_string()),
            (Part { k: 2, n: 8 }, "2/8".into())
        );
        for wrong in ["", "2", "0/3", "4/3", "1/0", "-1/3", "1/3/3", "a/b"] {
            assert!(wrong.parse::<Part>().is_err(), "{wrong}");
        }
    }
}
