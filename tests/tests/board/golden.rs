//! Tables in docs/ that the tests write when told to, and compare with otherwise.
//!
//! `UPDATE_GOLDEN=1 cargo test --release --package acceptance --test board` writes all of them.

use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};

/// Whether to write instead of to compare.
pub(crate) fn update() -> bool {
    std::env::var_os("UPDATE_GOLDEN").is_some_and(|value| value == "1")
}

/// A table between two comments in a file of docs/.
pub(crate) struct Golden {
    pub(crate) file: &'static str,
    /// Name in the comments.
    pub(crate) name: &'static str,
}

/// Tests run side by side, and several write the same file.
static WRITING: Mutex<()> = Mutex::new(());

impl Golden {
    fn path(&self) -> PathBuf {
        Path::new(env!("CARGO_MANIFEST_DIR"))
            .join("../docs")
            .join(self.file)
    }

    fn parts(&self) -> [String; 3] {
        let text = std::fs::read_to_string(self.path()).expect(self.file);
        let begin = format!("<!-- {}: written by the tests of board -->", self.name);
        let end = format!("<!-- end of {} -->", self.name);
        let (before, rest) = text.split_once(&begin).expect("the table's beginning");
        let (table, after) = rest.split_once(&end).expect("the table's end");
        [
            format!("{before}{begin}"),
            table.to_owned(),
            format!("{end}{after}"),
        ]
    }

    /// Writes the table, or compares its figures with `rows`: `slack` says of a row and a column
    /// how far a figure may be from what is written.
    pub(crate) fn check(
        &self,
        head: &[&str],
        rows: &[Vec<String>],
        slack: impl Fn(usize, f64) -> f64,
    ) {
        if update() {
            let _guard = WRITING.lock().unwrap_or_else(PoisonError::into_inner);
            let [before, _, after] = self.parts();
            let line = |cells: &[String]| format!("| {} |\n", cells.join(" | "));
            let head: Vec<_> = head.iter().map(ToString::to_string).collect();
            let mut table = line(&head) + &"|---".repeat(head.len()) + "|\n";
            for row in rows {
                table += &line(row);
            }
            let text = format!("{before}\n\n{table}\n{after}");
            std::fs::write(self.path(), text).expect("docs can be written");
            return;
        }
        let [_, table, _] = self.parts();
        let cells = |row: &str| -> Vec<String> {
            let cells = row.trim_matches('|').split('|');
            cells.map(|cell| cell.trim().to_owned()).collect()
        };
        let written: Vec<_> = table.trim().lines().map(cells).collect();
        assert_eq!(
            written.len(),
            rows.len() + 2,
            "rows of {}: {AGAIN}",
            self.name
        );
        assert_eq!(written[0], head, "head of {}", self.name);
        let mut moved = Vec::new();
        for (golden, now) in written[2..].iter().zip(rows) {
            assert_eq!(golden.len(), now.len(), "{golden:?}");
            for (column, (golden_cell, cell)) in golden.iter().zip(now).enumerate() {
                let same = match (golden_cell.parse::<f64>(), cell.parse::<f64>()) {
                    (Ok(golden), Ok(cell)) => (cell - golden).abs() <= slack(column, golden),
                    _ => golden_cell == cell,
                };
                if !same {
                    let what = head[column];
                    moved.push(format!("{}, {what}: {golden_cell} became {cell}", now[0]));
                }
            }
        }
        assert!(moved.is_empty(), "{moved:#?}\n{AGAIN}");
    }

    /// Puts two figures into the last cells of the rows that begin with these names, leaving the
    /// rest of a table that others write, or compares them within `slack`.
    pub(crate) fn check_last(
        &self,
        begin: &str,
        end: &str,
        figures: &[(&str, [u64; 2])],
        slack: f64,
    ) {
        let path = self.path();
        let _guard = WRITING.lock().unwrap_or_else(PoisonError::into_inner);
        let text = std::fs::read_to_string(&path).expect(self.file);
        let (before, rest) = text.split_once(begin).expect("the table's beginning");
        let (table, after) = rest.split_once(end).expect("the table's end");
        let mut moved = Vec::new();
        let mut seen = 0;
        let mut lines = Vec::new();
        for line in table.lines() {
            let cells: Vec<_> = line.trim_matches('|').split('|').map(str::trim).collect();
            let found = figures.iter().find(|(name, _)| *name == cells[0]);
            let (Some((name, figures)), [rest @ .., mean, most]) = (found, &cells[..]) else {
                let is_head = lines.len() < 4;
                assert!(is_head || line.is_empty(), "nobody measures '{line}'");
                lines.push(line.to_owned());
                continue;
            };
            seen += 1;
            for (golden, now) in [mean, most].into_iter().zip(figures) {
                let near = |golden: f64| (*now as f64 - golden).abs() <= slack * golden;
                if !golden.parse().is_ok_and(near) {
                    moved.push(format!("{name}: {golden} became {now}"));
                }
            }
            let rest = rest.join(" | ");
            lines.push(format!("| {rest} | {} | {} |", figures[0], figures[1]));
        }
        assert_eq!(seen, figures.len(), "rows of {}", self.name);
        if update() {
            let text = format!("{before}{begin}{}\n{end}{after}", lines.join("\n"));
            std::fs::write(path, text).expect("docs can be written");
        } else {
            assert!(moved.is_empty(), "{moved:#?}\n{AGAIN}");
        }
    }
}

const AGAIN: &str = "if that is meant, UPDATE_GOLDEN=1 writes the table anew";
