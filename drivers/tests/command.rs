//! The command parser against frames, floods and garbage.

use drivers::{Parser, encode};
use haptic_control::Request;

const REQUESTS: [Request; 5] = [
    Request::Arm,
    Request::Disarm,
    Request::Select(7),
    Request::Select(0xA5),
    Request::KeepAlive,
];

fn parse(parser: &mut Parser, bytes: &[u8]) -> Vec<Request> {
    bytes.iter().filter_map(|&byte| parser.take(byte)).collect()
}

#[test]
fn what_is_encoded_is_found_with_nothing_lost() {
    let mut parser = Parser::default();
    for request in REQUESTS {
        assert_eq!(parse(&mut parser, &encode(request)), [request]);
    }
    assert_eq!(parser.garbage(), 0);
}

#[test]
fn a_frame_is_found_behind_any_beginning_of_another() {
    for request in REQUESTS {
        for other in REQUESTS {
            for cut in 0..11 {
                let mut parser = Parser::default();
                let mut bytes = encode(other)[..cut].to_vec();
                bytes.extend(encode(request));
                // What comes next pushes out what is left of the torn frame.
                bytes.extend([0; 11]);
                assert_eq!(
                    parse(&mut parser, &bytes),
                    [request],
                    "{other:?} cut at {cut}"
                );
                assert_eq!(parser.garbage() as usize, cut + 11);
            }
        }
    }
}

#[test]
fn every_single_bit_error_is_garbage() {
    for request in REQUESTS {
        for bit in 0..88 {
            let mut bytes = encode(request);
            bytes[bit / 8] ^= 1 << (bit % 8);
            let mut parser = Parser::default();
            assert_eq!(parse(&mut parser, &bytes), []);
        }
    }
}

#[test]
fn unknown_kinds_are_counted_and_ignored() {
    let mut parser = Parser::default();
    let mut bytes = [0xA5, 9, 0, 0, 0, 0, 0, 0, 0, 0, 0];
    bytes[10] = bytes[1..10].iter().fold(0_u8, |crc, &byte| {
        (0..8).fold(crc ^ byte, |crc, _| {
            if crc & 0x80 == 0 {
                crc << 1
            } else {
                crc << 1 ^ 7
            }
        })
    });
    assert_eq!(parse(&mut parser, &bytes), []);
    assert_eq!(parser.garbage(), 11);
}

#[test]
fn a_flood_of_noise_is_bounded_and_mostly_garbage() {
    let mut parser = Parser::default();
    let mut x = 0x1234_5678_u32;
    let mut found = 0;
    for _ in 0..1_000_000 {
        x ^= x << 13;
        x ^= x >> 17;
        x ^= x << 5;
        found += u32::from(parser.take(x as u8).is_some());
    }
    // A start byte, a CRC and a known kind by chance: 1e6 / 2^24 * 4 = 0.24.
    assert!(found <= 3, "{found}");
    assert!(parser.garbage() > 999_900);
}
