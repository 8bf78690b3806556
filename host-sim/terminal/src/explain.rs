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
    let said = one_line(&error.render().to_string());
    Err(Failure::Input(format!("{said}; see {program} --help")))
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
    use super::one_line;

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
