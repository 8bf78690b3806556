//! Time stamps that a logger writes before whole lines, with a space after them. They are not read: a time and a
//! position with a space between them look alike.

use crate::recording::layout::Layout;

/// Words behind a time that belong to it.
const BELONGS: [&str; 7] = ["am", "pm", "utc", "gmt", "z", "cet", "cest"];

/// What to do about a time stamp and a space before the text of a first name or field; `None` if there is no stamp, or
/// nothing behind it.
pub(crate) fn remedy(text: &str) -> Option<String> {
    let words: Vec<_> = text.split(' ').collect();
    let is_dated = words.len() > 1 && is_date(words[0]);
    let time = usize::from(is_dated);
    let behind = words.get(time + 1)?;
    let is_stamp = is_time(words[time]) && !behind.is_empty() && !belongs(behind);
    is_stamp.then(|| {
        format!(
            "the lines begin with the time stamps of a logger, and a space: remove them, for example with \
             cut -d' ' -f{}-",
            time + 2
        )
    })
}

/// As [`remedy`], for a header, or for the first row of a text without one. Where the words of a line are taken for its
/// fields, the stamp is a name or the begin of the row.
pub(crate) fn remedy_of(layout: &Layout) -> Option<String> {
    let first = layout.names.first()?;
    let has_fields = |text: &&str| text.contains([',', ';', '\t']);
    let second = layout.names.get(1).map(String::as_str);
    let both = second
        .filter(has_fields)
        .map(|second| format!("{first} {second}"));
    let row = Some(layout.first_row.as_str()).filter(has_fields);
    remedy(first)
        .or_else(|| remedy(&both?))
        .or_else(|| remedy(row?))
}

fn is_date(word: &str) -> bool {
    let parts = word.split(['-', '/', '.']);
    let is_number = |part: &str| !part.is_empty() && part.bytes().all(|c| c.is_ascii_digit());
    parts.clone().count() == 3 && parts.clone().all(is_number)
}

/// 12:00:00, also with a date and a T before it, and with fractions and a zone.
fn is_time(word: &str) -> bool {
    let is_of_time = |c: char| c.is_ascii_digit() || ":.,-+TZ".contains(c);
    let begins = word.starts_with(|c: char| c.is_ascii_digit());
    begins && word.contains(':') && word.chars().all(is_of_time)
}

fn belongs(word: &str) -> bool {
    let is_zone =
        |digits: &str| digits.len() > 1 && digits.bytes().all(|c| c.is_ascii_digit() || c == b':');
    BELONGS.iter().any(|known| word.eq_ignore_ascii_case(known))
        || word.strip_prefix(['+', '-']).is_some_and(is_zone)
}

#[cfg(test)]
mod tests {
    use crate::recording::Recording;

    fn error(text: &str) -> String {
        Recording::parse(text.as_bytes(), "r.csv")
            .unwrap_err()
            .to_string()
    }

    #[test]
    fn stamp_and_a_space_before_each_line_are_to_be_cut() {
        for (stamp, cut) in [
            ("2025-03-01 12:00:00.000", "cut -d' ' -f3-"),
            ("2025-03-01 12:00:00", "cut -d' ' -f3-"),
            ("2025-03-01T12:00:00.000Z", "cut -d' ' -f2-"),
            ("12:00:00.000", "cut -d' ' -f2-"),
        ] {
            let rows = format!("{stamp} 0,0\n{stamp} 1,5\n{stamp} 2,9\n");
            for header in [
                format!("{stamp} ms,counts\n"),
                "ms,counts\n".to_owned(),
                String::new(),
            ] {
                let error = error(&format!("{header}{rows}"));
                let said =
                    "the lines begin with the time stamps of a logger, and a space: remove them";
                assert!(
                    error.contains(said) && error.contains(cut),
                    "{stamp}: {error}"
                );
            }
        }
    }

    /// What is told to be right.
    #[test]
    fn lines_that_are_cut_are_read() {
        let log = Recording::parse(&b"ms,counts\n0,0\n1,5\n2,9\n"[..], "r.csv").unwrap();
        assert_eq!(log.trace.counts_large, [0, 5, 9]);
    }

    #[test]
    fn time_of_its_own_is_none() {
        for text in [
            "12:00:00",
            "2025-03-01 12:00:00",
            "12:00:00 PM",
            "2025-03-01 12:00:00 +0100",
            "0.5 deg",
            "time",
        ] {
            assert_eq!(super::remedy(text), None, "{text}");
        }
    }
}
