//! Links and headings of a Markdown page.

use std::collections::BTreeSet;

/// One link or image.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Link {
    /// Line in the page, from 1.
    pub line: usize,
    /// Target as written, without a title.
    pub target: String,
}

/// Links and headings of a page.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Page {
    /// Links in order.
    pub links: Vec<Link>,
    /// Anchors of the headings.
    pub anchors: BTreeSet<String>,
}

impl Page {
    /// Reads inline links and images, link definitions and headings that begin with `#`. Code blocks,
    /// code spans and comments hold none.
    #[must_use]
    pub fn parse(text: &str) -> Self {
        let mut page = Self::default();
        let prose = without_code_blocks(text);
        for line in prose.lines() {
            if let Some(heading) = heading(line) {
                page.add_anchor(&anchor(heading));
            }
        }
        let prose = without_spans(&prose);
        for (index, line) in prose.lines().enumerate() {
            for target in targets(line) {
                let target = target.split_whitespace().next().unwrap_or_default();
                page.links.push(Link {
                    line: index + 1,
                    target: target.trim_matches(['<', '>']).to_owned(),
                });
            }
        }
        page
    }

    /// A heading that repeats gets a number.
    fn add_anchor(&mut self, anchor: &str) {
        let numbered = (1..).map(|number| format!("{anchor}-{number}"));
        let mut candidates = std::iter::once(anchor.to_owned()).chain(numbered);
        if let Some(free) = candidates.find(|name| !self.anchors.contains(name)) {
            self.anchors.insert(free);
        }
    }
}

/// Anchor of a heading: letters, digits, `-` and `_` in lower case, spaces as `-`, nothing else.
#[must_use]
pub fn anchor(heading: &str) -> String {
    let mut text = heading.to_owned();
    // A link in a heading counts as its text.
    while let Some(from) = text.find("](") {
        let Some(length) = text[from..].find(')') else {
            break;
        };
        text.replace_range(from..=from + length, "");
    }
    let lower = text.trim().to_lowercase();
    let kept = lower.chars().filter_map(|c| match c {
        ' ' => Some('-'),
        '-' | '_' => Some(c),
        _ => c.is_alphanumeric().then_some(c),
    });
    kept.collect()
}

fn heading(line: &str) -> Option<&str> {
    let text = line.trim_start_matches('#');
    let level = line.len() - text.len();
    ((1..=6).contains(&level) && text.starts_with(' ')).then_some(text)
}

/// The text with the lines of fenced code blocks empty, so that line numbers stay.
fn without_code_blocks(text: &str) -> String {
    let mut fence: Option<&str> = None;
    let mut prose = String::new();
    for line in text.lines() {
        let trimmed = line.trim_start();
        let begins = ["```", "~~~"].into_iter().find(|f| trimmed.starts_with(f));
        match (fence, begins) {
            (None, Some(_)) => fence = begins,
            (Some(open), Some(closing)) if open == closing => fence = None,
            (Some(_), _) => {}
            (None, None) => prose.push_str(line),
        }
        prose.push('\n');
    }
    prose
}

/// The text without code spans and comments; line breaks inside stay.
fn without_spans(text: &str) -> String {
    let mut rest = text;
    let mut kept = String::new();
    while let Some(at) = rest.find(['`', '<']) {
        kept.push_str(&rest[..at]);
        rest = &rest[at..];
        let ticks = rest.len() - rest.trim_start_matches('`').len();
        let (open, close) = match ticks {
            0 if rest.starts_with("<!--") => ("<!--", "-->"),
            0 => ("<", ""),
            _ => (&rest[..ticks], &rest[..ticks]),
        };
        let inside = &rest[open.len()..];
        let end = if close.is_empty() {
            None
        } else {
            inside.find(close)
        };
        match end {
            Some(length) => {
                kept.extend(inside[..length].chars().filter(|c| *c == '\n'));
                rest = &inside[length + close.len()..];
            }
            None => {
                kept.push_str(open);
                rest = inside;
            }
        }
    }
    kept + rest
}

/// Targets of the links of a line, with their titles.
fn targets(line: &str) -> Vec<&str> {
    let inline = line.split("](").skip(1);
    let mut targets: Vec<_> = inline.filter_map(|rest| rest.split(')').next()).collect();
    if let Some((name, target)) = line.trim_start().split_once("]: ")
        && name.starts_with('[')
    {
        targets.push(target);
    }
    targets
}
