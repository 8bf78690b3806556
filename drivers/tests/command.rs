//! The command parser against frames, floods and garbage.

use drivers::link::PROTOCOL;
use drivers::{Command, Parser, encode};
use haptic_control::Request;

/// Every command.
const COMMANDS: [Command; 13] = [
    Command::Request(Request::Arm),
    Command::Request(Request::Disarm),
    Command::Request(Request::Select(7)),
    Command::Request(Request::Select(0xA5)),
    Command::Request(Request::KeepAlive),
    Command::Torque(-0.0125),
    // Its bytes hold the start byte.
    Command::Torque(f32::from_bits(0xA5A5_0101)),
    Command::Tune {
        scene: 2,
        parameter: 1,
        value: 0.3,
    },
    Command::Estimator(3),
    Command::Identify,
    Command::Set {
        setting: 4,
        value: 0.5,
    },
    Command::Settings,
    Command::Store,
];

/// Bit by bit, by its polynomial.
fn crc8(bytes: &[u8]) -> u8 {
    bytes.iter().fold(0, |crc, &byte| {
        (0..8).fold(crc ^ byte, |crc, _| {
            if crc & 0x80 == 0 {
                crc << 1
            } else {
                crc << 1 ^ 7
            }
        })
    })
}

fn parse(parser: &mut Parser, bytes: &[u8]) -> Vec<Command> {
    bytes.iter().filter_map(|&byte| parser.take(byte)).collect()
}

/// Kinds and payloads are on the wire between a tool and a board of another release: a change takes another
/// [`PROTOCOL`](drivers::link::PROTOCOL).
#[test]
fn commands_have_the_bytes_of_protocol_1() {
    let bodies = [
        [1, 0, 0, 0, 0, 0, 0, 0, 0],
        [2, 0, 0, 0, 0, 0, 0, 0, 0],
        [3, 7, 0, 0, 0, 0, 0, 0, 0],
        [3, 0xA5, 0, 0, 0, 0, 0, 0, 0],
        [5, 0, 0, 0, 0, 0, 0, 0, 0],
        // -0.0125 is 0xBC4CCCCD, 0.3 is 0x3E99999A and 0.5 is 0x3F000000.
        [4, 0xCD, 0xCC, 0x4C, 0xBC, 0, 0, 0, 0],
        [4, 0x01, 0x01, 0xA5, 0xA5, 0, 0, 0, 0],
        [6, 2, 1, 0x9A, 0x99, 0x99, 0x3E, 0, 0],
        [7, 3, 0, 0, 0, 0, 0, 0, 0],
        [8, 0, 0, 0, 0, 0, 0, 0, 0],
        [9, 4, 0, 0, 0, 0x3F, 0, 0, 0],
        [10, 0, 0, 0, 0, 0, 0, 0, 0],
        [11, 0, 0, 0, 0, 0, 0, 0, 0],
    ];
    assert_eq!(PROTOCOL, 1);
    for (command, body) in COMMANDS.into_iter().zip(bodies) {
        let bytes = encode(command);
        assert_eq!((bytes[0], &bytes[1..10]), (0xA5, &body[..]), "{command:?}");
        assert_eq!(bytes[10], crc8(&body), "{command:?}");
    }
}

#[test]
fn encoded_frames_are_decoded_without_loss() {
    let mut parser = Parser::default();
    for command in COMMANDS {
        assert_eq!(parse(&mut parser, &encode(command)), [command]);
    }
    assert_eq!(parser.garbage(), 0);
}

/// An eight-bit checksum takes one of 256 torn frames for another; among these there is none such
/// (one begins as `Estimator(1)` and ends in the middle of `Tune`).
#[test]
fn frame_is_found_after_an_incomplete_frame() {
    for command in COMMANDS {
        for other in COMMANDS {
            for cut in 0..11 {
                let mut parser = Parser::default();
                let mut bytes = encode(other)[..cut].to_vec();
                bytes.extend(encode(command));
                // What comes next pushes out what is left of the torn frame.
                bytes.extend([0; 11]);
                assert_eq!(
                    parse(&mut parser, &bytes),
                    [command],
                    "{other:?} cut at {cut}"
                );
                assert_eq!(parser.garbage() as usize, cut + 11);
            }
        }
    }
}

/// Six bytes of one frame and the first five of the next, with the right CRC.
#[test]
fn torn_frame_with_a_valid_crc_is_rejected() {
    let torn = encode(Command::Estimator(1));
    let next = encode(COMMANDS[7]);
    let mut bytes = [torn[0], torn[1], torn[2], 0, 0, 0, 0, 0, 0, 0, 0];
    bytes[6..].copy_from_slice(&next[..5]);
    assert_eq!(crc8(&bytes[1..10]), bytes[10], "the chance");
    let mut parser = Parser::default();
    assert_eq!(parse(&mut parser, &bytes), []);
    assert_eq!(parse(&mut parser, &next[5..]), [COMMANDS[7]]);
}

#[test]
fn every_single_bit_error_is_garbage() {
    for command in COMMANDS {
        for bit in 0..88 {
            let mut bytes = encode(command);
            bytes[bit / 8] ^= 1 << (bit % 8);
            let mut parser = Parser::default();
            assert_eq!(parse(&mut parser, &bytes), []);
        }
    }
}

#[test]
fn unknown_kinds_of_frames_are_counted_and_ignored() {
    let mut parser = Parser::default();
    let mut bytes = [0xA5, 12, 0, 0, 0, 0, 0, 0, 0, 0, 0];
    bytes[10] = crc8(&bytes[1..10]);
    assert_eq!(parse(&mut parser, &bytes), []);
    assert_eq!(parser.garbage(), 11);
}

#[test]
fn noise_is_counted_as_garbage_with_few_valid_frames() {
    let mut parser = Parser::default();
    let mut x = 0x1234_5678_u32;
    let mut found = 0;
    for _ in 0..1_000_000 {
        x ^= x << 13;
        x ^= x >> 17;
        x ^= x << 5;
        found += u32::from(parser.take(x as u8).is_some());
    }
    // A start byte, a CRC and one of 11 known kinds by chance: 1e6 / 2^24 * 11 = 0.66; most have bytes of 0.
    assert!(found <= 3, "{found}");
    assert!(parser.garbage() > 999_900);
}

#[test]
fn all_frames_within_noise_are_found() {
    let mut parser = Parser::default();
    let mut x = 0x2545_F491_u32;
    let (mut bytes, mut sent) = (Vec::new(), Vec::new());
    for k in 0..2000_usize {
        for _ in 0..k % 40 {
            x ^= x << 13;
            x ^= x >> 17;
            x ^= x << 5;
            // Noise without a start byte cannot hide the frame that follows.
            bytes.push(if x as u8 == 0xA5 { 0 } else { x as u8 });
        }
        let command = COMMANDS[k % COMMANDS.len()];
        bytes.extend(encode(command));
        sent.push(command);
    }
    assert_eq!(parse(&mut parser, &bytes), sent);
    assert_eq!(parser.garbage() as usize, bytes.len() - 11 * sent.len());
}

#[test]
fn values_are_transmitted_bit_for_bit_without_a_range_check() {
    for bits in [0, 0x7FC0_0001, 0x7F80_0000, 0xFF80_0000, 1, 0x3F80_0000] {
        let mut parser = Parser::default();
        let tune = Command::Tune {
            scene: 8,
            parameter: 0,
            value: f32::from_bits(bits),
        };
        match parse(&mut parser, &encode(tune))[..] {
            [
                Command::Tune {
                    scene: 8,
                    parameter: 0,
                    value,
                },
            ] => {
                assert_eq!(value.to_bits(), bits);
            }
            ref other => panic!("{other:?}"),
        }
    }
}
