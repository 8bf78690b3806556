//! Rows that name their numbers, as a serial plotter reads them: `angle:1.5,velocity:2`.

mod logged;

use std::io::BufRead;

use csv::ByteRecord;

use terminal::failure::Failure;

use super::named_fields::{Field, Mark, Places, names, seen};
use crate::recording::layout::{Layout, SEARCHED, Seen, unit_since_1970};
use crate::recording::options::Column;
use crate::recording::text::lines::LineReader;
use crate::recording::text::separator::{bare, is_comment};

/// What follows a number before the next name. Spaces alone do, too.
const SEPARATORS: [char; 4] = [',', ';', '\t', '|'];

/// What the begin of a log tells.
pub(super) struct Begin {
    pub(super) names: Vec<String>,
    /// Line of the first row.
    pub(super) line: u64,
    /// What the numbers of each column tell in the first rows.
    seen: Vec<Seen>,
}

impl Begin {
    /// Reads the first bytes `head` of a log; `None` if it has no two adjacent rows of the same names.
    pub(super) fn of(head: &str) -> Option<Self> {
        let lines = || (1..).zip(head.lines().take(SEARCHED));
        let texts = || {
            lines()
                .map(|(line, text)| (line, bare(text.as_bytes())))
                .filter(|(_, text)| !text.trim_ascii().is_empty() && !is_comment(text))
        };
        let mut above: Option<(u64, Vec<String>)> = None;
        for (line, text) in texts() {
            let found = fields(text).map(names);
            match (above, found) {
                (Some((line, names)), Some(found)) if names == found => {
                    let rows = texts().filter_map(|(_, text)| fields(text));
                    return Some(Self {
                        seen: seen(&names, rows, |text| text.parse().ok()),
                        names,
                        line,
                    });
                }
                (_, found) => above = found.map(|names| (line, names)),
            }
        }
        None
    }

    /// The layout with what the first rows tell of the columns, beside what `layout` has.
    pub(super) fn told(&self, layout: Layout) -> Layout {
        let since_1970 = |place: usize| Some((place, unit_since_1970(self.seen[place].first?)?));
        Layout {
            moments: self.moments(),
            seen: self.seen.clone(),
            since_1970: (0..self.names.len()).filter_map(since_1970).collect(),
            ..layout
        }
    }

    /// Places of the columns that have a date or a time of day.
    fn moments(&self) -> Vec<usize> {
        let places = self.names.iter().position(|name| name == logged::NAME);
        places.into_iter().collect()
    }
}

/// Reads rows with names, one a line.
pub(super) struct Labelled<R> {
    inner: LineReader<R>,
    text: Vec<u8>,
    /// Line of the first row.
    first: u64,
    pub(super) places: Places,
}

impl Places {
    /// Whether one of these fields has a name of the columns, but for the time before a row.
    fn have_one_of(&self, fields: &[Field]) -> bool {
        let is_of_columns = |field: &Field| field.name != logged::NAME && self.has(&field.name);
        fields.iter().any(is_of_columns)
    }

    /// Whether one of the names stands in `text`, with the mark behind it that its number follows.
    fn are_called_in(&self, text: &str) -> bool {
        let mut before = text
            .match_indices([':', '='])
            .map(|(at, _)| text[..at].trim_end());
        before.any(|before| self.names().any(|name| is_last_word(before, name)))
    }
}

impl<R: BufRead> Labelled<R> {
    pub(super) fn new(inner: R, end: u8, begin: &Begin) -> Self {
        Self {
            inner: LineReader::new(inner, end),
            text: Vec::new(),
            first: begin.line,
            places: Places::new(&begin.names),
        }
    }

    /// Whether the row in `line` may be cut: no end of line follows it.
    pub(super) fn is_cut(&self, line: u64) -> bool {
        self.inner.cut() == Some(line)
    }

    /// Reads the next row into `record` and returns its line. A line without any of the names has no fields.
    pub(super) fn read(
        &mut self,
        record: &mut ByteRecord,
        name: &str,
    ) -> Result<Option<u64>, Failure> {
        loop {
            let Some(line) = self.inner.next_content(&mut self.text, name)? else {
                return Ok(None);
            };
            if line < self.first {
                continue;
            }
            let text = bare(&self.text);
            let fields = match fields(text) {
                Some(fields) if self.places.have_one_of(&fields) => fields,
                None if self.places.are_called_in(&String::from_utf8_lossy(text)) => {
                    return Err(Failure::Input(format!(
                        "{name}: line {line}: not each number has a name before it, as in line {}; remove the line",
                        self.first
                    )));
                }
                _ => Vec::new(),
            };
            self.places.take(fields, record);
            return Ok(Some(line));
        }
    }
}

/// The fields of a row of names and numbers, which may be behind a time; `None` for another line.
fn fields(line: &[u8]) -> Option<Vec<Field>> {
    let line = std::str::from_utf8(line).ok()?.trim();
    named(line).or_else(|| logged::fields(line, named))
}

/// The fields of a row of names and numbers alone.
fn named(mut rest: &str) -> Option<Vec<Field>> {
    let mut fields = Vec::new();
    while !rest.is_empty() {
        let (name, after) = rest.split_once([':', '='])?;
        let name = name.trim();
        if !name.contains(char::is_alphabetic) || name.contains(SEPARATORS) {
            return None;
        }
        let (number, after) = number(after.trim_start())?;
        let (unit, after) = unit(after)?;
        fields.push(Field {
            name: match unit {
                "" => name.to_owned(),
                unit => format!("{name} [{unit}]"),
            },
            text: number.to_owned(),
            mark: Mark::Text,
        });
        rest = after;
    }
    (!fields.is_empty()).then_some(fields)
}

/// Whether a text ends with a name, which may have its unit in brackets behind it.
fn is_last_word(text: &str, name: &str) -> bool {
    let name = name.split(" [").next().unwrap_or_default();
    let before = text.strip_suffix(name);
    before.is_some_and(|before| !before.ends_with(char::is_alphanumeric))
}

/// Whether a field of a row is a name and its number.
pub(crate) fn is_labelled(field: &str) -> bool {
    fields(field.as_bytes()).is_some()
}

/// The number that `text` begins with, and what comes after it.
fn number(text: &str) -> Option<(&str, &str)> {
    let is_of_number = |c: char| c.is_ascii_alphanumeric() || ['.', '+', '-'].contains(&c);
    let end = text.find(|c| !is_of_number(c)).unwrap_or(text.len());
    let end = (1..=end)
        .rev()
        .find(|end| text[..*end].parse::<f64>().is_ok())?;
    // A hexadecimal number is not the 0 that it begins with.
    let is_hexadecimal = text[end..].starts_with(['x', 'X']);
    (!is_hexadecimal).then(|| text.split_at(end))
}

/// The unit that `text` begins with, which is empty where the next name follows, and the rest after the
/// separator; `None` if `text` goes on in another way.
fn unit(text: &str) -> Option<(&str, &str)> {
    let is_attached = !text.starts_with(char::is_whitespace);
    let text = text.trim_start_matches(' ');
    let is_end = |c: char| c.is_whitespace() || SEPARATORS.contains(&c) || [':', '='].contains(&c);
    let (word, after) = text.split_at(text.find(is_end).unwrap_or(text.len()));
    if after.starts_with([':', '=']) {
        // The word is the next name.
        return (!is_attached && !word.is_empty()).then_some(("", text));
    }
    let after = after.trim_start_matches(' ');
    let (is_last, rest) = match after.strip_prefix(SEPARATORS) {
        Some(rest) => (true, rest.trim_start()),
        None => (after.is_empty(), after),
    };
    let word_is_unit = is_last || is_attached || is_known(word);
    match word_is_unit {
        true => Some((word.trim_matches(['[', ']', '(', ')']), rest)),
        false => Some(("", text)),
    }
}

/// Whether a word is a unit of a column.
fn is_known(word: &str) -> bool {
    let mut columns = Column::ALL.iter();
    columns.any(|column| column.quantity().unit(word).is_some())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::recording::read_log as read;

    fn shown(line: &str) -> Option<String> {
        let fields = fields(line.as_bytes())?;
        let each = fields
            .iter()
            .map(|field| format!("{}={}", field.name, field.text));
        Some(each.collect::<Vec<_>>().join("|"))
    }

    #[test]
    fn names_numbers_and_units_are_told_apart() {
        for (line, said) in [
            ("angle:1.5,velocity:-2", "angle=1.5|velocity=-2"),
            ("angle:1.5\tvelocity:2e-3\t\r", "angle=1.5|velocity=2e-3"),
            ("t = 1 ms; count = 8 ;", "t [ms]=1|count=8"),
            (
                "Angle: 1.5 deg Motor speed: nan rpm",
                "Angle [deg]=1.5|Motor speed [rpm]=nan",
            ),
            ("a:1 b:2 last c:3", "a=1|b=2|last c=3"),
            ("a:1.5deg b:2[A]", "a [deg]=1.5|b [A]=2"),
            ("temp: 30 C", "temp [C]=30"),
            ("x1=+.5|x2=-inf", "x1=+.5|x2=-inf"),
            ("a:1, ,b:2", ""),
            ("a:1,b", ""),
            ("a:1,b:", ""),
            ("a:1,5;b:2", ""),
            ("a:0x1F b:2", ""),
            ("a:1:b:2", ""),
            ("a:1 :2", ""),
            ("12:00:00,5", ""),
            ("2025-03-01T12:00:00,5", ""),
            ("1:2", ""),
            ("MOT: Align sensor.", ""),
            ("", ""),
        ] {
            assert_eq!(shown(line).unwrap_or_default(), said, "{line}");
        }
    }

    #[test]
    fn rows_with_names_are_a_log() {
        let row = |k: usize| format!("t_ms:{k},angle:{} deg,iq:0.5\n", 45 * k);
        let rows: String = (0..9).map(row).collect();
        let text = format!("MOT: Ready.\ngear:5\n0.5,iq:1\n{rows}\n# the end\n");
        let recording = read(&text, "").unwrap();
        assert_eq!(recording.trace.counts_large[..3], [0, 512, 1024]);
        assert_eq!(recording.t[8], 0.008);
        let said = "read by the names of its columns: t from 't_ms' (ms), counts_large from 'angle [deg]' (deg \
                    with 4096 counts/rev)";
        assert!(
            recording.notes[0].starts_with(said),
            "{:?}",
            recording.notes
        );
        let named = read(&text, "current=iq:mA").unwrap();
        assert_eq!(named.trace.current.unwrap()[..2], [0.5e-3; 2]);
        let stamped = text.replace("t_ms", "12:00:00.000 -> t_ms");
        let stamped = read(&stamped, "").unwrap();
        assert_eq!(stamped.trace.counts_large[..3], [0, 512, 1024]);
        let said = "the times of a serial monitor before the lines are not read";
        assert!(stamped.notes.iter().any(|note| note.starts_with(said)));
    }

    #[test]
    fn rows_are_placed_by_their_names_and_others_refused_by_line() {
        let text =
            |last: &str| format!("t:0,counts_large:1,x:2\nt:.001,counts_large:2,x:3\n{last}\n");
        let recording = read(&text("counts_large:5,y:3,t:.002"), "").unwrap();
        assert_eq!(recording.trace.counts_large, [1, 2, 5]);
        for (row, said) in [
            (
                "t:.002,counts",
                "not each number has a name before it, as in line 1; remove the line",
            ),
            (
                "t:.002",
                "column counts_large: no field 'counts_large' in the line; add it, or remove the line",
            ),
            (
                "t:.002,counts_large:5,t:3",
                "column t: two fields 't' in one line; rename or remove one",
            ),
            (
                "t:.002,counts_large:nan",
                "column counts_large: 'nan' is not a number",
            ),
        ] {
            let error = read(&text(row), "").unwrap_err();
            assert!(
                error.starts_with(&format!("r.csv: line 3: {said}")),
                "{error}"
            );
        }
        // One row alone could be anything.
        let error = read("t:0,counts_large:1\n", "").unwrap_err();
        assert!(error.starts_with("r.csv: line 1: no column t; "), "{error}");
    }
}
