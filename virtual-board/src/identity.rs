//! The identity of an image, as its link tells it at boot.

use drivers::link::{Hello, Message, Parser};

use crate::image::Image;
use crate::run::{Setup, on_board};

/// Virtual time in which an image boots and tells its identity, s.
const BOOT_S: f64 = 0.02;

/// Boots an image; `None` if it does not tell its identity.
///
/// # Errors
/// As [`on_board`].
pub(crate) fn of(image: &Image) -> Result<Option<Hello>, String> {
    let setup = Setup {
        seconds: BOOT_S,
        commands: Vec::new(),
        ..Setup::default()
    };
    let outcome = on_board(image, &setup, |_| ())?;
    let (mut parser, mut identity) = (Parser::default(), None);
    for (_, byte) in outcome.port {
        parser.take(byte, |message| {
            if let Message::Hello(hello) = message {
                identity = Some(hello);
            }
        });
    }
    Ok(identity)
}
