//! How long a program waits for a board.

use std::time::Duration;

use terminal::failure::Failure;

use crate::board::Board;
use crate::port::Port;

/// Longest wait for an answer, and longest silence, unless an option says otherwise, s.
pub const USUAL: &str = "2";

/// Time after which a question without an answer, or a command that the board has not followed, is sent again.
pub const AGAIN: Duration = Duration::from_millis(200);

/// Parses a longest wait, s.
///
/// # Errors
/// One line with the range.
pub fn patience(text: &str) -> Result<f64, String> {
    let seconds: Option<f64> = text.parse().ok();
    let seconds = seconds.filter(|seconds| (0.1..=60.0).contains(seconds));
    seconds.ok_or_else(|| "must be 0.1 to 60 s".to_owned())
}

/// Disarms the board at a port, and waits until a frame shows it.
///
/// # Errors
/// [`Failure::Check`] if the amplifiers stay enabled, [`Failure::Input`] if no frame comes or the connection
/// is lost.
pub fn disarm(port: Port, patience: Duration) -> Result<(), Failure> {
    Board::new(port, patience).disarm().map(|_| ())
}
