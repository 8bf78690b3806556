//! Logs with one JSON object a line.

use std::io::BufRead;

use csv::ByteRecord;
use serde_json::{Map, Value};

use terminal::failure::Failure;

/// The channel of a moteus log that has position and current.
const CHANNEL: &str = "servo_stats";

/// Reads objects, one a line. In a log with channels, it reads one channel of one controller.
pub(super) struct Json<R> {
    inner: R,
    line: u64,
    text: Vec<u8>,
    controller: Option<String>,
}

/// The fields of an object; those of an object inside it have the names of both, and those of `data`
/// have their own.
type Fields = Map<String, Value>;

impl<R: BufRead> Json<R> {
    pub(super) fn new(inner: R) -> Self {
        Self {
            inner,
            line: 0,
            text: Vec::new(),
            controller: None,
        }
    }

    /// Reads the fields called `names` of the next object into `record` and returns its line.
    pub(super) fn read(
        &mut self,
        names: &[String],
        record: &mut ByteRecord,
        name: &str,
    ) -> Result<Option<u64>, Failure> {
        loop {
            self.text.clear();
            let failed = |error| Failure::Input(format!("{name}: cannot read: {error}"));
            if self
                .inner
                .read_until(b'\n', &mut self.text)
                .map_err(failed)?
                == 0
            {
                return Ok(None);
            }
            self.line += 1;
            if self.text.trim_ascii().is_empty() {
                continue;
            }
            let Some(fields) = fields(&self.text) else {
                return Err(Failure::Input(format!(
                    "{name}: line {}: no JSON object; remove the line",
                    self.line
                )));
            };
            if !is_read(&fields) {
                continue;
            }
            self.one_controller(&fields, name)?;
            record.clear();
            for name in names {
                record.push_field(text(fields.get(name)).as_bytes());
            }
            return Ok(Some(self.line));
        }
    }

    /// Refuses a second controller, whose motion is another one.
    fn one_controller(&mut self, fields: &Fields, name: &str) -> Result<(), Failure> {
        let Some(controller) = fields.get("controller") else {
            return Ok(());
        };
        let this = text(Some(controller));
        let known = self.controller.get_or_insert_with(|| this.clone());
        if *known == this {
            return Ok(());
        }
        Err(Failure::Input(format!(
            "{name}: line {}: field controller: {this} after {known}; keep the lines of one controller",
            self.line
        )))
    }
}

/// Checks that the text that begins with `head` has no other layout of JSON than one object a line.
///
/// # Errors
/// [`Failure::Input`] with the remedy.
pub(super) fn check(head: &str, name: &str) -> Result<(), Failure> {
    let text = head.trim_start();
    let inside = text.strip_prefix('[').map(str::trim_start);
    let is_array = inside.is_some_and(|inside| inside.starts_with(['{', '[']));
    let first = text.lines().next().unwrap_or_default();
    let is_row = first.starts_with('[') && serde_json::from_str::<Vec<Value>>(first).is_ok();
    let what = match (is_array || is_row, first.trim_end()) {
        (true, _) => "a JSON array",
        (_, "{") => "a JSON object of several lines",
        _ => return Ok(()),
    };
    Err(Failure::Input(format!(
        "{name}: line 1: {what}; write one JSON object a line, for example {{\"t\": 0.001, \"counts_large\": 8}}"
    )))
}

/// Names of the fields of the first object in `head` that is read.
pub(super) fn names(head: &str) -> Vec<String> {
    let objects = || head.lines().filter_map(|line| fields(line.as_bytes()));
    let first = objects().find(is_read).or_else(|| objects().next());
    first.map_or_else(Vec::new, |fields| {
        fields.into_iter().map(|(name, _)| name).collect()
    })
}

fn is_read(fields: &Fields) -> bool {
    fields
        .get("channel")
        .is_none_or(|channel| channel == CHANNEL)
}

fn fields(line: &[u8]) -> Option<Fields> {
    let object = serde_json::from_slice(line)
        .or_else(|_| serde_json::from_slice(&without_nan(line)))
        .ok()?;
    let mut fields = Fields::new();
    flatten(object, "", &mut fields);
    Some(fields)
}

fn flatten(object: Map<String, Value>, prefix: &str, to: &mut Fields) {
    for (name, value) in object {
        match value {
            Value::Object(inner) if prefix.is_empty() && name == "data" => flatten(inner, "", to),
            Value::Object(inner) => flatten(inner, &format!("{prefix}{name}."), to),
            value => {
                to.insert(format!("{prefix}{name}"), value);
            }
        }
    }
}

/// The line with `null` for the numbers that JSON does not have and Python writes: NaN, Infinity,
/// -Infinity.
fn without_nan(line: &[u8]) -> Vec<u8> {
    let mut clean = Vec::with_capacity(line.len());
    let mut quoted = false;
    let mut k = 0;
    while k < line.len() {
        let rest = &line[k..];
        let words: [&[u8]; 3] = [b"NaN", b"-Infinity", b"Infinity"];
        if quoted && rest[0] == b'\\' {
            clean.extend(&rest[..rest.len().min(2)]);
            k += 2;
        } else if let (false, Some(word)) = (quoted, words.iter().find(|w| rest.starts_with(w))) {
            clean.extend(b"null");
            k += word.len();
        } else {
            quoted ^= rest[0] == b'"';
            clean.push(rest[0]);
            k += 1;
        }
    }
    clean
}

fn text(value: Option<&Value>) -> String {
    match value {
        None | Some(Value::Null) => String::new(),
        Some(Value::String(text)) => text.clone(),
        Some(value) => value.to_string(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn objects_inside_an_object_are_flattened() {
        let line = br#"{"timestamp": 1.5, "data": {"position": 0.25, "fw": {"id_A": 2}}}"#;
        let fields = fields(line).unwrap();
        assert_eq!(text(fields.get("timestamp")), "1.5");
        assert_eq!(text(fields.get("position")), "0.25");
        assert_eq!(text(fields.get("fw.id_A")), "2");
    }

    #[test]
    fn numbers_that_python_writes_are_empty_fields() {
        let line = br#"{"a": NaN, "b": -Infinity, "c": "NaN \" NaN", "d": [Infinity, 1]}"#;
        let fields = fields(line).unwrap();
        assert_eq!(text(fields.get("a")), "");
        assert_eq!(text(fields.get("b")), "");
        assert_eq!(text(fields.get("c")), "NaN \" NaN");
        assert_eq!(text(fields.get("d")), "[null,1]");
    }

    #[test]
    fn other_layouts_of_json_are_refused() {
        for (text, what) in [
            ("[{\"t\": 0.0, \"counts_large\": 0},", "a JSON array"),
            ("[\n {\n  \"t\": 0.0,\n", "a JSON array"),
            ("[0.0, 0]\n[0.001, 8]\n", "a JSON array"),
            (
                "{\n  \"t\": [0, 0.001],\n",
                "a JSON object of several lines",
            ),
        ] {
            let error = check(text, "r.json").unwrap_err().to_string();
            let said =
                format!("r.json: line 1: {what}; write one JSON object a line, for example ");
            assert!(error.starts_with(&said), "{error}");
        }
        for text in [
            "{\"t\": 0}\n",
            "[info] a log\nt,counts_large\n0,1\n",
            "t,x\n",
        ] {
            check(text, "r").unwrap();
        }
    }
}
