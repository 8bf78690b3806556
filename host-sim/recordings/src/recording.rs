//! Recordings of a motor, read from CSV.

mod absolute;
mod board;
mod clock;
mod header;
mod write;

use std::fs::File;
use std::io::{BufReader, Read};
use std::path::Path;

use csv::ByteRecord;

pub use board::BoardColumns;

use simulation::trace::{EDGE_CLOCK_HZ, EdgeStamp, Trace};
use terminal::failure::Failure;

/// A recording: its time column, and the other columns as a trace.
#[derive(Clone, Debug)]
pub struct Recording {
    /// Column `t`, s.
    pub t: Vec<f64>,
    /// The columns as a trace; its rate follows from the steps of `t` near their median.
    pub trace: Trace,
    /// The small motor's commanded current, applied from this tick to the next, A.
    pub current_small: Option<Vec<f64>>,
    /// Number of steps of `t` that differ from the period by more than a tenth of it.
    pub uneven_steps: usize,
}

/// The columns that are read; others are ignored.
const COLUMNS: [&str; 8] = [
    "t",
    "counts_large",
    "counts_small",
    "current",
    "current_small",
    "edge_tick",
    "edge_bound",
    "true_omega",
];

impl Recording {
    /// Reads a CSV file.
    ///
    /// # Errors
    /// [`Failure::Input`], one line that names file, line and column.
    pub fn read(path: &Path) -> Result<Self, Failure> {
        let name = path.display().to_string();
        let file = File::open(path)
            .map_err(|error| Failure::Input(format!("{name}: cannot read: {error}")))?;
        Self::parse(BufReader::new(file), &name)
    }

    /// Reads CSV text called `name` in messages.
    ///
    /// # Errors
    /// As [`Recording::read`].
    pub fn parse(input: impl Read, name: &str) -> Result<Self, Failure> {
        let mut reader = csv::ReaderBuilder::new()
            .trim(csv::Trim::All)
            .from_reader(input);
        let at = Places::find(
            reader.byte_headers().map_err(|e| csv_failure(name, &e))?,
            name,
        )?;
        let mut columns = Columns::default();
        let mut record = ByteRecord::new();
        let mut last = f64::NEG_INFINITY;
        while reader
            .read_byte_record(&mut record)
            .map_err(|e| csv_failure(name, &e))?
        {
            let line = record.position().map_or(0, csv::Position::line);
            let row = Row {
                name,
                line,
                record: &record,
            };
            let t = row.number("t", at.t)?;
            if t < last {
                return Err(row.failure("t", &format!("{t} s is before the {last} s above it")));
            }
            last = t;
            columns.t.push(t);
            columns.take(&row, &at)?;
        }
        columns.into_recording(name, &at)
    }
}

/// Index of each column in a row.
struct Places {
    t: usize,
    counts_large: usize,
    counts_small: Option<usize>,
    current: Option<usize>,
    current_small: Option<usize>,
    edge: Option<[usize; 2]>,
    true_omega: Option<usize>,
}

impl Places {
    fn find(header: &ByteRecord, name: &str) -> Result<Self, Failure> {
        let mut places = [None; COLUMNS.len()];
        for (i, field) in header.iter().enumerate() {
            let field = header::field(field);
            let Some(column) = COLUMNS.iter().position(|c| c.as_bytes() == field) else {
                continue;
            };
            if places[column].replace(i).is_some() {
                let message = format!(
                    "{name}: line 1: two columns {}; rename or remove one",
                    COLUMNS[column]
                );
                return Err(Failure::Input(message));
            }
        }
        let [
            t,
            counts_large,
            counts_small,
            current,
            current_small,
            edge_tick,
            edge_bound,
            true_omega,
        ] = places;
        let needed = |place: Option<usize>, column: &str| {
            place.ok_or_else(|| header::missing(column, header, name))
        };
        Ok(Self {
            t: needed(t, "t")?,
            counts_large: needed(counts_large, "counts_large")?,
            counts_small,
            current,
            current_small,
            edge: match (edge_tick, edge_bound) {
                (Some(tick), Some(bound)) => Some([tick, bound]),
                (None, None) => None,
                (Some(_), None) => return Err(needed(None, "edge_bound").unwrap_err()),
                (None, Some(_)) => return Err(needed(None, "edge_tick").unwrap_err()),
            },
            true_omega,
        })
    }
}

/// One row, to read fields from.
struct Row<'a> {
    name: &'a str,
    line: u64,
    record: &'a ByteRecord,
}

impl Row<'_> {
    fn failure(&self, column: &str, what: &str) -> Failure {
        Failure::Input(format!(
            "{}: line {}: column {column}: {what}",
            self.name, self.line
        ))
    }

    fn text(&self, column: &str, place: usize) -> Result<&str, Failure> {
        let bytes = self.record.get(place).unwrap_or_default();
        std::str::from_utf8(bytes).map_err(|_| self.failure(column, "not text"))
    }

    fn number(&self, column: &str, place: usize) -> Result<f64, Failure> {
        let text = self.text(column, place)?;
        match text.parse::<f64>() {
            Ok(number) if number.is_finite() => Ok(number),
            _ => Err(self.failure(column, &format!("{} is not a number", quoted(text)))),
        }
    }

    /// A whole number, modulo 2^32.
    fn count(&self, column: &str, place: usize) -> Result<u32, Failure> {
        let text = self.text(column, place)?;
        if let Ok(count) = text.parse::<i64>() {
            return Ok(count as u32);
        }
        // Some tools write integers as floats: 12.0.
        match text.parse::<f64>() {
            Ok(number) if number.fract() == 0.0 && number.abs() < 9e15 => Ok(number as i64 as u32),
            Ok(number) if number.is_finite() => {
                Err(self.failure(column, &format!("{number} is not a whole number of counts")))
            }
            _ => Err(self.failure(column, &format!("{} is not a number", quoted(text)))),
        }
    }
}

/// A field for a message: shortened, without control characters.
fn quoted(text: &str) -> String {
    let short: String = text.chars().take(20).flat_map(char::escape_debug).collect();
    format!("'{short}'")
}

fn csv_failure(name: &str, error: &csv::Error) -> Failure {
    let line = error.position().map_or(1, csv::Position::line);
    let what = match error.kind() {
        csv::ErrorKind::UnequalLengths {
            expected_len, len, ..
        } => format!("{len} fields where the first line has {expected_len}"),
        csv::ErrorKind::Io(error) => format!("cannot read: {error}"),
        _ => error.to_string(),
    };
    Failure::Input(format!("{name}: line {line}: {what}"))
}

#[derive(Default)]
struct Columns {
    t: Vec<f64>,
    counts_large: Vec<u32>,
    counts_small: Vec<u32>,
    current: Vec<f64>,
    current_small: Vec<f64>,
    edges: Vec<Option<EdgeStamp>>,
    true_omega: Vec<f64>,
}

impl Columns {
    /// Adds the fields of a row except `t`.
    fn take(&mut self, row: &Row, at: &Places) -> Result<(), Failure> {
        self.counts_large
            .push(row.count("counts_large", at.counts_large)?);
        if let Some(place) = at.counts_small {
            self.counts_small.push(row.count("counts_small", place)?);
        }
        if let Some(place) = at.current {
            self.current.push(row.number("current", place)?);
        }
        if let Some(place) = at.current_small {
            self.current_small.push(row.number("current_small", place)?);
        }
        if let Some([tick, bound]) = at.edge {
            self.edges.push(self.edge(row, tick, bound)?);
        }
        if let Some(place) = at.true_omega {
            self.true_omega.push(row.number("true_omega", place)?);
        }
        Ok(())
    }

    /// The latest edge; `None` if both fields are empty, before the first edge.
    fn edge(&self, row: &Row, tick: usize, bound: usize) -> Result<Option<EdgeStamp>, Failure> {
        if row.text("edge_tick", tick)?.is_empty() && row.text("edge_bound", bound)?.is_empty() {
            return Ok(None);
        }
        let now = self.t.last().copied().unwrap_or_default();
        let age_s = now - row.number("edge_tick", tick)? / EDGE_CLOCK_HZ;
        Ok(Some(EdgeStamp {
            // `t` has fewer digits than the stamp, so an edge at the tick can appear after it.
            age_s: age_s.max(0.0),
            boundary: row.count("edge_bound", bound)?,
        }))
    }

    fn into_recording(self, name: &str, at: &Places) -> Result<Recording, Failure> {
        let (rate_hz, uneven_steps) = clock::rate(&self.t, name)?;
        Ok(Recording {
            uneven_steps,
            t: self.t,
            current_small: at.current_small.is_some().then_some(self.current_small),
            trace: Trace {
                rate_hz,
                counts_large: self.counts_large,
                counts_small: at.counts_small.is_some().then_some(self.counts_small),
                current: at.current.is_some().then_some(self.current),
                edges: at.edge.is_some().then_some(self.edges),
                true_omega: at.true_omega.is_some().then_some(self.true_omega),
                true_damping: None,
            },
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn parse(text: &str) -> Result<Recording, String> {
        Recording::parse(text.as_bytes(), "r.csv").map_err(|failure| failure.to_string())
    }

    #[test]
    fn columns_are_found_by_name_in_any_order() {
        let text =
            "note,counts_large, t ,true_omega\nx,-1,0.0,1.5\ny,4294967296,0.001,2\nz,2,0.002,3\n";
        let recording = parse(text).unwrap();
        assert_eq!(recording.trace.rate_hz, 1000.0);
        assert_eq!(recording.trace.counts_large, [u32::MAX, 0, 2]);
        assert_eq!(recording.trace.true_omega, Some(vec![1.5, 2.0, 3.0]));
        assert_eq!(recording.trace.current, None);
        assert_eq!(recording.uneven_steps, 0);
    }

    #[test]
    fn counts_written_as_floats_are_read() {
        let text =
            "t,counts_large\n0,-3.0\n0.001,1e3\n0.002,-2.5e1\n0.003,4294967295.0\n0.004,+7\n";
        let counts = parse(text).unwrap().trace.counts_large;
        let expected = [-3, 1000, -25, -1, 7].map(|count: i32| count as u32);
        assert_eq!(counts, expected);
        for fraction in ["-3.5", "1e-3", "0.25e1"] {
            let error = parse(&format!("t,counts_large\n0,0\n0.001,{fraction}\n")).unwrap_err();
            let said = "r.csv: line 3: column counts_large: ";
            assert!(error.starts_with(said), "{error}");
            assert!(
                error.ends_with("is not a whole number of counts"),
                "{error}"
            );
        }
    }

    #[test]
    fn edge_columns_are_converted_to_ages() {
        let text =
            "t,counts_large,edge_tick,edge_bound\n0,0,,\n0.001,0,42000,-3\n0.002,1,168001,1\n";
        let edges = parse(text).unwrap().trace.edges.unwrap();
        assert_eq!(edges[0], None);
        let edge = edges[1].unwrap();
        assert!((edge.age_s - 500e-6).abs() < 1e-12);
        assert_eq!(edge.boundary, (-3_i32) as u32);
        assert_eq!(edges[2].unwrap().age_s, 0.0);
    }

    #[test]
    fn invalid_field_is_reported_by_line_and_column() {
        for (text, said) in [
            ("", "r.csv: line 1: no column t;"),
            (
                "t,counts_small\n0,0\n",
                "r.csv: line 1: no column counts_large;",
            ),
            ("t,counts_large,t\n", "r.csv: line 1: two columns t;"),
            (
                "t,counts_large,edge_tick\n0,0,0\n",
                "r.csv: line 1: no column edge_bound;",
            ),
            (
                "t,counts_large\n0,0\n0.1,one\n",
                "r.csv: line 3: column counts_large: 'one' is not a number",
            ),
            (
                "t,counts_large\n0,0\n0.1,\n",
                "r.csv: line 3: column counts_large: '' is not a number",
            ),
            (
                "t,counts_large\n0,0\nNaN,1\n",
                "r.csv: line 3: column t: 'NaN' is not a number",
            ),
            (
                "t,counts_large\n0,0\n0.1,1.5\n",
                "r.csv: line 3: column counts_large: 1.5 is not a whole",
            ),
            (
                "t,counts_large\n0,0\n0.2,1\n0.1,2\n",
                "r.csv: line 4: column t: 0.1 s is before the 0.2 s",
            ),
            (
                "t,counts_large\n0,0\n0.1\n",
                "r.csv: line 3: 1 fields where the first line has 2",
            ),
            ("t,counts_large\n0,0\n", "r.csv: fewer than two rows"),
            (
                "t,counts_large\n1,0\n1,0\n1,0\n",
                "r.csv: column t: does not increase",
            ),
            (
                "t,counts_large,current\n0,0,inf\n",
                "r.csv: line 2: column current: 'inf' is not a number",
            ),
        ] {
            let error = parse(text).unwrap_err();
            assert!(error.starts_with(said), "{text:?}: {error}");
        }
    }
}
