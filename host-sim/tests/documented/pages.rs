//! Every name that the command line offers has its place in the documentation.

use std::collections::BTreeSet;
use std::fs;
use std::path::Path;
use std::process::Command;

use measured::digits::within_a_tenth;

/// The text of a page of docs/theory.
fn theory(file: &str) -> String {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../docs/theory");
    fs::read_to_string(folder.join(file)).expect(file)
}

/// What the program prints.
fn printed(arguments: &[&str]) -> String {
    let output = Command::new(env!("CARGO_BIN_EXE_host-sim"))
        .args(arguments)
        .output()
        .expect("host-sim runs");
    assert!(output.status.success(), "{arguments:?}");
    String::from_utf8(output.stdout).expect("standard output is text")
}

/// The first words of the lines that are not indented.
fn names(list: &str) -> Vec<&str> {
    let lines = list.lines().filter(|line| !line.starts_with(' '));
    lines
        .filter_map(|line| line.split_whitespace().next())
        .collect()
}

/// Code spans in the first cells of the rows of all tables of a page.
fn first_cells(page: &str) -> BTreeSet<&str> {
    let rows = page.lines().filter(|line| line.starts_with('|'));
    let cells = rows.filter_map(|row| row.split('|').nth(1));
    cells
        .flat_map(|cell| cell.split('`').skip(1).step_by(2))
        .collect()
}

/// A theory page of estimators.
struct Page {
    /// Names of the estimators on the command line, from the line below the title.
    estimators: BTreeSet<String>,
    /// Names of the parameters in its tables.
    parameters: BTreeSet<String>,
    /// Whether it refers to the table of the observer's parameters.
    as_the_observer: bool,
}

fn pages() -> Vec<Page> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../docs/theory");
    let files = fs::read_dir(folder).expect("docs/theory");
    let page = |text: String| {
        let line = text.replace('\n', " ");
        let (_, from) = line.split_once("**command line**")?;
        let (names, _) = from.split_once("**reads**")?;
        let names = names.split('`').skip(1).step_by(2);
        Some(Page {
            estimators: names.map(str::to_owned).collect(),
            parameters: first_cells(&text).into_iter().map(str::to_owned).collect(),
            as_the_observer: text.contains("](observer.md#parameters)"),
        })
    };
    let texts = files.map(|file| fs::read_to_string(file.expect("a page").path()).expect("a page"));
    texts.filter_map(page).collect()
}

/// Words of a text, with a mark at each end of a line.
fn words(text: &str) -> Vec<&str> {
    text.lines()
        .flat_map(|line| line.split_whitespace().chain(["\n"]))
        .collect()
}

#[test]
fn quick_start_shows_what_its_command_prints() {
    let page = Path::new(env!("CARGO_MANIFEST_DIR")).join("../docs/quick-start.md");
    let page = fs::read_to_string(page).expect("docs/quick-start.md");
    let (before, shown) = page.split_once("```text\n").expect("a printed text");
    let (shown, _) = shown.split_once("```").expect("its end");
    let command = before
        .rsplit("```sh\ncargo sim ")
        .next()
        .expect("a command");
    let (command, _) = command.split_once('\n').expect("its end");
    let output = printed(&command.split(' ').collect::<Vec<_>>());
    let [shown, now] = [shown, &output].map(words);
    assert_eq!(shown.len(), now.len(), "{output}");
    for (shown, now) in shown.iter().zip(now) {
        match (shown.parse(), now.parse()) {
            (Ok(shown), Ok(now)) => assert!(within_a_tenth(shown, now), "{shown} is {now}"),
            _ => assert_eq!(*shown, now, "{output}"),
        }
    }
}

#[test]
fn every_estimator_and_parameter_has_a_theory_page() {
    let listed = printed(&["estimators"]);
    let pages = pages();
    let of = |name: &str| {
        let pages = pages.iter().filter(|page| page.estimators.contains(name));
        pages.collect::<Vec<_>>()
    };
    let mut checked = 0;
    for name in names(&listed) {
        let mut its = of(name);
        assert!(!its.is_empty(), "{name} has no page in docs/theory");
        if its.iter().any(|page| page.as_the_observer) {
            its.extend(of("observer"));
        }
        let option = format!("--set {name}.");
        for rest in listed.split(&option).skip(1) {
            let parameter = rest.split('=').next().unwrap_or_default();
            let is_there = its.iter().any(|page| page.parameters.contains(parameter));
            assert!(is_there, "{name}.{parameter} is in no table of its pages");
            checked += 1;
        }
    }
    assert!(checked > 20, "{checked} parameters");
}

#[test]
fn every_scenario_has_a_row() {
    let listed = printed(&["scenarios"]);
    let page = theory("scenarios.md");
    let documented = first_cells(&page);
    let listed: BTreeSet<_> = names(&listed).into_iter().collect();
    assert_eq!(documented, listed);
}

#[test]
fn every_score_has_a_row() {
    let help = printed(&["compare", "--help"]);
    let (_, scores) = help.split_once("The scores are:").expect("the scores");
    let (scores, _) = scores.split_once("--out").expect("the next option");
    let names = scores
        .lines()
        .filter_map(|line| line.trim().split_once(": "));
    let listed: BTreeSet<_> = names.map(|(name, _)| name).collect();
    assert_eq!(first_cells(&theory("scores.md")), listed);
}
