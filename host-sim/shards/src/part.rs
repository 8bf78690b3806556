//! Part K of N of the jobs of an experiment.

use std::ffi::OsStr;
use std::fmt;
use std::path::PathBuf;
use std::str::FromStr;

use serde::{Deserialize, Serialize};

/// Largest number of parts.
const MOST: usize = 1_000_000;

/// Part `k` of `n`; the first part is 1.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Part {
    /// Number of the part, 1 to `n`.
    pub k: usize,
    /// Number of parts.
    pub n: usize,
}

impl Part {
    /// The jobs of this part: every `n`th one from the `k`th on.
    #[must_use]
    pub fn of<J: Clone>(self, jobs: &[J]) -> Vec<J> {
        let own = jobs.iter().skip(self.k - 1).step_by(self.n);
        own.cloned().collect()
    }

    /// Number of this part's jobs among `jobs`.
    #[must_use]
    pub fn count(self, jobs: usize) -> usize {
        (jobs + self.n - self.k) / self.n
    }

    /// Name of the part's file.
    #[must_use]
    pub fn file_name(self) -> PathBuf {
        format!("shard-{}-of-{}.jsonl", self.k, self.n).into()
    }

    /// The part whose file has this name.
    pub(crate) fn named(file: &OsStr) -> Option<Self> {
        let numbers = file.to_str()?.strip_prefix("shard-")?;
        let (k, n) = numbers.strip_suffix(".jsonl")?.split_once("-of-")?;
        format!("{k}/{n}").parse().ok()
    }

    /// Whether both numbers are in range, as those of a parsed part are.
    pub(crate) fn is_valid(self) -> bool {
        (1..=self.n).contains(&self.k) && self.n <= MOST
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
            Some(Self { k, n }).filter(|part| part.is_valid())
        });
        part.ok_or_else(|| {
            format!("must be K/N with K from 1 to N and N at most {MOST}, as in 2/8")
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_job_is_in_exactly_one_part() {
        let jobs: Vec<usize> = (0..78).collect();
        for n in [1, 2, 3, 7, 78, 100] {
            let parts: Vec<_> = (1..=n).map(|k| Part { k, n }).collect();
            let mut all: Vec<_> = parts.iter().flat_map(|part| part.of(&jobs)).collect();
            all.sort_unstable();
            assert_eq!(all, jobs, "{n}");
            for part in parts {
                assert_eq!(part.count(jobs.len()), part.of(&jobs).len(), "{part}");
            }
        }
    }

    #[test]
    fn part_is_parsed_from_its_text_and_invalid_text_is_refused() {
        let part: Part = "2/8".parse().unwrap();
        assert_eq!(
            (part, part.to_string()),
            (Part { k: 2, n: 8 }, "2/8".into())
        );
        for wrong in [
            "",
            "2",
            "0/3",
            "4/3",
            "1/0",
            "-1/3",
            "1/3/3",
            "a/b",
            "1/1000001",
        ] {
            let said = wrong.parse::<Part>().expect_err(wrong);
            assert!(said.contains("N at most 1000000"), "{said}");
        }
    }
}
