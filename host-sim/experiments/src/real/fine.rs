//! Recordings of a fine encoder, read from CSV.

use std::path::Path;

use csv::ByteRecord;
use recordings::log::Log;
use recordings::recording::unwrap_long_counts;
use terminal::failure::Failure;

/// Columns that are read, each with the names under which it is found; others are ignored.
const COLUMNS: [(&str, &[&str]); 4] = [
    ("time_s", &["time_s", "t"]),
    ("fine_count", &["fine_count", "counts_large"]),
    ("motor_torque_nm", &["motor_torque_nm"]),
    ("true_omega_rad_s", &["true_omega_rad_s", "true_omega"]),
];

/// Bytes that separate fields, in the order in which they are tried. After the first one a comma is a
/// decimal comma.
const SEPARATORS: [u8; 3] = *b",;\t";

const BYTE_ORDER_MARK: &[u8] = b"\xef\xbb\xbf";

/// Shortest gap, in usual intervals or ticks.
const GAP: f64 = 1.5;

/// Position of a shaft as a fine encoder saw it. Times need not be even.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Fine {
    /// Time of each row from the first one, s, rising: a time since 1970 has too few digits for edges.
    pub t: Vec<f64>,
    /// Time of the first row in the file, s.
    pub start: f64,
    /// Counts of the fine encoder, without the steps of a counter of 32 bits.
    pub counts: Vec<i64>,
    /// Name of the column of the counts.
    pub count_column: String,
    /// Torque of the motor from a row to the next one, N.m; `None` without column
    /// `motor_torque_nm`.
    pub torque: Option<Vec<f64>>,
    /// True velocity at each row, rad/s; `None` without column `true_omega_rad_s`.
    pub omega: Option<Vec<f64>>,
    /// What is said about the counts, one line each.
    pub notes: Vec<String>,
}

impl Fine {
    /// Reads the first `seconds` of a CSV file, which may be compressed by gzip.
    ///
    /// # Errors
    /// [`Failure::Input`], one line that names file, line and column.
    pub fn read(path: &Path, seconds: f64) -> Result<Self, Failure> {
        let log = Log::open(path)?;
        Self::parse(&log.bytes()?, log.name(), seconds)
    }

    /// Reads the first `seconds` of CSV text called `name` in messages.
    ///
    /// # Errors
    /// As [`Fine::read`].
    pub fn parse(text: &[u8], name: &str, seconds: f64) -> Result<Self, Failure> {
        let failed = |error: &csv::Error| wrong_line(name, error);
        let separator = separator(text);
        let mut reader = csv::ReaderBuilder::new()
            .delimiter(separator)
            .trim(csv::Trim::All)
            .comment(Some(b'#'))
            .from_reader(text);
        let header = reader.byte_headers().map_err(|e| failed(&e))?.clone();
        let places = places(&header, name)?;
        let [Some(time), Some(count), torque, omega] = places else {
            let missing = if places[0].is_none() { 0 } else { 1 };
            let (column, names) = COLUMNS[missing];
            return Err(Failure::Input(format!(
                "{name}: line 1: no column {column}; name the column {}",
                names.join(" or ")
            )));
        };
        let mut fine = Self {
            torque: torque.map(|_| Vec::new()),
            omega: omega.map(|_| Vec::new()),
            count_column: self::text(&header, count),
            ..Self::default()
        };
        let mut last: Option<f64> = None;
        let mut record = ByteRecord::new();
        while reader
            .read_byte_record(&mut record)
            .map_err(|e| failed(&e))?
        {
            let line = record.position().map_or(0, csv::Position::line);
            let row = Row {
                name,
                line,
                header: &header,
                record: &record,
                decimal_comma: separator != SEPARATORS[0],
            };
            let t: f64 = row.number(time)?;
            if let Some(last) = last.filter(|last| t <= *last) {
                let said =
                    format!("{t} s is not after the {last} s above it; correct or remove the row");
                return Err(row.wrong(time, &said));
            }
            if last.replace(t).is_none() {
                fine.start = t;
            }
            let t = t - fine.start;
            fine.t.push(t);
            let count = row.count(count)?;
            // A counter of 32 bits wraps.
            let moved = |last: &i64| last + i64::from((count - last) as i32);
            fine.counts.push(fine.counts.last().map_or(count, moved));
            for (values, place) in [(&mut fine.torque, torque), (&mut fine.omega, omega)] {
                if let (Some(values), Some(place)) = (values, place) {
                    values.push(row.number(place)?);
                }
            }
            if t >= seconds {
                break;
            }
        }
        if fine.t.len() < 2 {
            return Err(Failure::Input(format!(
                "{name}: fewer than two rows of data; a recording needs at least two"
            )));
        }
        Ok(fine)
    }

    /// Unwraps the counts of an absolute encoder with `per_rev` counts per revolution, and notes it. `remedy`
    /// says how other counts per revolution are given.
    pub fn unwrap_counts(&mut self, per_rev: u32, remedy: &str) {
        let (counts, column) = (&mut self.counts, &self.count_column);
        let said = unwrap_long_counts(counts, &self.t, per_rev, column, remedy);
        self.notes.extend(said);
    }

    /// The intervals in which a tick is lost at this period and that are longer than usual: their number,
    /// and duration and end of the longest one, s, the end as in the file. `None` if there are none.
    #[must_use]
    pub fn gaps(&self, period_s: f64) -> Option<(usize, [f64; 2])> {
        let steps = self.t.windows(2).map(|pair| pair[1] - pair[0]);
        let mut sorted: Vec<f64> = steps.clone().collect();
        sorted.sort_by(f64::total_cmp);
        let longest_usual = GAP * sorted[sorted.len() / 2].max(period_s);
        let gaps = || {
            steps
                .clone()
                .zip(&self.t[1..])
                .filter(|(step, _)| *step > longest_usual)
        };
        let (step, end) = gaps().max_by(|a, b| a.0.total_cmp(&b.0))?;
        Some((gaps().count(), [step, self.start + *end]))
    }

    /// Mean rate of the rows, Hz.
    #[must_use]
    pub fn mean_rate_hz(&self) -> f64 {
        let last = self.t.len() - 1;
        last as f64 / (self.t[last] - self.t[0])
    }
}

/// The byte that separates a time from a position in the header, which is the first line of text.
fn separator(text: &[u8]) -> u8 {
    let text = text.strip_prefix(BYTE_ORDER_MARK).unwrap_or(text);
    let mut lines = text.split(|byte| *byte == b'\n');
    let header = lines.find(|line| !line.trim_ascii().is_empty() && !line.starts_with(b"#"));
    let names_both = |separator: &u8| {
        let fields = header
            .into_iter()
            .flat_map(|header| header.split(|byte| byte == separator));
        let found: Vec<_> = fields
            .filter_map(|field| column(field.trim_ascii()))
            .collect();
        [0, 1].iter().all(|column| found.contains(column))
    };
    let found = SEPARATORS.into_iter().find(names_both);
    found.unwrap_or(SEPARATORS[0])
}

/// Index in [`COLUMNS`] of the column called `name`, which may be in quotes.
fn column(name: &[u8]) -> Option<usize> {
    let name = name.strip_prefix(BYTE_ORDER_MARK).unwrap_or(name);
    let quoted = name
        .strip_prefix(b"\"")
        .and_then(|name| name.strip_suffix(b"\""));
    let name = quoted.unwrap_or(name);
    let is_known = |(_, names): &(&str, &[&str])| names.iter().any(|n| n.as_bytes() == name);
    COLUMNS.iter().position(is_known)
}

/// Index of each column of [`COLUMNS`].
fn places(header: &ByteRecord, name: &str) -> Result<[Option<usize>; COLUMNS.len()], Failure> {
    let mut places = [None; COLUMNS.len()];
    for (i, field) in header.iter().enumerate() {
        let Some(column) = column(field) else {
            continue;
        };
        if places[column].replace(i).is_some() {
            return Err(Failure::Input(format!(
                "{name}: line 1: two columns {}; rename or remove one",
                COLUMNS[column].1.join(" or ")
            )));
        }
    }
    Ok(places)
}

/// The failure of a line that is no row.
fn wrong_line(name: &str, error: &csv::Error) -> Failure {
    let line = error.position().map_or(1, csv::Position::line);
    let said = match error.kind() {
        csv::ErrorKind::UnequalLengths {
            expected_len, len, ..
        } => format!("fields: {len}, in the header {expected_len}; correct or remove the line"),
        _ => error.to_string(),
    };
    Failure::Input(format!("{name}: line {line}: {said}"))
}

/// One row, to read fields from. Its places are those of the header.
struct Row<'a> {
    name: &'a str,
    line: u64,
    header: &'a ByteRecord,
    record: &'a ByteRecord,
    decimal_comma: bool,
}

impl Row<'_> {
    fn wrong(&self, place: usize, what: &str) -> Failure {
        Failure::Input(format!(
            "{}: line {}: column {}: {what}",
            self.name,
            self.line,
            text(self.header, place)
        ))
    }

    fn number(&self, place: usize) -> Result<f64, Failure> {
        let text = text(self.record, place);
        let number = text.parse().ok().or_else(|| match self.decimal_comma {
            true => text.replacen(',', ".", 1).parse().ok(),
            false => None,
        });
        let number = number.filter(|number: &f64| number.is_finite());
        number.ok_or_else(|| {
            let short: String = text.chars().take(20).flat_map(char::escape_debug).collect();
            let said = format!("'{short}' is not a number; correct or remove the row");
            self.wrong(place, &said)
        })
    }

    fn count(&self, place: usize) -> Result<i64, Failure> {
        let number = self.number(place)?;
        if number.fract() != 0.0 || number.abs() >= 2.0_f64.powi(53) {
            return Err(self.wrong(place, &format!("{number} is not a whole number of counts")));
        }
        Ok(number as i64)
    }
}

/// A field of a line as text, without a byte order mark.
fn text(record: &ByteRecord, place: usize) -> String {
    let text = String::from_utf8_lossy(record.get(place).unwrap_or_default());
    text.trim_start_matches('\u{feff}').to_owned()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn columns_are_found_by_name_and_optional_ones_may_be_missing() {
        let text = b"note,fine_count,time_s\nx,-5,0\ny,7,0.5\nz,8,1.0\nw,9,1.5\n";
        let fine = Fine::parse(text, "f.csv", 1.0).unwrap();
        assert_eq!((fine.t, fine.counts), (vec![0.0, 0.5, 1.0], vec![-5, 7, 8]));
        assert_eq!((fine.torque, fine.omega), (None, None));
        assert_eq!(fine.count_column, "fine_count");
        let text = b"t,counts_large,true_omega,motor_torque_nm\n0,1,2.5,-0.5\n1,2,3.5,0.25\n";
        let fine = Fine::parse(text, "f.csv", 9.0).unwrap();
        assert_eq!(fine.omega, Some(vec![2.5, 3.5]));
        assert_eq!(fine.torque, Some(vec![-0.5, 0.25]));
    }

    #[test]
    fn invalid_file_is_reported_by_line_and_column() {
        for (text, said) in [
            (
                "fine_count\n1\n",
                "f.csv: line 1: no column time_s; name the column time_s or t",
            ),
            ("t\n1\n", "f.csv: line 1: no column fine_count;"),
            (
                "t,time_s,fine_count\n",
                "f.csv: line 1: two columns time_s or t;",
            ),
            (
                "t,fine_count\n0,1\n0,2\n",
                "f.csv: line 3: column t: 0 s is not after the 0 s above it; correct",
            ),
            (
                "t,fine_count\n0,1\n1,1.5\n",
                "f.csv: line 3: column fine_count: 1.5 is not a whole",
            ),
            (
                "t,fine_count\n0,one\n",
                "f.csv: line 2: column fine_count: 'one' is not a number",
            ),
            (
                "t,counts_large\n0,nan\n",
                "f.csv: line 2: column counts_large: 'nan' is not a number; correct or remove the row",
            ),
            (
                "# note\nt,fine_count,true_omega\n0,1,x\n",
                "f.csv: line 3: column true_omega: 'x' is not a number",
            ),
            (
                "t,fine_count\n0,1\n1\n",
                "f.csv: line 3: fields: 1, in the header 2; correct or remove the line",
            ),
            ("t,fine_count\n0,1\n", "f.csv: fewer than two rows"),
        ] {
            let error = Fine::parse(text.as_bytes(), "f.csv", 1.0)
                .unwrap_err()
                .to_string();
            assert!(error.starts_with(said), "{error}");
        }
    }

    #[test]
    fn fields_are_separated_by_commas_semicolons_or_tabs() {
        let text = "# a, b\nt;counts_large;motor_torque_nm\n0;-5;0,5\n0,25;7;-1.5\n";
        for text in [
            text.to_owned(),
            text.replace(';', "\t"),
            text.replacen('t', "\"t\"", 1),
        ] {
            let fine = Fine::parse(text.as_bytes(), "f.csv", 9.0).unwrap();
            assert_eq!((fine.t, fine.counts), (vec![0.0, 0.25], vec![-5, 7]));
            assert_eq!(fine.torque, Some(vec![0.5, -1.5]));
        }
        let error = Fine::parse(b"t,counts_large\n0,5,1\n", "f.csv", 9.0);
        assert!(error.is_err());
    }

    #[test]
    fn times_are_those_from_the_first_row() {
        let text = b"t,fine_count\n1700000000,1\n1700000000.5,2\n1700000001,3\n1700000003.5,3\n1700000004,3\n";
        let fine = Fine::parse(text, "f.csv", 3.5).unwrap();
        assert_eq!(fine.t, [0.0, 0.5, 1.0, 3.5]);
        assert_eq!(fine.start, 1.7e9);
        assert_eq!(fine.gaps(1.0), Some((1, [2.5, 1_700_000_003.5])));
    }

    #[test]
    fn counter_of_32_bits_goes_on_where_it_wraps() {
        let text = b"t,counts_large\n0,4294967290\n1,2\n2,4294967295\n";
        let fine = Fine::parse(text, "f.csv", 9.0).unwrap();
        assert_eq!(fine.counts, [4294967290, 4294967298, 4294967295]);
    }

    #[test]
    fn gaps_are_longer_than_usual_and_than_a_tick() {
        let t = |gap: f64| (0..10).map(move |k| f64::from(k) + if k > 5 { gap } else { 0.0 });
        let gaps = |gap: f64, period_s: f64| {
            let fine = Fine {
                t: t(gap).collect(),
                ..Fine::default()
            };
            fine.gaps(period_s)
        };
        assert_eq!(gaps(0.0, 1.0), None);
        assert_eq!(gaps(2.0, 1.0), Some((1, [3.0, 8.0])));
        assert_eq!(gaps(2.0, 2.0), None);
    }
}
