//! The tables of docs/link.md, made from the messages of the link.
//!
//! `UPDATE_GOLDEN=1 cargo test --release --package drive --test drive documented` writes them.

use drivers::link::{FEATURES, FieldFacts, MessageFacts, SCHEMA};
use measured::block::{Block, markdown};

fn check(name: &'static str, table: &str) {
    let block = Block {
        kind: "catalogue",
        name,
        page: "docs/link.md",
    };
    let checked = block.check(table);
    checked.unwrap_or_else(|error| panic!("{error}"));
}

/// The bytes of the payload that a field takes.
fn places(fields: &[FieldFacts]) -> Vec<String> {
    let mut at = 0;
    let place = |field: &FieldFacts| {
        let (first, last) = (at, at + field.size - 1);
        at += field.size;
        match first == last {
            true => first.to_string(),
            false => format!("{first} to {last}"),
        }
    };
    fields.iter().map(place).collect()
}

#[test]
fn every_message_is_in_the_table_of_messages() {
    let row = |message: &MessageFacts| {
        let length: usize = message.fields.iter().map(|field| field.size).sum();
        vec![
            format!("{} `{}`", message.kind, message.name),
            length.to_string(),
            message.meaning.trim().to_owned(),
        ]
    };
    let rows: Vec<_> = SCHEMA.iter().map(row).collect();
    check(
        "messages",
        &markdown(&["kind", "bytes of payload", "meaning"], &rows),
    );
}

#[test]
fn every_field_is_in_the_table_of_fields() {
    let mut rows = Vec::new();
    for message in SCHEMA {
        for (field, place) in message.fields.iter().zip(places(message.fields)) {
            rows.push(vec![
                format!("`{}`", message.name),
                place,
                format!("`{}`", field.name),
                field.wire.to_owned(),
                field.meaning.trim().to_owned(),
            ]);
        }
    }
    let head = ["message", "bytes", "field", "type", "meaning"];
    check("fields", &markdown(&head, &rows));
}

#[test]
fn every_feature_is_in_the_table_of_features() {
    let row = |(bit, name): (usize, &&str)| vec![bit.to_string(), format!("`{name}`")];
    let rows: Vec<_> = FEATURES.iter().enumerate().map(row).collect();
    check(
        "features",
        &markdown(&["bit", "feature of the image"], &rows),
    );
}
