//! Layout of a text: its separator, its header, and the columns that are read.

mod labview;
mod search;
mod stating;
mod unit_row;

use terminal::failure::Failure;

use crate::log::HEAD;

use super::endings::Ending;
use super::formats::{Format, SIMPLEFOC, SIMPLEFOC_COLUMNS};
use super::header;
use super::options::{Column, Mapping, ReadOptions};
use super::separator::{Separator, comment, stamp};
use super::units::Unit;
pub(super) use search::{UNKNOWN, is_number};
use search::{fractional, is_content, named, numbers, probable, two_levels};
pub(super) use stating::{POSITIONS, TIMES, has};
use unit_row::UnitRow;

/// Number of the first lines among which the header is searched.
pub(super) const SEARCHED: usize = 500;

/// Where the names of the columns are, and what they are.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Layout {
    pub(super) separator: Separator,
    /// Whether each value has its name beside it, as in JSON, and no separator is seen.
    pub(super) named_values: bool,
    /// Names of the columns, or their numbers from 1 where the text has no header.
    pub(super) names: Vec<String>,
    /// Units of the columns in a line of their own; empty without one.
    pub(super) units: Vec<String>,
    /// Line of the header; 0 where the text has no header.
    pub(super) line: u64,
    /// A line with names that are more or fewer than the columns, and their number.
    pub(super) misfit: Option<(u64, usize)>,
    /// Number of lines before the data.
    pub(super) skip: u64,
    /// What is searched of a text that goes on and has no header and no numbers there.
    pub(super) searched: Option<String>,
    /// Places of the columns that are 0 or 1 in the first rows, and both.
    pub(super) two_levels: Vec<usize>,
    /// Places of the columns that have a number with a fraction in the first rows.
    pub(super) fractional: Vec<usize>,
    /// The first row of a text that has no header.
    pub(super) first_row: String,
    /// Whether the lines begin with the time stamps of a serial monitor.
    pub(super) is_stamped: bool,
    /// Whether a row may end with a remark, which is not read.
    pub(super) remarks: bool,
    /// The rate of rows without a time as the text states it, Hz.
    pub(super) row_rate_hz: Option<f64>,
}

impl Layout {
    /// The layout of the log called `name` that begins with `head`. `is_cut` is true if it goes on.
    ///
    /// # Errors
    /// [`Failure::Input`] if rows have another separator than the header.
    pub(super) fn of(
        head: &str,
        is_cut: bool,
        options: &ReadOptions,
        name: &str,
    ) -> Result<Self, Failure> {
        let bare = head.lines().map(|line| &line[stamp(line.as_bytes())..]);
        let mut lines: Vec<_> = bare.take(SEARCHED + 1).collect();
        let limit = match (lines.len() > SEARCHED, is_cut) {
            (true, _) => Some(format!("{SEARCHED} lines")),
            (false, true) => Some(format!("{} KiB", HEAD >> 10)),
            (false, false) => None,
        };
        if limit.is_some() {
            // The last line may be cut.
            lines.pop();
        }
        let search = |lines: &[&str]| {
            let named = named(lines, options);
            let is_named = named.is_some();
            (
                named.unwrap_or_else(|| probable(lines, limit.clone())),
                is_named,
            )
        };
        if let Some(layout) = Self::labview(&lines) {
            return Ok(Self {
                fractional: fractional(&layout, &lines),
                ..layout
            });
        }
        let (layout, is_named) = match UnitRow::find(&lines) {
            None => search(&lines),
            Some(units) => {
                let mut without = lines.clone();
                without[units.index] = "";
                let (layout, is_named) = search(&without);
                match units.below(layout, &lines) {
                    Some(layout) => (layout, is_named),
                    None => search(&lines),
                }
            }
        };
        if is_named {
            layout.check_separator(&lines, name)?;
        }
        Ok(Self {
            is_stamped: is_stamped(head),
            two_levels: two_levels(&layout, &lines),
            fractional: fractional(&layout, &lines),
            ..layout
        })
    }

    pub(super) fn header(separator: Separator, mut names: Vec<String>, index: usize) -> Self {
        // Some programs end each line with a separator.
        if names.len() > 1 && names.last().is_some_and(String::is_empty) {
            names.pop();
        }
        Self {
            separator,
            named_values: false,
            names,
            units: Vec::new(),
            line: index as u64 + 1,
            misfit: None,
            skip: index as u64 + 1,
            searched: None,
            two_levels: Vec::new(),
            fractional: Vec::new(),
            first_row: String::new(),
            is_stamped: false,
            remarks: false,
            row_rate_hz: None,
        }
    }

    /// The layout of values with these names beside them.
    pub(super) fn named_values(names: Vec<String>) -> Self {
        Self {
            named_values: true,
            ..Self::header(Separator::Comma, names, 0)
        }
    }

    /// Checks that the first row has the separator of the header.
    fn check_separator(&self, lines: &[&str], name: &str) -> Result<(), Failure> {
        let below = (0..).zip(lines).skip(self.skip as usize);
        let mut rows = below.filter(|(_, line)| is_content(line) && comment(line).is_none());
        let Some((index, row)) = rows.next() else {
            return Ok(());
        };
        let own = self.separator.split(row);
        let is_row = own.len() == self.names.len()
            && own.iter().all(|field| is_number(field, self.separator));
        match numbers(row) {
            Some((other, fields))
                if !is_row && other != self.separator && fields == self.names.len() =>
            {
                Err(Failure::Input(format!(
                    "{name}: line {}: fields separated by {}, where the header in line {} has {}; write one \
                     separator in all lines",
                    index + 1,
                    other.name(),
                    self.line,
                    self.separator.name()
                )))
            }
            _ => Ok(()),
        }
    }

    /// Whether the text has a line with the names of its columns.
    pub(super) fn has_header(&self) -> bool {
        self.line > 0
    }

    /// Place of the column that the user calls `name`: its name in the header, or its number.
    pub(super) fn place(&self, name: &str) -> Option<usize> {
        let named = self.names.iter().position(|known| known == name);
        named.or_else(|| {
            let number: usize = name.parse().ok()?;
            (1..=self.names.len()).contains(&number).then(|| number - 1)
        })
    }

    /// The log of another program that the columns belong to.
    fn format(&self, options: &ReadOptions) -> Option<&'static Format> {
        let own = |column: Column| self.names.iter().any(|name| name == column.name());
        let given = |column| options.mapping(column).is_some() || own(column);
        if given(Column::CountsLarge) {
            return Format::own(&self.names);
        }
        if !self.has_header() {
            let columns = SIMPLEFOC_COLUMNS.iter();
            let known = columns
                .map(|names| names.len())
                .any(|n| n == self.names.len());
            return (known && self.separator == Separator::Tab).then_some(&SIMPLEFOC);
        }
        Format::of(&self.names)
    }

    /// The column that a user names.
    pub(super) fn mapped(&self, mapping: &Mapping, name: &str) -> Result<Place, Failure> {
        header::check_one(mapping, self, name)?;
        let place = self
            .place(&mapping.theirs)
            .ok_or_else(|| header::unknown(mapping, self, name))?;
        let quantity = mapping.column.quantity();
        let unit = match (mapping.unit, self.ending(quantity, place)) {
            (Some(unit), _) | (None, Ending::Unit(unit)) => unit,
            (None, Ending::Nothing) => &quantity.units()[0],
            (None, Ending::Unknown(unit)) => {
                return Err(header::unknown_unit(
                    mapping.column,
                    place,
                    unit,
                    self,
                    name,
                ));
            }
        };
        Ok(Place {
            column: mapping.column,
            place,
            unit,
        })
    }

    /// The columns to read.
    pub(super) fn places(&self, options: &ReadOptions, name: &str) -> Result<Places, Failure> {
        let mut places = Places {
            format: self.format(options),
            columns: Vec::new(),
            replaced_time: None,
            by_names: false,
        };
        for column in Column::ALL {
            if let Some(mapping) = options.mapping(column) {
                places.columns.push(self.mapped(mapping, name)?);
            } else if !column
                .command()
                .is_some_and(|command| options.mapping(command).is_some())
            {
                // Who names the column of the current wants that one.
                places.add_own(column, self, name)?;
            }
        }
        if let Some(format) = places.format {
            let names = match SIMPLEFOC_COLUMNS
                .iter()
                .find(|names| names.len() == self.names.len())
            {
                Some(names) if !self.has_header() => {
                    names.iter().map(|name| (*name).to_owned()).collect()
                }
                _ => self.names.clone(),
            };
            for found in format.find(&names) {
                let unit = found.column.quantity().unit(found.unit);
                if let (Some(unit), None) = (unit, places.get(found.column)) {
                    places.columns.push(Place {
                        column: found.column,
                        place: found.place,
                        unit,
                    });
                }
            }
        }
        if let Some(hz) = options.row_rate_hz {
            if options.mapping(Column::T).is_some() {
                return Err(Failure::Input(format!(
                    "{name}: --row-rate {hz}: --column names a column of time; leave one of the two out"
                )));
            }
            places.replaced_time = places.get(Column::T);
            places.columns.retain(|place| place.column != Column::T);
        }
        places.add_stating(self, options);
        if let (Some(modulus), None) = (options.modulus[1], places.get(Column::CountsSmall)) {
            return Err(Failure::Input(format!(
                "{name}: --modulus counts_small={modulus}: there is no column counts_small; name it with \
                 --column counts_small=THEIRS, or leave the option out"
            )));
        }
        let needs = |column| match places.get(column) {
            Some(_) => Ok(()),
            None => Err(header::missing(column, self, &places, name)),
        };
        if options.row_rate_hz.is_none() {
            if places
                .format
                .is_some_and(|format| std::ptr::eq(format, &SIMPLEFOC))
                && places.get(Column::T).is_none()
            {
                return Err(header::without_time(&SIMPLEFOC, name));
            }
            // A time that is known by its name is not what is missing.
            if self.stating(Column::T, &places.columns).is_some() {
                needs(Column::CountsLarge)?;
            }
            needs(Column::T)?;
        }
        needs(Column::CountsLarge)?;
        for [one, other] in [
            [Column::EdgeTick, Column::EdgeBound],
            [Column::EdgeBound, Column::EdgeTick],
        ] {
            if places.get(one).is_some() {
                needs(other)?;
            }
        }
        Ok(places)
    }
}

/// Whether lines of `head` begin with the time stamps of a serial monitor.
pub(super) fn is_stamped(head: &str) -> bool {
    head.lines().any(|line| stamp(line.as_bytes()) > 0)
}

/// A column that is read.
#[derive(Clone, Copy, Debug)]
pub(super) struct Place {
    pub(super) column: Column,
    /// Its index in a row.
    pub(super) place: usize,
    pub(super) unit: &'static Unit,
}

/// The columns that are read.
#[derive(Debug)]
pub(super) struct Places {
    /// The program that wrote the log, if it is known.
    pub(super) format: Option<&'static Format>,
    columns: Vec<Place>,
    /// The column of time that --row-rate replaces.
    pub(super) replaced_time: Option<Place>,
    /// Whether a column was found because its name says what it is.
    pub(super) by_names: bool,
}

impl Places {
    pub(super) fn get(&self, column: Column) -> Option<Place> {
        let found = self.columns.iter().find(|place| place.column == column);
        found.copied()
    }

    pub(super) fn all(&self) -> &[Place] {
        &self.columns
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
        self.columns.push(Place {
            column,
            place,
            unit,
        });
        Ok(())
    }
}

#[cfg(test)]
mod tests;
