//! Messages of the command-line parser.

use clap::error::ErrorKind;

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
    use super::{missing, one_line};

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
