//! Rows that are left out.

use terminal::failure::Failure;

use super::Columns;
use crate::recording::layout::Place;
use crate::recording::options::Column;
use crate::recording::records::named_fields::Mark;
use crate::recording::text::fields::is_without_value;
use crate::recording::text::row::Row;

/// Number of rows that are left out, and line of the first.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct LeftOut {
    pub(crate) rows: usize,
    pub(crate) first: u64,
}

impl LeftOut {
    pub(crate) fn add(&mut self, line: u64) {
        if self.rows == 0 {
            self.first = line;
        }
        self.rows += 1;
    }

    /// Note on rows of other signals.
    pub(super) fn of_others(self) -> Option<String> {
        let Self { rows, first } = self;
        match rows {
            0 => None,
            1 => Some(format!(
                "the row in line {first} has no position and is left out"
            )),
            _ => Some(format!(
                "{rows} rows without a position are left out, the first in line {first}"
            )),
        }
    }

    /// Note on lines that are no rows.
    pub(super) fn messages(self) -> Option<String> {
        let Self { rows, first } = self;
        match rows {
            0 => None,
            1 => Some(format!(
                "line {first} has none of the names and is left out"
            )),
            _ => Some(format!(
                "{rows} lines have none of the names and are left out, the first is line {first}"
            )),
        }
    }
}

impl Columns<'_> {
    /// Whether a row has no position and is one of other signals: in some logs each row has the signals that
    /// changed. A row of fields with names has the value of one of them; in one with separators all fields are there. A
    /// row without the time that is read has a time of its own, and a value.
    pub(super) fn is_of_others(&self, row: &Row) -> Result<bool, Failure> {
        let [Some(time), Some(position)] =
            [Column::T, Column::CountsLarge].map(|column| self.place(column))
        else {
            return Ok(false);
        };
        let has = |place: Place| -> Result<bool, Failure> {
            let is_new = row.marks.get(place.place) != Some(&Mark::Held);
            let text = row.text(place.column.name(), place.place)?;
            Ok(is_new && !is_without_value(text))
        };
        if has(position)? {
            return Ok(false);
        }
        let read: Vec<_> = time.indices().chain(position.indices()).collect();
        let others = || row.values(|place| !read.contains(&place));
        Ok(match (row.marks, has(time)?) {
            ([], true) => row.record.len() > 2,
            (_, true) => others() > 0,
            (_, false) => others() > 1,
        })
    }
}
