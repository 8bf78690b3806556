//! Counts per revolution that a recording states in a comment.

use simulation::device::parsed_counts_per_rev;
use terminal::failure::Failure;

use crate::recording::text::separator::comment;

/// Word that begins the comment.
const KEY: &str = "counts_per_rev";

/// The line that states the counts per revolution of `counts_large`, for [`stated_counts_per_rev`].
#[must_use]
pub fn counts_per_rev_line(counts_per_rev: u32) -> String {
    format!("# {KEY} = {counts_per_rev}\n")
}

/// The counts per revolution that the first bytes `head` of a recording called `name` state in a
/// comment: `# counts_per_rev = 1024`. `None` without such a comment.
///
/// # Errors
/// [`Failure::Input`] that names file, line and key, if the number is not a whole one in
/// [`COUNTS_PER_REV`](simulation::device::COUNTS_PER_REV), or if two comments differ.
pub fn stated_counts_per_rev(head: &[u8], name: &str) -> Result<Option<u32>, Failure> {
    let text = String::from_utf8_lossy(head);
    let mut stated: Option<(usize, u32)> = None;
    for (index, line) in text.lines().enumerate() {
        let Some(value) = comment(line).and_then(|text| text.strip_prefix(KEY)) else {
            continue;
        };
        let Some(value) = value.trim_start().strip_prefix(['=', ':']) else {
            continue;
        };
        let value = value.trim();
        let number = parsed_counts_per_rev(value).map_err(|rule| {
            Failure::Input(format!(
                "{name}: line {}: {KEY}: '{}': {rule}; correct or remove the comment",
                index + 1,
                value.escape_debug(),
            ))
        })?;
        let (line, known) = *stated.get_or_insert((index, number));
        if known != number {
            return Err(Failure::Input(format!(
                "{name}: line {}: {KEY}: {number}, where line {} states {known}; remove the wrong comment",
                index + 1,
                line + 1
            )));
        }
    }
    Ok(stated.map(|(_, number)| number))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn comment_with_the_key_and_a_number_is_read() {
        for (text, stated) in [
            ("# counts_per_rev = 1024\nt,counts_large\n", Some(1024)),
            ("t,counts_large\n// counts_per_rev: 90\r\n", Some(90)),
            ("t,counts_large,counts_per_rev=5\n", None),
            ("# counts_per_rev of this log are unknown\n", None),
            ("", None),
        ] {
            let found = stated_counts_per_rev(text.as_bytes(), "r").unwrap();
            assert_eq!(found, stated, "{text}");
        }
    }

    #[test]
    fn two_comments_that_differ_are_refused_with_their_lines() {
        let log = |second| format!("# counts_per_rev = 1024\nt,x\n# counts_per_rev = {second}\n");
        let stated = |second| stated_counts_per_rev(log(second).as_bytes(), "r.csv");
        assert_eq!(stated(1024).unwrap(), Some(1024));
        assert_eq!(
            stated(2048).unwrap_err().to_string(),
            "r.csv: line 3: counts_per_rev: 2048, where line 1 states 1024; remove the wrong comment"
        );
    }

    #[test]
    fn number_out_of_range_is_reported_by_line_and_key() {
        let [finer, lines] = ["divide the counts", "a line of a quadrature encoder"];
        for (number, remedy) in [
            ("", "a whole number"),
            ("1e3", "a whole number"),
            ("15", lines),
            ("-64", lines),
            ("4000001", finer),
            ("99999999999", finer),
            (&"9".repeat(60), finer),
        ] {
            let text = format!("# a log\n# counts_per_rev = {number}\n");
            let error = stated_counts_per_rev(text.as_bytes(), "r.csv").unwrap_err();
            let said = format!("r.csv: line 2: counts_per_rev: '{number}': must be ");
            assert!(error.to_string().starts_with(&said), "{error}");
            assert!(error.to_string().contains(remedy), "{error}");
        }
    }
}
