//! Rows as MCAP: a topic for each group of channels, with messages of protobuf and their descriptors.

use std::collections::BTreeMap;
use std::error::Error as _;
use std::io::Write;

use mcap::records::MessageHeader;
use mcap::write::NoSeek;
use prost::Message as _;
use prost_types::field_descriptor_proto::{Label, Type};
use prost_types::{DescriptorProto, FieldDescriptorProto, FileDescriptorProto, FileDescriptorSet};

use crate::list::CHANNELS;

/// Package of the messages.
const PACKAGE: &str = "limpid";
/// Topic of the estimators on the host.
const ESTIMATES: &str = "estimates";

/// A topic: its name, and the column of each field.
struct Topic {
    name: &'static str,
    fields: Vec<(String, usize)>,
}

/// The topics: those of the channels, and that of the estimators.
fn topics(estimators: &[&str]) -> Vec<Topic> {
    let mut topics: Vec<Topic> = Vec::new();
    for (column, channel) in CHANNELS.iter().enumerate().skip(1) {
        let at = topics.iter().position(|topic| topic.name == channel.topic);
        let at = at.unwrap_or_else(|| {
            topics.push(Topic {
                name: channel.topic,
                fields: Vec::new(),
            });
            topics.len() - 1
        });
        topics[at].fields.push((channel.name.to_owned(), column));
    }
    let fields = estimators.iter().zip(CHANNELS.len()..);
    let fields = fields.map(|(name, column)| (name.replace('-', "_"), column));
    topics.push(Topic {
        name: ESTIMATES,
        fields: fields.collect(),
    });
    topics
}

impl Topic {
    /// Name of the message.
    fn message(&self) -> String {
        let (first, rest) = self.name.split_at(1);
        first.to_uppercase() + rest
    }

    /// Descriptors of the message: every field is an optional `double`, numbered from 1.
    fn descriptors(&self) -> Vec<u8> {
        let field = |(number, (name, _)): (i32, &(String, usize))| FieldDescriptorProto {
            name: Some(name.clone()),
            number: Some(number),
            label: Some(Label::Optional.into()),
            r#type: Some(Type::Double.into()),
            ..FieldDescriptorProto::default()
        };
        let message = DescriptorProto {
            name: Some(self.message()),
            field: (1..).zip(&self.fields).map(field).collect(),
            ..DescriptorProto::default()
        };
        let file = FileDescriptorProto {
            name: Some(format!("{PACKAGE}/{}.proto", self.name)),
            package: Some(PACKAGE.to_owned()),
            message_type: vec![message],
            ..FileDescriptorProto::default()
        };
        FileDescriptorSet { file: vec![file] }.encode_to_vec()
    }

    /// A row's message. A value that is not known is left out.
    fn encode(&self, row: &[f64]) -> Vec<u8> {
        let mut bytes = Vec::new();
        for (number, (_, column)) in (1_u32..).zip(&self.fields) {
            match row.get(*column) {
                Some(value) if !value.is_nan() => {
                    prost::encoding::double::encode(number, value, &mut bytes);
                }
                _ => {}
            }
        }
        bytes
    }
}

/// A file in the making. The time of a message is that of its row, from zero.
pub struct McapWriter<W: Write> {
    topics: Vec<Topic>,
    /// Channel of each topic.
    channels: Vec<u16>,
    writer: mcap::Writer<NoSeek<W>>,
    sequence: u32,
}

impl<W: Write> McapWriter<W> {
    /// A file of rows that end with these estimators.
    ///
    /// # Errors
    /// One line if a record cannot be written.
    pub fn new(out: W, estimators: &[&str]) -> Result<Self, String> {
        let options = mcap::WriteOptions::new()
            .compression(None)
            .disable_seeking(true)
            .library("limpid");
        let mut writer = options
            .create(NoSeek::new(out))
            .map_err(|error| failed(&error))?;
        let topics = topics(estimators);
        let mut channels = Vec::new();
        for topic in &topics {
            let name = format!("{PACKAGE}.{}", topic.message());
            let schema = writer
                .add_schema(&name, "protobuf", &topic.descriptors())
                .map_err(|error| failed(&error))?;
            let path = format!("/{}", topic.name);
            let channel = writer.add_channel(schema, &path, "protobuf", &BTreeMap::new());
            channels.push(channel.map_err(|error| failed(&error))?);
        }
        Ok(Self {
            topics,
            channels,
            writer,
            sequence: 0,
        })
    }

    /// Adds a row.
    ///
    /// # Errors
    /// One line if a record cannot be written.
    pub fn row(&mut self, row: &[f64]) -> Result<(), String> {
        let time = (row.first().copied().unwrap_or_default().max(0.0) * 1e9).round() as u64;
        for (topic, channel_id) in self.topics.iter().zip(&self.channels) {
            let message = topic.encode(row);
            if message.is_empty() {
                continue;
            }
            let header = MessageHeader {
                channel_id: *channel_id,
                sequence: self.sequence,
                log_time: time,
                publish_time: time,
            };
            self.writer
                .write_to_known_channel(&header, &message)
                .map_err(|error| failed(&error))?;
        }
        self.sequence = self.sequence.wrapping_add(1);
        Ok(())
    }

    /// Ends the file; returns what it was written to.
    ///
    /// # Errors
    /// One line if a record cannot be written.
    pub fn finish(mut self) -> Result<W, String> {
        self.writer.finish().map_err(|error| failed(&error))?;
        Ok(self.writer.into_inner().into_inner())
    }
}

/// The error with its causes: that of the file, as a full disk, is one.
fn failed(error: &mcap::McapError) -> String {
    let mut said = format!("MCAP: {error}");
    let mut cause = error.source();
    while let Some(error) = cause {
        said += &format!(": {error}");
        cause = error.source();
    }
    said
}

/// Rows as the bytes of an MCAP file.
///
/// # Errors
/// One line if a record cannot be written.
pub fn mcap<'a>(
    rows: impl Iterator<Item = &'a [f64]>,
    estimators: &[&str],
) -> Result<Vec<u8>, String> {
    let mut writer = McapWriter::new(Vec::new(), estimators)?;
    for row in rows {
        writer.row(row)?;
    }
    writer.finish()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A disk that has no room.
    struct Full;

    impl Write for Full {
        fn write(&mut self, _: &[u8]) -> std::io::Result<usize> {
            Err(std::io::Error::new(
                std::io::ErrorKind::StorageFull,
                "No space left on device",
            ))
        }

        fn flush(&mut self) -> std::io::Result<()> {
            Ok(())
        }
    }

    #[test]
    fn error_of_the_file_is_told() {
        let written = McapWriter::new(Full, &[]).and_then(McapWriter::finish);
        let Err(said) = written else {
            panic!("a full disk takes the file");
        };
        assert!(said.ends_with(": No space left on device"), "{said}");
    }

    /// What a reader finds: for each topic the message, its package and its fields, all optional doubles.
    #[test]
    fn topics_have_the_channels_of_the_list() {
        let bytes = mcap(std::iter::empty(), &["imm-edge", "pll"]).unwrap();
        let summary = mcap::Summary::read(&bytes).unwrap().unwrap();
        let mut found = BTreeMap::new();
        for channel in summary.channels.values() {
            let schema = channel.schema.as_ref().expect("a schema");
            assert_eq!(schema.encoding, "protobuf");
            let files = FileDescriptorSet::decode(&*schema.data).unwrap().file;
            assert_eq!((files.len(), files[0].package()), (1, "limpid"));
            assert_eq!(files[0].name(), format!("limpid{}.proto", channel.topic));
            let message = &files[0].message_type[0];
            let is_optional_double = |field: &FieldDescriptorProto| {
                (field.label(), field.r#type()) == (Label::Optional, Type::Double)
            };
            assert!(message.field.iter().all(is_optional_double), "{message:?}");
            let names = message.field.iter().map(|field| field.name().to_owned());
            found.insert(
                channel.topic.clone(),
                (message.name().to_owned(), names.collect::<Vec<_>>()),
            );
        }
        let mut expected = BTreeMap::new();
        for channel in &CHANNELS[1..] {
            let (topic, message) = match channel.topic {
                "velocity" => ("/velocity", "Velocity"),
                "torque" => ("/torque", "Torque"),
                "force" => ("/force", "Force"),
                "current" => ("/current", "Current"),
                "cost" => ("/cost", "Cost"),
                "device" => ("/device", "Device"),
                other => panic!("{other}"),
            };
            let entry = expected.entry(topic.to_owned());
            let (_, names) = entry.or_insert_with(|| (message.to_owned(), Vec::new()));
            names.push(channel.name.to_owned());
        }
        let names = ["imm_edge", "pll"].map(str::to_owned).to_vec();
        expected.insert("/estimates".to_owned(), ("Estimates".to_owned(), names));
        assert_eq!(found, expected);
    }

    #[test]
    fn every_channel_has_a_schema_and_unknown_values_are_left_out() {
        let width = CHANNELS.len() + 1;
        let mut row = vec![f64::NAN; width];
        (row[0], row[width - 1]) = (0.25, -1.5);
        let bytes = mcap([row.as_slice()].into_iter(), &["some-name"]).unwrap();
        let summary = mcap::Summary::read(&bytes).unwrap().unwrap();
        for channel in summary.channels.values() {
            let schema = channel.schema.as_ref().expect("a schema");
            let files = FileDescriptorSet::decode(&*schema.data).unwrap().file;
            let message = &files[0].message_type[0];
            assert_eq!(schema.name, format!("{PACKAGE}.{}", message.name()));
            let numbers: Vec<_> = message.field.iter().map(|field| field.number()).collect();
            assert!(
                numbers[0] == 1 && numbers.is_sorted_by(|a, b| a + 1 == *b),
                "{numbers:?}"
            );
        }
        let messages: Vec<_> = mcap::MessageStream::new(&bytes).unwrap().collect();
        let [Ok(message)] = &messages[..] else {
            panic!("one message, of the only topic with a value");
        };
        assert_eq!(
            (message.channel.topic.as_str(), message.log_time),
            ("/estimates", 250_000_000)
        );
        // Field 1 of wire type 1, and the value.
        let expected: Vec<u8> = [9].into_iter().chain((-1.5_f64).to_le_bytes()).collect();
        assert_eq!(*message.data, expected);
    }

    /// The float nearest to a multiple of 0.1 ms may be below it.
    #[test]
    fn message_has_the_number_of_its_row_and_its_time_in_ns() {
        let rows: Vec<_> = (0..2000).map(|k| [1e-4 * f64::from(k), 1.0]).collect();
        let bytes = mcap(rows.iter().map(|row| &row[..]), &[]).unwrap();
        let mut read = 0;
        for (k, message) in (0..).zip(mcap::MessageStream::new(&bytes).unwrap()) {
            let message = message.unwrap();
            let times = [message.log_time, message.publish_time];
            assert_eq!((message.sequence, times), (k, [100_000 * u64::from(k); 2]));
            assert_eq!(message.channel.message_encoding, "protobuf");
            read += 1;
        }
        assert_eq!(read, 2000);
    }

    /// A value of zero is known, and so is one beyond all numbers.
    #[test]
    fn zero_and_infinity_are_written() {
        for value in [0.0, f64::INFINITY] {
            let bytes = mcap([[0.0, value].as_slice()].into_iter(), &[]).unwrap();
            let messages: Vec<_> = mcap::MessageStream::new(&bytes).unwrap().collect();
            let [Ok(message)] = &messages[..] else {
                panic!("one message, of the only topic with a value");
            };
            let expected: Vec<u8> = [9].into_iter().chain(value.to_le_bytes()).collect();
            assert_eq!(*message.data, expected, "{value}");
        }
    }
}
