//! Layout of a text: its separator, its header, and the columns that are read.

use terminal::failure::Failure;

use super::endings::Ending;
use super::formats::{Format, SIMPLEFOC, SIMPLEFOC_COLUMNS};
use super::header;
use super::options::{Column, ReadOptions};
use super::separator::{Separator, comment};
use super::units::Unit;

/// Number of the first lines among which the header is searched.
const SEARCHED: usize = 500;

/// Where the names of the columns are, and what they are.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Layout {
    pub(super) separator: Separator,
    /// Names of the columns, or their numbers from 1 where the text has no header.
    pub(super) names: Vec<String>,
    /// Line of the header; 0 where the text has no header.
    pub(super) line: u64,
    /// Number of lines before the data.
    pub(super) skip: u64,
}

impl Layout {
    /// The layout of a text that begins with `head`.
    pub(super) fn of(head: &str, options: &ReadOptions) -> Self {
        let lines: Vec<_> = head.lines().take(SEARCHED).collect();
        named(&lines, options).unwrap_or_else(|| probable(&lines))
    }

    fn header(separator: Separator, mut names: Vec<String>, index: usize) -> Self {
        // Some programs end each line with a separator.
        if names.len() > 1 && names.last().is_some_and(String::is_empty) {
            names.pop();
        }
        Self {
            separator,
            names,
            line: index as u64 + 1,
            skip: index as u64 + 1,
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
            return None;
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

    /// The columns to read.
    pub(super) fn places(&self, options: &ReadOptions, name: &str) -> Result<Places, Failure> {
        let mut places = Places {
            format: self.format(options),
            columns: Vec::new(),
            replaced_time: None,
        };
        for column in Column::ALL {
            if let Some(mapping) = options.mapping(column) {
                header::check_one(mapping, self, name)?;
                let place = self
                    .place(&mapping.theirs)
                    .ok_or_else(|| header::unknown(mapping, self, name))?;
                let quantity = column.quantity();
                let unit = match (mapping.unit, Ending::of(quantity, &self.names[place])) {
                    (Some(unit), _) | (None, Ending::Unit(unit)) => unit,
                    (None, Ending::Nothing) => &quantity.units()[0],
                    (None, Ending::Unknown(unit)) => {
                        return Err(header::unknown_unit(mapping, unit, self, name));
                    }
                };
                places.columns.push(Place {
                    column,
                    place,
                    unit,
                });
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
}

impl Places {
    pub(super) fn get(&self, column: Column) -> Option<Place> {
        let found = self.columns.iter().find(|place| place.column == column);
        found.copied()
    }

    pub(super) fn all(&self) -> &[Place] {
        &self.columns
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
        self.columns.extend(place.map(|place| Place {
            column,
            place,
            unit: &column.quantity().units()[0],
        }));
        Ok(())
    }
}

/// The first line that names a time and a position, in text or in a comment.
fn named(lines: &[&str], options: &ReadOptions) -> Option<Layout> {
    let order = [
        Separator::Comma,
        Separator::Semicolon,
        Separator::Tab,
        Separator::Whitespace,
    ];
    let in_line = |(index, text): (usize, &str)| {
        order.into_iter().find_map(|separator| {
            let layout = Layout::header(separator, separator.split(text), index);
            let has = |column: Column| match options.mapping(column) {
                Some(mapping) => layout.names.contains(&mapping.theirs),
                None => layout.names.iter().any(|name| name == column.name()),
            };
            let timed = options.row_rate_hz.is_some() || has(Column::T);
            let own = timed && has(Column::CountsLarge);
            (own || Format::of(&layout.names).is_some()).then_some(layout)
        })
    };
    let numbered = || lines.iter().enumerate();
    let text = numbered().filter(|(_, line)| comment(line).is_none());
    let comments = numbered().filter_map(|(index, line)| Some((index, comment(line)?)));
    text.map(|(index, line)| (index, *line))
        .find_map(in_line)
        .or_else(|| comments.into_iter().find_map(in_line))
}

/// The line before the first line of numbers; a text without names where the first line has numbers.
fn probable(lines: &[&str]) -> Layout {
    let mut above: Option<(usize, &str)> = None;
    for (index, line) in lines.iter().enumerate() {
        let is_separator = |c: char| matches!(c, ',' | ';') || c.is_whitespace();
        if line.chars().all(is_separator) {
            continue;
        }
        if comment(line).is_none()
            && let Some((separator, fields)) = numbers(line)
        {
            if let Some((above, text)) = above {
                let names = separator.split(text);
                if names.len() == fields && numbers(text).is_none() {
                    return Layout::header(separator, names, above);
                }
            }
            return Layout {
                separator,
                names: (1..=fields - usize::from(line.trim_end().ends_with([',', ';'])))
                    .map(|number| number.to_string())
                    .collect(),
                line: 0,
                skip: index as u64,
            };
        }
        above = Some((index, comment(line).unwrap_or(line)));
    }
    // No line of numbers: the first line that is no comment is the header.
    let mut text = lines.iter().enumerate();
    let first = text.find(|(_, line)| !line.trim().is_empty() && comment(line).is_none());
    let (index, line) = first.unwrap_or((0, &""));
    let separator = Separator::ALL
        .into_iter()
        .find(|separator| separator.split(line).len() > 1);
    let separator = separator.unwrap_or(Separator::Comma);
    Layout::header(separator, separator.split(line), index)
}

/// Separator and number of fields of a line of numbers.
fn numbers(line: &str) -> Option<(Separator, usize)> {
    Separator::ALL.into_iter().find_map(|separator| {
        let fields = separator.split(line);
        let number = |field: &String| match separator.allows_decimal_comma() {
            true => field.replacen(',', ".", 1).parse::<f64>().is_ok(),
            false => field.parse::<f64>().is_ok(),
        };
        (fields.len() > 1 && fields.iter().all(|field| field.is_empty() || number(field)))
            .then_some((separator, fields.len()))
    })
}
