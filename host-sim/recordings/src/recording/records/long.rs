//! Tables with the numbers of one signal a row: time, name and value; or time, joint, position and velocity.

mod numbered;

use std::collections::BTreeSet;
use std::io::BufRead;

use csv::ByteRecord;

use terminal::failure::Failure;

use super::named_fields::{Field, Mark, Places, names, seen};
use crate::recording::layout::{Keyed, Layout, SEARCHED, is_number, is_stamped, number};
use crate::recording::options::{Column, ReadOptions};
use crate::recording::text::Text;
use crate::recording::text::separator::{Separator, comment};

/// Names of the columns that say whose the numbers of a row are.
const KEYS: [&str; 18] = [
    "name",
    "signal",
    "channel",
    "variable",
    "parameter",
    "series",
    "metric",
    "field",
    "topic",
    "key",
    "joint",
    "motor",
    "axis",
    "encoder",
    "sensor",
    "device",
    "wheel",
    "node",
];

/// Name of the column that has the numbers, where each row has one.
const VALUE: &str = "value";

/// Columns of such a table.
#[derive(Clone, Debug, PartialEq)]
struct Table {
    time: usize,
    keys: Vec<usize>,
    /// Columns of numbers, and their own names behind that of the key.
    values: Vec<(usize, String)>,
    columns: usize,
    /// Whether the keys are numbers of motors.
    is_numbered: bool,
}

impl Table {
    /// The columns called `names`, with the first row. `None` if they are none of such a table.
    fn of(names: &[String], row: &[String], separator: Separator) -> Option<Self> {
        let is_number = |place: usize| {
            row.get(place)
                .is_some_and(|field| is_number(field, separator))
        };
        let lower = |name: &String| name.trim_start_matches('_').to_lowercase();
        let lower: Vec<_> = names.iter().map(lower).collect();
        let places = |is: &dyn Fn(&str) -> bool| -> Vec<usize> {
            (0..lower.len())
                .filter(|place| is(&lower[*place]))
                .collect()
        };
        let time = places(&|name| name == "t" || name.contains("time") || name.contains("stamp"));
        let mut keys = places(&|name| KEYS.contains(&name));
        let is_numbered = !keys.iter().any(|key| !is_number(*key));
        if is_numbered {
            keys = places(&numbered::is_called_so);
            let is_id = |key: &usize| row.get(*key).is_some_and(|field| numbered::is_id(field));
            keys.retain(is_id);
        }
        let value = places(&|name| name == VALUE);
        let values: Vec<_> = match value.as_slice() {
            [value] if !is_numbered => vec![(*value, String::new())],
            _ => (0..names.len())
                .filter(|place| !time.contains(place) && !keys.contains(place) && is_number(*place))
                .map(|place| (place, format!(".{}", names[place])))
                .collect(),
        };
        let has_numbers = !values.is_empty() && values.iter().all(|(place, _)| is_number(*place));
        match time.as_slice() {
            [time] if row.len() == names.len() && has_numbers && !keys.is_empty() => Some(Self {
                time: *time,
                keys,
                values,
                columns: names.len(),
                is_numbered,
            }),
            _ => None,
        }
    }

    /// Whose the numbers of a row are.
    fn key(&self, row: &ByteRecord) -> String {
        let part = |place: &usize| text(row, *place);
        let parts: Vec<_> = self.keys.iter().map(part).collect();
        parts.join(".")
    }

    /// The numbers of a row, with their names.
    fn fields<'a>(&'a self, row: &'a ByteRecord) -> impl Iterator<Item = Field> + 'a {
        let key = self.key(row);
        let values = self.values.iter();
        values.map(move |(place, name)| field(format!("{key}{name}"), text(row, *place)))
    }
}

fn text(row: &ByteRecord, place: usize) -> String {
    let field = row.get(place).unwrap_or_default();
    String::from_utf8_lossy(field.trim_ascii()).into_owned()
}

/// What the begin of a log tells.
pub(super) struct Begin {
    pub(super) layout: Layout,
    table: Table,
}

impl Begin {
    /// Reads the first bytes `head` of a log; `None` if it is no such table, or if the columns that are read have
    /// names in its header.
    pub(super) fn of(head: &str, options: &ReadOptions) -> Option<Self> {
        let lines = (0..).zip(head.lines().take(SEARCHED));
        let is_row = |line: &&str| !line.trim().is_empty() && comment(line).is_none();
        let rows = |index: usize| head.lines().skip(index + 1).filter(is_row);
        // Most lines are rows of numbers, and take no time.
        let names_keys = |line: &str| {
            let lower = line.to_lowercase();
            let mut words = KEYS.iter().chain(&numbered::WORDS);
            words.any(|word| lower.contains(word))
        };
        let mut tables = lines.filter_map(|(index, line)| {
            if !names_keys(line) {
                return None;
            }
            Separator::ALL.into_iter().find_map(|separator| {
                let header = separator.split(comment(line).unwrap_or(line));
                let first = separator.split(rows(index).next()?);
                let table = Table::of(&header, &first, separator)?;
                Some((index, separator, header, table))
            })
        });
        let (index, separator, header, table) = tables.next()?;
        let is_read = |column: &Column| match options.mapping(*column) {
            Some(mapping) => header.contains(&mapping.theirs),
            None => header.iter().any(|name| name == column.name()),
        };
        let rows = rows(index).map(|line| ByteRecord::from(separator.split(line)));
        let rows: Vec<_> = rows.filter(|row| row.len() == header.len()).collect();
        let keys: Vec<_> = rows.iter().map(|row| table.key(row)).collect();
        let is_other = match table.is_numbered {
            // The rows of motors in turn are those of no shaft, but a column that is read is no number of a motor.
            true => {
                let mut read = Column::COUNTS
                    .iter()
                    .filter_map(|column| options.mapping(*column));
                let is_key = |theirs: &String| table.keys.iter().any(|key| header[*key] == *theirs);
                !numbered::alternate(&keys) || read.any(|mapping| is_key(&mapping.theirs))
            }
            // Rows of one key alone need no other names.
            false => {
                let is_of_one = keys.windows(2).all(|pair| pair[0] == pair[1]);
                let is_wide = table.values.iter().any(|(_, name)| !name.is_empty());
                Column::COUNTS.iter().any(is_read) || (is_wide && is_of_one)
            }
        };
        if is_other {
            return None;
        }
        let mut columns = vec![header[table.time].clone()];
        columns.extend(names(
            rows.iter().flat_map(|row| table.fields(row)).collect(),
        ));
        let keyed = table.is_numbered.then(|| Keyed {
            columns: table.keys.iter().map(|key| header[*key].clone()).collect(),
            keys: keys
                .into_iter()
                .collect::<BTreeSet<_>>()
                .into_iter()
                .collect(),
        });
        let fields = rows.iter().map(|row| table.fields(row).collect());
        let seen = seen(&columns, fields, |text| number(text, separator));
        Some(Self {
            layout: Layout {
                is_stamped: is_stamped(head),
                seen,
                keyed,
                ..Layout::header(separator, columns, index)
            },
            table,
        })
    }
}

/// Rows of one time each, with the numbers of all names that the table has at it. A name without a number at
/// this time has its latest one.
pub(super) struct Long<R> {
    rows: Text<R>,
    table: Table,
    time: String,
    pub(super) places: Places,
    /// The row that is read ahead, and its line.
    ahead: ByteRecord,
    line: Option<u64>,
    /// Whether a row of the latest time may be cut.
    pub(super) is_cut: bool,
}

impl<R: BufRead> Long<R> {
    pub(super) fn new(inner: R, end: u8, begin: Begin, name: &str) -> Result<Self, Failure> {
        let Begin { layout, table } = begin;
        let mut rows = Text::new(inner, end, &layout, table.columns);
        let mut ahead = ByteRecord::new();
        Ok(Self {
            line: rows.read(&mut ahead, name)?,
            rows,
            table,
            time: layout.names[0].clone(),
            places: Places::new(&layout.names),
            ahead,
            is_cut: false,
        })
    }

    /// Reads the rows of the next time into `record` and returns the line of the first one.
    pub(super) fn read(
        &mut self,
        record: &mut ByteRecord,
        name: &str,
    ) -> Result<Option<u64>, Failure> {
        let Some(mut line) = self.line else {
            return Ok(None);
        };
        let time = text(&self.ahead, self.table.time);
        let mut fields = vec![field(self.time.clone(), time.clone())];
        while self.line.is_some() && text(&self.ahead, self.table.time) == time {
            let new: Vec<_> = self.table.fields(&self.ahead).collect();
            let is_known = |field: &Field| fields.iter().any(|known| known.name == field.name);
            if new.iter().any(is_known) {
                break;
            }
            if let Some(cut) = self.line.filter(|line| self.rows.is_cut(*line)) {
                self.is_cut = true;
                line = cut;
            }
            fields.extend(new);
            self.line = self.rows.read(&mut self.ahead, name)?;
        }
        self.places.take_and_hold(fields, record);
        Ok(Some(line))
    }
}

fn field(name: String, text: String) -> Field {
    let mark = Mark::Text;
    Field { name, text, mark }
}

#[cfg(test)]
mod tests;
