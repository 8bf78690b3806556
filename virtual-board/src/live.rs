//! A client of a run: it sees the board every millisecond of virtual time, and acts on it.
//!
//! The run waits for the client, so that a client that sleeps sets the pace. A run without a client is
//! not changed by this module.

mod guided;

use simulation::plant::Pose;
use terminal::failure::Failure;

use crate::bridge;
use crate::fault::Fault;
use crate::image::Image;
use crate::objections;
use crate::port::Wire;
use crate::run::{ControlTick, Setup, emulate};
pub(crate) use guided::Guided;
pub use guided::{FASTEST_RAD_S, FOLLOWING_PER_S};

/// A client of a run.
pub trait Client: Send {
    /// Looks at the board and acts on it; whether the run goes on. Virtual time stands still until the
    /// client returns.
    fn look(&mut self, seen: &Seen<'_>, acts: &mut Acts) -> bool;
}

/// What a client sees at a look.
#[derive(Clone, Copy, Debug)]
pub struct Seen<'a> {
    /// Virtual time, ns.
    pub at_ns: u64,
    /// Bytes that the board's serial port has sent since the last look.
    pub sent: &'a [u8],
    /// Bytes to the board that have not left yet.
    pub waiting: usize,
    /// Calls of the control task that have ended since the last look.
    pub ticks: &'a [ControlTick],
    /// Restarts of the processor so far.
    pub restarts: usize,
    /// Currents of the large and the small motor, A.
    pub currents: [f64; 2],
    /// Changes of the amplifiers' enables with their times in ns: the latest one before the last look, then
    /// those since.
    pub enables: &'a [(u64, [bool; 2])],
    /// Intended position and velocity of the hand; `None` without a hand.
    pub hand: Option<Pose>,
}

/// What a client does at a look.
#[derive(Clone, Debug, Default)]
pub struct Acts {
    /// Bytes to the board's serial port.
    pub send: Vec<u8>,
    /// Faults that begin now. One that acts from power-up on has no effect.
    pub faults: Vec<Fault>,
    /// The hand from now on; `None` leaves it as it is.
    pub hand: Option<Hold>,
}

/// A hand that a client guides. The hand is the spring and the damper of the device file between the
/// handle and the target, which it follows with [`FOLLOWING_PER_S`] and at most [`FASTEST_RAD_S`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Hold {
    /// The hand lets go of the handle.
    Free,
    /// The hand holds the handle and moves to this angle, rad.
    At(f64),
}

/// Runs `image` with a client, until the end of the setup or until the client ends the run. Only the
/// last state is kept, so that a run may be long.
///
/// # Errors
/// As [`on_board`](crate::run::on_board) and [`Outcome::check`](crate::run::Outcome::check).
pub fn run(image: &Image, setup: &Setup, client: Box<dyn Client>) -> Result<(), Failure> {
    let live = Live::Client(client);
    let (session, _, _) = emulate(image, setup, Some(live), |_| ())?;
    objections::verdict(&objections::of(&session))
}

/// The client of a run: one of this module, or that of the bridge.
pub(crate) enum Live {
    Client(Box<dyn Client>),
    Bridge(bridge::Served),
}

impl Live {
    /// Serves the client; whether the run goes on.
    pub(crate) fn look(&mut self, wire: &mut Wire, seen: Seen<'_>, acts: &mut Acts) -> bool {
        match self {
            Self::Bridge(served) => served.look(wire, seen.at_ns),
            Self::Client(client) => {
                let sent: Vec<u8> = wire.up.drain(..).map(|(_, byte)| byte).collect();
                let seen = Seen {
                    sent: &sent,
                    waiting: wire.down.len(),
                    ..seen
                };
                let goes_on = client.look(&seen, acts);
                let bytes = acts.send.drain(..);
                wire.down.extend(bytes.map(|byte| (seen.at_ns, byte)));
                goes_on
            }
        }
    }
}
