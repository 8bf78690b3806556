//! Lists in docs/ that nobody writes by hand: the pages of estimators, from the pages themselves; the
//! scenarios, the scores and the known logs, from their rows.
//!
//! `UPDATE_GOLDEN=1 cargo test --release --package host-sim --test documented lists` writes them. The
//! page of an estimator has a table with the heading row [`HEAD`].

use std::fs;
use std::path::{Path, PathBuf};

use catalogue::estimators::Kind;
use measured::block::{Block, markdown};
use measured::update;
use recordings::recording::known_logs;
use scoring::score::Score;
use simulation::scenario::ScenarioName;

/// Heading row of the table of an estimator's page, and of the list of all of them.
const HEAD: &str = "| estimator | example | g | RMS | delay | operations | state, bytes |";

/// The page of an estimator.
struct Page {
    /// Name of the file.
    file: String,
    /// Title.
    title: String,
    /// Rows of its table.
    rows: Vec<String>,
    /// Place of its first estimator in the catalogue; the number of estimators for none.
    place: usize,
}

fn docs(file: &str) -> PathBuf {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../docs");
    root.join(file)
}

/// The pages of estimators: those of the catalogue in its order, then the others by name.
fn pages() -> Vec<Page> {
    let files = fs::read_dir(docs("theory")).expect("docs/theory");
    let files = files.map(|file| file.expect("a page").path());
    let mut pages: Vec<_> = files.filter_map(|path| page(&path)).collect();
    pages.sort_by(|a, b| (a.place, &a.file).cmp(&(b.place, &b.file)));
    pages
}

fn page(path: &Path) -> Option<Page> {
    let text = fs::read_to_string(path).expect("a page");
    let rows: Vec<_> = text.lines().skip_while(|line| *line != HEAD).collect();
    if rows.is_empty() {
        return None;
    }
    let file = path.file_name()?.to_string_lossy().into_owned();
    let table = rows.iter().skip(2).take_while(|row| row.starts_with('|'));
    let title = text.lines().find_map(|line| line.strip_prefix("# "));
    let place = {
        // The words may stand on two lines.
        let text = text.replace('\n', " ");
        let (_, named) = text.split_once("**command line**").unwrap_or_default();
        let (named, _) = named.split_once("**reads**").unwrap_or_default();
        let is_named = |kind: &Kind| named.contains(&format!("`{}`", kind.name));
        Kind::all().iter().position(is_named)
    };
    Some(Page {
        title: title
            .unwrap_or_else(|| panic!("{file} has no title"))
            .to_owned(),
        rows: table.map(|row| listed(row, &file)).collect(),
        place: place.unwrap_or(Kind::all().len()),
        file,
    })
}

/// A row of a page as it stands in docs/theory.md: with a link to the page, and the links of its cells
/// from there.
fn listed(row: &str, file: &str) -> String {
    let cells = row.trim_start_matches("| ");
    let (name, rest) = cells.split_once(" | ").expect("a row of several cells");
    let rest = rest
        .replace("](", "](theory/")
        .replace("](theory/../", "](");
    format!("| [{name}](theory/{file}) | {rest}")
}

/// Writes or compares a block of a page.
fn check(page: &'static str, name: &'static str, content: &str) {
    let block = Block {
        kind: "catalogue",
        name,
        page,
    };
    let checked = block.check(content);
    checked.unwrap_or_else(|error| panic!("{error}"));
}

#[test]
fn every_page_of_an_estimator_is_in_the_overview() {
    let rows: Vec<_> = pages().into_iter().flat_map(|page| page.rows).collect();
    assert!(rows.len() >= Kind::all().len() / 2, "{rows:#?}");
    let rule = "|---".repeat(HEAD.matches('|').count() - 1);
    let table = format!("{HEAD}\n{rule}|\n{}", rows.join("\n"));
    check("docs/theory.md", "estimators", &table);
}

/// The table of contents of the book has no room for comments, so its list lies between two lines.
#[test]
fn every_page_of_an_estimator_is_in_the_contents() {
    let line = |page: &Page| format!("  - [{}](theory/{})\n", page.title, page.file);
    let lines: String = pages().iter().map(line).collect();
    let (begin, end) = ("- [Estimators]()\n", "- [Gains at compile time]");
    let path = docs("SUMMARY.md");
    let text = fs::read_to_string(&path).expect("docs/SUMMARY.md");
    let (before, rest) = text.split_once(begin).expect("the beginning of the list");
    let (written, after) = rest.split_once(end).expect("the end of the list");
    if update() {
        let text = format!("{before}{begin}{lines}{end}{after}");
        fs::write(&path, text).expect("docs/SUMMARY.md can be written");
    } else {
        assert_eq!(
            written, lines,
            "docs/SUMMARY.md differs from the pages: UPDATE_GOLDEN=1 writes the list anew"
        );
    }
}

#[test]
fn every_estimator_is_on_a_page_with_its_figures() {
    let pages = pages();
    for kind in Kind::all() {
        let names = format!("`{}`", kind.name);
        let is_there = pages.iter().any(|page| {
            let text = fs::read_to_string(docs("theory").join(&page.file)).expect("a page");
            text.contains(&names) && !page.rows.is_empty()
        });
        assert!(is_there, "no page with figures names {}", kind.name);
    }
}

#[test]
fn every_scenario_is_in_the_table_of_scenarios() {
    let compared = ScenarioName::compared();
    let row = |scenario: ScenarioName| {
        vec![
            format!("`{scenario}`"),
            scenario.description().to_owned(),
            if scenario.linear_plant() {
                "linear"
            } else {
                "friction"
            }
            .to_owned(),
            scenario.default_seconds().to_string(),
            if compared.contains(&scenario) {
                "yes"
            } else {
                "when named"
            }
            .to_owned(),
        ]
    };
    let rows: Vec<_> = ScenarioName::ALL.into_iter().map(row).collect();
    let head = ["name", "motion", "plant", "length, s", "compared"];
    let table = markdown(&head, &rows);
    check("docs/theory/scenarios.md", "scenarios", &table);
}

#[test]
fn every_score_is_in_the_table_of_scores() {
    let rows: Vec<_> = Score::FIELDS
        .iter()
        .map(|field| {
            let about = field.about.join("").trim().trim_end_matches('.').to_owned();
            let about = about.replace('|', "\\|").replace("`None`", "none");
            vec![format!("`{}`", field.name), about]
        })
        .collect();
    let table = markdown(&["name in JSON, CSV and options", "definition"], &rows);
    check("docs/theory/scores.md", "scores", &table);
}

#[test]
fn every_known_log_is_in_the_table_of_logs() {
    let row = |log: recordings::recording::KnownLog| {
        let column =
            |[ours, theirs, unit]: &[String; 3]| format!("`{ours}` from `{theirs}` ({unit})");
        let columns: Vec<_> = log.columns.iter().map(column).collect();
        vec![
            log.name.to_owned(),
            columns.join("<br>"),
            log.source.to_owned(),
        ]
    };
    let rows: Vec<_> = known_logs().into_iter().map(row).collect();
    let table = markdown(&["program", "columns", "source of the names"], &rows);
    check("docs/your-log.md", "logs", &table);
}
