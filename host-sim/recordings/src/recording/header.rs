//! Error message for a header with a missing column.

use csv::ByteRecord;

use terminal::failure::Failure;

/// Characters of a header that a message shows.
const SHOWN: usize = 60;

/// A header field without the byte order mark, which can precede the first field.
pub(super) fn field(bytes: &[u8]) -> &[u8] {
    bytes.strip_prefix(b"\xEF\xBB\xBF").unwrap_or(bytes)
}

/// Error for a header without `column`, with the header and a hint at the probable cause.
pub(super) fn missing(column: &str, header: &ByteRecord, name: &str) -> Failure {
    let fields = header
        .iter()
        .map(|bytes| String::from_utf8_lossy(field(bytes)));
    let fields: Vec<String> = fields.map(Into::into).collect();
    let line: String = fields.join(",").chars().take(SHOWN).collect();
    let hint = hint(column, &fields).map_or_else(String::new, |hint| format!(" ({hint})"));
    Failure::Input(format!(
        "{name}: line 1: no column {column}; the line is '{}'{hint}; it must have the names of the \
         columns, t and counts_large among them, separated by commas",
        line.escape_debug()
    ))
}

fn hint(column: &str, fields: &[String]) -> Option<String> {
    let short = |field: &str| field.chars().take(20).collect::<String>();
    let first = fields
        .first()
        .filter(|_| fields.iter().any(|field| !field.is_empty()));
    let Some(first) = first else {
        return Some("empty".to_owned());
    };
    if first.starts_with('#') {
        return Some("remove the comment before the names".to_owned());
    }
    if let ([only], Some(separator)) = (fields, first.find([';', '\t'])) {
        let separator = &only[separator..=separator];
        return Some(format!("separated by '{}'?", separator.escape_debug()));
    }
    if fields.iter().all(|field| field.parse::<f64>().is_ok()) {
        return Some("these are numbers; put a line with the names before them".to_owned());
    }
    let lower = |field: &&String| field.to_lowercase() == column;
    if let Some(field) = fields.iter().find(lower) {
        return Some(format!("'{}' must be in lower case", short(field)));
    }
    let words: &[&str] = match column {
        "t" => &["time", "ms", "sec", "stamp"],
        "counts_large" => &["count", "enc", "pos", "angle"],
        _ => return None,
    };
    let like = |field: &&String| words.iter().any(|word| field.to_lowercase().contains(word));
    let field = fields.iter().find(like)?;
    Some(match column {
        "t" => format!("if '{}' is the time, name it t, in seconds", short(field)),
        _ => format!(
            "if '{}' is the encoder, name it {column}, in counts",
            short(field)
        ),
    })
}

#[cfg(test)]
mod tests {
    use super::super::Recording;

    #[test]
    fn error_shows_the_header_and_a_hint() {
        for (text, said) in [
            (
                "t;counts_large\n0;1\n",
                "the line is 't;counts_large' (separated by ';'?)",
            ),
            ("", "the line is '' (empty)"),
            ("t\tcounts_large\n0\t1\n", r"separated by '\t'?"),
            ("# my log\nt,counts_large\n", "remove the comment"),
            ("T,counts_large\n0,1\n", "'T' must be in lower case"),
            (
                "t,Counts_Large\n0,1\n",
                "'Counts_Large' must be in lower case",
            ),
            ("0,1\n0.1,2\n", "these are numbers"),
            (
                "time_ms,counts_large\n0,1\n",
                "if 'time_ms' is the time, name it t, in seconds",
            ),
            (
                "t,angle_deg\n0,1\n",
                "if 'angle_deg' is the encoder, name it counts_large",
            ),
        ] {
            let error = Recording::parse(text.as_bytes(), "r.csv")
                .unwrap_err()
                .to_string();
            assert!(error.starts_with("r.csv: line 1: no column "), "{error}");
            assert!(error.contains(said), "{text:?}: {error}");
        }
    }
}
