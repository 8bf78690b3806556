//! The guided procedures, for a program that shows their lines itself.

use std::time::Duration;

use drivers::Setting;
use terminal::failure::Failure;

use crate::board::Board;
use crate::port::Port;
use crate::{bring_up, calibrate};

/// Longest wait for an answer: an emulated board may be slow.
const PATIENCE: Duration = Duration::from_secs(10);

/// A guided procedure.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Guided {
    /// Checks a new board and its motors, and verifies the signs of encoders and currents.
    BringUp,
    /// Finds zero and gain of both current outputs by measured currents.
    Calibrate,
}

impl Guided {
    /// All procedures.
    pub const ALL: [Self; 2] = [Self::BringUp, Self::Calibrate];

    /// Name, as that of the command.
    #[must_use]
    pub const fn as_str(self) -> &'static str {
        match self {
            Self::BringUp => "bring-up",
            Self::Calibrate => "calibrate",
        }
    }

    /// Settings that the board may have from the middle of the procedure if it is ended from outside: they are those
    /// from before again after an end by itself. Bring-up leaves no verification of before.
    #[must_use]
    pub const fn provisional(self) -> &'static [Setting] {
        match self {
            Self::BringUp => &[],
            Self::Calibrate => &calibrate::SETTINGS,
        }
    }

    /// Runs the procedure on the board at a port, and hands each line to `listener`. It stores nothing.
    ///
    /// # Errors
    /// [`Failure::Check`] if a check failed, [`Failure::Input`] if the connection is lost. The board is
    /// disarmed in every case, as far as the connection allows.
    pub fn run(self, port: Port, listener: impl FnMut(String) + 'static) -> Result<(), Failure> {
        let mut board = Board::new(port, PATIENCE);
        board.speak_to(Box::new(listener));
        match self {
            Self::BringUp => bring_up::run(&mut board, false, false),
            Self::Calibrate => calibrate::run(&mut board, false),
        }
    }
}
