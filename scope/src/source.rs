//! Sources of the page: what runs behind the server.

mod board;
mod emulated;
mod pacer;
mod recorded;
mod truths;

use std::sync::Arc;
use std::sync::mpsc::Receiver;

use serde_json::Value;
use terminal::failure::Failure;

pub(crate) use board::RealBoard;
pub(crate) use emulated::Emulated;
pub(crate) use recorded::Recorded;

use crate::hub::Hub;
use crate::order::Order;

/// Why a procedure ends, and the board is disarmed: it is silent.
const SILENCE_ENDS: &str = "ended, as the board sends nothing";
/// Why a procedure ends, and the board is disarmed: the page that commands has gone, or its order found no room.
const PAGE_LEFT: &str = "ended by the page";

/// A source: it sends rows and a status to the hub, and follows orders.
pub(crate) trait Source: Send {
    /// What a page has to know of the source.
    fn facts(&self) -> Value;

    /// Runs until the hub stops.
    ///
    /// # Errors
    /// The failure that ends the source.
    fn run(self: Box<Self>, hub: Arc<Hub>, orders: Receiver<Order>) -> Result<(), Failure>;
}
