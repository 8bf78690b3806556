//! The rows of a log: text with separators, one JSON object a line, or numbers with their names.

use std::io::{BufReader, Cursor, Read};

use csv::ByteRecord;

use terminal::failure::Failure;

use crate::log::{HEAD, cannot_read};

use super::json::{self, Json};
use super::kinds;
use super::labelled::{self, Labelled};
use super::layout::{Layout, is_stamped};
use super::lines::LINE_REMEDY;
use super::options::ReadOptions;
use super::row::Row;
use super::separator::{Lines, Separator};

/// Bytes and lines of a row from which a quote is taken as one that has no end.
const QUOTED: usize = 256;
const QUOTED_LINES: usize = 20;

const BYTE_ORDER_MARK: &[u8] = b"\xEF\xBB\xBF";

type Input<'a> = BufReader<Box<dyn Read + 'a>>;

enum Source<'a> {
    Text(csv::Reader<Lines<Input<'a>>>),
    Json(Json<Input<'a>>),
    Labelled(Labelled<Input<'a>>),
}

/// The rows of the log called `name` in messages.
pub(super) struct Records<'a> {
    name: &'a str,
    source: Source<'a>,
    pub(super) layout: Layout,
    record: ByteRecord,
}

impl<'a> Records<'a> {
    /// Reads the begin of a log.
    pub(super) fn open(
        mut input: impl Read + 'a,
        name: &'a str,
        options: &ReadOptions,
    ) -> Result<Self, Failure> {
        let mut head = Vec::new();
        let read = input.by_ref().take(HEAD).read_to_end(&mut head);
        read.map_err(|error| cannot_read(name, &error))?;
        kinds::check(&head, name)?;
        let is_cut = head.len() as u64 == HEAD;
        if head.starts_with(BYTE_ORDER_MARK) {
            head.drain(..BYTE_ORDER_MARK.len());
        }
        // Lines end with a carriage return alone only where there is no line feed.
        let end = if head.contains(&b'\n') { b'\n' } else { b'\r' };
        let text = String::from_utf8_lossy(&head).replace(char::from(end), "\n");
        let is_cut_line = is_cut && !text.contains('\n');
        let input: Box<dyn Read> = Box::new(Cursor::new(head).chain(input));
        let input = BufReader::with_capacity(1 << 16, input);
        let named = |names: &[String], line| Layout {
            line,
            is_stamped: is_stamped(&text),
            ..Layout::header(Separator::Comma, names.to_vec(), 0)
        };
        let (layout, source) = if let Some(begin) = json::Begin::of(&text, name)? {
            let layout = named(&begin.names, begin.line);
            (layout, Source::Json(Json::new(input, end, &begin)))
        } else if let Some(begin) = labelled::Begin::of(&text) {
            let layout = named(&begin.names, begin.line);
            (layout, Source::Labelled(Labelled::new(input, end, &begin)))
        } else if is_cut_line {
            return Err(Failure::Input(format!(
                "{name}: line 1: no end of the line within {} KiB; {LINE_REMEDY}",
                HEAD >> 10
            )));
        } else {
            let layout = Layout::of(&text, is_cut, options, name)?;
            let lines = Lines::new(input, layout.separator, layout.skip, end);
            let reader = csv::ReaderBuilder::new()
                .has_headers(false)
                .flexible(true)
                .delimiter(layout.separator.byte())
                .from_reader(lines);
            (layout, Source::Text(reader))
        };
        Ok(Self {
            name,
            source,
            layout,
            record: ByteRecord::new(),
        })
    }

    /// The next row.
    pub(super) fn next(&mut self) -> Result<Option<Row<'_>>, Failure> {
        let line = match &mut self.source {
            Source::Json(json) => json.read(&mut self.record, self.name)?,
            Source::Labelled(rows) => rows.read(&mut self.record, self.name)?,
            Source::Text(reader) => {
                let read = reader.read_byte_record(&mut self.record);
                let read = read.map_err(|error| {
                    let line = error.position().map(|at| format!("line {}: ", at.line()));
                    let line = line.unwrap_or_default();
                    Failure::Input(format!("{}: {line}cannot read: {error}", self.name))
                })?;
                // The reader is at the begin of the next line.
                let line = read.then(|| reader.position().line() - 1);
                closed(&self.record, line, self.name)?;
                line
            }
        };
        let Some(line) = line else {
            return Ok(None);
        };
        let (fields, names) = (self.record.len(), self.layout.names.len());
        let ends_with_separator = fields == names + 1 && self.record[names].trim_ascii().is_empty();
        if fields != names && !ends_with_separator {
            return Err(Failure::Input(self.ragged(line, fields)));
        }
        Ok(Some(Row {
            name: self.name,
            line,
            record: &self.record,
            marks: match &self.source {
                Source::Json(json) => &json.places.marks,
                Source::Labelled(rows) => &rows.places.marks,
                Source::Text(_) => &[],
            },
            names: &self.layout.names,
            is_first: self.layout.has_header() && line == self.layout.line + 1,
            decimal_comma: self.layout.separator.allows_decimal_comma(),
        }))
    }

    fn ragged(&self, line: u64, fields: usize) -> String {
        let (name, names) = (self.name, self.layout.names.len());
        let model = match self.layout.line {
            0 => "the first row".to_owned(),
            1 => "the first line".to_owned(),
            line => format!("the header in line {line}"),
        };
        let commas = self.layout.separator == Separator::Comma && fields > names;
        let remedy = match commas {
            true => "; numbers with a decimal comma need another separator than a comma",
            false => "; remove the line if the log was cut there",
        };
        format!("{name}: line {line}: {fields} fields where {model} has {names}{remedy}")
    }
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
