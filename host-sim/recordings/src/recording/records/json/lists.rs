//! A JSON object with a list for each column, one row a line.

use std::borrow::Cow;
use std::fmt;
use std::io::{self, Read};
use std::ops::Range;

use serde::Deserializer as _;
use serde::de::{MapAccess, Visitor};
use serde_json::value::RawValue;
use terminal::failure::Failure;

use crate::log::cannot_read;

use super::REMEDY;
use super::fields::{name_inside, with_words};

/// Most bytes of the object, which is kept in memory.
const MOST: u64 = 1 << 28;

/// Names of the lists that pandas writes with `orient="split"`.
const SPLIT: [&str; 2] = ["columns", "data"];

/// A list of values with its name; the values are texts of JSON.
type List<'a> = (String, Vec<&'a str>);

/// Reads an object as JSON with an object a line: row k has the k-th values of its lists.
pub(super) struct Lists {
    text: Vec<u8>,
    /// `"name":`, and where in `text` the values are.
    columns: Vec<(String, Vec<Range<u32>>)>,
    row: usize,
    line: Vec<u8>,
    /// Number of bytes of `line` that are read.
    read: usize,
}

impl Lists {
    /// Reads the rest of a log called `name`, in whose line `line` the object begins. `None` if the object has no lists
    /// of at least two values.
    ///
    /// # Errors
    /// [`Failure::Input`] if it is no object, is longer than is kept in memory, or has lists of unequal length.
    pub(super) fn open(from: impl Read, line: u64, name: &str) -> Result<Option<Self>, Failure> {
        Self::open_up_to(MOST, from, line, name)
    }

    /// As [`Lists::open`], of at most `most` bytes.
    fn open_up_to(
        most: u64,
        from: impl Read,
        line: u64,
        name: &str,
    ) -> Result<Option<Self>, Failure> {
        let refused = |what: &str| Failure::Input(format!("{name}: line {line}: {what}"));
        let mut text = Vec::new();
        let read = from.take(most + 1).read_to_end(&mut text);
        read.map_err(|error| cannot_read(name, &error))?;
        if text.len() as u64 > most {
            return Err(refused(&format!(
                "a JSON object of more than {most} bytes, which is kept in memory; {REMEDY}"
            )));
        }
        if serde_json::from_slice::<&RawValue>(&text).is_err() {
            text = with_words(&text);
        }
        let columns = {
            let mut lists = Vec::new();
            let raw = serde_json::from_slice::<&RawValue>(&text);
            let found = raw.and_then(|raw| collect(String::new(), raw.get(), &mut lists));
            found.map_err(|error| {
                let all = error.to_string();
                refused(&format!("no JSON object ({all}); correct it, or {REMEDY}"))
            })?;
            let base = text.as_ptr() as usize;
            let place = |value: &&str| {
                let begin = value.as_ptr() as usize - base;
                begin as u32..(begin + value.len()) as u32
            };
            let columns = columns(lists).map_err(|what| refused(&what))?;
            let key = |name: &str| serde_json::Value::from(name).to_string();
            let places = |(name, values): List| {
                (
                    format!("{}:", key(&name)),
                    values.iter().map(place).collect(),
                )
            };
            columns.into_iter().map(places).collect::<Vec<_>>()
        };
        Ok((!columns.is_empty()).then_some(Self {
            text,
            columns,
            row: 0,
            line: Vec::new(),
            read: 0,
        }))
    }

    /// Writes the next row into `line`; nothing after the last one.
    fn advance(&mut self) {
        self.line.clear();
        self.read = 0;
        if self.row == self.columns[0].1.len() {
            return;
        }
        for (name, places) in &self.columns {
            self.line
                .push(if self.line.is_empty() { b'{' } else { b',' });
            self.line.extend(name.as_bytes());
            let Range { start, end } = places[self.row];
            let value = &self.text[start as usize..end as usize];
            self.line.extend(value.iter().map(|byte| match byte {
                b'\n' | b'\r' => b' ',
                byte => *byte,
            }));
        }
        self.line.extend(b"}\n");
        self.row += 1;
    }
}

impl Read for Lists {
    fn read(&mut self, to: &mut [u8]) -> io::Result<usize> {
        if self.read == self.line.len() {
            self.advance();
        }
        let bytes = (&self.line[self.read..]).read(to)?;
        self.read += bytes;
        Ok(bytes)
    }
}

/// Whether the object `text` has a list of at least two values.
pub(super) fn has_lists(text: &str) -> bool {
    let mut lists = Vec::new();
    let text = with_words(text.as_bytes());
    let found = serde_json::from_slice::<&RawValue>(&text)
        .and_then(|raw| collect(String::new(), raw.get(), &mut lists));
    found.is_ok() && lists.iter().any(|(_, values)| values.len() > 1)
}

/// The lists of one length among `lists`, which are the columns.
///
/// A list of lists is a column for each of their values. Shorter lists are no columns, but one with more than half of
/// the numbers lacks the others.
fn columns(lists: Vec<List>) -> Result<Vec<List>, String> {
    let rows = lists.iter().map(|(_, values)| values.len()).max();
    let rows = rows.filter(|rows| *rows > 1).unwrap_or(usize::MAX);
    let names = lists.iter().find(|(name, _)| name == SPLIT[0]);
    let names = names.map(|(_, names)| names.clone()).unwrap_or_default();
    let mut columns = Vec::new();
    for (name, values) in lists {
        if values.len() == rows {
            match values[0].starts_with('[') {
                true => columns.extend(split(&name, &values, &names)?),
                false => columns.push((name, values)),
            }
        } else if 2 * values.len() > rows && !values[0].starts_with('"') {
            return Err(format!(
                "list {name}: {} values where the longest list has {rows}; make the lists equally long, or {REMEDY}",
                values.len()
            ));
        }
    }
    Ok(columns)
}

/// The columns of a list of lists called `name`.
fn split<'a>(name: &str, rows: &[&'a str], names: &[&str]) -> Result<Vec<List<'a>>, String> {
    let mut columns: Vec<List> = Vec::new();
    for (k, row) in rows.iter().enumerate() {
        let values: Vec<&RawValue> = serde_json::from_str(row).unwrap_or_default();
        if k == 0 {
            let named = name == SPLIT[1] && names.len() == values.len();
            let of = |place: usize| match named {
                true => serde_json::from_str(names[place]).unwrap_or_default(),
                false => format!("{name}.{place}"),
            };
            columns = (0..values.len())
                .map(|place| (of(place), Vec::new()))
                .collect();
        }
        if values.len() != columns.len() {
            return Err(format!(
                "list {name}: value {} has {} numbers where the first one has {}; {REMEDY}",
                k + 1,
                values.len(),
                columns.len()
            ));
        }
        for ((_, column), value) in columns.iter_mut().zip(values) {
            column.push(value.get());
        }
    }
    Ok(columns)
}

/// Adds the lists of the value `text` called `name`, and those of the objects in it, whose names it precedes. An object
/// whose keys are numbers is a list, if it has none. A list of a single object, as of one run, is this object.
fn collect<'a>(
    name: String,
    text: &'a str,
    to: &mut Vec<List<'a>>,
) -> Result<(), serde_json::Error> {
    match text.as_bytes().first() {
        Some(b'[') => {
            let values: Vec<&RawValue> = serde_json::from_str(text)?;
            let values: Vec<_> = values.into_iter().map(RawValue::get).collect();
            let before = to.len();
            if let [only] = values[..]
                && only.starts_with('{')
            {
                collect(name.clone(), only, to)?;
            }
            if to.len() == before {
                to.push((name, values));
            }
        }
        Some(b'{') => {
            let members = serde_json::Deserializer::from_str(text).deserialize_map(Members)?;
            let is_number = |(key, _): &(Cow<str>, &str)| key.parse::<u64>().is_ok();
            let is_list = !members.is_empty() && members.iter().all(is_number);
            let before = to.len();
            let values: Vec<_> = members.iter().map(|(_, value)| *value).collect();
            for (key, value) in members {
                collect(name_inside(&name, key.into_owned()), value, to)?;
            }
            if is_list && to.len() == before {
                to.push((name, values));
            }
        }
        _ => {}
    }
    Ok(())
}

/// Takes the members of an object, in their order.
struct Members;

impl<'de> Visitor<'de> for Members {
    type Value = Vec<(Cow<'de, str>, &'de str)>;

    fn expecting(&self, to: &mut fmt::Formatter<'_>) -> fmt::Result {
        to.write_str("a JSON object")
    }

    fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<Self::Value, A::Error> {
        let mut members = Vec::new();
        while let Some((key, value)) = map.next_entry::<Cow<str>, &RawValue>()? {
            members.push((key, value.get()));
        }
        Ok(members)
    }
}

#[cfg(test)]
mod tests {
    use super::Lists;

    #[test]
    fn an_object_is_kept_up_to_the_bytes_for_it() {
        let text = "{\"t\": [0, 1, 2]}";
        let open = |most| Lists::open_up_to(most, text.as_bytes(), 3, "r.json");
        assert!(open(text.len() as u64).is_ok_and(|lists| lists.is_some()));
        let error = open(text.len() as u64 - 1)
            .err()
            .map(|error| error.to_string());
        let said =
            "r.json: line 3: a JSON object of more than 15 bytes, which is kept in memory; write ";
        assert!(error.is_some_and(|error| error.starts_with(said)));
    }
}
