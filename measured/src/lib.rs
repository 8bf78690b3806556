//! Measured tables. The data of a table is the file `measured/NAME.csv`. A page of docs/ shows it
//! between two comments:
//!
//! ```text
//! <!-- measured: NAME -->
//! ...
//! <!-- end of NAME -->
//! ```
//!
//! With `UPDATE_GOLDEN=1` in the environment, [`Table::check`] writes both. Otherwise it compares: the
//! file with what was measured now, within a slack, and the page with the file, to the letter. No
//! program reads a table out of a page.

use std::fs;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};

/// A column: its name in the CSV file and its heading on the page.
pub type Column = (&'static str, &'static str);

/// A measured table.
#[derive(Clone, Copy, Debug)]
pub struct Table {
    /// Name of the CSV file and of the block.
    pub name: &'static str,
    /// The page below docs/ that shows it.
    pub page: &'static str,
    /// Its columns; the first one names the row.
    pub columns: &'static [Column],
    /// The command that measures it.
    pub command: &'static str,
}

/// The file of a table could not be read, or a measurement is not what the file says.
pub type Difference = String;

/// Tests run side by side, and several write the same page.
static WRITING: Mutex<()> = Mutex::new(());

/// Whether `UPDATE_GOLDEN=1` asks for new files.
#[must_use]
pub fn update() -> bool {
    std::env::var_os("UPDATE_GOLDEN").is_some_and(|value| value == "1")
}

fn root() -> &'static Path {
    Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/.."))
}

impl Table {
    fn file(&self) -> PathBuf {
        root()
            .join("measured")
            .join(self.name)
            .with_extension("csv")
    }

    fn page(&self) -> PathBuf {
        root().join("docs").join(self.page)
    }

    /// The cells of the file, row by row.
    ///
    /// # Errors
    /// One line that names the file if it cannot be read or has other columns.
    pub fn read(&self) -> Result<Vec<Vec<String>>, Difference> {
        let wrong = |what: &dyn std::fmt::Display| format!("measured/{}.csv: {what}", self.name);
        let mut reader = csv::Reader::from_path(self.file()).map_err(|error| wrong(&error))?;
        let head = reader.headers().map_err(|error| wrong(&error))?;
        if !head.iter().eq(self.columns.iter().map(|(name, _)| *name)) {
            return Err(wrong(&"other columns than those of its command"));
        }
        let cells = |row: csv::StringRecord| row.iter().map(str::to_owned).collect();
        let rows = reader.records().map(|row| row.map(cells));
        rows.collect::<Result<_, _>>()
            .map_err(|error| wrong(&error))
    }

    /// The rows as a Markdown table.
    #[must_use]
    pub fn markdown(&self, rows: &[Vec<String>]) -> String {
        let line = |cells: Vec<&str>| format!("| {} |\n", cells.join(" | "));
        let mut table = line(self.columns.iter().map(|(_, heading)| *heading).collect());
        table += &format!("|{}\n", "---|".repeat(self.columns.len()));
        for row in rows {
            table += &line(row.iter().map(String::as_str).collect());
        }
        table
    }

    fn parts(&self, page: &str) -> Result<[String; 3], Difference> {
        let begin = format!("<!-- measured: {} -->", self.name);
        let end = format!("<!-- end of {} -->", self.name);
        let missing = |comment: &str| format!("docs/{}: no '{comment}'", self.page);
        let (before, rest) = page.split_once(&begin).ok_or_else(|| missing(&begin))?;
        let (block, after) = rest.split_once(&end).ok_or_else(|| missing(&end))?;
        Ok([
            format!("{before}{begin}"),
            block.to_owned(),
            format!("{end}{after}"),
        ])
    }

    /// Writes file and page.
    ///
    /// # Errors
    /// One line that names what cannot be written.
    pub fn write(&self, rows: &[Vec<String>]) -> Result<(), Difference> {
        let _guard = WRITING.lock().unwrap_or_else(PoisonError::into_inner);
        let io =
            |path: &Path, error: &dyn std::fmt::Display| format!("{}: {error}", path.display());
        let file = self.file();
        let mut writer = csv::Writer::from_path(&file).map_err(|error| io(&file, &error))?;
        let head = self.columns.iter().map(|(name, _)| *name);
        writer
            .write_record(head)
            .map_err(|error| io(&file, &error))?;
        for row in rows {
            writer
                .write_record(row)
                .map_err(|error| io(&file, &error))?;
        }
        writer.flush().map_err(|error| io(&file, &error))?;
        let page = self.page();
        let text = fs::read_to_string(&page).map_err(|error| io(&page, &error))?;
        let [before, _, after] = self.parts(&text)?;
        let text = format!("{before}\n\n{}\n{after}", self.markdown(rows));
        fs::write(&page, text).map_err(|error| io(&page, &error))
    }

    /// Rows of `measured` that differ from the file: text to the letter, numbers by more than
    /// `slack`, which takes the name of a column and the number in the file. Rows are compared in
    /// their order.
    ///
    /// # Errors
    /// One line if the file cannot be read or has another number of rows.
    pub fn moved(
        &self,
        measured: &[Vec<String>],
        slack: impl Fn(&str, f64) -> f64,
    ) -> Result<Vec<String>, Difference> {
        let file = self.read()?;
        if file.len() != measured.len() {
            let (then, now) = (file.len(), measured.len());
            return Err(format!(
                "measured/{}.csv: {then} rows, {now} measured",
                self.name
            ));
        }
        let same = |((then, now), (name, _)): ((&String, &String), &Column)| match (
            then.parse::<f64>(),
            now.parse::<f64>(),
        ) {
            (Ok(then), Ok(now)) => (then - now).abs() <= slack(name, then),
            _ => then == now,
        };
        let rows = file.iter().zip(measured);
        let moved = rows.filter(|(then, now)| !then.iter().zip(*now).zip(self.columns).all(same));
        Ok(moved
            .map(|(then, now)| format!("{}\nbecame {}", then.join(", "), now.join(", ")))
            .collect())
    }

    /// Writes file and page with `UPDATE_GOLDEN=1`; compares otherwise, as [`Table::moved`], and the
    /// page with the file.
    ///
    /// # Errors
    /// What differs, and the command that writes the table anew.
    pub fn check(
        &self,
        measured: &[Vec<String>],
        slack: impl Fn(&str, f64) -> f64,
    ) -> Result<(), Difference> {
        if update() {
            return self.write(measured);
        }
        let moved = self.moved(measured, slack)?;
        let anew = format!(
            "if that is meant, UPDATE_GOLDEN=1 {} writes it anew",
            self.command
        );
        if !moved.is_empty() {
            return Err(format!(
                "measured/{}.csv\n{}\n{anew}",
                self.name,
                moved.join("\n")
            ));
        }
        let page =
            fs::read_to_string(self.page()).map_err(|error| format!("{}: {error}", self.page))?;
        let [_, block, _] = self.parts(&page)?;
        match block.trim() == self.markdown(&self.read()?).trim() {
            true => Ok(()),
            false => Err(format!(
                "docs/{} is not measured/{}.csv; {anew}",
                self.page, self.name
            )),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const TABLE: Table = Table {
        name: "x",
        page: "NAME.md",
        columns: &[("name", "name"), ("mean_3", "mean, `3`")],
        command: "cargo x",
    };

    #[test]
    fn markdown_has_headings_and_rows() {
        let rows = [vec!["a, n = 1".to_owned(), "2.5".to_owned()]];
        assert_eq!(
            TABLE.markdown(&rows),
            "| name | mean, `3` |\n|---|---|\n| a, n = 1 | 2.5 |\n"
        );
    }

    #[test]
    fn block_without_its_comments_is_refused_by_name() {
        let error = TABLE.parts("<!-- measured: x -->").unwrap_err();
        assert_eq!(error, "docs/NAME.md: no '<!-- end of x -->'");
        let text = "a <!-- measured: x -->b<!-- end of x --> c";
        let [before, block, after] = TABLE.parts(text).unwrap();
        assert_eq!([&*before, &*block, &*after].concat(), text);
    }
}
