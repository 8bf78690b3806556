//! Commands of a run that the image has refused.

use drive::refusal::refusal;
use drivers::link::{Message, Parser, Rejected};

use crate::run::Outcome;

impl Outcome {
    /// Why the image has refused a command, as its serial port tells it; `None` if it has not. Noise on the
    /// command channel is no command.
    #[must_use]
    pub fn refusal(&self) -> Option<&'static str> {
        let (mut parser, mut told) = (Parser::default(), None);
        for (_, byte) in &self.port {
            parser.take(*byte, |message| {
                if let Message::Rejected(counts) = message {
                    told = told.or_else(|| refusal(&Rejected::default(), &counts));
                }
            });
        }
        told
    }
}
