//! A real board, or another process's virtual board, as a source: over its link.

use std::io;
use std::sync::Arc;
use std::sync::mpsc::Receiver;
use std::time::{Duration, Instant};

use drive::port::Port;
use drive::refusal::compatible;
use drivers::link::{Message, Parser};
use drivers::{Command, encode};
use haptic_control::Request;
use serde_json::{Value, json};
use simulation::device::Device;
use terminal::failure::Failure;

use super::Source;
use crate::desk::Desk;
use crate::facts;
use crate::hub::Hub;
use crate::order::Order;

/// Interval of the question for the identity, until it is answered.
const AGAIN: Duration = Duration::from_millis(200);

/// A board at a port.
pub(crate) struct RealBoard {
    port: Port,
    device: Device,
}

impl RealBoard {
    /// The board at the port of this name: a serial port, or `tcp:HOST:PORT`.
    ///
    /// # Errors
    /// [`Failure::Input`] if the port cannot be opened.
    pub(crate) fn open(port: &str, device: Device) -> Result<Self, Failure> {
        Ok(Self {
            port: Port::open(Some(port))?,
            device,
        })
    }
}

impl Source for RealBoard {
    fn facts(&self) -> Value {
        let mut all = facts::of_device(&self.device);
        all["source"] = json!({
            "kind": "board",
            "title": "board",
            "text": "A board at its link. What only a simulation knows is missing.",
            "from": self.port.name(),
        });
        all
    }

    fn run(mut self: Box<Self>, hub: Arc<Hub>, orders: Receiver<Order>) -> Result<(), Failure> {
        let mut desk = Desk::new(Arc::clone(&hub), &self.device)?;
        let followed = self.follow(&mut desk, &orders);
        // A lost connection cannot be told again.
        let _ = self.port.write(&encode(Command::Request(Request::Disarm)));
        self.port.finish();
        desk.close();
        followed
    }
}

impl RealBoard {
    fn follow(&mut self, desk: &mut Desk, orders: &Receiver<Order>) -> Result<(), Failure> {
        let mut parser = Parser::default();
        let mut asked: Option<Instant> = None;
        while !desk.hub.stops() {
            if desk.hello().is_none() && asked.is_none_or(|at| at.elapsed() >= AGAIN) {
                asked = Some(Instant::now());
                self.send(Command::Identify)?;
            }
            let mut bytes = [0; 4096];
            let number = self
                .port
                .read(&mut bytes)
                .map_err(|error| self.lost(&error))?;
            desk.heard(&bytes[..number]);
            let mut messages = Vec::new();
            for byte in &bytes[..number] {
                parser.take(*byte, |message| messages.push(message));
            }
            for message in messages {
                if let Message::Hello(hello) = message {
                    compatible(self.port.name(), &hello)?;
                }
                desk.message(message, None);
            }
            while let Ok(order) = orders.try_recv() {
                // A board that is not identified gets no command but the one that disarms.
                let command = desk.order(&order);
                let is_known = desk.hello().is_some() || order == Order::Disarm;
                if let Some(command) = command.filter(|_| is_known) {
                    self.send(command)?;
                }
            }
            // After the orders of the page that has left.
            if desk.hub.take_left()
                && let Some(command) = desk.order(&Order::Disarm)
            {
                self.send(command)?;
            }
            let bytes = desk.take_bytes();
            self.write(&bytes)?;
            let _ = desk.hub.take_hand();
            desk.tell(|| json!({}));
        }
        Ok(())
    }

    fn send(&mut self, command: Command) -> Result<(), Failure> {
        self.write(&encode(command))
    }

    fn write(&mut self, bytes: &[u8]) -> Result<(), Failure> {
        self.port.write(bytes).map_err(|error| self.lost(&error))
    }

    fn lost(&self, error: &io::Error) -> Failure {
        Failure::Input(format!(
            "{}: connection lost: {error}; check cable and power, then run the command again",
            self.port.name()
        ))
    }
}
