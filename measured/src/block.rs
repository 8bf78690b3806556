//! Blocks of pages that a program writes.

use std::fs;
use std::path::PathBuf;
use std::sync::{Mutex, PoisonError};

use crate::{Difference, replace, root, update};

/// A part of a page between `<!-- KIND: NAME -->` and `<!-- end of NAME -->`.
#[derive(Clone, Copy, Debug)]
pub struct Block {
    /// What the block is made from: `measured` or `catalogue`.
    pub kind: &'static str,
    /// Its name.
    pub name: &'static str,
    /// The page, from the top of the repository.
    pub page: &'static str,
}

/// Tests run side by side, and several write the same page.
static WRITING: Mutex<()> = Mutex::new(());

/// A Markdown table.
#[must_use]
pub fn markdown(head: &[&str], rows: &[Vec<String>]) -> String {
    let line = |cells: String| format!("| {cells} |\n");
    let rule = format!("|{}\n", "---|".repeat(head.len()));
    let rows = rows.iter().map(|row| line(row.join(" | ")));
    [line(head.join(" | ")), rule]
        .into_iter()
        .chain(rows)
        .collect()
}

impl Block {
    fn path(&self) -> PathBuf {
        root().join(self.page)
    }

    fn wrong(&self, what: impl std::fmt::Display) -> Difference {
        format!("{}: {what}", self.page)
    }

    /// The page before the block's content, the content, and the page after it.
    fn parts(&self, page: &str) -> Result<[String; 3], Difference> {
        let begin = format!("<!-- {}: {} -->", self.kind, self.name);
        let end = format!("<!-- end of {} -->", self.name);
        let missing = |comment: &str| self.wrong(format!("no '{comment}'"));
        let (before, rest) = page.split_once(&begin).ok_or_else(|| missing(&begin))?;
        let (content, after) = rest.split_once(&end).ok_or_else(|| missing(&end))?;
        Ok([
            format!("{before}{begin}"),
            content.to_owned(),
            format!("{end}{after}"),
        ])
    }

    fn text(&self) -> Result<String, Difference> {
        fs::read_to_string(self.path()).map_err(|error| self.wrong(error))
    }

    /// The content.
    ///
    /// # Errors
    /// One line that names the page if it cannot be read or has no such block.
    pub fn read(&self) -> Result<String, Difference> {
        let [_, content, _] = self.parts(&self.text()?)?;
        Ok(content)
    }

    /// Replaces the content.
    ///
    /// # Errors
    /// One line that names the page if it cannot be read or written, or has no such block.
    pub fn write(&self, content: &str) -> Result<(), Difference> {
        let _guard = WRITING.lock().unwrap_or_else(PoisonError::into_inner);
        let [before, _, after] = self.parts(&self.text()?)?;
        let text = format!("{before}\n\n{}\n\n{after}", content.trim());
        replace(&self.path(), text.as_bytes()).map_err(|error| self.wrong(error))
    }

    /// Writes the content with `UPDATE_GOLDEN=1`, and compares otherwise.
    ///
    /// # Errors
    /// One line that names the page and the block.
    pub fn check(&self, content: &str) -> Result<(), Difference> {
        if update() {
            return self.write(content);
        }
        match self.read()?.trim() == content.trim() {
            true => Ok(()),
            false => Err(self.wrong(format!(
                "the block '{}' is not what the {} gives; the same test with UPDATE_GOLDEN=1 \
                 writes it",
                self.name, self.kind
            ))),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const BLOCK: Block = Block {
        kind: "measured",
        name: "x",
        page: "NAME.md",
    };

    #[test]
    fn table_has_a_line_for_each_row() {
        let cells = |cells: [&str; 2]| cells.map(str::to_owned).to_vec();
        assert_eq!(
            markdown(&["a", "b"], &[cells(["1", ""]), cells(["2", "3"])]),
            "| a | b |\n|---|---|\n| 1 |  |\n| 2 | 3 |\n"
        );
    }

    #[test]
    fn block_without_its_comments_is_refused_by_name() {
        let error = BLOCK.parts("<!-- measured: x -->").unwrap_err();
        assert_eq!(error, "NAME.md: no '<!-- end of x -->'");
        let text = "a <!-- measured: x -->b<!-- end of x --> c";
        let [before, content, after] = BLOCK.parts(text).unwrap();
        assert_eq!([&*before, &*content, &*after].concat(), text);
    }
}
