//! Logs with one JSON object a line.

mod elements;
mod fields;
mod lists;
mod other;

use std::collections::HashMap;
use std::io::BufRead;

use csv::ByteRecord;
use terminal::failure::Failure;

use super::named_fields::{Field, Places, names, seen};
use crate::recording::layout::{SEARCHED, Seen, unit_since_1970};
use crate::recording::text::lines::LineReader;
use crate::recording::text::separator::is_comment;
use crate::recording::times::moment::Moment;

use fields::fields;
pub(super) use other::Other;

/// The channel of a moteus log that has position and current.
const CHANNEL: &str = "servo_stats";

const REMEDY: &str =
    "write one JSON object a line, for example {\"t\": 0.001, \"counts_large\": 8}";

/// What the begin of a log tells.
pub(super) struct Begin {
    /// Names of the fields of the first object that is read.
    pub(super) names: Vec<String>,
    /// Line of the first object.
    pub(super) line: u64,
    /// What the numbers of each name tell in the first objects.
    pub(super) seen: Vec<Seen>,
    /// Places of the names that have a date or a time of day in the first object.
    pub(super) moments: Vec<usize>,
    /// Places of the names that have a time since 1970 in the first object, and its unit.
    pub(super) since_1970: Vec<(usize, &'static str)>,
    /// Whether it is a log of moteus, whose lines belong to channels and controllers.
    channels: bool,
}

impl Begin {
    /// Reads the first bytes `head` of a log called `name`; `None` if it has no objects.
    ///
    /// # Errors
    /// [`Failure::Input`] with the remedy for a first line that is more than one object, or a wrong one.
    pub(super) fn of(head: &str, name: &str) -> Result<Option<Self>, Failure> {
        let Some(index) = content(head) else {
            return Ok(None);
        };
        let line = index as u64 + 1;
        let lines = || head.lines().skip(index);
        let first = lines().next().unwrap_or_default();
        if !first.trim_start().starts_with('{') {
            return Ok(None);
        }
        if fields(first.as_bytes()).is_err() && is_whole(first.as_bytes()) {
            return Err(not_alone(first.as_bytes(), line, name));
        }
        let objects = || lines().filter_map(|line| fields(line.as_bytes()).ok());
        let of_channel = objects().find(|fields| channel(fields) == Some(CHANNEL));
        let channels = of_channel.is_some();
        let Some(found) = of_channel.or_else(|| objects().next()) else {
            return Err(not_alone(first.as_bytes(), line, name));
        };
        let first: HashMap<_, _> = (found.iter().rev())
            .map(|field| (field.name.clone(), field.text.clone()))
            .collect();
        let names = names(found);
        let texts = || names.iter().filter_map(|name| first.get(name)).enumerate();
        let is_moment = |(_, text): &(usize, &String)| Moment::parse(text).is_some();
        let unit = |text: &String| unit_since_1970(text.parse().ok()?);
        Ok(Some(Self {
            seen: seen(&names, objects().take(SEARCHED), |text| text.parse().ok()),
            moments: texts().filter(is_moment).map(|(place, _)| place).collect(),
            since_1970: texts()
                .filter_map(|(place, text)| Some((place, unit(text)?)))
                .collect(),
            names,
            line,
            channels,
        }))
    }
}

/// Reads objects, one a line. In a log with channels, it reads one channel of one controller.
pub(super) struct Json<R> {
    inner: LineReader<R>,
    text: Vec<u8>,
    pub(super) places: Places,
    channels: bool,
    controller: Option<String>,
}

impl<R: BufRead> Json<R> {
    pub(super) fn new(inner: R, end: u8, begin: &Begin) -> Self {
        Self {
            inner: LineReader::new(inner, end),
            text: Vec::new(),
            places: Places::new(&begin.names),
            channels: begin.channels,
            controller: None,
        }
    }

    /// Reads the fields of the next object into `record` and returns its line.
    pub(super) fn read(
        &mut self,
        record: &mut ByteRecord,
        name: &str,
    ) -> Result<Option<u64>, Failure> {
        loop {
            let Some(line) = self.inner.next_content(&mut self.text, name)? else {
                return Ok(None);
            };
            let text = self.text.as_slice();
            let Ok(fields) = fields(text) else {
                return Err(no_object(text, line, name));
            };
            if self.channels {
                if channel(&fields).is_some_and(|channel| channel != CHANNEL) {
                    continue;
                }
                self.one_controller(&fields, line, name)?;
            }
            self.places.take(fields, record);
            return Ok(Some(line));
        }
    }

    /// Refuses a second controller, whose motion is another one.
    fn one_controller(&mut self, fields: &[Field], line: u64, name: &str) -> Result<(), Failure> {
        let Some(controller) = fields.iter().find(|field| field.name == "controller") else {
            return Ok(());
        };
        let this = &controller.text;
        let known = self.controller.get_or_insert_with(|| this.clone());
        if known == this {
            return Ok(());
        }
        Err(Failure::Input(format!(
            "{name}: line {line}: field controller: {this} after {known}; keep the lines of one controller"
        )))
    }
}

/// The channel that an object of moteus belongs to.
fn channel(fields: &[Field]) -> Option<&str> {
    let channel = fields.iter().find(|field| field.name == "channel")?;
    Some(&channel.text)
}

/// Error for a line that is no object.
fn no_object(text: &[u8], line: u64, name: &str) -> Failure {
    match is_whole(text) {
        true => not_alone(text, line, name),
        false => Failure::Input(format!(
            "{name}: line {line}: no JSON object; remove the line"
        )),
    }
}

/// Index of the first line of `head` that is neither blank nor a comment.
fn content(head: &str) -> Option<usize> {
    let is_content = |line: &str| !line.trim().is_empty() && !is_comment(line.as_bytes());
    head.lines().position(is_content)
}

/// Whether a line has begin and end of an object. A cut line has no end.
fn is_whole(line: &[u8]) -> bool {
    let line = line.trim_ascii();
    let line = line.strip_suffix(b",").unwrap_or(line);
    line.starts_with(b"{") && line.ends_with(b"}")
}

/// Error for a line that is more than one object, or a wrong one.
fn not_alone(text: &[u8], line: u64, name: &str) -> Failure {
    let why = match fields(text) {
        Ok(_) => String::new(),
        Err(error) => {
            let all = error.to_string();
            let what = all.split(" at line ").next().unwrap_or_default();
            format!(" ({what} at column {})", error.column())
        }
    };
    Failure::Input(format!(
        "{name}: line {line}: no JSON object on a line of its own{why}; {REMEDY}"
    ))
}

#[cfg(test)]
mod tests {
    use crate::recording::Recording;

    fn read(text: &str) -> Result<Recording, String> {
        Recording::parse(text.as_bytes(), "r.json").map_err(|error| error.to_string())
    }

    #[test]
    fn comments_and_blank_lines_are_no_objects() {
        let rows = "{\"t\":0,\"counts_large\":1}\n{\"t\":0.001,\"counts_large\":2}\n";
        let text = format!("\n# counts_per_rev = 512\n  // a log\n{rows}\n% the end\n");
        assert_eq!(read(&text).unwrap().trace.counts_large, [1, 2]);
        let text = text.replace('\n', "\r");
        assert_eq!(read(&text).unwrap().trace.counts_large, [1, 2]);
    }

    #[test]
    fn channels_and_controllers_are_those_of_moteus() {
        let log = |lines: [&str; 3]| {
            let line = |(k, fields)| format!("{{\"t\":{k}e-3,\"counts_large\":{k},{fields}}}\n");
            read(&(1..).zip(lines).map(line).collect::<String>())
        };
        for fields in [
            ["\"channel\":1", "\"channel\":2", "\"channel\":1"],
            [r#""channel":"a""#, r#""channel":"b""#, r#""channel":"a""#],
            ["\"controller\":1", "\"controller\":2", "\"controller\":1"],
        ] {
            assert_eq!(log(fields).unwrap().trace.counts_large, [1, 2, 3]);
        }
        let servo = r#""channel":"servo_stats""#;
        let moteus = log([r#""channel":"git""#, servo, servo]).unwrap();
        assert_eq!(moteus.trace.counts_large, [2, 3]);
        let of = |controller: u8| format!("{servo},\"controller\":{controller}");
        assert!(log([&of(1), &of(1), &of(1)]).is_ok());
        let error = log([&of(1), &of(1), &of(2)]).unwrap_err();
        assert!(
            error.starts_with("r.json: line 3: field controller: 2 after 1; keep"),
            "{error}"
        );
    }

    #[test]
    fn name_of_two_fields_is_refused_where_it_is_read() {
        let first = "{\"t\":0,\"counts_large\":1,\"x\":0}\n";
        for (second, name) in [
            (
                "{\"t\":1,\"counts_large\":0,\"data\":{\"counts_large\":7}}",
                "counts_large",
            ),
            ("{\"t\":0,\"t\":1,\"counts_large\":0}", "t"),
        ] {
            for (text, line) in [
                (format!("{first}{second}\n"), 2),
                (format!("{second}\n"), 1),
            ] {
                let error = read(&text).unwrap_err();
                let said = format!(
                    "r.json: line {line}: column {name}: two fields '{name}' in one line; rename or \
                     remove one"
                );
                assert_eq!(error, said);
            }
        }
        let unread = "{\"t\":0.001,\"x\":5,\"counts_large\":2,\"x\":7,\"a.b\":5,\"a\":{\"b\":7}}\n";
        let recording = read(&format!("{first}{unread}")).unwrap();
        assert_eq!(recording.trace.counts_large, [1, 2]);
    }

    #[test]
    fn field_without_a_number_is_reported_as_it_is() {
        let first = "{\"t\":0,\"counts_large\":1}\n";
        for (field, said) in [
            (
                ",\"counts_large\":NaN",
                "'NaN' is not a number; remove the rows",
            ),
            (
                ",\"counts_large\":null",
                "'null' is not a number; remove the rows",
            ),
            (
                "",
                "no field 'counts_large' in the line; add it, or remove the line",
            ),
        ] {
            let error = read(&format!("{first}{{\"t\":0.001{field}}}\n")).unwrap_err();
            let said = format!("r.json: line 2: column counts_large: {said}");
            assert!(error.starts_with(&said), "{error}");
        }
    }
}
