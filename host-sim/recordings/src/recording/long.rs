//! Tables with one number a row: its time, its name and its value.

use std::io::BufRead;

use csv::ByteRecord;

use terminal::failure::Failure;

use super::layout::{Layout, SEARCHED, is_number, is_stamped};
use super::named_fields::{Field, Mark, Places, names};
use super::separator::{Separator, comment};
use super::text::Text;

/// Names of the columns that name a number, and of the column that has it.
const KEYS: &[&str] = &[
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
];
const VALUE: &str = "value";

/// Columns of such a table.
#[derive(Clone, Debug, PartialEq)]
struct Table {
    time: usize,
    keys: Vec<usize>,
    value: usize,
    columns: usize,
}

impl Table {
    /// The columns with these names; `None` if there is none of a kind, or a second time or value.
    fn of(names: &[String]) -> Option<Self> {
        let lower = |name: &String| name.trim_start_matches('_').to_lowercase();
        let lower: Vec<_> = names.iter().map(lower).collect();
        let places = |is: &dyn Fn(&str) -> bool| -> Vec<usize> {
            (0..lower.len())
                .filter(|place| is(&lower[*place]))
                .collect()
        };
        let time = places(&|name| name == "t" || name.contains("time") || name.contains("stamp"));
        let keys = places(&|name| KEYS.contains(&name));
        let value = places(&|name| name == VALUE);
        match (time.as_slice(), value.as_slice()) {
            ([time], [value]) if !keys.is_empty() => Some(Self {
                time: *time,
                keys,
                value: *value,
                columns: names.len(),
            }),
            _ => None,
        }
    }

    /// The name of the number in a row.
    fn key(&self, row: &ByteRecord) -> String {
        let part = |place: &usize| {
            let field = row.get(*place).unwrap_or_default();
            String::from_utf8_lossy(field.trim_ascii()).into_owned()
        };
        let parts: Vec<_> = self.keys.iter().map(part).collect();
        parts.join(".")
    }
}

/// What the begin of a log tells.
pub(super) struct Begin {
    pub(super) layout: Layout,
    table: Table,
}

impl Begin {
    /// Reads the first bytes `head` of a log; `None` if it is no such table.
    pub(super) fn of(head: &str) -> Option<Self> {
        let mut lines = (0..).zip(head.lines().take(SEARCHED));
        let (index, separator, header, table) = lines.find_map(|(index, line)| {
            Separator::ALL.into_iter().find_map(|separator| {
                let header = separator.split(comment(line).unwrap_or(line));
                let table = Table::of(&header)?;
                Some((index, separator, header, table))
            })
        })?;
        let rows = head.lines().skip(index + 1);
        let rows = rows.filter(|line| !line.trim().is_empty() && comment(line).is_none());
        let rows: Vec<_> = rows.map(|line| separator.split(line)).collect();
        let first = rows.first()?;
        let is_row = first.len() == header.len()
            && is_number(&first[table.value], separator)
            && table
                .keys
                .iter()
                .any(|key| !is_number(&first[*key], separator));
        let whole = rows.iter().filter(|row| row.len() == header.len());
        let keys = whole.map(|row| Field {
            name: table.key(&row.iter().collect()),
            text: String::new(),
            mark: Mark::Missing,
        });
        let mut columns = vec![header[table.time].clone()];
        columns.extend(names(keys.collect()));
        is_row.then(|| Self {
            layout: Layout {
                is_stamped: is_stamped(head),
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
        let text = |field: &[u8]| String::from_utf8_lossy(field.trim_ascii()).into_owned();
        let time = text(&self.ahead[self.table.time]);
        let mut fields = vec![field(self.time.clone(), time.clone())];
        while self.line.is_some() && text(&self.ahead[self.table.time]) == time {
            let key = self.table.key(&self.ahead);
            if fields.iter().any(|field| field.name == key) {
                break;
            }
            if let Some(cut) = self.line.filter(|line| self.rows.is_cut(*line)) {
                self.is_cut = true;
                line = cut;
            }
            fields.push(field(key, text(&self.ahead[self.table.value])));
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
mod tests {
    use crate::recording::read_log as read;

    #[test]
    fn numbers_of_one_time_are_one_row() {
        for (header, row, shaft, iq) in [
            ("Timestamp,Name,Value", "T,K,", "shaft", "iq"),
            ("time,series,unit,value", "T,K,A,", "shaft", "iq"),
            ("_time,_field,topic,_value", "T,K,m,", "shaft.m", "iq.m"),
        ] {
            let mut text = format!("# a log\n{header}\n");
            for k in 0..9 {
                for (key, value) in [("temp", 20), ("shaft", 8 * k), ("iq", k)] {
                    text += &row.replace('T', &format!("0.{k}")).replace('K', key);
                    text += &format!("{value}\n");
                }
            }
            let time = header.split(',').next().unwrap();
            let options = format!("t={time}:s,counts_large={shaft}:counts,current={iq}:A");
            let recording = read(&text, &options).unwrap();
            assert_eq!(recording.trace.counts_large[..3], [0, 8, 16], "{header}");
            assert_eq!(recording.trace.current.unwrap()[..3], [0.0, 1.0, 2.0]);
            assert_eq!(recording.t.len(), 9);
        }
    }

    #[test]
    fn name_without_a_number_has_its_latest_one() {
        let mut text = String::from("time;signal;value\n0,0;iq;7\n");
        for k in 1..9 {
            text += &format!("0,{k}1;shaft;{}\n0,{k}2;iq;{k},5\n0,{k}3;vbus;24\n", 8 * k);
        }
        let options = "t=time:s,counts_large=shaft:counts,current=iq:A";
        let recording = read(&text, options).unwrap();
        assert_eq!(recording.trace.counts_large[..3], [8, 16, 24]);
        assert_eq!(recording.trace.current.unwrap()[..3], [7.0, 1.5, 2.5]);
        let said = "17 rows without a position are left out";
        assert!(
            recording.notes.iter().any(|note| note == said),
            "{:?}",
            recording.notes
        );
        // Two numbers of one name at one time are two rows.
        let twice = read(&text.replace("0,22;iq", "0,21;shaft"), options).unwrap_err();
        let said = "of the rows have the time of the row before, the first in line 7 at 0.21 s";
        assert!(twice.contains(said), "{twice}");
    }

    #[test]
    fn errors_name_line_and_names() {
        let text = "time,name,value\n0,shaft,1\n0.001,shaft,2\n0.002,iq,3\n";
        let error = read(text, "").unwrap_err();
        let said = "r.csv: line 1: no column t; found: time; shaft; iq, separated by ','; name the columns";
        assert!(error.starts_with(said), "{error}");
        let columns = "t=time:s,counts_large=shaft:counts";
        for (row, said) in [
            (
                "0.003,shaft",
                "line 5: 2 fields where the first line has 3; remove the line",
            ),
            (
                "0.003,shaft,x",
                "line 5: column counts_large: 'x' is not a number",
            ),
        ] {
            let error = read(&format!("{text}{row}\n"), columns).unwrap_err();
            assert!(error.starts_with(&format!("r.csv: {said}")), "{error}");
        }
        // Values of names that are numbers are columns.
        let error = read("time,channel,value\n0,1,5\n0.001,1,6\n", "").unwrap_err();
        assert!(error.contains("found: time; channel; value"), "{error}");
    }
}
