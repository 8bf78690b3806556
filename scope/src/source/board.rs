//! A real board, or another process's virtual board, as a source: over its link.

use std::io;
use std::sync::Arc;
use std::sync::mpsc::Receiver;
use std::time::{Duration, Instant};

use drive::patience::{AGAIN, disarm};
use drive::port::Port;
use drive::refusal::{compatible, silent};
use drivers::link::{Hello, Message, Parser};
use drivers::{Command, encode};
use haptic_control::Fingerprint;
use serde_json::{Value, json};
use simulation::device::Device;
use terminal::failure::Failure;
use terminal::output::note;

use super::{PAGE_LEFT, SILENCE_ENDS, Source};
use crate::desk::{Desk, GAP_S};
use crate::facts;
use crate::hub::Hub;
use crate::order::Order;

/// Why a procedure of another program ends.
const FOUND_ENABLED: &str = "the board was enabled by another program";

/// A board at a port.
pub(crate) struct RealBoard {
    port: Port,
    parser: Parser,
    /// What the board has told of itself.
    hello: Hello,
    device: Device,
    /// Longest silence.
    patience: Duration,
}

impl RealBoard {
    /// The board at the port of this name: a serial port, or `tcp:HOST:PORT`. It has told its identity.
    ///
    /// # Errors
    /// [`Failure::Input`] if the port cannot be opened, or if the board speaks another protocol or does not
    /// answer.
    pub(crate) fn open(port: &str, device: Device, patience: Duration) -> Result<Self, Failure> {
        let mut port = Port::open(Some(port))?;
        let mut parser = Parser::default();
        let hello = identity(&mut port, &mut parser, patience)?;
        compatible(port.name(), &hello)?;
        if let Some(other) = other_device(&hello, &device) {
            note(format_args!("{}: {other}", port.name()));
        }
        Ok(Self {
            port,
            parser,
            hello,
            device,
            patience,
        })
    }
}

/// What a person has to know of an image for another device.
fn other_device(hello: &Hello, device: &Device) -> Option<String> {
    let [image, own] = [Fingerprint(hello.device), device.stages.fingerprint()];
    (image != own).then(|| {
        format!(
            "the image is for device {image}, the page for {own}: angles, speeds and forces are those of the wrong \
             device; give --device FILE of the board"
        )
    })
}

/// The amplifiers of a board at the begin.
#[derive(Clone, Copy)]
enum Found {
    /// No frame has come.
    Unknown,
    /// They were enabled, and a disarm was sent then.
    Enabled(Instant),
    /// They are disabled, or have been.
    Disarmed,
}

/// Asks a board for its identity until it answers.
fn identity(port: &mut Port, parser: &mut Parser, patience: Duration) -> Result<Hello, Failure> {
    let lost = |port: &Port, error| Failure::Input(port.lost(&error));
    let (begin, mut asked) = (Instant::now(), None);
    while begin.elapsed() < patience {
        if asked.is_none_or(|at: Instant| at.elapsed() >= AGAIN) {
            asked = Some(Instant::now());
            let sent = port.write(&encode(Command::Identify));
            sent.map_err(|error| lost(port, error))?;
        }
        let mut found = None;
        for message in read(port, parser).map_err(|error| lost(port, error))?.1 {
            if let Message::Hello(hello) = message {
                found = Some(hello);
            }
        }
        if let Some(hello) = found {
            return Ok(hello);
        }
    }
    Err(Failure::Input(silent(port.name(), parser)))
}

/// The bytes that have come, and their messages.
fn read(port: &mut Port, parser: &mut Parser) -> io::Result<(Vec<u8>, Vec<Message>)> {
    let mut bytes = vec![0; 4096];
    let number = port.read(&mut bytes)?;
    bytes.truncate(number);
    let mut messages = Vec::new();
    for byte in &bytes {
        parser.take(*byte, |message| messages.push(message));
    }
    Ok((bytes, messages))
}

impl Source for RealBoard {
    fn facts(&self) -> Value {
        let mut all = facts::of_device(&self.device);
        let text = "A board at its link. What only a simulation knows is missing.".to_owned();
        let text = match other_device(&self.hello, &self.device) {
            Some(other) => format!("{text} But {other}."),
            None => text,
        };
        all["source"] = json!({
            "kind": "board",
            "title": "board",
            "text": text,
            "from": self.port.name(),
            "gap": GAP_S,
        });
        all
    }

    fn run(mut self: Box<Self>, hub: Arc<Hub>, orders: Receiver<Order>) -> Result<(), Failure> {
        let mut desk = Desk::new(Arc::clone(&hub), &self.device)?;
        desk.message(Message::Hello(self.hello), None);
        let followed = self.follow(&mut desk, &orders);
        desk.close();
        // Before the disarm, which may wait for its answer.
        if let Err(failure) = &followed {
            hub.ended(failure);
        }
        // A lost connection cannot be told again.
        let _ = self.port.write(&desk.last_bytes());
        let disarmed = disarm(self.port, self.patience);
        followed.and(disarmed)
    }
}

impl RealBoard {
    fn follow(&mut self, desk: &mut Desk, orders: &Receiver<Order>) -> Result<(), Failure> {
        let (mut heard, mut was_silent) = (Instant::now(), None);
        // The first frames tell whether another program has left the board enabled.
        let mut found = Found::Unknown;
        while !desk.hub.stops() {
            let read = read(&mut self.port, &mut self.parser);
            let (bytes, messages) = read.map_err(|error| self.lost(&error))?;
            desk.heard(&bytes);
            for message in messages {
                heard = Instant::now();
                if let Message::Hello(hello) = message {
                    compatible(self.port.name(), &hello)?;
                }
                desk.message(message, None);
                if let Message::Frame(_) = message {
                    found = self.found(found, desk)?;
                }
            }
            let is_silent = heard.elapsed() >= self.patience;
            if is_silent != was_silent.is_some() {
                was_silent = self.turned(is_silent, desk)?;
            }
            // Before the orders: one that comes later is of another page.
            let is_left = desk.hub.take_left();
            while let Ok(order) = orders.try_recv() {
                // A board that is not heard gets no command but the one that disarms: it ends a scene by itself.
                if is_silent && order.needs_an_answer() {
                    continue;
                }
                if let Some(command) = desk.order(&order) {
                    self.send(command)?;
                }
            }
            // After the orders of the page that has left.
            if is_left {
                self.disarm(desk, PAGE_LEFT)?;
            }
            let bytes = desk.take_bytes();
            self.write(&bytes)?;
            let _ = desk.hub.take_hand();
            desk.tell(|| json!({ "silent": was_silent }));
        }
        Ok(())
    }

    /// Disarms a board that was enabled before this server, until a frame shows it: the page would keep a scene
    /// alive that it does not know.
    fn found(&mut self, before: Found, desk: &mut Desk) -> Result<Found, Failure> {
        let again = match before {
            Found::Disarmed => return Ok(before),
            _ if !desk.is_on() => return Ok(Found::Disarmed),
            Found::Unknown => {
                note(format_args!(
                    "{}: the board was enabled already, by another program or by itself; it is disarmed",
                    self.port.name()
                ));
                true
            }
            Found::Enabled(asked) => asked.elapsed() >= AGAIN,
        };
        if again {
            self.disarm(desk, FOUND_ENABLED)?;
            return Ok(Found::Enabled(Instant::now()));
        }
        Ok(before)
    }

    /// The board has become silent, or sends again: tells it, and disarms a silent board. Returns the message
    /// about the silence.
    fn turned(&mut self, is_silent: bool, desk: &mut Desk) -> Result<Option<String>, Failure> {
        if !is_silent {
            note(format_args!("{}: the board sends again", self.port.name()));
            return Ok(None);
        }
        let told = silent(self.port.name(), &self.parser);
        note(&told);
        self.disarm(desk, SILENCE_ENDS)?;
        Ok(Some(told))
    }

    fn disarm(&mut self, desk: &mut Desk, why: &str) -> Result<(), Failure> {
        let disarm = desk.disarm(why);
        self.send(disarm)
    }

    fn send(&mut self, command: Command) -> Result<(), Failure> {
        self.write(&encode(command))
    }

    fn write(&mut self, bytes: &[u8]) -> Result<(), Failure> {
        self.port.write(bytes).map_err(|error| self.lost(&error))
    }

    fn lost(&self, error: &io::Error) -> Failure {
        Failure::Input(self.port.lost(error))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn image_for_another_device_is_told() {
        let device = Device::default();
        let own = device.stages.fingerprint();
        let hello = |device| Hello {
            device,
            ..Hello::default()
        };
        assert_eq!(other_device(&hello(own.0), &device), None);
        let other = Fingerprint(own.0 ^ 1);
        let told = other_device(&hello(other.0), &device).expect("a notice");
        assert!(
            told.contains(&own.to_string()) && told.contains(&other.to_string()),
            "{told}"
        );
    }
}
