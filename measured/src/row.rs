//! A row of a file.

use crate::Difference;

/// A row of a file, with the names of its columns.
#[derive(Clone, Debug)]
pub struct Row {
    table: &'static str,
    /// Name and text, in the order of the file.
    cells: Vec<(String, String)>,
}

impl Row {
    pub(crate) fn new(table: &'static str, cells: impl Iterator<Item = (String, String)>) -> Self {
        let cells = cells.collect();
        Self { table, cells }
    }

    /// Names of the columns, in the order of the file.
    pub fn names(&self) -> impl Iterator<Item = &str> {
        self.cells.iter().map(|(name, _)| &**name)
    }

    pub(crate) fn cells(&self) -> impl Iterator<Item = &str> {
        self.cells.iter().map(|(_, cell)| &**cell)
    }

    /// The text in a column.
    ///
    /// # Errors
    /// One line if there is no such column.
    pub fn text(&self, column: &str) -> Result<&str, Difference> {
        let found = self.cells.iter().find(|(name, _)| name == column);
        let missing = || format!("measured/{}.csv: no column {column}", self.table);
        found.map(|(_, cell)| &**cell).ok_or_else(missing)
    }

    /// The number in a column.
    ///
    /// # Errors
    /// One line if there is no such column or no number in it.
    pub fn number(&self, column: &str) -> Result<f64, Difference> {
        let text = self.text(column)?;
        let wrong = |_| {
            let table = self.table;
            format!("measured/{table}.csv: column {column}: '{text}' is no number")
        };
        text.parse().map_err(wrong)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn missing_column_and_text_for_a_number_are_reported() {
        let cells = [("name", "a"), ("off_ms", "never on")];
        let cells = cells.map(|(name, cell)| (name.to_owned(), cell.to_owned()));
        let row = Row::new("x", cells.into_iter());
        assert_eq!(row.text("name").unwrap(), "a");
        assert_eq!(
            row.text("on_ms").unwrap_err(),
            "measured/x.csv: no column on_ms"
        );
        assert_eq!(
            row.number("off_ms").unwrap_err(),
            "measured/x.csv: column off_ms: 'never on' is no number"
        );
    }
}
