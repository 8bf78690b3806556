//! Tables on standard output, and the files of the same scores.

use std::collections::BTreeSet;

use scoring::score::Score;

use crate::{Folder, HOST_SIM, json};

/// Two estimators at 1 kHz, long enough for a score of the learned damping.
const RUN: [&str; 10] = [
    "compare",
    "--no-report",
    "--rate",
    "1000",
    "--seconds",
    "4",
    "--estimator",
    "finite-difference",
    "--estimator",
    "adaptive",
];

/// The cells of `estimator`'s lines.
fn cells<'a>(text: &'a str, estimator: &str) -> Vec<&'a str> {
    let of = text
        .lines()
        .map(str::split_whitespace)
        .filter_map(|mut cells| (cells.next() == Some(estimator)).then_some(cells));
    of.flatten().collect()
}

#[test]
fn every_score_can_be_requested_and_has_a_number() {
    let folder = Folder::new(HOST_SIM);
    for field in Score::FIELDS {
        for scenarios in [&["step"][..], &["step", "track", "stochastic"]] {
            let mut arguments = RUN.to_vec();
            arguments.extend(["--score", field.name]);
            for scenario in scenarios {
                arguments.extend(["--scenario", scenario]);
            }
            let text = folder.good(&arguments);
            let cells = cells(&text, "adaptive");
            // A column a scenario, and one over several.
            let columns = match scenarios.len() {
                1 => 1,
                several => several + 1,
            };
            assert_eq!(cells.len(), columns, "{}: {text}", field.name);
            for (i, cell) in cells.iter().enumerate() {
                // In scenario stochastic there is no transient.
                if cell.parse::<f64>().is_err() {
                    assert!(field.name.contains("transient") && i == 2, "{text}");
                }
            }
        }
    }
}

#[test]
fn help_names_every_score() {
    let folder = Folder::new(HOST_SIM);
    let help = folder.good(&["compare", "--help"]);
    let words: BTreeSet<_> = help
        .split(|c: char| !c.is_alphanumeric() && c != '_')
        .collect();
    for field in Score::FIELDS {
        assert!(words.contains(field.name), "{}", field.name);
    }
    let error = folder.refused(&["compare", "--score", "rms"]);
    for field in Score::FIELDS {
        assert!(error.contains(field.name), "{error}");
    }
}

#[test]
fn csv_and_json_have_the_same_fields() {
    let folder = Folder::new(HOST_SIM);
    let run = ["--rate", "1000", "--seconds", "1", "--estimator", "pll"];
    let same = |name: &str, nested: &str, arguments: &[&str]| {
        folder.good(&[arguments, &["--out", "out"]].concat());
        let read = |end| folder.text(&format!("out/{name}.{end}"));
        let csv = read("csv");
        let header: BTreeSet<_> = csv.lines().next().unwrap().split(',').collect();
        let rows = json(&read("json"));
        let mut keys: BTreeSet<_> = rows[0].as_object().unwrap().keys().collect();
        let inner = rows[0].get(nested).and_then(|value| value.as_object());
        if let Some(inner) = inner {
            keys.retain(|key| *key != nested);
            keys.extend(inner.keys());
        }
        let keys: BTreeSet<_> = keys.into_iter().map(String::as_str).collect();
        assert_eq!(header, keys, "{name}");
        assert!(keys.len() > 8 && csv.lines().count() == rows.len() + 1);
    };
    let scenario = [&["compare", "--scenario", "step"], &run[..]].concat();
    same("scores", "", &scenario);
    let scene = [&["compare", "--closed-loop", "--scene", "wall"], &run[..]].concat();
    same("closed-loop", "", &scene);
    let sensitivity = [&["sensitivity", "--scenario", "step"], &run[..]].concat();
    same("sensitivity", "", &sensitivity);
    let robust = [
        "robust",
        "--scene",
        "off",
        "--devices",
        "1",
        "--seconds",
        "0.2",
    ];
    same("robust", "variation", &robust);
}

#[test]
fn no_line_of_a_table_is_wider_than_80_characters() {
    let folder = Folder::new(HOST_SIM);
    let short = ["--rate", "1000", "--seconds", "0.4"];
    let two = ["--estimator", "pll", "--estimator", "kalman-triple-steady"];
    let all: [&[&str]; 9] = [
        &["compare", "--no-report"],
        &["compare", "--no-report", "--scenario", "step"],
        &[
            "compare",
            "--no-report",
            "--frictionless",
            "--scenario",
            "step",
        ],
        &["compare", "--no-report", "--closed-loop", "--scene", "wall"],
        &["compare", "--no-report", "--closed-loop", "--scene", "off"],
        &["sensitivity", "--scenario", "step", "--out", "page"],
        &["limit", "--particles", "10"],
        &[
            "zwidth",
            "--rate",
            "1000",
            "--lines",
            "256",
            "--estimator",
            "pll",
            "--out",
            "page",
        ],
        &[
            "robust",
            "--devices",
            "1",
            "--seconds",
            "0.2",
            "--out",
            "page",
        ],
    ];
    for arguments in all {
        let mut arguments = arguments.to_vec();
        match arguments[0] {
            "zwidth" | "robust" => {}
            "compare" if arguments.contains(&"--scenario") => arguments.extend(short),
            _ => arguments.extend([short, two].concat()),
        }
        let text = folder.good(&arguments);
        for line in text.lines() {
            let width = line.chars().count();
            assert!(width <= 80, "{width}: {line}\n{arguments:?}");
        }
        assert!(text.lines().count() > 3, "{text}");
        assert!(!text.contains("plant with frictionless"), "{text}");
    }
}

#[test]
fn help_states_the_lowest_rate_of_a_closed_loop() {
    let folder = Folder::new(HOST_SIM);
    for command in ["zwidth", "feel", "robust", "compare", "simulate"] {
        let help = folder.good(&format!("{command} --help"));
        let words: Vec<_> = help.split_whitespace().collect();
        assert!(words.join(" ").contains("600"), "{command}: {help}");
    }
    // It is one at which each scene runs.
    let run = "compare --closed-loop --rate 600 --seconds 0.2 --estimator pll --no-report";
    folder.good(run);
}

#[test]
fn limit_names_the_scenarios_in_which_it_is_no_bound() {
    let folder = Folder::new(HOST_SIM);
    let run = "limit --seconds 0.3 --particles 10 --estimator pll --scenario";
    let text = folder.good(&format!("{run} stochastic --scenario free-air"));
    assert!(
        text.contains("note: limit is no bound in free-air: the particle"),
        "{text}"
    );
    assert!(
        !folder
            .good(&format!("{run} stochastic"))
            .contains("no bound")
    );
}
