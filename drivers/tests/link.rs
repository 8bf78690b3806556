//! Messages of the link: their bytes, their schema, and the parser against noise and torn frames.

use std::fs;

use drivers::link::{
    Edge, FEATURES, Features, Frame, Hello, Index, LONGEST, Label, Learned, Measured, Message,
    PROTOCOL, Parser, Reference, Rejected, SCHEMA, Setting, Stored, Supply,
};
use haptic_control::Fingerprint;

/// Hashes of the schema, each with its protocol. A schema that has been released never changes: a
/// change adds a line with the next number.
const HASHES: [(u16, &str); 1] = [(1, "e1d0e3ac")];

const HELLO: Hello = Hello {
    protocol: PROTOCOL,
    version: Label::new("0.1.0"),
    commit: Label::new("a1b2c3d"),
    features: Features(0b110),
    rate: 10_000,
    device: 0x0012_ABCD,
    presets: u32::MAX,
    cause: 8,
    brown_out_reset: true,
};

const FRAME: Frame = Frame {
    seq: 1,
    tick: 10,
    counts_large: u32::MAX,
    counts_small: 3,
    current: -0.5,
    current_small: 0.25,
    torque: 0.01,
    velocity_large: 1.5,
    velocity_small: -1.5,
    state: 2,
    cause: 16,
    sigma_large: 0.125,
    estimator: 255,
    overruns: 4,
    drops: 5,
    rtt_drops: 6,
    cycles: 900,
};

/// One message of every kind.
fn messages() -> [Message; 11] {
    [
        HELLO.into(),
        FRAME.into(),
        Edge {
            seq: 1,
            bound: 2,
            // Start bytes inside a payload.
            age: 0x5A5A_5A5A,
        }
        .into(),
        Learned {
            seq: 128,
            damping: 0.1,
            friction: -0.2,
            torque_constant: 0.0,
        }
        .into(),
        Reference { seq: 1, count: 9 }.into(),
        Rejected {
            garbage: 1,
            not_finite: 2,
            out_of_bounds: 3,
            unknown: 4,
            unverified: 5,
        }
        .into(),
        Setting {
            number: 4,
            value: 0.1,
            count: 8,
        }
        .into(),
        Stored { outcome: 2 }.into(),
        Measured {
            seq: 1,
            large: -0.5,
            small: 1.25,
        }
        .into(),
        Index {
            seq: 1,
            pulses_large: 2,
            count_large: u32::MAX,
            deviation_large: -3,
            position_large: i32::MIN,
            pulses_small: 0x5A5A_5A5A,
            count_small: 7,
            deviation_small: i32::MAX,
            position_small: -1,
        }
        .into(),
        Supply {
            seq: 1,
            volts: 24.5,
        }
        .into(),
    ]
}

fn encoded(message: Message) -> Vec<u8> {
    let mut buffer = [0; LONGEST];
    message.encode(&mut buffer).expect("room").to_vec()
}

fn parse(parser: &mut Parser, bytes: &[u8]) -> Vec<Message> {
    let mut found = Vec::new();
    for byte in bytes {
        parser.take(*byte, |message| found.push(message));
    }
    found
}

/// CRC-16/IBM-3740 bit by bit, by its polynomial.
fn crc16(bytes: &[u8]) -> [u8; 2] {
    let crc = bytes.iter().fold(0xFFFF_u16, |crc, byte| {
        (0..8).fold(crc ^ u16::from(*byte) << 8, |crc, _| {
            if crc & 0x8000 == 0 {
                crc << 1
            } else {
                crc << 1 ^ 0x1021
            }
        })
    });
    crc.to_le_bytes()
}

/// A frame of any kind and payload.
fn framed(kind: u8, payload: &[u8]) -> Vec<u8> {
    let mut bytes = vec![0x5A, kind, payload.len() as u8];
    bytes.extend(payload);
    bytes.extend(crc16(&bytes[1..]));
    bytes
}

fn noise(x: &mut u32) -> u8 {
    *x ^= *x << 13;
    *x ^= *x >> 17;
    *x ^= *x << 5;
    *x as u8
}

#[test]
fn schema_of_a_protocol_does_not_change() {
    let mut hash = Fingerprint::EMPTY;
    for message in SCHEMA {
        hash = hash.number(f64::from(message.kind)).text(message.name);
        for field in message.fields {
            hash = hash.text(field.name).text(":").text(field.wire).text(";");
        }
    }
    let known = HASHES.last().expect("a protocol");
    assert_eq!(
        (PROTOCOL, &*hash.to_string()),
        *known,
        "the messages of the link have changed: increase PROTOCOL in drivers/src/link.rs and add \
         its hash to HASHES"
    );
    let numbers: Vec<_> = HASHES.iter().map(|(number, _)| *number).collect();
    assert_eq!(numbers, (1..=PROTOCOL).collect::<Vec<_>>());
}

#[test]
fn kinds_are_numbered_in_order_and_payloads_have_room() {
    let kinds: Vec<_> = SCHEMA.iter().map(|message| message.kind).collect();
    assert_eq!(kinds, (1..=messages().len() as u8).collect::<Vec<_>>());
    for (facts, message) in SCHEMA.iter().zip(messages()) {
        let bytes = encoded(message);
        let payload: usize = facts.fields.iter().map(|field| field.size).sum();
        assert_eq!(bytes[..3], [0x5A, facts.kind, payload as u8]);
        assert_eq!(bytes.len(), payload + 5);
        assert!(bytes.len() <= LONGEST);
    }
}

/// The format of the log line names the fields and types of the frame on the link.
#[test]
fn frame_of_the_link_has_the_fields_of_the_log_line() {
    macro_rules! format {
        ($format:literal; $($rest:tt)+) => {
            $format
        };
    }
    let fields = SCHEMA[1].fields.iter();
    let words: Vec<_> = fields
        .map(|field| [field.name, "={=", field.wire, "}"].concat())
        .collect();
    let line = ["frame", &words.join(" ")].join(" ");
    assert_eq!(line, drivers::frame_fields!(format, frame, lost));
}

#[test]
fn every_feature_of_the_firmware_has_a_bit() {
    let manifest = concat!(env!("CARGO_MANIFEST_DIR"), "/../firmware/app/Cargo.toml");
    let manifest = fs::read_to_string(manifest).unwrap();
    let (_, features) = manifest.split_once("[features]\n").unwrap();
    let lines = features.lines().take_while(|line| !line.starts_with('['));
    let names: Vec<_> = lines
        .filter_map(|line| Some(line.split_once(" = ")?.0))
        .collect();
    assert_eq!(names, FEATURES);
    assert!(Features(u32::MAX).names().eq(names));
}

#[test]
fn payload_is_little_endian_in_the_order_of_the_fields() {
    let mut payload = vec![1, 0];
    payload.extend(b"0.1.0\0\0\0\0\0\0\0\0\0\0\0a1b2c3d\0\0\0\0\0\0\0\0\0");
    payload.extend([6, 0, 0, 0, 0x10, 0x27, 0, 0, 0xCD, 0xAB, 0x12, 0]);
    payload.extend([0xFF, 0xFF, 0xFF, 0xFF, 8, 1]);
    assert_eq!(encoded(HELLO.into()), framed(1, &payload));

    let mut payload = vec![1, 0, 0, 0, 10, 0, 0, 0, 0xFF, 0xFF, 0xFF, 0xFF, 3, 0, 0, 0];
    for value in [-0.5_f32, 0.25, 0.01, 1.5, -1.5] {
        payload.extend(value.to_bits().to_le_bytes());
    }
    payload.extend([2, 16, 0, 0, 0, 0x3E, 255]);
    payload.extend([4, 0, 0, 0, 5, 0, 0, 0, 6, 0, 0x84, 3, 0, 0]);
    assert_eq!(encoded(FRAME.into()), framed(2, &payload));
}

#[test]
fn encoded_messages_are_decoded_without_loss() {
    let mut parser = Parser::default();
    for message in messages() {
        assert_eq!(parse(&mut parser, &encoded(message)), [message]);
    }
    assert_eq!((parser.garbage(), parser.foreign()), (0, 0));
}

#[test]
fn short_buffer_is_refused() {
    for message in messages() {
        let length = encoded(message).len();
        for size in 0..length {
            assert_eq!(message.encode(&mut vec![0; size]), None);
        }
        assert!(message.encode(&mut vec![0; length]).is_some());
    }
}

#[test]
fn message_is_found_after_an_incomplete_frame() {
    for message in messages() {
        for torn in messages() {
            let torn = encoded(torn);
            for cut in 0..torn.len() {
                let mut bytes = torn[..cut].to_vec();
                bytes.extend(encoded(message));
                // The bytes that a torn frame waits for.
                bytes.extend([0; LONGEST]);
                let mut parser = Parser::default();
                assert_eq!(parse(&mut parser, &bytes), [message], "cut at {cut}");
                assert_eq!(parser.garbage() as usize, cut + LONGEST);
            }
        }
    }
}

/// Every pair of bits, of every message. The CRC covers a number of bytes that the length states: with an error
/// in the length it is right by chance in one of 65 536 cases, and the frame is then none of a known message.
#[test]
fn every_single_and_double_bit_error_is_garbage() {
    const LENGTH: usize = 2;
    for message in messages() {
        let mut bytes = encoded(message);
        let bits = bytes.len() * 8;
        bytes.extend([0; LONGEST]);
        for first in 0..bits {
            bytes[first / 8] ^= 1 << (first % 8);
            for second in first..bits {
                // The first bit alone, then each pair with it.
                let flipped = u8::from(second > first) << (second % 8);
                bytes[second / 8] ^= flipped;
                let mut parser = Parser::default();
                assert_eq!(parse(&mut parser, &bytes), [], "bits {first} and {second}");
                let is_length = first / 8 == LENGTH || second / 8 == LENGTH;
                assert!(
                    parser.foreign() <= u32::from(is_length),
                    "bits {first} and {second}"
                );
                bytes[second / 8] ^= flipped;
            }
            bytes[first / 8] ^= 1 << (first % 8);
        }
    }
}

#[test]
fn all_messages_within_noise_are_found() {
    let mut x = 0x2545_F491;
    let (mut bytes, mut sent) = (Vec::new(), Vec::new());
    for k in 0..2000 {
        for _ in 0..k % 40 {
            bytes.push(noise(&mut x));
        }
        let message = messages()[k % messages().len()];
        bytes.extend(encoded(message));
        sent.push(message);
    }
    let framed: usize = sent.iter().map(|message| encoded(*message).len()).sum();
    let garbage = bytes.len() - framed;
    bytes.extend([0; LONGEST]);
    let mut parser = Parser::default();
    assert_eq!(parse(&mut parser, &bytes), sent);
    assert_eq!(parser.garbage() as usize, garbage + LONGEST);
}

#[test]
fn frames_of_another_protocol_are_counted_and_hello_is_read() {
    let mut parser = Parser::default();
    // A kind that does not exist, and a frame with a field more.
    assert_eq!(parse(&mut parser, &framed(200, &[1, 2, 3])), []);
    let longer = [&encoded(FRAME.into())[3..][..59], &[0]].concat();
    assert_eq!(parse(&mut parser, &framed(2, &longer)), []);
    assert_eq!((parser.garbage(), parser.foreign()), (0, 2));
    // A later identity has the fields of this one, and more.
    let hello = encoded(Message::Hello(Hello {
        protocol: 9,
        ..HELLO
    }));
    let longer = [&hello[3..hello.len() - 2], b"more"].concat();
    let found = parse(&mut parser, &framed(1, &longer));
    let [Message::Hello(found)] = found[..] else {
        panic!("{found:?}");
    };
    assert_eq!((found.protocol, found.commit), (9, HELLO.commit));
    // A shorter one has not.
    assert_eq!(parse(&mut parser, &framed(1, &hello[3..20])), []);
}

/// A tool that knows one protocol reads the frames of every other one.
#[test]
fn payload_of_a_frame_is_of_128_bytes_at_most() {
    let mut parser = Parser::default();
    assert_eq!(parse(&mut parser, &framed(200, &[0; 128])), []);
    assert_eq!((parser.garbage(), parser.foreign()), (0, 1));
    // Nothing waits for the rest of a longer one.
    assert_eq!(parse(&mut parser, &[0x5A, 200, 129]), []);
    assert_eq!((parser.garbage(), parser.foreign()), (3, 1));
}

#[test]
fn labels_are_printable_whatever_the_bytes_are() {
    let mut x = 1;
    for _ in 0..100 {
        let payload: Vec<u8> = (0..52).map(|_| noise(&mut x)).collect();
        let found = parse(&mut Parser::default(), &framed(1, &payload));
        let [Message::Hello(hello)] = found[..] else {
            panic!("{found:?}");
        };
        for label in [hello.version, hello.commit] {
            assert!(
                label
                    .as_str()
                    .bytes()
                    .all(|byte| (b' '..=b'~').contains(&byte))
            );
        }
    }
    assert_eq!(Label::new("µ").as_str(), "??");
}
