//! Notes on parts of a text that are not read.

use super::header::short;
use super::{Layout, Places};

impl Layout {
    /// Notes on the lines and the columns that are not read.
    pub(crate) fn notes(&self, places: &Places) -> Vec<String> {
        let mut notes = Vec::new();
        if let Some(line) = self.rows_above {
            notes.push(format!(
                "the rows from line {line} to the header in line {} are not read: remove them, or cut the log there",
                self.line
            ));
        }
        if self.cuts_first {
            notes
                .push("line 1, the first one, is left out: its first number may be cut".to_owned());
        }
        if let Some(line) = self.nul {
            notes.push(format!(
                "NUL bytes in the text are not read, the first in line {line}"
            ));
        }
        if self.is_stamped {
            notes.push(
                "the times of a serial monitor before the lines are not read: they are those of arrival".to_owned(),
            );
        }
        notes.extend(places.without_value.iter().map(|(column, place)| {
            let name = short(&self.names[*place]);
            format!(
                "column '{name}' has no number in the first rows and is not read as {}; --column reads it",
                column.name()
            )
        }));
        notes
    }
}
