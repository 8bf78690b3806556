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
    use super::*;

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
