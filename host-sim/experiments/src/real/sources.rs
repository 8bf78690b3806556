//! The list of a folder's recordings: `recordings.toml`.

use std::collections::BTreeSet;
use std::path::Path;

use serde::{Deserialize, Serialize};
use simulation::device::{COUNTS_PER_REV, counts_per_rev_rule};
use terminal::failure::Failure;

/// The list of a folder.
pub const LIST: &str = "recordings.toml";

/// What a recording was made with.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Kind {
    /// A fine encoder: the recording is coarsened.
    Fine,
    /// A coarse encoder with a reference: the recording runs as it is.
    Coarse,
}

/// What a recording is used for.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Role {
    /// Constants and parameters of estimators were chosen with it.
    Chooses,
    /// No constant was chosen with it.
    #[default]
    Judges,
}

/// One recording of the list.
#[derive(Clone, Debug, PartialEq, Eq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Source {
    /// Name of the file in the folder of the list.
    pub file: String,
    /// Device and motion, in a few words.
    pub what: String,
    /// Fine or coarse.
    pub kind: Kind,
    /// Counts per revolution of the recorded encoder.
    pub counts_per_rev: u32,
    /// Whether constants were chosen with it.
    #[serde(default)]
    pub role: Role,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct List {
    recording: Vec<Source>,
}

impl Source {
    /// Name of the recording: that of its file without the endings.
    #[must_use]
    pub fn name(&self) -> &str {
        let name = self.file.strip_suffix(".gz").unwrap_or(&self.file);
        name.strip_suffix(".csv").unwrap_or(name)
    }

    /// The entry of the file `path` in the list beside it; `None` without a list or an entry.
    ///
    /// # Errors
    /// As [`read`].
    pub fn of(path: &Path) -> Result<Option<Self>, Failure> {
        let folder = path.parent().unwrap_or(Path::new(""));
        if !folder.join(LIST).is_file() {
            return Ok(None);
        }
        let entries = read(folder)?;
        Ok(entries
            .into_iter()
            .find(|source| Some(source.file.as_ref()) == path.file_name()))
    }
}

/// The recordings of `folder`, in the order of its list.
///
/// # Errors
/// [`Failure::Input`] that names the list and its wrong line, or a file that is missing.
pub fn read(folder: &Path) -> Result<Vec<Source>, Failure> {
    let path = folder.join(LIST);
    let name = path.display();
    let text = std::fs::read_to_string(&path).map_err(|error| {
        Failure::Input(format!(
            "{name}: cannot read: {error}; the folder of the recordings needs this list, see \
             docs/real-motion.md"
        ))
    })?;
    let list: List = toml::from_str(&text).map_err(|error| {
        let start = error.span().map_or(0, |span| span.start);
        let line = 1 + text[..start].matches('\n').count();
        Failure::Input(format!("{name}: line {line}: {}", error.message()))
    })?;
    let mut names = BTreeSet::new();
    for source in &list.recording {
        let file = &source.file;
        if !names.insert(source.name()) {
            return Err(Failure::Input(format!(
                "{name}: two recordings {}",
                source.name()
            )));
        }
        if !COUNTS_PER_REV.contains(&source.counts_per_rev) {
            return Err(Failure::Input(format!(
                "{name}: {file}: counts_per_rev = {}: must be {}",
                source.counts_per_rev,
                counts_per_rev_rule(Some(source.counts_per_rev.into()))
            )));
        }
        if !folder.join(file).is_file() {
            return Err(Failure::Input(format!(
                "{name}: {file}: there is no such file"
            )));
        }
    }
    if list.recording.is_empty() {
        return Err(Failure::Input(format!("{name}: no recording")));
    }
    Ok(list.recording)
}

#[cfg(test)]
mod tests {
    use tempfile::TempDir;

    use super::*;

    /// A folder with this list and one file `a.csv`.
    fn folder(list: &str) -> TempDir {
        let folder = tempfile::tempdir().unwrap();
        std::fs::write(folder.path().join("a.csv"), "").unwrap();
        std::fs::write(folder.path().join(LIST), list).unwrap();
        folder
    }

    fn entry(more: &str) -> String {
        format!("[[recording]]\nfile = 'a.csv'\nwhat = 'x'\nkind = 'fine'\n{more}\n")
    }

    #[test]
    fn recording_without_a_role_judges() {
        let folder = folder(&entry("counts_per_rev = 3000"));
        let path = folder.path();
        let sources = read(path).unwrap();
        assert_eq!((sources[0].role, sources[0].name()), (Role::Judges, "a"));
        assert_eq!(
            Source::of(&path.join("a.csv")).unwrap(),
            Some(sources[0].clone())
        );
        assert_eq!(Source::of(&path.join("b.csv")).unwrap(), None);
    }

    #[test]
    fn invalid_list_is_reported_with_its_place() {
        for (list, said) in [
            (
                entry(""),
                "recordings.toml: line 1: missing field `counts_per_rev`",
            ),
            (
                entry("counts_per_rev = 3"),
                "a.csv: counts_per_rev = 3: must be from 16",
            ),
            (
                entry("counts_per_rev = 30\nrole = 'both'"),
                "line 6: unknown variant `both`",
            ),
            (entry("counts_per_rev = 30").repeat(2), "two recordings a"),
            (
                entry("counts_per_rev = 30").replace("a.csv", "b.csv"),
                "b.csv: there is no such file",
            ),
            ("recording = []".to_owned(), "recordings.toml: no recording"),
        ] {
            let folder = folder(&list);
            let path = folder.path();
            let error = read(path).unwrap_err().to_string();
            assert!(error.contains(said), "{error}");
        }
    }
}
