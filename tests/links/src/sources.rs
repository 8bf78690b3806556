//! Files that sources and pages name without a link.

use std::path::Path;

/// Extensions of the files that a name has to be one of.
const NAMED: [&str; 6] = [".md", ".svg", ".rs", ".toml", ".csv", ".yml"];

/// Stands for any name in a path.
const PLACEHOLDER: &str = "NAME";

/// Names of files with their line: in a page the code spans that are a path, elsewhere the names that
/// begin with `docs/`.
pub(crate) fn names<'a>(path: &Path, text: &'a str) -> Vec<(usize, &'a str)> {
    let is_page = path.extension().is_some_and(|extension| extension == "md");
    // A changelog names files of its time, and the tests of this crate name files that they make.
    if path.ends_with("CHANGELOG.md") || path.starts_with("tests/links/tests") {
        return Vec::new();
    }
    let of_line = |(index, line): (usize, &'a str)| {
        let names = if is_page { spans(line) } else { words(line) };
        names.into_iter().map(move |name| (index + 1, name))
    };
    text.lines().enumerate().flat_map(of_line).collect()
}

fn spans(line: &str) -> Vec<&str> {
    let spans = line.split('`').skip(1).step_by(2);
    spans.filter(|span| is_path(span)).collect()
}

fn words(line: &str) -> Vec<&str> {
    let words = line.split(|c: char| !is_part_of_a_path(c));
    (words.map(|word| word.trim_end_matches('.')))
        .filter(|word| word.starts_with("docs/") && is_path(word))
        .collect()
}

fn is_part_of_a_path(c: char) -> bool {
    c.is_ascii_alphanumeric() || "_-./".contains(c)
}

fn is_path(text: &str) -> bool {
    text.contains('/')
        && !text.contains(PLACEHOLDER)
        && text.chars().all(is_part_of_a_path)
        && NAMED.iter().any(|extension| text.ends_with(extension))
}
