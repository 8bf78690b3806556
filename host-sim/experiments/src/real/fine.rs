//! Recordings of a fine encoder, read from CSV.

use std::io::Read;
use std::path::Path;

use csv::ByteRecord;
use flate2::read::MultiGzDecoder;

use terminal::failure::Failure;

/// Columns that are read, each with the names under which it is found; others are ignored.
const COLUMNS: [(&str, &[&str]); 4] = [
    ("time_s", &["time_s", "t"]),
    ("fine_count", &["fine_count", "counts_large"]),
    ("motor_torque_nm", &["motor_torque_nm"]),
    ("true_omega_rad_s", &["true_omega_rad_s", "true_omega"]),
];

/// Position of a shaft as a fine encoder saw it. Times need not be even.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Fine {
    /// Time of each row, s, rising.
    pub t: Vec<f64>,
    /// Counts of the fine encoder.
    pub counts: Vec<i64>,
    /// Torque of the motor from a row to the next one, N.m; `None` without column
    /// `motor_torque_nm`.
    pub torque: Option<Vec<f64>>,
    /// True velocity at each row, rad/s; `None` without column `true_omega_rad_s`.
    pub omega: Option<Vec<f64>>,
}

/// The bytes of a file, decompressed if they are those of gzip.
///
/// # Errors
/// [`Failure::Input`] that calls the file `name`.
pub fn decompressed(bytes: Vec<u8>, name: &str) -> Result<Vec<u8>, Failure> {
    if !bytes.starts_with(&[0x1f, 0x8b]) {
        return Ok(bytes);
    }
    let mut text = Vec::new();
    let read = MultiGzDecoder::new(bytes.as_slice()).read_to_end(&mut text);
    read.map_err(|error| Failure::Input(format!("{name}: not a complete gzip file: {error}")))?;
    Ok(text)
}

impl Fine {
    /// Reads the first `seconds` of a CSV file, which may be compressed by gzip.
    ///
    /// # Errors
    /// [`Failure::Input`], one line that names file, line and column.
    pub fn read(path: &Path, seconds: f64) -> Result<Self, Failure> {
        let name = path.display().to_string();
        let bytes = std::fs::read(path)
            .map_err(|error| Failure::Input(format!("{name}: cannot read: {error}")))?;
        Self::parse(&decompressed(bytes, &name)?, &name, seconds)
    }

    /// Reads the first `seconds` of CSV text called `name` in messages.
    ///
    /// # Errors
    /// As [`Fine::read`].
    pub fn parse(text: &[u8], name: &str, seconds: f64) -> Result<Self, Failure> {
        let failed = |error: &csv::Error| {
            let line = error.position().map_or(1, csv::Position::line);
            Failure::Input(format!("{name}: line {line}: {error}"))
        };
        let mut reader = csv::ReaderBuilder::new()
            .trim(csv::Trim::All)
            .from_reader(text);
        let places = places(reader.byte_headers().map_err(|e| failed(&e))?, name)?;
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
            ..Self::default()
        };
        let mut record = ByteRecord::new();
        while reader
            .read_byte_record(&mut record)
            .map_err(|e| failed(&e))?
        {
            let line = record.position().map_or(0, csv::Position::line);
            let row = Row {
                name,
                line,
                record: &record,
            };
            let t: f64 = row.number(0, time)?;
            if let Some(last) = fine.t.last().filter(|last| t <= **last) {
                return Err(row.wrong(0, &format!("{t} s is not after the {last} s above it")));
            }
            fine.t.push(t);
            fine.counts.push(row.count(1, count)?);
            for (values, column, place) in
                [(&mut fine.torque, 2, torque), (&mut fine.omega, 3, omega)]
            {
                if let (Some(values), Some(place)) = (values, place) {
                    values.push(row.number(column, place)?);
                }
            }
            if t - fine.t[0] >= seconds {
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

    /// Mean rate of the rows, Hz.
    #[must_use]
    pub fn mean_rate_hz(&self) -> f64 {
        let last = self.t.len() - 1;
        last as f64 / (self.t[last] - self.t[0])
    }
}

/// Index of each column of [`COLUMNS`].
fn places(header: &ByteRecord, name: &str) -> Result<[Option<usize>; COLUMNS.len()], Failure> {
    let mut places = [None; COLUMNS.len()];
    for (i, field) in header.iter().enumerate() {
        let field = field.strip_prefix(b"\xef\xbb\xbf").unwrap_or(field);
        let is_known = |(_, names): &(&str, &[&str])| names.iter().any(|n| n.as_bytes() == field);
        let Some(column) = COLUMNS.iter().position(is_known) else {
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

/// One row, to read fields from.
struct Row<'a> {
    name: &'a str,
    line: u64,
    record: &'a ByteRecord,
}

impl Row<'_> {
    fn wrong(&self, column: usize, what: &str) -> Failure {
        let column = COLUMNS[column].0;
        Failure::Input(format!(
            "{}: line {}: column {column}: {what}",
            self.name, self.line
        ))
    }

    fn text(&self, place: usize) -> String {
        String::from_utf8_lossy(self.record.get(place).unwrap_or_default()).into_owned()
    }

    fn number(&self, column: usize, place: usize) -> Result<f64, Failure> {
        let text = self.text(place);
        let number = text.parse().ok().filter(|number: &f64| number.is_finite());
        number.ok_or_else(|| {
            let short: String = text.chars().take(20).flat_map(char::escape_debug).collect();
            self.wrong(column, &format!("'{short}' is not a number"))
        })
    }

    fn count(&self, column: usize, place: usize) -> Result<i64, Failure> {
        let number = self.number(column, place)?;
        if number.fract() != 0.0 || number.abs() >= 2.0_f64.powi(53) {
            return Err(self.wrong(column, &format!("{number} is not a whole number of counts")));
        }
        Ok(number as i64)
    }
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
                "f.csv: line 3: column time_s: 0 s is not after",
            ),
            (
                "t,fine_count\n0,1\n1,1.5\n",
                "f.csv: line 3: column fine_count: 1.5 is not a whole",
            ),
            (
                "t,fine_count\n0,one\n",
                "f.csv: line 2: column fine_count: 'one' is not a number",
            ),
            ("t,fine_count\n0\n", "f.csv: line 2: "),
            ("t,fine_count\n0,1\n", "f.csv: fewer than two rows"),
        ] {
            let error = Fine::parse(text.as_bytes(), "f.csv", 1.0)
                .unwrap_err()
                .to_string();
            assert!(error.starts_with(said), "{error}");
        }
    }

    #[test]
    fn incomplete_gzip_is_refused_and_plain_text_is_kept() {
        assert_eq!(decompressed(b"t,x\n".to_vec(), "f").unwrap(), b"t,x\n");
        let error = decompressed(vec![0x1f, 0x8b, 8, 0], "f.gz").unwrap_err();
        assert!(
            error
                .to_string()
                .starts_with("f.gz: not a complete gzip file: ")
        );
    }
}
