//! The virtual board as a source: the flash image on the emulated board, paced to real time.

use std::mem;
use std::path::PathBuf;
use std::sync::mpsc::Receiver;
use std::sync::{Arc, Mutex, PoisonError};

use drivers::link::{Message, Parser};
use drivers::{Command, encode};
use serde_json::{Value, json};
use simulation::device::Device;
use terminal::failure::Failure;
use virtual_board::bridge::WAITING;
use virtual_board::fault::Fault;
use virtual_board::image::{HOW_TO_BUILD, Image};
use virtual_board::live::{self, Acts, Client, Hold, Seen};
use virtual_board::run::Setup;

use super::pacer::Pacer;
use super::truths::Truths;
use super::{PAGE_LEFT, SILENCE_ENDS, Source};
use crate::desk::{Desk, FRAMES_HZ, GAP_S};
use crate::facts;
use crate::fault_watch::FaultWatch;
use crate::hub::Hub;
use crate::order::Order;
use crate::values::Truth;

/// Longest run before the board starts again, s: a year.
const SECONDS: f64 = 3.2e7;
/// What a page says of a silent board.
const SILENT: &str =
    "The board sends nothing: its core or its line stands still; Restart gives a new board";

/// Virtual time without a message from which on the board is silent, ns: that of a board at a port.
const SILENT_NS: u64 = 2_000_000_000;

/// The flash image on the emulated board.
pub(crate) struct Emulated {
    image: Image,
    /// Where the image is from, for the page.
    from: String,
    device: Device,
}

impl Emulated {
    /// The image of this file, or one that is built now.
    ///
    /// # Errors
    /// [`Failure::Input`] if there is no image.
    pub(crate) fn new(file: Option<PathBuf>, device: Device) -> Result<Self, Failure> {
        let (image, from) = match file {
            Some(path) => (Image::read(&path)?, path.display().to_string()),
            None => (Image::build("")?, HOW_TO_BUILD.to_owned()),
        };
        Ok(Self {
            image,
            from,
            device,
        })
    }
}

impl Source for Emulated {
    fn facts(&self) -> Value {
        let faults: Vec<_> = Fault::all()
            .filter(|fault| !fault.acts_from_power_up())
            .collect();
        let faults = faults
            .iter()
            .map(|fault| json!([fault.as_str(), fault.description()]));
        let mut all = facts::of_device(&self.device);
        all["source"] = json!({
            "kind": "emulated",
            "title": "virtual board",
            "text": "The flash image runs on an emulated board with a simulated device. No silicon runs.",
            "from": self.from,
            "gap": GAP_S,
        });
        all["faults"] = faults.collect();
        all
    }

    fn run(self: Box<Self>, hub: Arc<Hub>, orders: Receiver<Order>) -> Result<(), Failure> {
        let desk = Desk::new(Arc::clone(&hub), &self.device)?;
        let table = Arc::new(Mutex::new(Table {
            desk,
            orders,
            restarts: false,
            offset_s: 0.0,
        }));
        let setup = Setup {
            device: self.device,
            hand: experiments::closed_loop::Hand::Gone(0.0),
            seconds: SECONDS,
            commands: Vec::new(),
            keep_alive: false,
            ..Setup::default()
        };
        while !hub.stops() {
            let seat = Seat::new(&table);
            live::run(&self.image, &setup, Box::new(seat))?;
            let mut table = table.lock().unwrap_or_else(PoisonError::into_inner);
            table.restarts = false;
            table.offset_s = table.desk.t() + 1.0 / FRAMES_HZ;
            table.desk.restarted();
        }
        let mut table = table.lock().unwrap_or_else(PoisonError::into_inner);
        table.desk.close();
        Ok(())
    }
}

/// What outlives a restart of the run.
struct Table {
    desk: Desk,
    orders: Receiver<Order>,
    /// Whether the run is to start again.
    restarts: bool,
    /// Time of the runs before, s.
    offset_s: f64,
}

/// The client of one run.
struct Seat {
    table: Arc<Mutex<Table>>,
    parser: Parser,
    truths: Truths,
    pacer: Pacer,
    restarts: usize,
    is_held: bool,
    /// Virtual time of the latest message, ns.
    heard_ns: u64,
    is_silent: bool,
    /// Control ticks of a frame.
    frame_ticks: usize,
    last_enables: [bool; 2],
}

impl Seat {
    fn new(table: &Arc<Mutex<Table>>) -> Self {
        Self {
            table: Arc::clone(table),
            parser: Parser::default(),
            truths: Truths::default(),
            pacer: Pacer::new(),
            restarts: 0,
            is_held: false,
            heard_ns: 0,
            is_silent: false,
            frame_ticks: 1,
            last_enables: [false; 2],
        }
    }

    /// Takes what the board has sent, and gives its messages to the desk.
    fn hear(&mut self, seen: &Seen<'_>, desk: &mut Desk, offset_s: f64) {
        let mut messages = Vec::new();
        for byte in seen.sent {
            self.parser.take(*byte, |message| messages.push(message));
        }
        if !messages.is_empty() {
            self.heard_ns = seen.at_ns;
        }
        for message in messages {
            if let Message::Hello(hello) = message {
                self.frame_ticks = (f64::from(hello.rate) / FRAMES_HZ) as usize;
            }
            let truth = match &message {
                Message::Frame(frame) => self.truths.of(frame, self.frame_ticks.saturating_sub(1)),
                _ => None,
            };
            let truth = truth.map(|(tick, instructions)| Truth {
                t: offset_s + tick.at_ns as f64 * 1e-9,
                large: [tick.large.angle, tick.large.omega],
                handle: [tick.handle.angle, tick.handle.omega],
                felt: tick.felt,
                currents: seen.currents,
                instructions,
                hand: seen.hand.map(|pose| pose.angle),
            });
            desk.message(message, truth.as_ref());
        }
    }

    /// Follows the orders of the page. Without room on the line they stay, unless the page has left.
    fn take_orders(&self, table: &mut Table, seen: &Seen<'_>, acts: &mut Acts, is_left: bool) {
        loop {
            // The line is slower than a page.
            let has_room = seen.waiting + acts.send.len() < WAITING;
            if !has_room && !is_left {
                break;
            }
            let Ok(order) = table.orders.try_recv() else {
                break;
            };
            match &order {
                Order::Restart => table.restarts = true,
                Order::Fault { name } => {
                    if let Ok(fault) = name.parse() {
                        let now = seen.at_ns + (table.offset_s * 1e9) as u64;
                        let was_on = self.last_enables != [false; 2];
                        table.desk.fault = Some(FaultWatch::new(fault, now, was_on));
                        acts.faults.push(fault);
                    }
                }
                _ => {}
            }
            // What has to wait would follow the disarm of the page that has left.
            if (self.is_silent || !has_room) && order.needs_an_answer() {
                continue;
            }
            if let Some(command) = table.desk.order(&order) {
                acts.send.extend(encode(command));
            }
        }
    }
}

impl Client for Seat {
    fn look(&mut self, seen: &Seen<'_>, acts: &mut Acts) -> bool {
        let table = Arc::clone(&self.table);
        let mut locked = table.lock().unwrap_or_else(PoisonError::into_inner);
        let table = &mut *locked;
        if mem::replace(&mut self.restarts, seen.restarts) != seen.restarts {
            self.truths = Truths::default();
            table.desk.restarted();
        }
        self.truths.add(seen.ticks);
        if let Some((_, on)) = seen.enables.last() {
            self.last_enables = *on;
        }
        if let Some(watch) = &mut table.desk.fault {
            watch.enables(&shifted(seen.enables, table.offset_s));
        }
        table.desk.heard(seen.sent);
        self.hear(seen, &mut table.desk, table.offset_s);
        if table.desk.hello().is_none() && seen.at_ns.is_multiple_of(100_000_000) {
            acts.send.extend(encode(Command::Identify));
        }
        let is_silent = seen.at_ns.saturating_sub(self.heard_ns) >= SILENT_NS;
        let was_silent = mem::replace(&mut self.is_silent, is_silent);
        if is_silent && !was_silent {
            acts.send.extend(encode(table.desk.disarm(SILENCE_ENDS)));
        }
        // Before the orders: one that comes later is of another page.
        let is_left = table.desk.hub.take_left();
        self.take_orders(table, seen, acts, is_left);
        // After the orders of the page that has left.
        if is_left {
            acts.send.extend(encode(table.desk.disarm(PAGE_LEFT)));
        }
        acts.send.extend(table.desk.take_bytes());
        if let Some(Order::Hand { at }) = table.desk.hub.take_hand() {
            self.is_held = at.is_some();
            acts.hand = Some(at.map_or(Hold::Free, Hold::At));
        } else if self.is_held && table.desk.hub.is_abandoned() {
            self.is_held = false;
            acts.hand = Some(Hold::Free);
        }
        let silent = is_silent.then_some(SILENT);
        table.desk.tell(|| {
            let mut status = self.pacer.json();
            status["silent"] = silent.into();
            status
        });
        let goes_on = !table.desk.hub.stops() && !table.restarts;
        drop(locked);
        self.pacer.wait(seen.at_ns);
        goes_on
    }
}

/// Changes of the enables, in the time of all runs.
fn shifted(enables: &[(u64, [bool; 2])], offset_s: f64) -> Vec<(u64, [bool; 2])> {
    let offset = (offset_s * 1e9) as u64;
    enables.iter().map(|(at, on)| (at + offset, *on)).collect()
}

#[cfg(test)]
mod tests {
    use haptic_control::Request;

    use super::*;

    /// The client of a board, and its hub.
    fn seat() -> (Arc<Hub>, Seat) {
        let (hub, orders) = Hub::new("token".to_owned(), Value::Null);
        let desk = Desk::new(Arc::clone(&hub), &Device::default()).expect("a desk");
        let table = Table {
            desk,
            orders,
            restarts: false,
            offset_s: 0.0,
        };
        (hub, Seat::new(&Arc::new(Mutex::new(table))))
    }

    /// What is done at a board that sends nothing, with so many bytes on their way to it.
    fn look(seat: &mut Seat, waiting: usize) -> Acts {
        let mut acts = Acts::default();
        let seen = Seen {
            at_ns: 1,
            sent: &[],
            waiting,
            ticks: &[],
            restarts: 0,
            currents: [0.0; 2],
            enables: &[],
            hand: None,
        };
        assert!(seat.look(&seen, &mut acts));
        acts
    }

    /// A page that freezes holds no handle. Nobody commands here.
    #[test]
    fn hand_of_a_page_that_is_not_heard_lets_go_once() {
        let (hub, mut seat) = seat();
        let mut hand = || look(&mut seat, 0).hand;
        hub.order(Order::Hand { at: Some(0.25) });
        assert!(matches!(hand(), Some(Hold::At(0.25))));
        assert!(matches!(hand(), Some(Hold::Free)));
        assert!(hand().is_none());
    }

    /// The line of a board in slow motion takes the orders of a page later than they come.
    #[test]
    fn order_that_waits_for_the_line_does_not_follow_the_disarm_of_its_page() {
        let (hub, mut seat) = seat();
        let mut sent = |waiting| look(&mut seat, waiting).send;
        let page = hub.enter();
        assert!(hub.join(page));
        let [arm, disarm] = [Request::Arm, Request::Disarm].map(|it| encode(Command::Request(it)));
        hub.order(Order::Arm);
        assert_eq!((sent(WAITING), sent(0)), (Vec::new(), arm.to_vec()));
        hub.order(Order::Arm);
        hub.leave(page);
        assert_eq!((sent(WAITING), sent(0)), (disarm.to_vec(), Vec::new()));
    }
}
