//! Checks the links of the Markdown pages of a repository.
//!
//! The rules are those of a forge and of mdBook at once: a page of `docs/` reads on a forge and as a
//! chapter of the book.

mod page;
mod sources;

pub use page::{Link, Page, anchor};

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Component, Path, PathBuf};
use std::{fs, io};

/// The pages of a repository by their path in it, and every other file.
#[derive(Debug)]
pub struct Repository {
    pages: BTreeMap<PathBuf, Page>,
    files: BTreeMap<PathBuf, bool>,
    texts: BTreeMap<PathBuf, String>,
}

/// Table of contents of the book.
const SUMMARY: &str = "docs/SUMMARY.md";

/// The page that every other page is reached from.
const FIRST: &str = "README.md";

/// Folders whose content is made by a program.
const MADE: [&str; 2] = ["target", "book"];

/// Hidden folders that belong to the repository.
const HIDDEN: [&str; 3] = [".cargo", ".ci", ".github"];

/// Extensions of files that may name a page of `docs/` in a comment or a text.
const SOURCES: [&str; 4] = ["rs", "toml", "yml", "md"];

impl Repository {
    /// Reads the repository at `root`.
    ///
    /// # Errors
    /// A file that cannot be read.
    pub fn read(root: &Path) -> io::Result<Self> {
        let mut repository = Self {
            pages: BTreeMap::new(),
            files: BTreeMap::from([(PathBuf::new(), true)]),
            texts: BTreeMap::new(),
        };
        repository.walk(root, Path::new(""))?;
        Ok(repository)
    }

    fn walk(&mut self, root: &Path, folder: &Path) -> io::Result<()> {
        for entry in fs::read_dir(root.join(folder))? {
            let entry = entry?;
            let name = entry.file_name();
            let name = name.to_string_lossy();
            let path = folder.join(&*name);
            let is_folder = entry.file_type()?.is_dir();
            let is_hidden = name.starts_with('.') && !HIDDEN.contains(&&*name);
            if is_folder && (is_hidden || MADE.contains(&&*name)) {
                continue;
            }
            if is_folder {
                self.walk(root, &path)?;
            } else if has_extension(&path, &SOURCES) {
                let text = fs::read_to_string(root.join(&path))?;
                if has_extension(&path, &["md"]) {
                    self.pages.insert(path.clone(), Page::parse(&text));
                }
                self.texts.insert(path.clone(), text);
            }
            self.files.insert(path, is_folder);
        }
        Ok(())
    }

    /// Every fault, as `file:line: what is wrong`, in order of files.
    #[must_use]
    pub fn faults(&self) -> Vec<String> {
        let mut faults = Vec::new();
        for (path, page) in &self.pages {
            for link in &page.links {
                if let Err(fault) = self.target(path, link) {
                    faults.push(format!("{}:{}: {fault}", path.display(), link.line));
                }
            }
        }
        faults.extend(self.contents_faults());
        faults.extend(self.unreachable());
        faults.extend(self.stale_names());
        faults
    }

    /// The page that a link leads to, if it leads to a page of this repository.
    fn target(&self, from: &Path, link: &Link) -> Result<Option<PathBuf>, String> {
        let (file, fragment) = match link.target.split_once('#') {
            Some((file, fragment)) => (file, Some(fragment)),
            None => (link.target.as_str(), None),
        };
        if file.is_empty() && fragment.is_none() {
            return if from == Path::new(SUMMARY) {
                Ok(None) // A chapter that only groups others.
            } else {
                Err("link without a target".to_owned())
            };
        }
        if file.contains("://") || file.starts_with("mailto:") {
            return Ok(None);
        }
        let path = if file.is_empty() {
            from.to_owned()
        } else {
            resolved(from, file).ok_or_else(|| format!("{file} leaves the repository"))?
        };
        let is_folder = *(self.files.get(&path)).ok_or_else(|| format!("no file {file}"))?;
        let in_docs = from.starts_with("docs");
        if in_docs && (is_folder || has_extension(&path, &["md"]) && !path.starts_with("docs")) {
            return Err(format!(
                "{file}: no page of the book; name it without a link"
            ));
        }
        let path = if is_folder { path.join(FIRST) } else { path };
        let page = self.pages.get(&path);
        if let Some(fragment) = fragment {
            let page = page.ok_or_else(|| format!("{file} has no headings"))?;
            if !page.anchors.contains(fragment) {
                return Err(format!("no heading #{fragment} in {}", path.display()));
            }
        }
        Ok(page.map(|_| path))
    }

    /// Pages of the book that the table of contents lacks or has twice.
    fn contents_faults(&self) -> Vec<String> {
        let Some(summary) = self.pages.get(Path::new(SUMMARY)) else {
            return vec![format!("no {SUMMARY}")];
        };
        let mut listed = BTreeSet::new();
        let mut faults = Vec::new();
        for link in &summary.links {
            if let Ok(Some(path)) = self.target(Path::new(SUMMARY), link)
                && !listed.insert(path)
            {
                faults.push(format!("{SUMMARY}:{}: {} twice", link.line, link.target));
            }
        }
        for path in self.pages.keys() {
            let is_chapter = path.starts_with("docs") && path != Path::new(SUMMARY);
            if is_chapter && !listed.contains(path) {
                faults.push(format!("{SUMMARY}: {} is missing", path.display()));
            }
        }
        faults
    }

    /// Pages that no chain of links reaches from the first one. The table of contents does not count,
    /// and changelogs are found by their name.
    fn unreachable(&self) -> Vec<String> {
        let mut reached = BTreeSet::from([PathBuf::from(FIRST)]);
        let mut waiting = vec![PathBuf::from(FIRST)];
        while let Some(path) = waiting.pop() {
            let Some(page) = self.pages.get(&path) else {
                continue;
            };
            for link in &page.links {
                if let Ok(Some(next)) = self.target(&path, link)
                    && reached.insert(next.clone())
                {
                    waiting.push(next);
                }
            }
        }
        let is_known = |path: &Path| path == Path::new(SUMMARY) || path.ends_with("CHANGELOG.md");
        let is_orphan = |path: &&PathBuf| !is_known(path) && !reached.contains(*path);
        (self.pages.keys().filter(is_orphan))
            .map(|path| format!("{}: no link leads here from {FIRST}", path.display()))
            .collect()
    }

    /// Files that a source or a page names and that are not there.
    fn stale_names(&self) -> Vec<String> {
        let mut faults = Vec::new();
        for (path, text) in &self.texts {
            for (line, name) in sources::names(path, text) {
                if !self.files.contains_key(Path::new(name)) && self.is_ours(name) {
                    faults.push(format!("{}:{line}: no file {name}", path.display()));
                }
            }
        }
        faults
    }

    /// Whether the first folder of a path is one of this repository.
    fn is_ours(&self, name: &str) -> bool {
        let first = name.split('/').next().unwrap_or_default();
        self.files
            .get(Path::new(first))
            .is_some_and(|folder| *folder)
    }
}

fn has_extension(path: &Path, extensions: &[&str]) -> bool {
    let extension = path.extension().and_then(|extension| extension.to_str());
    extension.is_some_and(|extension| extensions.contains(&extension))
}

/// The path in the repository of a target written in the page `from`.
fn resolved(from: &Path, target: &str) -> Option<PathBuf> {
    let mut path = from.parent()?.to_owned();
    for part in Path::new(target).components() {
        match part {
            Component::Normal(name) => path.push(name),
            Component::CurDir => {}
            Component::ParentDir => {
                if !path.pop() {
                    return None;
                }
            }
            Component::RootDir | Component::Prefix(_) => return None,
        }
    }
    Some(path)
}
