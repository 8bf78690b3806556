//! Text for a terminal: wrapped lines, names without control characters, arguments of a shell, and the
//! message about an unknown name.

use std::borrow::Cow;
use std::ffi::OsStr;

/// Width of a terminal if the width is unknown, columns.
pub const WIDTH: usize = 80;

/// `text` in lines of at most [`WIDTH`] columns; all but the first begin with `indent` spaces.
/// A word that is longer than a line is not broken.
#[must_use]
pub fn wrapped(text: &str, indent: usize) -> String {
    let mut lines = String::new();
    let mut column = 0;
    let mut words = text.split(' ');
    // Leading spaces align the first line.
    if let Some(first) = words.next() {
        lines += first;
        column = first.chars().count();
    }
    for word in words {
        let length = word.chars().count();
        if length > 0 && column + 1 + length > WIDTH {
            lines.truncate(lines.trim_end().len());
            lines += "\n";
            lines += &" ".repeat(indent);
            column = indent;
        } else {
            lines += " ";
            column += 1;
        }
        lines += word;
        column += length;
    }
    lines
}

/// `text` with its control characters escaped, so that a name from a file does not command a terminal.
#[must_use]
pub(crate) fn harmless(text: &str) -> Cow<'_, str> {
    if !text.contains(char::is_control) {
        return Cow::Borrowed(text);
    }
    let mut escaped = String::new();
    for c in text.chars() {
        match c.is_control() {
            true => escaped.extend(c.escape_debug()),
            false => escaped.push(c),
        }
    }
    Cow::Owned(escaped)
}

/// The lines of `text`, each as by [`harmless`].
#[must_use]
pub(crate) fn harmless_lines(text: &str) -> String {
    let lines: Vec<_> = text.split('\n').map(harmless).collect();
    lines.join("\n")
}

/// `argument` as a shell reads it, with quotes where it needs them.
#[must_use]
pub fn quoted(argument: &OsStr) -> String {
    let argument = argument.to_string_lossy();
    let plain = |c: char| c.is_alphanumeric() || "-_./=,:+".contains(c);
    match !argument.is_empty() && argument.chars().all(plain) {
        true => argument.into_owned(),
        false => format!("'{}'", argument.replace('\'', r"'\''")),
    }
}

/// Message about a `name` that is not one of the `known` names. `what` is the kind of thing that is
/// named, for example "scene".
#[must_use]
pub fn unknown<'a>(what: &str, name: &str, known: impl IntoIterator<Item = &'a str>) -> String {
    let known: Vec<_> = known.into_iter().collect();
    let nearest = spelling::nearest(name, known.iter().copied());
    let all = known.join(", ");
    let name = name.escape_debug();
    match nearest {
        Some(nearest) => format!("no {what} '{name}'; did you mean {nearest}? there are {all}"),
        None => format!("no {what} '{name}'; there are {all}"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_are_wrapped_with_an_indent() {
        let text = format!("a  b {} c", "x".repeat(76));
        assert_eq!(wrapped(&text, 2), format!("a  b\n  {} c", "x".repeat(76)));
        assert_eq!(wrapped("a   b", 2), "a   b");
        let long = "y".repeat(100);
        assert_eq!(wrapped(&format!("a {long}"), 4), format!("a\n    {long}"));
    }

    /// Of words of 9 letters, eight fill 79 columns with their spaces; with an indent of 8 columns there are seven a
    /// line. A letter of several bytes has one column.
    #[test]
    fn every_line_has_as_many_words_as_its_columns_take() {
        for letter in ["x", "µ"] {
            let word = letter.repeat(9);
            let words = |number: usize| vec![&*word; number].join(" ");
            let indent = " ".repeat(8);
            let lines = [8, 7, 7, 1].map(words).join(&format!("\n{indent}"));
            assert_eq!(wrapped(&words(23), 8), lines);
        }
    }

    #[test]
    fn lines_of_a_text_are_kept_and_their_control_characters_escaped() {
        let text = "a\u{1b}[31mb:\n\n  \u{9b}0m\tµ\n";
        assert_eq!(harmless_lines(text), "a\\u{1b}[31mb:\n\n  \\u{9b}0m\\tµ\n");
    }

    /// The shell says what it reads.
    #[cfg(unix)]
    #[test]
    fn quoted_argument_is_one_word_for_a_shell() {
        for argument in [
            "",
            "plain-1.csv",
            "a b",
            "it's",
            "''",
            "$HOME",
            "~",
            "*",
            "a;b",
            "a\\b",
            "#",
            "\"",
            "a\nb",
            "µ=1,2",
        ] {
            let line = format!("printf '<%s>' {} end", quoted(OsStr::new(argument)));
            let read = std::process::Command::new("sh")
                .args(["-c", &line])
                .output();
            let read = String::from_utf8(read.unwrap().stdout).unwrap();
            assert_eq!(read, format!("<{argument}><end>"), "{line}");
        }
        assert_eq!(quoted(OsStr::new("a-1.csv")), "a-1.csv");
    }

    #[test]
    fn similar_name_is_suggested_and_a_different_one_is_not() {
        let known = ["wall", "free-air", "excite"];
        let said = unknown("scene", "exite", known);
        assert!(said.starts_with("no scene 'exite'; did you mean excite? there are wall,"));
        let capitals = unknown("scene", "WALL", known);
        assert!(capitals.starts_with("no scene 'WALL'; did you mean wall?"));
        assert_eq!(
            unknown("scene", "q", known),
            "no scene 'q'; there are wall, free-air, excite"
        );
        // A name is in one line.
        assert!(unknown("scene", "a\nb", known).starts_with(r"no scene 'a\nb'; "));
    }
}
