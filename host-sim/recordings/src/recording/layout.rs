//! Layout of a text: its separator, its header, and the columns that are read.

mod cut_row;
pub(super) mod endings;
pub(super) mod formats;
pub(super) mod header;
pub(super) mod hint;
mod labview;
mod notes;
mod places;
mod search;
mod seen;
pub(super) mod sources;
mod stating;
mod twincat;
mod unit_row;
mod words;

use terminal::failure::Failure;

use crate::log::HEAD;

use super::options::{Column, Mapping, ReadOptions};
use super::text::row_ends;
use super::text::separator::{Separator, comment, stamp};
use endings::Ending;
use formats::{Format, SIMPLEFOC, SIMPLEFOC_COLUMNS};
pub(super) use places::{Part, Place, Places};
pub(super) use search::{UNKNOWN, is_number, number, numbers, unit_since_1970};
use search::{is_content, moments, named, probable, since_1970, two_levels, without_value};
pub(super) use seen::Seen;
use unit_row::UnitRow;
pub(super) use words::{
    POSITIONS, TIMES, has, is_coordinate, is_derived, is_duration, is_indirect, is_joint,
};

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
    /// What the numbers of each column tell in the first rows; empty where no rows are seen.
    pub(super) seen: Vec<Seen>,
    /// Places of the columns that have no value in the first rows.
    pub(super) without_value: Vec<usize>,
    /// Whether the first line of a text without a header is left out, because its first number may be cut.
    pub(super) cuts_first: bool,
    /// Places of the columns that have a time since 1970 in the first row, and its unit.
    pub(super) since_1970: Vec<(usize, &'static str)>,
    /// Places of the columns that have a date or a time of day in the first row.
    pub(super) moments: Vec<usize>,
    /// The first row of a text that has no header.
    pub(super) first_row: String,
    /// Whether the lines begin with the time stamps of a serial monitor.
    pub(super) is_stamped: bool,
    /// Whether a row may end with a remark, which is not read.
    pub(super) remarks: bool,
    /// Whether a row may lack its last fields.
    pub(super) ends_early: bool,
    /// Whether a separator of its own ends each row, as in `1,2;`.
    pub(super) has_row_ends: bool,
    /// Line of the first NUL bytes of a text, which are skipped.
    pub(super) nul: Option<u64>,
    /// The rate of rows without a time as the text states it, Hz.
    pub(super) row_rate_hz: Option<f64>,
    /// Whether --row-rate states the rate of the rows.
    pub(super) has_rate: bool,
    /// Line of the first row above a header that is in the middle of the text.
    pub(super) rows_above: Option<u64>,
    /// The motors of a table with rows of one motor each.
    pub(super) keyed: Option<Keyed>,
}

/// Motors that a table calls by their numbers, which are the begins of the names of their columns.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Keyed {
    /// The columns with the numbers.
    pub(super) columns: Vec<String>,
    pub(super) keys: Vec<String>,
}

impl Layout {
    /// The layout of the log that begins with `head`. `is_cut` is true if it goes on.
    pub(super) fn of(head: &str, is_cut: bool, options: &ReadOptions) -> Self {
        let bare = head.lines().map(|line| &line[stamp(line.as_bytes())..]);
        let mut lines: Vec<_> = bare.take(SEARCHED + 1).collect();
        let has_row_ends = row_ends::end(&lines);
        if has_row_ends {
            lines = lines.into_iter().map(row_ends::cut).collect();
        }
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
        if let Some(layout) = Self::labview(&lines).or_else(|| Self::twincat(&lines)) {
            return Self {
                seen: Seen::of(&layout, &lines),
                ..layout
            };
        }
        let (mut layout, is_named) = match UnitRow::find(&lines) {
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
            layout.separate_as_rows(&lines);
        }
        layout.leave_out_cut_row(&lines);
        Self {
            has_row_ends,
            has_rate: options.row_rate_hz.is_some(),
            is_stamped: is_stamped(head),
            two_levels: two_levels(&layout, &lines),
            seen: Seen::of(&layout, &lines),
            without_value: without_value(&layout, &lines),
            since_1970: since_1970(&layout, &lines),
            moments: moments(&layout, &lines),
            ..layout
        }
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
            seen: Vec::new(),
            without_value: Vec::new(),
            cuts_first: false,
            since_1970: Vec::new(),
            moments: Vec::new(),
            first_row: String::new(),
            is_stamped: false,
            remarks: false,
            ends_early: false,
            has_row_ends: false,
            nul: None,
            row_rate_hz: None,
            has_rate: false,
            rows_above: None,
            keyed: None,
        }
    }

    /// The layout of values with these names beside them.
    pub(super) fn named_values(names: Vec<String>) -> Self {
        Self {
            named_values: true,
            ..Self::header(Separator::Comma, names, 0)
        }
    }

    /// Takes the separator of the first row where it is another one than that of the header.
    fn separate_as_rows(&mut self, lines: &[&str]) {
        let mut below = lines.iter().skip(self.skip as usize);
        let row = below.find(|line| is_content(line) && comment(line).is_none());
        let Some(row) = row else { return };
        let own = self.separator.split(row);
        let is_row = own.len() == self.names.len()
            && own.iter().all(|field| is_number(field, self.separator));
        if let Some((separator, fields)) = numbers(row).filter(|_| !is_row)
            && fields == self.names.len()
        {
            self.separator = separator;
        }
    }

    /// Whether the column at `place` has a number with a fraction in the first rows.
    fn is_fractional(&self, place: usize) -> bool {
        self.seen.get(place).is_some_and(|seen| seen.is_fractional)
    }

    /// Whether the column at `place` has one number in the first rows.
    fn is_at_rest(&self, place: usize) -> bool {
        let seen = self.seen.get(place);
        seen.is_some_and(|seen| seen.rows > 1 && seen.is_constant)
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
            // It writes fractions, and first a target. A whole number that rises in each row is a time.
            let rises = self.seen.first().is_some_and(|first| first.step.is_some());
            let is_timed = rises && !self.is_fractional(0);
            return (known && self.separator == Separator::Tab && !is_timed).then_some(&SIMPLEFOC);
        }
        Format::of(&self.names)
    }

    /// The column that a user names.
    pub(super) fn mapped(
        &self,
        mapping: &Mapping,
        options: &ReadOptions,
        name: &str,
    ) -> Result<Place, Failure> {
        let beside = self.beside_position(mapping, options);
        if beside.is_none() {
            header::check_one(mapping, self, name)?;
        }
        let place = beside
            .or_else(|| self.place(&mapping.theirs))
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
        let at = self.at(mapping.column, place, unit);
        let Some((theirs, unit)) = &mapping.part else {
            return Ok(at);
        };
        let part = Mapping {
            theirs: theirs.clone(),
            unit: Some(unit),
            part: None,
            ..*mapping
        };
        let part = self.mapped(&part, options, name)?;
        Ok(Place {
            part: Some(Part {
                place: part.place,
                unit: part.unit,
            }),
            ..at
        })
    }

    /// Of several columns of time with one name the last one before the position: each signal of a log may have
    /// its own times beside it. `None` for another column, and where the time has one place.
    fn beside_position(&self, mapping: &Mapping, options: &ReadOptions) -> Option<usize> {
        let is_time = mapping.column == Column::T && !mapping.is_number();
        let position = options.mapping(Column::CountsLarge).filter(|_| is_time)?;
        let end = self.place(&position.theirs)?;
        let named = self.names[..end].iter().enumerate();
        let mut named = named.filter(|(_, known)| **known == mapping.theirs);
        let last = named.next_back()?.0;
        (self
            .names
            .iter()
            .filter(|known| **known == mapping.theirs)
            .count()
            > 1)
        .then_some(last)
    }
}

/// Whether lines of `head` begin with the time stamps of a serial monitor.
pub(super) fn is_stamped(head: &str) -> bool {
    head.lines().any(|line| stamp(line.as_bytes()) > 0)
}

#[cfg(test)]
mod tests;
