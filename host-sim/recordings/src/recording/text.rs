//! Rows of fields with separators.

pub(super) mod fields;
pub(super) mod lines;
pub(super) mod prefixed;
pub(super) mod row;
pub(super) mod row_ends;
pub(super) mod separator;
pub(super) mod thousands;

use std::io::BufRead;

use csv::{ByteRecord, Reader, ReaderBuilder};

use terminal::failure::Failure;

use super::layout::{Layout, is_number};
use separator::{Lines, Separator};

/// Bytes and lines of a row from which a quote is taken as one that has no end.
const QUOTED: usize = 256;
const QUOTED_LINES: usize = 20;

/// Rows that are looked at below one with another number of fields, and fewest that tell.
const LOOKED_AT: usize = 100;
const FEWEST: usize = 10;

/// A line that some programs write behind the last row.
const END_OF_FILE: &[u8] = b"EOF";

/// Reads rows with as many fields as there are columns.
pub(super) struct Text<R> {
    reader: Reader<Lines<R>>,
    separator: Separator,
    /// Line of the header; 0 without one.
    header: u64,
    /// Line of the first row of a text without a header.
    first_row: u64,
    columns: usize,
    /// Whether one more field may end a row.
    remarks: bool,
    /// Whether a row may lack its last fields.
    ends_early: bool,
}

impl<R: BufRead> Text<R> {
    pub(super) fn new(inner: R, end: u8, layout: &Layout, columns: usize) -> Self {
        Self {
            reader: ReaderBuilder::new()
                .has_headers(false)
                .flexible(true)
                .delimiter(layout.separator.byte())
                .from_reader(Lines::of(inner, layout, end)),
            separator: layout.separator,
            header: layout.line,
            first_row: layout.skip + 1,
            columns,
            remarks: layout.remarks,
            ends_early: layout.ends_early,
        }
    }

    /// Whether the row in `line` may be cut: no end of line follows it.
    pub(super) fn is_cut(&self, line: u64) -> bool {
        self.reader.get_ref().cut() == Some(line)
    }

    /// Reads the next row into `record` and returns its line.
    pub(super) fn read(
        &mut self,
        record: &mut ByteRecord,
        name: &str,
    ) -> Result<Option<u64>, Failure> {
        let mut is_end = true;
        let mut read = false;
        while is_end {
            read = self.reader.read_byte_record(record).map_err(|error| {
                let line = error.position().map(|at| format!("line {}: ", at.line()));
                let line = line.unwrap_or_default();
                Failure::Input(format!("{name}: {line}cannot read: {error}"))
            })?;
            is_end = read && self.columns > 1 && record.len() == 1 && is_no_row(&record[0]);
        }
        // The reader is at the begin of the next line.
        let line = read.then(|| self.reader.position().line() - 1);
        closed(record, line, name)?;
        let Some(line) = line else {
            return Ok(None);
        };
        let (fields, columns) = (record.len(), self.columns);
        let may_end =
            fields == columns + 1 && (self.remarks || record[columns].trim_ascii().is_empty());
        // The log ends in the middle of a row.
        let is_begin = fields < columns && (self.ends_early || self.is_cut(line));
        match fields == columns || may_end || is_begin {
            true => Ok(Some(line)),
            false => Err(Failure::Input(self.ragged(line, record, name))),
        }
    }

    /// Whether most of the next rows have this number of `fields`.
    fn are_alike(&mut self, fields: usize) -> bool {
        let mut record = ByteRecord::new();
        let (mut alike, mut below) = (0, 0);
        while below < LOOKED_AT && self.reader.read_byte_record(&mut record).unwrap_or(false) {
            alike += usize::from(record.len() == fields);
            below += 1;
        }
        below >= FEWEST && 10 * alike >= 9 * below
    }

    fn ragged(&mut self, line: u64, record: &ByteRecord, name: &str) -> String {
        let (fields, columns) = (record.len(), self.columns);
        let has_number = record.iter().any(|field| {
            let field = String::from_utf8_lossy(field);
            is_number(field.trim(), self.separator)
        });
        let model = match self.header {
            0 => format!("the first row, in line {},", self.first_row),
            1 => "the first line".to_owned(),
            line => format!("the header in line {line}"),
        };
        let noun = if fields == 1 { "field" } else { "fields" };
        if self.are_alike(fields) {
            let remedy = match self.header {
                0 => "remove that line",
                _ => "write one name for each field, or remove the lines above that are no rows",
            };
            return format!(
                "{name}: line {line}: {fields} {noun}, as in the lines below, where {model} has {columns}; {remedy}"
            );
        }
        let remedy = match (self.header, fields > columns) {
            _ if !has_number => {
                "it has no number: if another table begins there, cut the log there, else remove the line"
            }
            (0, _) => "one of these lines is cut, or is two rows run together: remove it",
            (_, false) => "remove the line if the log was cut there",
            (_, true) => "remove the line if two rows run together there",
        };
        let commas = match self.separator == Separator::Comma && fields > columns {
            true => "; numbers with a decimal comma need another separator than a comma",
            false => "",
        };
        format!(
            "{name}: line {line}: {fields} {noun} where {model} has {columns}; {remedy}{commas}"
        )
    }
}

/// Whether the only field of a line of a table is that of no row: the end of the file, or quotes around nothing, as Python
/// writes a row of an empty text.
fn is_no_row(field: &[u8]) -> bool {
    field == END_OF_FILE || field.trim_ascii().is_empty()
}

/// Checks that the quotes of `record`, which ends in `line`, end near where they begin.
///
/// # Errors
/// [`Failure::Input`] with the line of the quote.
fn closed(record: &ByteRecord, line: Option<u64>, name: &str) -> Result<(), Failure> {
    if record.as_slice().len() < QUOTED {
        return Ok(());
    }
    // The end of the last line is in the field too where the quote has no end.
    let text = record.as_slice();
    let text = text.strip_suffix(b"\n").unwrap_or(text);
    let ends = text.iter().filter(|byte| **byte == b'\n').count();
    match ends > QUOTED_LINES {
        false => Ok(()),
        true => Err(Failure::Input(format!(
            "{name}: line {}: a quote (\") begins a field that has no end within {QUOTED_LINES} lines; close \
             it, or remove it",
            line.unwrap_or_default().saturating_sub(ends as u64)
        ))),
    }
}
