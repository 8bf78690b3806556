//! The fields of one JSON object, in their order.

use std::fmt;

use serde::Deserializer as _;
use serde::de::{DeserializeSeed, Error, MapAccess, SeqAccess, Visitor};
use serde_json::{Number, Value};

use super::super::named_fields::{Field, Mark};

/// Begins a text that stands for a word which is no JSON.
const WORD: char = '\0';

/// Most numbers of a list that are fields.
const MOST: usize = 64;

/// The key under which `serde_json` hands over the text of a number, where its feature
/// `arbitrary_precision` is on. Another package may turn it on.
const NUMBER: &str = "$serde_json::private::Number";

/// The name of a member `key` of an object called `outer`: both names, but for the log's object, which has none, and for
/// `data`.
pub(super) fn name_inside(outer: &str, key: String) -> String {
    match outer {
        "" | "data" => key,
        outer => format!("{outer}.{key}"),
    }
}

/// The fields of the object in a line.
pub(super) fn fields(line: &[u8]) -> Result<Vec<Field>, serde_json::Error> {
    let parse = |line: &[u8]| {
        let mut fields = Vec::new();
        let mut from = serde_json::Deserializer::from_slice(line);
        let objects = Inside {
            name: String::new(),
            to: &mut fields,
        };
        (&mut from).deserialize_map(objects)?;
        from.end()?;
        Ok(fields)
    };
    parse(line).or_else(|error| parse(&with_words(line)).map_err(|_| error))
}

/// Takes a value called `name`: a field, or the fields of an object. The log's object has no name.
struct Inside<'a> {
    name: String,
    to: &'a mut Vec<Field>,
}

impl Inside<'_> {
    fn field(self, text: String, mark: Mark) {
        let Self { name, to } = self;
        to.push(Field { name, text, mark });
    }
}

impl<'de> DeserializeSeed<'de> for Inside<'_> {
    type Value = ();

    fn deserialize<D: serde::Deserializer<'de>>(self, from: D) -> Result<(), D::Error> {
        from.deserialize_any(self)
    }
}

impl<'de> Visitor<'de> for Inside<'_> {
    type Value = ();

    fn expecting(&self, to: &mut fmt::Formatter<'_>) -> fmt::Result {
        to.write_str("a JSON object")
    }

    fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<(), A::Error> {
        while let Some(name) = map.next_key::<String>()? {
            if name == NUMBER {
                let text = map.next_value()?;
                self.field(text, Mark::Text);
                return Ok(());
            }
            let name = name_inside(&self.name, name);
            map.next_value_seed(Inside { name, to: self.to })?;
        }
        Ok(())
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut list: A) -> Result<(), A::Error> {
        let mut values: Vec<Value> = Vec::new();
        while let Some(value) = list.next_element()? {
            values.push(value);
        }
        let is_short = (1..=MOST).contains(&values.len());
        if is_short && values.iter().all(Value::is_object) {
            for (place, value) in values.into_iter().enumerate() {
                let name = format!("{}.{place}", self.name);
                let object = Inside { name, to: self.to };
                object.deserialize(value).map_err(A::Error::custom)?;
            }
            return Ok(());
        }
        if is_short && values.iter().all(is_number) {
            for (place, value) in values.into_iter().enumerate() {
                let name = format!("{}.{place}", self.name);
                let number = Inside { name, to: self.to };
                match value {
                    Value::Null => number.visit_unit::<A::Error>(),
                    Value::String(word) => number.visit_str(&word),
                    value => {
                        number.field(value.to_string(), Mark::Text);
                        Ok(())
                    }
                }?;
            }
            return Ok(());
        }
        let text = Value::from(values).to_string().replace("\\u0000", "");
        self.field(text, Mark::Text);
        Ok(())
    }

    fn visit_str<E: Error>(self, text: &str) -> Result<(), E> {
        let word = text.strip_prefix(WORD);
        match word.and_then(|word| WORDS.into_iter().find(|known| *known == word)) {
            Some(word) => self.field(String::new(), Mark::Blank(word)),
            None => self.field(text.to_owned(), Mark::Text),
        }
        Ok(())
    }

    fn visit_unit<E: Error>(self) -> Result<(), E> {
        self.field(String::new(), Mark::Blank("null"));
        Ok(())
    }

    fn visit_bool<E: Error>(self, value: bool) -> Result<(), E> {
        self.field(value.to_string(), Mark::Text);
        Ok(())
    }

    fn visit_i64<E: Error>(self, value: i64) -> Result<(), E> {
        self.field(value.to_string(), Mark::Text);
        Ok(())
    }

    fn visit_u64<E: Error>(self, value: u64) -> Result<(), E> {
        self.field(value.to_string(), Mark::Text);
        Ok(())
    }

    fn visit_f64<E: Error>(self, value: f64) -> Result<(), E> {
        let text = Number::from_f64(value).map_or_else(String::new, |number| number.to_string());
        self.field(text, Mark::Text);
        Ok(())
    }
}

/// Whether a value of a list is a number, or stands for none.
fn is_number(value: &Value) -> bool {
    match value {
        Value::Number(_) | Value::Null => true,
        Value::String(text) => text.starts_with(WORD),
        _ => false,
    }
}

/// The values that JSON does not have and Python writes.
const WORDS: [&str; 4] = ["NaN", "-Infinity", "Infinity", "None"];

/// The truth values as Python prints them, and as JSON has them.
const TRUTH: [(&str, &str); 2] = [("True", "true"), ("False", "false")];

/// The text with strings for [`WORDS`], which [`fields`] reads as those words, and with what else Python prints for a
/// dictionary as JSON has it: truth values, and strings in single quotes.
pub(super) fn with_words(text: &[u8]) -> Vec<u8> {
    let mut clean = Vec::with_capacity(text.len());
    let mut quote = None;
    let mut k = 0;
    while k < text.len() {
        let rest = &text[k..];
        let begins = |word: &str| rest.starts_with(word.as_bytes());
        let mut length = 1;
        match (quote, rest[0]) {
            (Some(_), b'\\') => {
                length = rest.len().min(2);
                // JSON has no escape of a single quote.
                let begin = usize::from(rest.get(1) == Some(&b'\''));
                clean.extend(&rest[begin..length]);
            }
            (Some(b'\''), b'"') => clean.extend(b"\\\""),
            (Some(end), byte) => {
                let is_end = byte == end;
                clean.push(if is_end { b'"' } else { byte });
                quote = quote.filter(|_| !is_end);
            }
            (None, byte @ (b'"' | b'\'')) => {
                clean.push(b'"');
                quote = Some(byte);
            }
            (None, byte) => {
                if let Some(word) = WORDS.iter().find(|word| begins(word)) {
                    clean.extend(format!("\"\\u0000{word}\"").as_bytes());
                    length = word.len();
                } else if let Some((word, json)) = TRUTH.iter().find(|(word, _)| begins(word)) {
                    clean.extend(json.as_bytes());
                    length = word.len();
                } else {
                    clean.push(byte);
                }
            }
        }
        k += length;
    }
    clean
}

#[cfg(test)]
mod tests {
    use super::*;

    fn shown(line: &str) -> Vec<(String, String, Mark)> {
        let fields = fields(line.as_bytes()).unwrap();
        let shown = |field: Field| (field.name, field.text, field.mark);
        fields.into_iter().map(shown).collect()
    }

    fn field(name: &str, text: &str, mark: Mark) -> (String, String, Mark) {
        (name.to_owned(), text.to_owned(), mark)
    }

    #[test]
    fn objects_inside_an_object_are_flattened() {
        let line = r#"{"timestamp": 1.5, "data": {"position": 0.25, "fw": {"id_A": 2}}, "a": {"data": -1}}"#;
        let expected = [
            ("timestamp", "1.5"),
            ("position", "0.25"),
            ("fw.id_A", "2"),
            ("a.data", "-1"),
        ];
        let expected = expected.map(|(name, text)| field(name, text, Mark::Text));
        assert_eq!(shown(line), expected);
    }

    #[test]
    fn numbers_that_python_writes_are_empty_fields() {
        let line =
            r#"{"a": NaN, "b": -Infinity, "c": "NaN \" NaN", "d": [Infinity, 1], "e": null}"#;
        let expected = [
            field("a", "", Mark::Blank("NaN")),
            field("b", "", Mark::Blank("-Infinity")),
            field("c", "NaN \" NaN", Mark::Text),
            field("d.0", "", Mark::Blank("Infinity")),
            field("d.1", "1", Mark::Text),
            field("e", "", Mark::Blank("null")),
        ];
        assert_eq!(shown(line), expected);
    }

    #[test]
    fn numbers_of_a_list_are_fields() {
        let line = r#"{"q": [0.5, -2, null], "a": {"tau": [0.25]}, "name": ["j1", "j2"], "b": [[1, 2]], "c": [], "d": [{}, 1]}"#;
        let expected = [
            field("q.0", "0.5", Mark::Text),
            field("q.1", "-2", Mark::Text),
            field("q.2", "", Mark::Blank("null")),
            field("a.tau.0", "0.25", Mark::Text),
            field("name", "[\"j1\",\"j2\"]", Mark::Text),
            field("b", "[[1,2]]", Mark::Text),
            field("c", "[]", Mark::Text),
            field("d", "[{},1]", Mark::Text),
        ];
        assert_eq!(shown(line), expected);
        let long = format!("{{\"image\": [{}0]}}", "0,".repeat(MOST));
        assert_eq!(shown(&long)[0].0, "image");
    }

    #[test]
    fn objects_of_a_list_are_flattened() {
        let line = r#"{"t": 0, "axes": [{"pos": 1.5, "q": [2]}, {"pos": NaN, "id": {"n": "b"}}]}"#;
        let expected = [
            field("t", "0", Mark::Text),
            field("axes.0.pos", "1.5", Mark::Text),
            field("axes.0.q.0", "2", Mark::Text),
            field("axes.1.pos", "", Mark::Blank("NaN")),
            field("axes.1.id.n", "b", Mark::Text),
        ];
        let mut found = shown(line);
        found.sort_by(|a, b| a.0.cmp(&b.0));
        let mut expected = expected.to_vec();
        expected.sort_by(|a, b| a.0.cmp(&b.0));
        assert_eq!(found, expected);
    }

    #[test]
    fn dictionaries_that_python_prints_are_objects() {
        let line =
            r#"{'t': 0.5, 'a "b"': None, "it's": True, 'c': 'it\'s \\ {', 'd': {'e': False}}"#;
        let expected = [
            field("t", "0.5", Mark::Text),
            field("a \"b\"", "", Mark::Blank("None")),
            field("it's", "true", Mark::Text),
            field("c", "it's \\ {", Mark::Text),
            field("d.e", "false", Mark::Text),
        ];
        assert_eq!(shown(line), expected);
        for broken in ["{'t': 0.5", "{'t: 0.5}", "{'t': '}", "{'t': \\", "{t: 0.5}"] {
            assert!(fields(broken.as_bytes()).is_err(), "{broken}");
        }
    }
}
