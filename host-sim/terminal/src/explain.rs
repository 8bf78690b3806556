//! Messages of the command-line parser.

use std::error::Error as _;

use clap::error::{ContextKind, ContextValue, ErrorKind};

use crate::failure::Failure;

/// Prints help and version on standard output. Other errors of the parser become one line that
/// refers to the help of `program`.
///
/// # Errors
/// [`Failure::Input`] with this line.
pub fn explain(error: &clap::Error, program: &str) -> Result<(), Failure> {
    if let ErrorKind::DisplayHelp | ErrorKind::DisplayVersion = error.kind() {
        return crate::output::print_bytes(error.render().to_string().as_bytes());
    }
    let text = error.render().to_string();
    let said = match error.kind() {
        ErrorKind::DisplayHelpOnMissingArgumentOrSubcommand => missing(&text),
        ErrorKind::ValueValidation => with_requirement(one_line(&text), error),
        _ => one_line(&text),
    };
    Err(Failure::Input(format!("{said}; see {program} --help")))
}

/// The line on a command line without a command, from the help that lists the commands.
fn missing(help: &str) -> String {
    let listed = help.lines().skip_while(|line| *line != "Commands:").skip(1);
    let listed = listed.take_while(|line| !line.is_empty());
    // A description goes on in lines that are indented more.
    let first_lines = listed.filter_map(|line| line.strip_prefix("  "));
    let first_lines = first_lines.filter(|line| !line.starts_with(' '));
    let names = first_lines.filter_map(|line| line.split_whitespace().next());
    let names: Vec<_> = names.filter(|name| *name != "help").collect();
    match names[..] {
        [] => "an argument is missing".to_owned(),
        _ => format!("a command is missing; give one of {}", names.join(", ")),
    }
}

/// The line `said` on a value that does not parse, with what a number has to be in the place of the reason that the
/// parser gives.
fn with_requirement(said: String, error: &clap::Error) -> String {
    let value = match error.get(ContextKind::InvalidValue) {
        Some(ContextValue::String(value)) => value,
        _ => "",
    };
    let reason = error.source().map(ToString::to_string);
    let better = reason.and_then(|reason| {
        let before = said.strip_suffix(&reason)?;
        Some(format!("{before}{}", requirement(&reason, value)?))
    });
    better.unwrap_or(said)
}

/// What a number has to be, from the reason for which `value` is none; `None` for a reason that says it.
fn requirement(reason: &str, value: &str) -> Option<String> {
    let is_negative = (value.strip_prefix('-'))
        .is_some_and(|digits| !digits.is_empty() && digits.bytes().all(|b| b.is_ascii_digit()));
    let fixed = match reason {
        "invalid float literal" | "cannot parse float from empty string" => "must be a number",
        "number too large to fit in target type" => "must be a smaller number",
        // Of a signed type a whole number is valid.
        "invalid digit found in string" if is_negative => "must be a whole number from 0 on",
        "invalid digit found in string" | "cannot parse integer from empty string" => {
            "must be a whole number, written in digits alone"
        }
        _ => {
            let (_, range) = reason.split_once(" is not in ")?;
            let (least, most) = range.split_once("..=")?;
            return Some(format!("must be from {least} to {most}"));
        }
    };
    Some(fixed.to_owned())
}

/// The paragraphs before the usage in one line. The lines of a paragraph after its first one are a list.
fn one_line(text: &str) -> String {
    let before_usage = (text.lines())
        .take_while(|line| !line.starts_with("Usage:") && !line.starts_with("For more"));
    let lines: Vec<_> = before_usage.map(str::trim).collect();
    let paragraphs = lines.split(|line| line.is_empty());
    let paragraph = |lines: &[&str]| {
        let (first, list) = lines.split_first()?;
        Some(match list {
            [] => (*first).to_owned(),
            _ => format!("{first} {}", list.join(", ")),
        })
    };
    let said: Vec<_> = paragraphs.filter_map(paragraph).collect();
    let said = said.join("; ");
    said.strip_prefix("error: ").unwrap_or(&said).to_owned()
}

#[cfg(test)]
mod tests {
    use clap::{Arg, Command, value_parser};

    use super::{explain, missing, one_line};

    #[test]
    fn value_that_is_no_number_is_told_what_it_has_to_be() {
        let told = |value: &str, argument: Arg| {
            let command = Command::new("tool").arg(argument.long("n").value_name("N"));
            let error = command.try_get_matches_from(["tool".to_owned(), format!("--n={value}")]);
            let said = explain(&error.unwrap_err(), "tool")
                .unwrap_err()
                .to_string();
            let (start, end) = (
                format!("invalid value '{value}' for '--n <N>': "),
                "; see tool --help",
            );
            let said = said
                .strip_prefix(&start)
                .and_then(|said| said.strip_suffix(end));
            said.expect("the value and the help").to_owned()
        };
        let arg = || Arg::new("n");
        let digits = "must be a whole number, written in digits alone";
        for (value, argument, said) in [
            (
                "1khz",
                arg().value_parser(value_parser!(f64)),
                "must be a number",
            ),
            ("1e3", arg().value_parser(value_parser!(u64)), digits),
            (
                "-1",
                arg().value_parser(value_parser!(u64)),
                "must be a whole number from 0 on",
            ),
            ("-", arg().value_parser(value_parser!(u64)), digits),
            ("-x", arg().value_parser(value_parser!(u64)), digits),
            (
                "",
                arg().value_parser(value_parser!(f64)),
                "must be a number",
            ),
            ("", arg().value_parser(value_parser!(i64)), digits),
            (
                "99999999999999999999",
                arg().value_parser(value_parser!(u64)),
                "must be a smaller number",
            ),
            (
                "-200",
                arg().value_parser(value_parser!(i64).range(-100..=100)),
                "must be from -100 to 100",
            ),
            (
                "1.5",
                arg().value_parser(value_parser!(u32).range(4..=9)),
                digits,
            ),
            (
                "x",
                arg().value_parser(|_: &str| Err::<u8, _>("no scene 'x'")),
                "no scene 'x'",
            ),
        ] {
            assert_eq!(told(value, argument), said, "{value}");
        }
    }

    #[test]
    fn missing_command_is_told_with_the_names_of_all() {
        let help = "A tool.\n\nUsage: tool <COMMAND>\n\nCommands:\n  list    Print\n            the \
                    ports\n  info    Print\n  help    Print\n\nOptions:\n  --port <PORT>\n";
        let said = "a command is missing; give one of list, info";
        assert_eq!(missing(help), said);
        let help = "A tool.\n\nUsage: tool <LOG>\n\nOptions:\n  --rate <HZ>\n";
        assert_eq!(missing(help), "an argument is missing");
    }

    #[test]
    fn error_is_one_line_with_its_list_and_its_tip() {
        for (text, line) in [
            (
                "error: the following required arguments were not provided:\n  --rate <HZ>\n  <LOG>\n\nUsage: \
                 tool --rate <HZ> <LOG>\n\nFor more information, try '--help'.\n",
                "the following required arguments were not provided: --rate <HZ>, <LOG>",
            ),
            (
                "error: unexpected argument '--rats' found\n\n  tip: a similar argument exists: '--rate'\n\nUsage: \
                 tool --rate <HZ>\n",
                "unexpected argument '--rats' found; tip: a similar argument exists: '--rate'",
            ),
            (
                "error: invalid value 'x' for '--kind <KIND>'\n  [possible values: off, scores]\n\nFor more \
                 information, try '--help'.\n",
                "invalid value 'x' for '--kind <KIND>' [possible values: off, scores]",
            ),
            ("error: nothing\n", "nothing"),
        ] {
            assert_eq!(one_line(text), line);
        }
    }
}
