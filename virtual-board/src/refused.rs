//! Commands of a run that the image has refused.

use drive::refusal::refusal;
use drivers::link::{Message, Parser, Rejected};

use crate::run::Outcome;

impl Outcome {
    /// Why the image has refused a command, as its serial port tells it; `None` if it has not. Noise on the
    /// command channel is no command.
    #[must_use]
    pub fn refusal(&self) -> Option<&'static str> {
        first(self.port.iter().map(|(_, byte)| *byte))
    }
}

/// The first refusal that a serial port tells. The counts of a board that starts again begin at 0.
fn first(bytes: impl Iterator<Item = u8>) -> Option<&'static str> {
    let (mut parser, mut told) = (Parser::default(), None);
    for byte in bytes {
        parser.take(byte, |message| {
            if let Message::Rejected(counts) = message {
                told = told.or_else(|| refusal(&Rejected::default(), &counts));
            }
        });
    }
    told
}

#[cfg(test)]
mod tests {
    use drivers::link::LONGEST;

    use super::*;

    #[test]
    fn refusal_before_a_restart_is_told() {
        let none = Rejected::default();
        let garbage = Rejected { garbage: 9, ..none };
        let unknown = Rejected { unknown: 1, ..none };
        let told = |counts: &[Rejected]| {
            let bytes = counts.iter().flat_map(|counts| {
                let mut buffer = [0; LONGEST];
                Message::from(*counts).encode(&mut buffer).unwrap().to_vec()
            });
            first(bytes)
        };
        let said = Some("the image does not have it");
        assert_eq!(told(&[garbage, unknown, none]), said);
        assert_eq!(told(&[none, garbage]), None);
    }
}
