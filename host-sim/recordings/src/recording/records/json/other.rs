//! Layouts of JSON other than one object a line.

use std::io::{BufRead, Read};

use serde_json::Value;
use terminal::failure::Failure;

use crate::log::cannot_read;

use super::elements::{Elements, count};
use super::fields::fields;
use super::lists::{Lists, has_lists};
use super::{REMEDY, content};

/// Begins a number, a text or a list in a list.
const IN_LIST: &str = "-0123456789\"[N";

/// A layout of JSON that is arranged as rows, one a line.
#[derive(Debug, PartialEq)]
pub(crate) struct Other {
    /// Number of lines before the JSON.
    before: usize,
    kind: Kind,
}

#[derive(Debug, PartialEq)]
enum Kind {
    /// Objects or lists inside of this number of lists: in one list, in one line, or over several lines.
    Elements(u32),
    /// One object with lists.
    Lists,
}

impl Other {
    /// The layout of a log that begins with `head`; `None` for JSON with one object a line, and for what is no JSON.
    pub(crate) fn of(head: &str) -> Option<Self> {
        let before = content(head)?;
        let lines = || head.lines().skip(before);
        let first = lines().next().unwrap_or_default().trim();
        let mut text = lines().map(str::trim).filter(|line| !line.is_empty());
        let kind = match first.as_bytes().first() {
            Some(b'[') => {
                let inside = first[1..].trim_start();
                let inside = if inside.is_empty() {
                    text.nth(1)?
                } else {
                    inside
                };
                let is_list = |inside: &str| {
                    let begin = inside.strip_prefix(['[', '(']).map(str::trim_start);
                    begin.is_some_and(|begin| {
                        begin.is_empty() || begin.starts_with(|c| IN_LIST.contains(c))
                    })
                };
                if inside.starts_with('{') || is_list(inside) {
                    Kind::Elements(1)
                } else if serde_json::from_str::<Vec<Value>>(first).is_ok() {
                    Kind::Elements(0)
                } else {
                    return None;
                }
            }
            Some(b'(') => {
                let inside = first.strip_prefix('(')?.strip_suffix(')')?;
                let are_numbers = inside
                    .split(',')
                    .all(|field| field.trim().parse::<f64>().is_ok());
                are_numbers.then_some(Kind::Elements(0))?
            }
            Some(b'{') => {
                Self::of_objects(first, text.nth(1), &lines().collect::<Vec<_>>().join("\n"))?
            }
            _ => return None,
        };
        Some(Self { before, kind })
    }

    /// The kind of a text that begins with an object, by its first two lines and all that is known of it.
    fn of_objects(first: &str, second: Option<&str>, text: &str) -> Option<Kind> {
        let is_object = |line: &str| fields(line.as_bytes()).is_ok();
        if first.strip_suffix(',').is_some_and(is_object) {
            return Some(Kind::Elements(0));
        }
        if second.is_some_and(|line| is_object(line) || is_object(first)) {
            return None;
        }
        match count(text) {
            1 if is_object(first) => has_lists(first).then_some(Kind::Lists),
            1 => Some(Kind::Lists),
            _ => Some(Kind::Elements(0)),
        }
    }

    /// Reads the rest `input` of the log called `name`, whose lines end with `end`, one row a line.
    ///
    /// # Errors
    /// [`Failure::Input`] for an object without lists, or as [`Lists::open`].
    pub(crate) fn rows<'a>(
        &self,
        mut input: impl BufRead + 'a,
        end: u8,
        name: &str,
    ) -> Result<Box<dyn Read + 'a>, Failure> {
        if let Kind::Elements(around) = self.kind {
            return Ok(Box::new(Elements::new(input, end, self.before, around)));
        }
        for _ in 0..self.before {
            let line = input.skip_until(end);
            line.map_err(|error| cannot_read(name, &error))?;
        }
        let line = self.before as u64 + 1;
        match Lists::open(input, line, name)? {
            Some(lists) => Ok(Box::new(lists)),
            None => Err(Failure::Input(format!(
                "{name}: line {line}: one JSON object without lists of two values and more; {REMEDY}"
            ))),
        }
    }
}

#[cfg(test)]
mod tests;
