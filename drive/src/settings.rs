//! The settings of a board: shown, changed, stored.

use drivers::link::Message;
use drivers::{Command, Saved, Setting, SettingFacts, Settings};
use terminal::failure::Failure;
use terminal::wording::unknown;

use crate::board::Board;

/// A new value of a setting.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Assignment {
    pub(crate) setting: Setting,
    pub(crate) value: f32,
}

/// Parses `NAME=VALUE`.
///
/// # Errors
/// One line with what would be right.
pub(crate) fn assignment(text: &str) -> Result<Assignment, String> {
    let (name, value) = text
        .split_once('=')
        .ok_or("must be NAME=VALUE, for example current-scale=0.5")?;
    let names = || Setting::ALL.iter().map(|setting| setting.facts().name);
    let setting = Setting::ALL
        .iter()
        .find(|setting| setting.facts().name == name)
        .ok_or_else(|| unknown("setting", name, names()))?;
    // What is no number is outside every range.
    let value = value.parse().unwrap_or(f32::NAN);
    admitted(*setting, value)?;
    Ok(Assignment {
        setting: *setting,
        value,
    })
}

/// Checks that a value is in the range of its setting.
///
/// # Errors
/// One line with the range.
pub fn admitted(setting: Setting, value: f32) -> Result<(), String> {
    if setting.admits(value) {
        return Ok(());
    }
    let SettingFacts {
        name,
        unit,
        least,
        most,
        is_whole,
        ..
    } = setting.facts();
    let whole = if is_whole { "a whole number " } else { "" };
    let unit = with_unit(unit);
    Err(format!(
        "{name} must be {whole}from {least} to {most}{unit}"
    ))
}

/// The unit behind a number.
fn with_unit(unit: &str) -> String {
    match unit {
        "1" => String::new(),
        unit => format!(" {unit}"),
    }
}

/// Changes settings until the next reset.
///
/// # Errors
/// Those of [`Board::change`].
pub(crate) fn change(board: &mut Board, assignments: &[Assignment]) -> Result<(), Failure> {
    for Assignment { setting, value } in assignments {
        let command = Command::Set {
            setting: setting.number(),
            value: *value,
        };
        board.change(command, &format!("{}={value}", setting.facts().name))?;
    }
    Ok(())
}

/// The settings of the board.
///
/// # Errors
/// [`Failure::Input`] if the board does not answer.
pub(crate) fn present(board: &mut Board) -> Result<Settings, Failure> {
    let mut settings = Settings::DEFAULT;
    for (setting, value) in Setting::ALL.iter().zip(values(board)?) {
        settings.set(*setting, value);
    }
    Ok(settings)
}

/// All settings of the board as a table.
///
/// # Errors
/// [`Failure::Input`] if the board does not answer.
pub(crate) fn table(board: &mut Board) -> Result<String, Failure> {
    let values = values(board)?;
    let lines = Setting::ALL.iter().zip(values).map(|(setting, value)| {
        let SettingFacts {
            name,
            meaning,
            unit,
            least,
            most,
            ..
        } = setting.facts();
        let value = format!("{value}{}", with_unit(unit));
        format!("{name:<16}{value:<14}{least} to {most}: {meaning}\n")
    });
    Ok(lines.collect())
}

/// The values of the board's settings, each at its number.
fn values(board: &mut Board) -> Result<Vec<f32>, Failure> {
    let mut values = Vec::new();
    let all = board.ask(Command::Settings, |message| {
        let Message::Setting(setting) = message else {
            return None;
        };
        if setting.number == 0 {
            values.clear();
        }
        if usize::from(setting.number) == values.len() {
            values.push(setting.value);
        }
        (values.len() == usize::from(setting.count)).then(|| values.clone())
    })?;
    all.ok_or_else(|| board.silent())
}

/// Stores the settings in the board's flash.
///
/// # Errors
/// [`Failure::Check`] if the board does not store them, [`Failure::Input`] if it does not answer.
pub(crate) fn store(board: &mut Board) -> Result<(), Failure> {
    let mut enabled = false;
    // The board stores nothing until it is certain that the amplifiers are disabled.
    let outcome = board.ask(Command::Store, |message| match message {
        Message::Stored(stored) => match Saved::from_code(stored.outcome) {
            Some(Saved::Enabled) => {
                enabled = true;
                None
            }
            saved => Some((stored.outcome, saved)),
        },
        _ => None,
    })?;
    let reason = match outcome {
        // The flash has what it had.
        Some(_) if board.has_lost_a_change() => {
            "the board has started again, and has lost what was changed; find the cause of the reset, then run the \
             command again"
                .to_owned()
        }
        Some((_, Some(Saved::Stored))) => {
            board.note(outcome_words(Saved::Stored));
            return Ok(());
        }
        Some((code, saved)) => saved.map_or_else(
            || format!("outcome {code}"),
            |s| outcome_words(s).to_owned(),
        ),
        None if enabled => outcome_words(Saved::Enabled).to_owned(),
        None => return Err(board.silent()),
    };
    Err(Failure::Check(format!("not stored: {reason}")))
}

/// What an outcome of the command `store` means.
#[must_use]
pub const fn outcome_words(saved: Saved) -> &'static str {
    match saved {
        Saved::Stored => "settings stored",
        Saved::Enabled => "the amplifiers are enabled; disarm first",
        Saved::Full => "the flash is full; reset the board and store again",
        Saved::Refused => "the flash refuses the access",
        Saved::Mismatch => "the flash does not hold what was written",
    }
}

#[cfg(test)]
mod tests {
    use drivers::link;

    use super::*;
    use crate::board::tests::sent;

    /// How the command `store` ends with these outcomes from the board.
    fn stored(outcomes: &[u8]) -> Result<(), Failure> {
        let messages = outcomes.iter().map(|outcome| {
            let outcome = *outcome;
            link::Stored { outcome }.into()
        });
        let (mut board, _end) = sent(&messages.collect::<Vec<_>>());
        board.speak_to(Box::new(drop));
        store(&mut board)
    }

    #[test]
    fn settings_are_stored_once_the_board_says_so() {
        let [done, enabled] = [Saved::Stored, Saved::Enabled].map(|saved| saved as u8);
        assert_eq!(stored(&[done]), Ok(()));
        // It is not certain yet that the amplifiers are disabled.
        assert_eq!(stored(&[enabled, enabled, done]), Ok(()));
        for (outcome, reason) in [
            (enabled, "the amplifiers are enabled; disarm first"),
            (
                Saved::Full as u8,
                "the flash is full; reset the board and store again",
            ),
            (Saved::Refused as u8, "the flash refuses the access"),
            (
                Saved::Mismatch as u8,
                "the flash does not hold what was written",
            ),
            (99, "outcome 99"),
        ] {
            let failed = Failure::Check(format!("not stored: {reason}"));
            assert_eq!(stored(&[outcome]), Err(failed));
        }
        assert_eq!(stored(&[]).unwrap_err().status(), 2);
    }

    #[test]
    fn table_has_value_unit_and_range_of_each_setting() {
        let messages = Setting::ALL.iter().map(|setting| {
            Message::Setting(link::Setting {
                number: setting.number(),
                value: Settings::DEFAULT.get(*setting),
                count: Setting::ALL.len() as u8,
            })
        });
        let (mut board, _end) = sent(&messages.collect::<Vec<_>>());
        let table = table(&mut board).unwrap();
        assert_eq!(table.lines().count(), Setting::ALL.len(), "{table}");
        for begin in [
            "zero-large      2048 codes    1848 to 2248: ",
            // A ratio has no unit.
            "gain-small      1             0.8 to 1.25: ",
        ] {
            let has_it = table.lines().any(|line| line.starts_with(begin));
            assert!(has_it, "{begin}: {table}");
        }
    }

    /// The value of each setting is its number, and a hundred more in an older answer.
    #[test]
    fn values_keep_their_numbers_if_messages_are_lost() {
        const COUNT: u8 = Setting::ALL.len() as u8;
        let message = |number: u8, older: f32| {
            let value = f32::from(number) + older;
            Message::Setting(link::Setting {
                number,
                value,
                count: COUNT,
            })
        };
        let expected: Vec<_> = (0..COUNT).map(f32::from).collect();
        let shown = |messages: &[Message]| values(&mut sent(messages).0).unwrap();
        // One answer lacks the second setting, the next one the first.
        let lacking = (0..COUNT - 1).filter(|number| *number != 1);
        let both = lacking.chain(1..COUNT).map(|number| message(number, 0.0));
        assert_eq!(shown(&both.collect::<Vec<_>>()), expected);
        let older = (0..2).map(|number| message(number, 100.0));
        let whole = (0..COUNT).map(|number| message(number, 0.0));
        assert_eq!(shown(&older.chain(whole).collect::<Vec<_>>()), expected);
    }

    #[test]
    fn assignments_are_checked_before_anything_is_sent() {
        let Assignment { setting, value } = assignment("gain-small=1.02").unwrap();
        assert_eq!((setting, value), (Setting::GainSmall, 1.02));
        for (text, told) in [
            ("gain-small", "NAME=VALUE"),
            ("gain=1", "gain-large"),
            ("gain-small=nan", "from 0.8 to 1.25"),
            ("zero-large=4000", "1848 to 2248 codes"),
            ("serial=0.5", "a whole number"),
        ] {
            let error = assignment(text).unwrap_err();
            assert!(error.contains(told), "{text}: {error}");
        }
    }
}
