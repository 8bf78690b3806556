//! The columns of a text that are read.

use terminal::failure::Failure;

use super::Layout;
use super::endings::Ending;
use super::formats::{Format, SIMPLEFOC, SIMPLEFOC_COLUMNS};
use super::header;
use crate::recording::options::units::{Quantity, Unit};
use crate::recording::options::{Column, ReadOptions};

/// A column that is read.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Place {
    pub(crate) column: Column,
    /// Its index in a row.
    pub(crate) place: usize,
    pub(crate) unit: &'static Unit,
    /// For whole seconds, the column with the part of a second.
    pub(crate) part: Option<Part>,
}

/// The column with the part of a second beside one of whole seconds.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Part {
    /// Its index in a row.
    pub(crate) place: usize,
    pub(crate) unit: &'static Unit,
}

impl Place {
    /// The indices in a row of what is read.
    pub(crate) fn indices(self) -> impl Iterator<Item = usize> {
        std::iter::once(self.place).chain(self.part.map(|part| part.place))
    }
}

/// The columns that are read.
#[derive(Debug)]
pub(crate) struct Places {
    /// The program that wrote the log, if it is known.
    pub(crate) format: Option<&'static Format>,
    columns: Vec<Place>,
    /// The column of time that --row-rate replaces.
    pub(crate) replaced_time: Option<Place>,
    /// Optional columns that were found by their names and have no value in the first rows. They are not read.
    pub(crate) without_value: Vec<(Column, usize)>,
    /// Whether a column was found because its name says what it is.
    pub(crate) by_names: bool,
}

impl Places {
    pub(crate) fn get(&self, column: Column) -> Option<Place> {
        let found = self.columns.iter().find(|place| place.column == column);
        found.copied()
    }

    pub(crate) fn all(&self) -> &[Place] {
        &self.columns
    }

    /// Adds the columns of the program that wrote the log.
    fn add_of_format(&mut self, format: &Format, layout: &Layout) {
        let names = match SIMPLEFOC_COLUMNS
            .iter()
            .find(|names| names.len() == layout.names.len())
        {
            Some(names) if !layout.has_header() => {
                names.iter().map(|name| (*name).to_owned()).collect()
            }
            _ => layout.names.clone(),
        };
        for found in format.find(&names) {
            let unit = found.column.quantity().unit(found.unit);
            if let (Some(unit), None) = (unit, self.get(found.column)) {
                self.columns
                    .push(layout.at(found.column, found.place, unit));
            }
        }
    }

    /// Checks that what is needed is there.
    fn check(&self, layout: &Layout, options: &ReadOptions, name: &str) -> Result<(), Failure> {
        if let (Some(modulus), None) = (options.modulus[1], self.get(Column::CountsSmall)) {
            return Err(Failure::Input(format!(
                "{name}: --modulus counts_small={modulus}: there is no column counts_small; name it with \
                 --column counts_small=THEIRS, or leave the option out"
            )));
        }
        let needs = |column| match self.get(column) {
            Some(_) => Ok(()),
            None => Err(header::missing(column, layout, self, name)),
        };
        if options.row_rate_hz.is_none() {
            // A constant has no address of its own.
            let is_monitor = self
                .format
                .is_some_and(|format| format.name == SIMPLEFOC.name);
            if is_monitor && self.get(Column::T).is_none() {
                return Err(header::without_time(&SIMPLEFOC, name));
            }
            // A time that is known by its name is not what is missing.
            if layout.stating(Column::T, &self.columns).is_some() {
                needs(Column::CountsLarge)?;
            }
            needs(Column::T)?;
        }
        needs(Column::CountsLarge)?;
        for [one, other] in [
            [Column::EdgeTick, Column::EdgeBound],
            [Column::EdgeBound, Column::EdgeTick],
        ] {
            if self.get(one).is_some() {
                needs(other)?;
            }
        }
        Ok(())
    }

    /// Adds time and position by names that say what they are, if both are read then.
    fn add_stating(&mut self, layout: &Layout, options: &ReadOptions) {
        let needed = match options.row_rate_hz {
            None => &[Column::T, Column::CountsLarge][..],
            Some(_) => &[Column::CountsLarge],
        };
        let lacking = needed.iter().filter(|column| self.get(**column).is_none());
        let lacking: Vec<_> = lacking.collect();
        let found: Option<Vec<_>> = lacking
            .iter()
            .map(|column| layout.stating(**column, &self.columns))
            .collect();
        if let (None, Some(found)) = (self.format, found) {
            self.by_names = !found.is_empty();
            self.columns.extend(found);
        }
    }

    /// Leaves out optional columns without a value that no option names. Stamps of edges may begin late.
    fn leave_out_without_value(&mut self, layout: &Layout, options: &ReadOptions) {
        let is_needed = |column| {
            use Column::{CountsLarge, EdgeBound, EdgeTick, T};
            matches!(column, T | CountsLarge | EdgeTick | EdgeBound)
        };
        let is_left_out = |at: &Place| {
            layout.without_value.contains(&at.place)
                && !is_needed(at.column)
                && options.mapping(at.column).is_none()
        };
        let left_out = self.columns.extract_if(.., |at| is_left_out(at));
        self.without_value = left_out.map(|at| (at.column, at.place)).collect();
    }

    /// Adds the column of the project's own name.
    fn add_own(&mut self, column: Column, layout: &Layout, name: &str) -> Result<(), Failure> {
        let called = |name: &&String| *name == column.name();
        if layout.names.iter().filter(called).count() > 1 {
            return Err(Failure::Input(format!(
                "{name}: line {}: two columns {}; rename or remove one",
                layout.line,
                column.name()
            )));
        }
        let place = layout.names.iter().position(|name| name == column.name());
        let Some(place) = place else {
            return Ok(());
        };
        let unit = match layout.ending(column.quantity(), place) {
            Ending::Unit(unit) => unit,
            Ending::Nothing => &column.quantity().units()[0],
            Ending::Unknown(unit) => {
                return Err(header::unknown_unit(column, place, unit, layout, name));
            }
        };
        self.columns.push(layout.at(column, place, unit));
        Ok(())
    }
}

impl Layout {
    /// The column at `place`, with that of its parts of a second.
    pub(super) fn at(&self, column: Column, place: usize, unit: &'static Unit) -> Place {
        let part = (column == Column::T).then(|| self.part_of_second(place, unit));
        Place {
            column,
            place,
            unit,
            part: part.flatten(),
        }
    }

    /// The only column with the part of a second beside the whole seconds at `place`: its name differs in the
    /// unit, as `stamp.nanosec` from `stamp.sec`.
    pub(super) fn part_of_second(&self, place: usize, seconds: &'static Unit) -> Option<Part> {
        let stem = seconds.before(&self.names[place]);
        let stem = stem.filter(|_| seconds.per_s() == 1.0 && !self.is_fractional(place))?;
        let units = || {
            Quantity::Time
                .units()
                .iter()
                .filter(|unit| unit.per_s() > 1.0)
        };
        let mut parts = self.names.iter().enumerate().filter_map(|(place, name)| {
            let unit = units().find(|unit| unit.before(name) == Some(stem))?;
            Some(Part { place, unit })
        });
        let first = parts.next()?;
        parts.next().is_none().then_some(first)
    }

    /// Whether the column at `part` has the part of a second beside the whole seconds at `whole`.
    pub(super) fn is_part_of(&self, part: usize, whole: usize) -> bool {
        let found = match self.ending(Quantity::Time, whole) {
            Ending::Unit(unit) => self.part_of_second(whole, unit),
            Ending::Nothing | Ending::Unknown(_) => None,
        };
        found.is_some_and(|found| found.place == part)
    }

    /// The columns to read.
    pub(crate) fn places(&self, options: &ReadOptions, name: &str) -> Result<Places, Failure> {
        let mut places = Places {
            format: self.format(options),
            columns: Vec::new(),
            replaced_time: None,
            without_value: Vec::new(),
            by_names: false,
        };
        for column in Column::ALL {
            if let Some(mapping) = options.mapping(column) {
                places.columns.push(self.mapped(mapping, options, name)?);
            } else if !column
                .command()
                .is_some_and(|command| options.mapping(command).is_some())
            {
                // Who names the column of the current wants that one.
                places.add_own(column, self, name)?;
            }
        }
        if let Some(format) = places.format {
            places.add_of_format(format, self);
        }
        places.leave_out_without_value(self, options);
        if options.row_rate_hz.is_some() {
            let by_name = || self.stating(Column::T, &places.columns);
            places.replaced_time = places.get(Column::T).or_else(by_name);
            places.columns.retain(|place| place.column != Column::T);
        }
        places.add_stating(self, options);
        places.check(self, options, name)?;
        Ok(places)
    }
}

#[cfg(test)]
mod tests {
    use crate::recording::read_log as read;

    fn log(header: &str, fields: &[&str]) -> String {
        let row = |(k, field): (usize, &&str)| format!("{}e-3,{},{field}\n", k, 2 * k);
        let rows: String = fields.iter().enumerate().map(row).collect();
        format!("{header}\n{rows}")
    }

    #[test]
    fn optional_column_without_a_number_is_left_out() {
        for (header, name) in [
            ("__time,/a/position,/a/effort", "/a/effort"),
            ("t,counts_large,current", "current"),
        ] {
            for word in ["", "nan", "null"] {
                let text = log(header, &[word; 5]).replace(",0,", ",0.0,");
                let recording = read(&text, "").unwrap();
                assert_eq!(recording.trace.current, None);
                let said = format!(
                    "column '{name}' has no number in the first rows and is not read as current; --column reads it"
                );
                assert!(recording.notes.contains(&said), "{:?}", recording.notes);
                let error = read(&text, &format!("current={name}:A")).unwrap_err();
                assert!(error.contains("column current: '"), "{error}");
            }
            // One number is a column.
            let error = read(&log(header, &["nan", "0.5", "nan"]), "").unwrap_err();
            let said = format!("rename the column {name} if the command does without it");
            assert!(error.ends_with(&said), "{error}");
        }
        let text = log("t,counts_large,edge_tick", &["", "", ""]);
        assert!(
            read(&text, "")
                .unwrap_err()
                .contains("no column edge_bound")
        );
    }
}
