//! What became of commands that the board did not follow, by its counts.

use drive::refusal::{NOISE, has_grown, is_damaged, refusal};
use drivers::link::Rejected;
use serde_json::{Value, json};

/// The counts of a board, and what they tell of the latest command.
#[derive(Default)]
pub(crate) struct Refusals {
    /// The latest counts.
    counts: Option<Rejected>,
    /// What became of the latest command that was refused or may be lost, and how many there were since the latest one
    /// that was sent.
    told: Option<(String, u32)>,
}

impl Refusals {
    /// Takes counts; whether the board has refused to select a scene.
    pub(crate) fn take(&mut self, now: &Rejected) -> bool {
        let before = self.counts.replace(*now).unwrap_or(*now);
        if let Some(words) = words(&before, now) {
            let number = self.told.as_ref().map_or(0, |(_, number)| *number) + 1;
            self.told = Some((words, number));
        }
        has_grown(before.unverified, now.unverified)
    }

    /// A command is sent: what was told is of those before.
    pub(crate) fn forget(&mut self) {
        self.told = None;
    }

    /// The board has started again.
    pub(crate) fn restarted(&mut self) {
        self.counts = None;
    }

    pub(crate) fn json(&self) -> Value {
        let told = self.told.as_ref();
        told.map_or(
            Value::Null,
            |(words, number)| json!({"words": words, "number": number}),
        )
    }
}

/// What became of a command between two counts, if the board did not follow it.
fn words(before: &Rejected, now: &Rejected) -> Option<String> {
    if let Some(reason) = refusal(before, now) {
        return Some(format!("the board refused a command: {reason}"));
    }
    is_damaged(before, now).then(|| {
        format!("bytes that are no command reach the board, and a command may be lost: {NOISE}")
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn refusal_and_noise_are_told_apart_and_a_reset_is_none_of_both() {
        let mut refusals = Refusals::default();
        let mut told = |garbage, unknown, unverified| {
            let counts = Rejected {
                garbage,
                unknown,
                unverified,
                ..Rejected::default()
            };
            let is_scene = refusals.take(&counts);
            let told = refusals.json()["words"].as_str().map(str::to_owned);
            refusals.forget();
            (told.unwrap_or_default(), is_scene)
        };
        // From before the server.
        assert_eq!(told(7, 1, 1), (String::new(), false));
        let (noise, _) = told(8, 1, 1);
        assert!(
            noise.starts_with("bytes that are no command reach the board, and"),
            "{noise}"
        );
        let refused = "the board refused a command: the image does not have it";
        assert_eq!(told(9, 2, 1), (refused.to_owned(), false));
        assert!(told(9, 2, 2).1);
        assert_eq!(told(0, 0, 0), (String::new(), false));
        // The counts of a new board are not compared with those of the old one.
        refusals.restarted();
        assert!(!refusals.take(&Rejected {
            unverified: 5,
            ..Rejected::default()
        }));
        assert!(refusals.json().is_null());
    }
}
