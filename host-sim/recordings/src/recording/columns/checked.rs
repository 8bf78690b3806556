//! What is said on a log's columns once all rows are read.

use terminal::failure::Failure;

use super::currents::measured_note;
use super::{Columns, MARKED};
use crate::recording::layout::sources::sources;
use crate::recording::layout::{Layout, Places};
use crate::recording::options::Column;

impl Columns<'_> {
    /// Notes on the rows that were taken: their columns, rows left out, and rounded positions.
    ///
    /// # Errors
    /// [`Failure::Input`] if many rows have the time of the row before, or if the time stamps of edges
    /// are not those of the rows.
    pub(in crate::recording) fn checked(
        &self,
        name: &str,
        places: &Places,
        layout: &Layout,
    ) -> Result<Vec<String>, Failure> {
        for (column, thousands) in MARKED.iter().zip(&self.thousands) {
            thousands.check(name, column.name())?;
        }
        let repeated = self
            .repeated
            .check(name, self.taken, self.last_t - self.first_t)?;
        if let Some(at) = self.place(Column::EdgeTick) {
            self.stamps.check(name, &layout.names[at.place])?;
        }
        let mut notes = Vec::new();
        if let (Some(at), Some(hz)) = (self.replaced_place, self.options.row_rate_hz) {
            notes.extend(self.replaced.check(name, &layout.names[at.place], hz)?);
        }
        notes.extend(sources(self.options, places, layout));
        notes.extend(
            self.measured()
                .map(|(column, lack)| measured_note(column, lack)),
        );
        notes.extend(layout.notes(places));
        notes.extend(self.own_times.notes());
        if self.replaced_place.is_none() {
            notes.extend(self.own_times.floats.note());
        }
        notes.extend(repeated);
        notes.extend(self.of_others.of_others());
        notes.extend(self.messages.messages());
        if let Some(line) = self.cut {
            notes.push(format!(
                "line {line}, the last one, has no end and is left out: its last number may be cut"
            ));
        }
        notes.extend(self.counts_large.notes(0, self.options));
        notes.extend(self.counts_small.notes(1, self.options));
        notes.extend(self.stamps.notes());
        Ok(notes)
    }
}
