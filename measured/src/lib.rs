//! Measured tables. The data of a table is the file `measured/NAME.csv`, which the command that
//! measures writes. A page shows it as a block between two comments:
//!
//! ```text
//! <!-- measured: NAME -->
//! ...
//! <!-- end of NAME -->
//! ```
//!
//! [`tables`] lists the tables with their pages, headings and commands. With `UPDATE_GOLDEN=1` in the
//! environment, [`Table::check`] writes file and block. Otherwise it compares the file with the new
//! measurement, within the tolerance of the caller. A test of this package compares every block of
//! every page with what its file gives, to the letter. No program reads a figure out of a page.
//!
//! | module | content |
//! |---|---|
//! | [`tables`] | the list of the tables |
//! | [`block`] | blocks of pages, Markdown |
//! | [`control_rate`] | the control rate that an image allows |
//! | [`digits`] | figures with so many significant digits |

pub mod block;
pub mod control_rate;
pub mod digits;
mod row;
pub mod tables;

use std::fs;
use std::path::{Path, PathBuf};

pub use row::Row;

use block::Block;

/// A column: its name in the CSV file, with the unit, and its heading on the page.
pub type Column = (&'static str, &'static str);

/// A measured table.
#[derive(Clone, Copy, Debug)]
pub struct Table {
    /// Name of the CSV file and of the block.
    pub name: &'static str,
    /// The page that shows it, from the top of the repository.
    pub page: &'static str,
    /// The first columns, of which the first one names the row. The file may have more, which the
    /// command adds and which the page heads by their names.
    pub columns: &'static [Column],
    /// Significant digits of a number on the page; the text of the file if there is none.
    pub digits: Option<usize>,
    /// The command that measures it, a line of `.ci/measure`.
    pub command: &'static str,
}

/// What differs between a file, a measurement and a page, or what cannot be read or written: one line
/// for each.
pub type Difference = String;

/// Whether `UPDATE_GOLDEN=1` asks for new files.
#[must_use]
pub fn update() -> bool {
    std::env::var_os("UPDATE_GOLDEN").is_some_and(|value| value == "1")
}

/// The top of the repository.
pub(crate) fn root() -> &'static Path {
    Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/.."))
}

/// Replaces a file as a whole: a reader beside it sees the old or the new content.
pub(crate) fn replace(path: &Path, content: &[u8]) -> std::io::Result<()> {
    let new = path.with_extension("new");
    fs::write(&new, content)?;
    fs::rename(new, path)
}

impl Table {
    fn path(&self) -> PathBuf {
        root().join(format!("measured/{}.csv", self.name))
    }

    fn wrong(&self, what: impl std::fmt::Display) -> Difference {
        format!("measured/{}.csv: {what}", self.name)
    }

    fn block(&self) -> Block {
        Block {
            kind: "measured",
            name: self.name,
            page: self.page,
        }
    }

    /// Names of all columns: those of the table, then `more`.
    fn names<'a>(&self, more: &[&'a str]) -> Vec<&'a str> {
        let own = self.columns.iter().map(|(name, _)| *name);
        own.chain(more.iter().copied()).collect()
    }

    /// The rows of the file.
    ///
    /// # Errors
    /// One line that names the file if it cannot be read or does not begin with the table's columns.
    pub fn read(&self) -> Result<Vec<Row>, Difference> {
        let mut reader = csv::Reader::from_path(self.path()).map_err(|error| self.wrong(error))?;
        let head = reader.headers().map_err(|error| self.wrong(error))?.clone();
        let own = head.iter().take(self.columns.len());
        if !own.eq(self.names(&[])) {
            return Err(self.wrong("other columns than those of its command"));
        }
        let row = |cells: csv::StringRecord| {
            let named = head.iter().zip(&cells);
            Row::new(
                self.name,
                named.map(|(name, cell)| (name.into(), cell.into())),
            )
        };
        let rows = reader.records().map(|cells| cells.map(row));
        rows.collect::<Result<_, _>>()
            .map_err(|error| self.wrong(error))
    }

    /// What a page shows of these rows. `more` names the columns after those of the table.
    #[must_use]
    pub fn markdown(&self, more: &[&str], rows: &[Vec<String>]) -> String {
        let headings = self.columns.iter().map(|(_, heading)| *heading);
        let head: Vec<_> = headings.chain(more.iter().copied()).collect();
        let shown = |cell: &String| match self.digits {
            Some(digits) => digits::shown(cell, digits),
            None => cell.clone(),
        };
        let rows = rows.iter().map(|row| row.iter().map(shown).collect());
        block::markdown(&head, &rows.collect::<Vec<_>>())
    }

    /// What the page has to show: the content of the file.
    fn content(&self) -> Result<String, Difference> {
        let rows = self.read()?;
        let names = rows.first().map(Row::names).into_iter().flatten();
        let more: Vec<_> = names.skip(self.columns.len()).collect();
        let cells = |row: &Row| row.cells().map(str::to_owned).collect();
        let cells: Vec<_> = rows.iter().map(cells).collect();
        Ok(self.markdown(&more, &cells))
    }

    /// Writes file and page. `more` names the columns after those of the table.
    ///
    /// # Errors
    /// One line that names what cannot be written.
    pub fn write(&self, more: &[&str], rows: &[Vec<String>]) -> Result<(), Difference> {
        let mut writer = csv::Writer::from_writer(Vec::new());
        let mut put = |cells: &mut dyn Iterator<Item = &str>| {
            let written = writer.write_record(cells);
            written.map_err(|error| self.wrong(error))
        };
        put(&mut self.names(more).into_iter())?;
        for row in rows {
            put(&mut row.iter().map(String::as_str))?;
        }
        let bytes = writer.into_inner().map_err(|error| self.wrong(error))?;
        replace(&self.path(), &bytes).map_err(|error| self.wrong(error))?;
        self.block().write(&self.content()?)
    }

    /// Rows of the measurement that differ from the file. `same` takes the name of a column, the
    /// number in the file and the measured one. Text has to be equal, and rows are compared in their
    /// order.
    ///
    /// # Errors
    /// One line if the file cannot be read, or has other columns or another number of rows.
    pub fn moved(
        &self,
        more: &[&str],
        rows: &[Vec<String>],
        same: impl Fn(&str, f64, f64) -> bool,
    ) -> Result<Vec<Difference>, Difference> {
        let file = self.read()?;
        if file.len() != rows.len() {
            let (then, now) = (file.len(), rows.len());
            return Err(self.wrong(format!("{then} rows, {now} measured")));
        }
        let names = self.names(more);
        let mut moved = Vec::new();
        for (then, now) in file.iter().zip(rows) {
            if !then.names().eq(names.iter().copied()) || names.len() != now.len() {
                return Err(self.wrong("other columns than those measured"));
            }
            let cells = names.iter().zip(then.cells()).zip(now);
            let cells = cells.filter(|((name, then), now)| {
                match (then.parse::<f64>(), now.parse::<f64>()) {
                    (Ok(then), Ok(now)) => !same(name, then, now),
                    _ => then != now,
                }
            });
            let cells = cells.map(|((name, then), now)| format!("{name} {then} became {now}"));
            let cells: Vec<_> = cells.collect();
            if !cells.is_empty() {
                moved.push(format!("{}: {}", now[0], cells.join(", ")));
            }
        }
        Ok(moved)
    }

    /// Writes file and page with `UPDATE_GOLDEN=1`, and compares otherwise, as [`Table::moved`].
    ///
    /// # Errors
    /// What differs, and the command that writes the table anew.
    pub fn check(
        &self,
        more: &[&str],
        rows: &[Vec<String>],
        same: impl Fn(&str, f64, f64) -> bool,
    ) -> Result<(), Difference> {
        if update() {
            return self.write(more, rows);
        }
        let anew = format!(
            "if that is meant, UPDATE_GOLDEN=1 {} writes it anew",
            self.command
        );
        let moved = self.moved(more, rows, same);
        match moved.map_err(|error| format!("{error}; {anew}"))? {
            moved if moved.is_empty() => Ok(()),
            moved => Err(self.wrong(format!("\n{}\n{anew}", moved.join("\n")))),
        }
    }

    /// Writes the block of the page from the file with `UPDATE_GOLDEN=1`, and compares it otherwise.
    ///
    /// # Errors
    /// One line that names the page and says what writes the block.
    pub fn check_page(&self) -> Result<(), Difference> {
        if update() {
            return self.block().write(&self.content()?);
        }
        if self.block().read()?.trim() == self.content()?.trim() {
            return Ok(());
        }
        Err(format!(
            "{}: the block is not measured/{}.csv; UPDATE_GOLDEN=1 {} writes both",
            self.page, self.name, self.command
        ))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const TABLE: Table = Table {
        name: "x",
        page: "NAME.md",
        columns: &[("name", "name"), ("mean_3", "mean, `3`")],
        digits: Some(2),
        command: "cargo x",
    };

    #[test]
    fn markdown_has_headings_digits_and_further_columns() {
        let rows = [["a, n = 1", "2.5499", "0"].map(str::to_owned).to_vec()];
        assert_eq!(
            TABLE.markdown(&["hold"], &rows),
            "| name | mean, `3` | hold |\n|---|---|---|\n| a, n = 1 | 2.5 | 0 |\n"
        );
    }
}
