//! The serial port of the board over TCP.

use std::io::{Read as _, Write as _};
use std::net::TcpStream;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use drivers::link::{Message, Parser};
use haptic_control::Mode;
use virtual_board::bridge::Bridge;
use virtual_board::command::Command;
use virtual_board::run::Setup;

use crate::image::image;
use crate::link::{IDENTIFY, frame};

/// Messages that a client reads until it has one of these.
fn read_until(client: &mut TcpStream, wanted: impl Fn(&Message) -> bool) -> Message {
    let mut parser = Parser::default();
    let mut found = None;
    let mut byte = [0];
    while found.is_none() {
        client.read_exact(&mut byte).expect("the run ended");
        parser.take(byte[0], |message| {
            found = Some(message).filter(|it| wanted(it)).or(found);
        });
    }
    found.expect("a message")
}

/// A client on TCP commands the board; a second one is told that there is one, and is served once the
/// first has gone.
#[test]
fn bridge_serves_one_client_after_the_other() {
    let bridge = Bridge::bind(0).unwrap();
    let address = bridge.address();
    assert!(address.ip().is_loopback());
    let setup = Setup {
        // Until the clients are through.
        seconds: 60.0,
        commands: Vec::new(),
        keep_alive: false,
        ..Setup::default()
    };
    let stop = Arc::new(AtomicBool::new(false));
    let until = Arc::clone(&stop);
    let image = image("");
    let runs = std::thread::spawn(move || bridge.run(image, &setup, until).unwrap());
    let is_frame = |mode| move |message: &Message| matches!(message, Message::Frame(frame) if frame.state == mode);
    let mut first = TcpStream::connect(address).unwrap();
    first.write_all(&IDENTIFY).unwrap();
    read_until(&mut first, |it| matches!(it, Message::Hello(_)));
    read_until(&mut first, |it| matches!(it, Message::Rejected(_)));
    let mut refusal = String::new();
    let mut second = TcpStream::connect(address).unwrap();
    second.read_to_string(&mut refusal).unwrap();
    assert!(refusal.starts_with("the board has a client"), "{refusal}");
    first.write_all(&frame(Command::Arm)).unwrap();
    read_until(&mut first, is_frame(Mode::Armed as u8));
    drop(first);
    // The bridge sees the end at its next look; until then it refuses.
    let mut third = loop {
        let mut client = TcpStream::connect(address).unwrap();
        let mut byte = [0];
        client.read_exact(&mut byte).unwrap();
        if byte != [refusal.as_bytes()[0]] {
            break client;
        }
    };
    third.write_all(&frame(Command::Disarm)).unwrap();
    read_until(&mut third, is_frame(Mode::Boot as u8));
    stop.store(true, Ordering::Relaxed);
    let (pace, _) = runs.join().unwrap();
    assert!(pace.seconds < 60.0, "{pace:?}");
}
