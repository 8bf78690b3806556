//! The rows of a log, in any layout.

pub(super) mod json;
pub(super) mod kinds;
pub(super) mod labelled;
pub(super) mod long;
pub(super) mod named_fields;
mod nuls;
pub(super) mod value_changes;

use std::io::{BufReader, Cursor, Read};

use csv::ByteRecord;

use terminal::failure::Failure;

use crate::log::{HEAD, cannot_read};

use super::layout::{Layout, is_stamped};
use super::options::ReadOptions;
use super::text::Text;
use super::text::lines::LINE_REMEDY;
use super::text::row::Row;
use json::Json;
use labelled::Labelled;
use long::Long;
use value_changes::ValueChanges;

const BYTE_ORDER_MARK: &[u8] = b"\xEF\xBB\xBF";

type Input<'a> = BufReader<Box<dyn Read + 'a>>;

enum Source<'a> {
    Text(Text<Input<'a>>),
    Json(Json<Input<'a>>),
    Labelled(Labelled<Input<'a>>),
    Long(Box<Long<Input<'a>>>),
    ValueChanges(Box<ValueChanges<Input<'a>>>),
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
        input: impl Read + 'a,
        name: &'a str,
        options: &ReadOptions,
    ) -> Result<Self, Failure> {
        Self::open_layout(input, name, options, false)
    }

    /// As [`Records::open`]; `is_arranged` is true for the rows of JSON that had another layout.
    fn open_layout(
        mut input: impl Read + 'a,
        name: &'a str,
        options: &ReadOptions,
        is_arranged: bool,
    ) -> Result<Self, Failure> {
        let mut head = Vec::new();
        let read = input.by_ref().take(HEAD).read_to_end(&mut head);
        read.map_err(|error| cannot_read(name, &error))?;
        kinds::check(&head, name)?;
        let is_cut = head.len() as u64 == HEAD;
        let nul = nuls::line(&head);
        if nul.is_some() {
            head.retain(|byte| *byte != 0);
        }
        if head.starts_with(BYTE_ORDER_MARK) {
            head.drain(..BYTE_ORDER_MARK.len());
        }
        // Lines end with a carriage return alone only where there is no line feed.
        let end = if head.contains(&b'\n') { b'\n' } else { b'\r' };
        let text = String::from_utf8_lossy(&head).replace(char::from(end), "\n");
        let is_cut_line = is_cut && !text.contains('\n');
        let input: Box<dyn Read> = match nul {
            None => Box::new(Cursor::new(head).chain(input)),
            Some(_) => Box::new(Cursor::new(head).chain(nuls::Without(input))),
        };
        let input = BufReader::with_capacity(1 << 16, input);
        if let Some(other) = json::Other::of(&text).filter(|_| !is_arranged) {
            let rows = other.rows(input, end, name)?;
            return Self::open_layout(rows, name, options, true);
        }
        let named = |names: &[String], line| Layout {
            line,
            is_stamped: is_stamped(&text),
            ..Layout::named_values(names.to_vec())
        };
        let (layout, source) = if value_changes::is_begin(&text) {
            let (changes, layout) = ValueChanges::open(input, name)?;
            (layout, Source::ValueChanges(Box::new(changes)))
        } else if let Some(begin) = json::Begin::of(&text, name)? {
            let layout = Layout {
                seen: begin.seen.clone(),
                moments: begin.moments.clone(),
                since_1970: begin.since_1970.clone(),
                ..named(&begin.names, begin.line)
            };
            (layout, Source::Json(Json::new(input, end, &begin)))
        } else if let Some(begin) = labelled::Begin::of(&text) {
            let layout = begin.told(named(&begin.names, begin.line));
            (layout, Source::Labelled(Labelled::new(input, end, &begin)))
        } else if let Some(begin) = long::Begin::of(&text, options) {
            let layout = begin.layout.clone();
            (
                layout,
                Source::Long(Box::new(Long::new(input, end, begin, name)?)),
            )
        } else if is_cut_line {
            return Err(Failure::Input(format!(
                "{name}: line 1: no end of the line within {} KiB; {LINE_REMEDY}",
                HEAD >> 10
            )));
        } else {
            let layout = Layout::of(&text, is_cut, options);
            let rows = Text::new(input, end, &layout, layout.names.len());
            (layout, Source::Text(rows))
        };
        Ok(Self {
            name,
            source,
            layout: Layout { nul, ..layout },
            record: ByteRecord::new(),
        })
    }

    /// The next row.
    pub(super) fn next(&mut self) -> Result<Option<Row<'_>>, Failure> {
        let line = match &mut self.source {
            Source::Json(json) => json.read(&mut self.record, self.name)?,
            Source::Labelled(rows) => rows.read(&mut self.record, self.name)?,
            Source::Long(rows) => rows.read(&mut self.record, self.name)?,
            Source::Text(rows) => rows.read(&mut self.record, self.name)?,
            Source::ValueChanges(changes) => changes.read(&mut self.record, self.name)?,
        };
        let Some(line) = line else {
            return Ok(None);
        };
        Ok(Some(Row {
            name: self.name,
            line,
            record: &self.record,
            is_cut: match &self.source {
                // A cut object or command is refused.
                Source::Json(_) | Source::ValueChanges(_) => false,
                Source::Labelled(rows) => rows.is_cut(line),
                Source::Long(rows) => rows.is_cut,
                Source::Text(rows) => rows.is_cut(line),
            },
            marks: match &self.source {
                Source::Json(json) => &json.places.marks,
                Source::Labelled(rows) => &rows.places.marks,
                Source::Long(rows) => &rows.places.marks,
                Source::Text(_) | Source::ValueChanges(_) => &[],
            },
            names: &self.layout.names,
            is_first: self.layout.has_header() && line == self.layout.line + 1,
            decimal_comma: self.layout.separator.allows_decimal_comma(),
        }))
    }
}
