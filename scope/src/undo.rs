//! The settings of before a procedure that was ended from outside.

use std::time::Instant;

use drive::guided::Guided;
use drive::patience::AGAIN;
use drivers::{Command, Setting, encode};

/// What brings a board back to the settings from before a procedure. A setting that the procedure has tried would
/// otherwise be stored by the next order to store.
pub(crate) struct Undo {
    wanted: Vec<(Setting, f32)>,
    /// When the settings were sent.
    sent: Option<Instant>,
    /// Whether the board was heard since, or since the end of the procedure.
    is_heard: bool,
}

impl Undo {
    /// What a procedure may leave, with the values of before; `None` if there is nothing.
    pub(crate) fn new(what: Guided, before: &[f32]) -> Option<Self> {
        let value = |setting: &Setting| before.get(usize::from(setting.number())).copied();
        let wanted: Vec<_> = (what.provisional().iter())
            .filter_map(|setting| Some((*setting, value(setting)?)))
            .collect();
        (!wanted.is_empty()).then_some(Self {
            wanted,
            sent: None,
            is_heard: false,
        })
    }

    /// A message of the board has come.
    pub(crate) fn heard(&mut self) {
        self.is_heard = true;
    }

    /// A page sets a setting: that value counts.
    pub(crate) fn set(&mut self, number: u8) {
        self.wanted
            .retain(|(setting, _)| setting.number() != number);
    }

    /// Whether the board, which has these settings, is as before.
    pub(crate) fn is_done(&self, settings: &[f32]) -> bool {
        let has = |(setting, value): &(Setting, f32)| {
            settings.get(usize::from(setting.number())) == Some(value)
        };
        self.sent.is_some() && self.wanted.iter().all(has)
    }

    /// The bytes for the board that are due: settings, and the question for them. A board that sends nothing gets none.
    pub(crate) fn bytes(&mut self, now: Instant) -> Vec<u8> {
        let is_early = |at: Instant| now.saturating_duration_since(at) < AGAIN;
        if !self.is_heard || self.sent.is_some_and(is_early) {
            return Vec::new();
        }
        (self.sent, self.is_heard) = (Some(now), false);
        let sets = self.wanted.iter().map(|(setting, value)| Command::Set {
            setting: setting.number(),
            value: *value,
        });
        sets.chain([Command::Settings]).flat_map(encode).collect()
    }
}

#[cfg(test)]
mod tests {
    use std::time::Duration;

    use drivers::Settings;

    use super::*;

    #[test]
    fn settings_are_sent_until_the_board_has_them() {
        let mut settings = Settings::DEFAULT;
        assert!(settings.set(Setting::ZeroSmall, 2040.0));
        let values = |settings: &Settings| -> Vec<f32> {
            Setting::ALL.iter().map(|it| settings.get(*it)).collect()
        };
        let before = values(&settings);
        assert!(Undo::new(Guided::BringUp, &before).is_none());
        let mut undo = Undo::new(Guided::Calibrate, &before).expect("zeros and gains");
        // An answer from before the order is none to it.
        assert!(!undo.is_done(&before));
        let now = Instant::now();
        let zero = encode(Command::Set {
            setting: Setting::ZeroSmall.number(),
            value: 2040.0,
        });
        assert!(undo.bytes(now).is_empty(), "the board is silent");
        undo.heard();
        let sent = undo.bytes(now);
        assert!(
            sent.windows(zero.len()).any(|it| it == &zero[..]),
            "{sent:?}"
        );
        assert!(sent.ends_with(&encode(Command::Settings)));
        undo.heard();
        assert!(
            undo.bytes(now + AGAIN - Duration::from_millis(1))
                .is_empty()
        );
        assert_eq!(undo.bytes(now + AGAIN), sent);
        assert!(undo.bytes(now + 10 * AGAIN).is_empty(), "not heard since");
        assert!(settings.set(Setting::ZeroSmall, 2056.0));
        assert!(!undo.is_done(&values(&settings)));
        assert!(undo.is_done(&before));
        // A value of a page is not undone.
        undo.set(Setting::ZeroSmall.number());
        assert!(undo.is_done(&values(&settings)));
    }
}
