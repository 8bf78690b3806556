//! Tables with the numbers of one signal a row: time, name and value; or time, joint, position and velocity.

use std::io::BufRead;

use csv::ByteRecord;

use terminal::failure::Failure;

use super::layout::{Layout, SEARCHED, is_number, is_stamped};
use super::named_fields::{Field, Mark, Places, names};
use super::options::{Column, ReadOptions};
use super::separator::{Separator, comment};
use super::text::Text;

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
        let keys = places(&|name| KEYS.contains(&name));
        let value = places(&|name| name == VALUE);
        let values: Vec<_> = match value.as_slice() {
            [value] => vec![(*value, String::new())],
            _ => (0..names.len())
                .filter(|place| !time.contains(place) && !keys.contains(place) && is_number(*place))
                .map(|place| (place, format!(".{}", names[place])))
                .collect(),
        };
        let has_numbers = !values.is_empty() && values.iter().all(|(place, _)| is_number(*place));
        let has_keys = keys.iter().any(|key| !is_number(*key));
        match time.as_slice() {
            [time] if row.len() == names.len() && has_numbers && has_keys => Some(Self {
                time: *time,
                keys,
                values,
                columns: names.len(),
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
            KEYS.iter().any(|key| lower.contains(key))
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
        // Rows of one key alone need no other names.
        let is_of_one = rows
            .windows(2)
            .all(|pair| table.key(&pair[0]) == table.key(&pair[1]));
        let is_wide = table.values.iter().any(|(_, name)| !name.is_empty());
        if Column::COUNTS.iter().any(is_read) || (is_wide && is_of_one) {
            return None;
        }
        let mut columns = vec![header[table.time].clone()];
        columns.extend(names(
            rows.iter().flat_map(|row| table.fields(row)).collect(),
        ));
        Some(Self {
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
    fn numbers_of_a_joint_have_its_name() {
        let mut text = String::from("time_s,joint,state,counts,iq\n");
        for k in 0..9 {
            text += &format!(
                "0.{k}0,left,RUN,{},0.5\n0.{k}5,right,RUN,{},0\n",
                8 * k,
                9 - k
            );
        }
        let error = read(&text, "").unwrap_err();
        assert!(
            error.contains("found: time_s; left.counts; left.iq; right.counts; right.iq"),
            "{error}"
        );
        let recording = read(
            &text,
            "t=time_s,counts_large=right.counts,current=left.iq:A",
        )
        .unwrap();
        assert_eq!(recording.trace.counts_large[..3], [9, 8, 7]);
        assert_eq!(recording.trace.current.unwrap()[..2], [0.5; 2]);
        // Where the user names a column of the table, or it has one of ours, its rows are the rows.
        let wide = read(&text, "t=time_s,counts_large=counts").unwrap();
        assert_eq!(wide.trace.counts_large[..3], [0, 9, 8]);
        let own = read(&text.replace("counts", "counts_large"), "t=time_s").unwrap();
        assert_eq!(own.trace.counts_large[..3], [0, 9, 8]);
        // So are those of one joint.
        let one: String = text
            .lines()
            .filter(|line| !line.contains("right"))
            .map(|line| format!("{line}\n"))
            .collect();
        assert_eq!(read(&one, "").unwrap().trace.counts_large[..3], [0, 8, 16]);
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
        let said = "17 rows without a position are left out, the first in line 2";
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
