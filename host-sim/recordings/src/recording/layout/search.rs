//! The search for the header and the separator of a text.

use std::collections::BTreeSet;

use super::Layout;
use super::formats::Format;
use super::words::{POSITIONS, TIMES, has};
use crate::recording::options::units::{Quantity, Unit};
use crate::recording::options::{Column, Mapping, ReadOptions};
use crate::recording::records::labelled::is_labelled;
use crate::recording::text::fields::is_without_value;
use crate::recording::text::separator::{Separator, comment};
use crate::recording::times::moment::Moment;

/// The first line that names a time and a position, in text or in a comment. A column that is called by its number has
/// no name there.
pub(super) fn named(lines: &[&str], options: &ReadOptions) -> Option<Layout> {
    let order = [
        Separator::Comma,
        Separator::Semicolon,
        Separator::Tab,
        Separator::Whitespace,
    ];
    let in_line = |(index, text): (usize, &str)| {
        order.into_iter().find_map(|separator| {
            let layout = Layout::header(separator, separator.split(text), index);
            let has = |column: &Column| match options.mapping(*column) {
                Some(mapping) => layout.names.contains(&mapping.theirs),
                None => layout.names.iter().any(|name| name == column.name()),
            };
            let mut needed = vec![Column::CountsLarge];
            needed.extend(options.row_rate_hz.is_none().then_some(Column::T));
            needed.retain(|column| !options.mapping(*column).is_some_and(Mapping::is_number));
            let own = !needed.is_empty() && needed.iter().all(has);
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

/// The header of a text whose columns no option names: the line before the first line of numbers, also before comments
/// between them. Else a line above it, or below it, that names a time and a position; or none.
/// `limit` is what was searched of a text that goes on.
pub(super) fn probable(lines: &[&str], limit: Option<String>) -> Layout {
    let is_text = |line: &str| is_content(line) && comment(line).is_none();
    let first = (lines.iter().enumerate()).find_map(|(index, line)| {
        let (separator, fields) = numbers(line).filter(|_| is_text(line))?;
        Some((index, separator, fields))
    });
    let Some((index, separator, fields)) = first else {
        return without_numbers(lines, limit);
    };
    let named = fields - usize::from(end_with(separator, &lines[index..]));
    let fits = |header: &Layout| [fields, named].contains(&header.names.len());
    let header = |(at, line): (usize, &&str)| {
        let text = comment(line).unwrap_or(line);
        let has_names = text.chars().any(char::is_alphabetic) && numbers(text).is_none();
        let names = || {
            let own = names(separator, text, named);
            // A comment may have blanks between its names, and the rows commas.
            let other = Separator::ALL.into_iter().map(|other| other.split(text));
            let is_whole =
                |name: &String| !name.contains([',', ';']) && !name.starts_with(['(', '[']);
            let mut other = other.filter(|names| {
                names.len() == named && names.iter().all(is_whole) && name_columns(names)
            });
            match own.len() == named {
                true => own,
                false => other.next().unwrap_or(own),
            }
        };
        has_names.then(|| Layout::header(separator, names(), at))
    };
    let above = || (lines[..index].iter().enumerate().rev()).filter(|(_, line)| is_content(line));
    // The latest line, and the latest one that is no comment.
    let latest = [
        above().next(),
        above().find(|(_, line)| comment(line).is_none()),
    ];
    let latest: Vec<_> = latest.into_iter().flatten().filter_map(header).collect();
    let is_prose = |header: &Layout| {
        comment(lines[header.line as usize - 1]).is_some()
            && has_values(header)
            && !name_columns(&header.names)
    };
    let nearest = latest
        .iter()
        .find(|header| fits(header) && !is_prose(header));
    let is_name = |name: &String| !is_number(name, separator);
    if let Some(header) = nearest.filter(|header| header.names.iter().all(is_name)) {
        return header.clone();
    }
    let is_header = |header: &Layout| fits(header) && name_columns(&header.names);
    if let Some(header) = above().filter_map(header).find(is_header) {
        return Layout {
            skip: index as u64,
            ..header
        };
    }
    let below = lines.iter().enumerate().skip(index + 1);
    if let Some(header) = below.filter_map(header).find(is_header) {
        return Layout {
            rows_above: Some(index as u64 + 1),
            ..header
        };
    }
    if let Some(header) = nearest {
        return header.clone();
    }
    let misfit = latest.iter().find(|header| name_columns(&header.names));
    let index = index + numbering(separator, &lines[index..]).unwrap_or(0);
    Layout {
        misfit: misfit.map(|header| (header.line, header.names.len())),
        ..without_header(separator, named, (index, lines[index]))
    }
}

/// How many lines below the first one the rows begin, if the first one has the numbers of the columns from 0, as pandas
/// writes them where there are no names: the row below it begins with 0 too.
fn numbering(separator: Separator, lines: &[&str]) -> Option<usize> {
    let fields = separator.split(lines.first()?);
    // Above an index of the rows there is no number.
    let index = usize::from(fields[0].is_empty());
    let mut numbers = fields.iter().skip(index).zip(0..);
    if fields.len() < index + 2 || !numbers.all(|(field, number)| *field == number.to_string()) {
        return None;
    }
    let mut below = lines.iter().enumerate().skip(1);
    let (at, row) = below.find(|(_, line)| is_content(line) && comment(line).is_none())?;
    let row = separator.split(row);
    (row.len() == fields.len() && number(&row[0], separator) == Some(0.0)).then_some(at)
}

/// The layout of a text without a line of more than one number: the first line that is no comment is the header, or a
/// row with some text or a single number.
fn without_numbers(lines: &[&str], limit: Option<String>) -> Layout {
    let is_text = |line: &str| !line.trim().is_empty() && comment(line).is_none();
    let mut text = (lines.iter().enumerate()).filter(|(_, line)| is_text(line));
    let (index, line) = text.next().unwrap_or((0, &""));
    let separator = Separator::ALL
        .into_iter()
        .find(|separator| separator.split(line).len() > 1);
    let separator = separator.unwrap_or(Separator::Comma);
    let fields = separator.split(line).len();
    let next = text.next();
    let is_row = next.is_some_and(|(_, next)| {
        are_rows(separator, line, next) || are_labelled(separator, line, next)
    });
    if is_row || (fields == 1 && is_number(line.trim(), separator)) {
        let mut above = lines[..index].iter().enumerate().rev();
        let header = above.find_map(|(at, line)| {
            let names = separator.split(comment(line)?);
            (names.len() == fields).then(|| Layout::header(separator, names, at))
        });
        return header.unwrap_or_else(|| without_header(separator, fields, (index, line)));
    }
    Layout {
        searched: limit,
        ..Layout::header(separator, separator.split(line), index)
    }
}

/// The names of `fields` columns in a line. Names with single blanks in them have two or more between them.
fn names(separator: Separator, line: &str, fields: usize) -> Vec<String> {
    let apart = line
        .split("  ")
        .map(str::trim)
        .filter(|name| !name.is_empty());
    let apart: Vec<_> = apart.map(str::to_owned).collect();
    match separator == Separator::Whitespace && apart.len() == fields {
        true => apart,
        false => separator.split(line),
    }
}

/// Whether one of the names of a header is a number, or has a value.
fn has_values(header: &Layout) -> bool {
    let is_value = |name: &String| name.contains('=') || is_number(name, header.separator);
    header.names.iter().any(is_value)
}

/// Whether one of these names is that of a time, and another one that of a position.
pub(super) fn name_columns(names: &[String]) -> bool {
    let [mut timed, mut placed] = [false; 2];
    for name in names {
        match has(name, TIMES) || has(name, &["t"]) {
            true => timed = true,
            false => placed |= has(name, POSITIONS),
        }
    }
    timed && placed
}

/// The layout of a text without names, whose first row is at an index.
fn without_header(separator: Separator, fields: usize, (index, row): (usize, &str)) -> Layout {
    let numbers = (1..=fields).map(|number| number.to_string());
    Layout {
        names: numbers.collect(),
        line: 0,
        skip: index as u64,
        first_row: row.trim().to_owned(),
        ..Layout::header(separator, Vec::new(), 0)
    }
}

/// Whether two adjacent lines are rows: both have numbers in the same columns, and in at least two.
fn are_rows(separator: Separator, one: &str, next: &str) -> bool {
    let numbers = |line: &str| -> Vec<bool> {
        let fields = separator.split(line);
        let is_number = |field: &String| is_number(field, separator);
        fields.iter().map(is_number).collect()
    };
    let [one, next] = [one, next].map(numbers);
    one == next && one.iter().filter(|is_number| **is_number).count() >= 2
}

/// Whether two adjacent lines are rows of which some field has its name in it: both have such fields in the same columns.
fn are_labelled(separator: Separator, one: &str, next: &str) -> bool {
    let [one, next] = [one, next].map(|line| -> Vec<bool> {
        let fields = separator.split(line);
        fields.iter().map(|field| is_labelled(field)).collect()
    });
    one == next && one.contains(&true)
}

/// Whether a line has more than separators.
pub(super) fn is_content(line: &str) -> bool {
    let is_separator = |c: char| matches!(c, ',' | ';' | '"') || c.is_whitespace();
    !line.chars().all(is_separator)
}

/// Whether all rows of `lines` end with the separator, after the last field. In a few rows the last
/// field may be empty.
fn end_with(separator: Separator, lines: &[&str]) -> bool {
    let mut rows = lines
        .iter()
        .filter(|line| is_content(line) && comment(line).is_none());
    let end = char::from(separator.byte());
    separator != Separator::Whitespace
        && rows.all(|row| row.trim_end_matches([' ', '\r']).ends_with(end))
}

/// A level that a logic analyser does not know.
pub(crate) const UNKNOWN: &str = "X";

/// The fields of the rows of `layout` among `lines`.
pub(super) fn rows(layout: &Layout, lines: &[&str]) -> Vec<Vec<String>> {
    let rows = lines.iter().skip(layout.skip as usize);
    let rows = rows.filter(|line| is_content(line) && comment(line).is_none());
    rows.map(|line| layout.separator.split(line)).collect()
}

/// Places of the columns of `layout` that are 0 or 1 in the rows among `lines`, and both.
pub(super) fn two_levels(layout: &Layout, lines: &[&str]) -> Vec<usize> {
    let rows = rows(layout, lines);
    let has_two = |place: &usize| {
        let field = |row: &Vec<String>| row.get(*place).cloned();
        let levels: BTreeSet<_> = rows.iter().map(field).collect();
        levels
            .into_iter()
            .eq(["0", "1"].map(|level| Some(level.to_owned())))
    };
    (0..layout.names.len()).filter(has_two).collect()
}

/// Places of the columns of `layout` that have no value in the rows among `lines`, at least two.
pub(super) fn without_value(layout: &Layout, lines: &[&str]) -> Vec<usize> {
    let rows = rows(layout, lines);
    let has_value = |row: &Vec<String>, place: usize| {
        row.get(place)
            .is_some_and(|field| !is_without_value(field.trim()))
    };
    (0..layout.names.len())
        .filter(|place| rows.len() > 1 && !rows.iter().any(|row| has_value(row, *place)))
        .collect()
}

/// The fields of the first of the rows among `lines`: those with a name, or all in a log without names.
fn first_row(layout: &Layout, lines: &[&str]) -> Vec<String> {
    let mut first = rows(layout, lines).into_iter().next().unwrap_or_default();
    if !layout.names.is_empty() {
        first.truncate(layout.names.len());
    }
    first
}

/// Seconds from 1970 to 2001 and to 2100, between which the time of a log is.
const SINCE_1970: std::ops::Range<f64> = 1e9..4.1e9;

/// Places of the columns of `layout` that are a time since 1970 in the first of the rows among `lines`, and its unit.
pub(super) fn since_1970(layout: &Layout, lines: &[&str]) -> Vec<(usize, &'static str)> {
    let unit = |field: &String| unit_since_1970(number(field, layout.separator)?);
    let first = first_row(layout, lines);
    let fields = first.iter().enumerate();
    fields
        .filter_map(|(place, field)| Some((place, unit(field)?)))
        .collect()
}

/// The unit in which `number` is a time since 1970.
pub(crate) fn unit_since_1970(number: f64) -> Option<&'static str> {
    let fits = |unit: &&Unit| SINCE_1970.contains(&(number / unit.per_s()));
    Quantity::Time.units().iter().find(fits).map(Unit::name)
}

/// Places of the columns of `layout` that are a date or a time of day in the first of the rows among `lines`.
pub(super) fn moments(layout: &Layout, lines: &[&str]) -> Vec<usize> {
    let first = first_row(layout, lines);
    let is_moment = |place: &usize| Moment::parse(&first[*place]).is_some();
    (0..first.len()).filter(is_moment).collect()
}

/// Separator and number of fields of a line of numbers.
pub(crate) fn numbers(line: &str) -> Option<(Separator, usize)> {
    Separator::ALL.into_iter().find_map(|separator| {
        let fields = separator.split(line);
        let is_number = |field: &String| field.is_empty() || is_number(field, separator);
        let is_row = |field: &String| is_number(field) || field == UNKNOWN;
        let is_row = fields.iter().all(is_row) && fields.iter().any(is_number);
        (fields.len() > 1 && is_row).then_some((separator, fields.len()))
    })
}

/// The number that a field is.
pub(crate) fn number(field: &str, separator: Separator) -> Option<f64> {
    match separator.allows_decimal_comma() {
        true => field.replacen(',', ".", 1).parse().ok(),
        false => field.parse().ok(),
    }
}

/// Whether a field is a number or a time.
pub(crate) fn is_number(field: &str, separator: Separator) -> bool {
    number(field, separator).is_some() || Moment::parse(field).is_some()
}

#[cfg(test)]
mod tests;
