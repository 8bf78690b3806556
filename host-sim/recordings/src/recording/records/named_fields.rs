//! Rows whose fields have names, which places them in a record.

use std::collections::HashMap;

use csv::ByteRecord;

use crate::recording::layout::Seen;

/// What a row has in the place of a field.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Mark {
    Missing,
    Text,
    /// The text of an earlier row.
    Held,
    /// No value: null, or what Python writes for one.
    Blank(&'static str),
    /// Several values.
    Twice,
}

/// A field: its name, its text, which is empty without a value, and what it is. A field of an object inside
/// another one has the names of both, and one of `data` has its own.
pub(crate) struct Field {
    pub(crate) name: String,
    pub(crate) text: String,
    pub(crate) mark: Mark,
}

/// The names of fields, each once.
pub(crate) fn names(fields: Vec<Field>) -> Vec<String> {
    let mut names: Vec<String> = Vec::new();
    for field in fields {
        if !names.contains(&field.name) {
            names.push(field.name);
        }
    }
    names
}

/// What the numbers of each of `names` tell in `rows`, where `number` reads them.
pub(crate) fn seen(
    names: &[String],
    rows: impl Iterator<Item = Vec<Field>>,
    number: impl Fn(&str) -> Option<f64>,
) -> Vec<Seen> {
    let mut numbers = vec![Vec::new(); names.len()];
    for field in rows.flatten() {
        let place = names.iter().position(|name| *name == field.name);
        if let (Some(place), Some(number)) = (place, number(&field.text)) {
            numbers[place].push(number);
        }
    }
    numbers
        .iter()
        .map(|column| Seen::of_numbers(column))
        .collect()
}

/// The places of names, and what the last row has there.
pub(crate) struct Places {
    names: Vec<String>,
    places: HashMap<String, usize>,
    values: Vec<String>,
    pub(crate) marks: Vec<Mark>,
}

impl Places {
    pub(crate) fn new(names: &[String]) -> Self {
        Self {
            names: names.to_vec(),
            places: names.iter().cloned().zip(0..).collect(),
            values: vec![String::new(); names.len()],
            marks: vec![Mark::Missing; names.len()],
        }
    }

    pub(crate) fn names(&self) -> impl Iterator<Item = &str> {
        self.names.iter().map(String::as_str)
    }

    /// Whether `name` has a place.
    pub(crate) fn has(&self, name: &str) -> bool {
        self.places.contains_key(name)
    }

    /// Writes the fields of a row into `record`, each to the place of its name. Fields of other names are
    /// left out.
    pub(crate) fn take(&mut self, fields: Vec<Field>, record: &mut ByteRecord) {
        self.marks.fill(Mark::Missing);
        self.values.iter_mut().for_each(String::clear);
        self.place(fields, record);
    }

    /// As [`Places::take`], and names without a field keep their latest one.
    pub(crate) fn take_and_hold(&mut self, fields: Vec<Field>, record: &mut ByteRecord) {
        for mark in &mut self.marks {
            if *mark != Mark::Missing {
                *mark = Mark::Held;
            }
        }
        self.place(fields, record);
    }

    fn place(&mut self, fields: Vec<Field>, record: &mut ByteRecord) {
        for (k, field) in fields.into_iter().enumerate() {
            // Rows mostly have the order of the first one.
            let place = match self.names.get(k) == Some(&field.name) {
                true => Some(k),
                false => self.places.get(&field.name).copied(),
            };
            let Some(place) = place else { continue };
            if [Mark::Missing, Mark::Held].contains(&self.marks[place]) {
                self.marks[place] = field.mark;
                self.values[place] = field.text;
            } else {
                self.marks[place] = Mark::Twice;
            }
        }
        record.clear();
        for value in &self.values {
            record.push_field(value.as_bytes());
        }
    }
}
