//! Names from the user's files on the pages and in figures.

use crate::{Folder, HOST_SIM};

const DEVICE: &str = "d<&\".toml";
const RECORDING: &str = "r<&\".csv";
const COLUMN: &str = "c<&\"";

#[test]
fn names_of_files_and_columns_are_escaped_on_every_page() {
    let folder = Folder::new(HOST_SIM);
    let run = |arguments: &str, names: &[&str]| {
        let words = arguments.split_whitespace().chain(names.iter().copied());
        folder.good(&words.collect::<Vec<_>>());
    };
    folder.write(DEVICE, "");
    run("simulate --every 10 --out plain.csv", &[]);
    let plain = folder.text("plain.csv");
    let more = |(i, line): (usize, &str)| match i {
        0 => format!("{line},{COLUMN}\n"),
        _ => format!("{line},0\n"),
    };
    folder.write(
        RECORDING,
        plain.lines().enumerate().map(more).collect::<String>(),
    );

    let short = "--seconds 1 --rate 1000 --estimator pll";
    let pages = [
        (format!("compare --scenario step {short}"), Some(DEVICE)),
        (
            format!("compare --closed-loop --scene off {short}"),
            Some(DEVICE),
        ),
        (format!("sensitivity --scenario step {short}"), Some(DEVICE)),
        (
            "zwidth --lines 256 --rate 1000 --estimator pll".to_owned(),
            Some(DEVICE),
        ),
        // This page shows the constants that it ran with, without the name of their file.
        (format!("robust --scene off --devices 1 {short}"), None),
        ("identify".to_owned(), Some(RECORDING)),
        ("plot".to_owned(), Some(RECORDING)),
    ];
    let mut wrong = Vec::new();
    for (command, shown) in &pages {
        let (file, names) = match command.as_str() {
            "identify" => (
                "page/index.html",
                &[RECORDING, "--report", "page", "--device", DEVICE][..],
            ),
            "plot" => ("plot.svg", &[RECORDING, "--out", "plot.svg"][..]),
            _ => (
                "page/index.html",
                &["--out", "page", "--device", DEVICE][..],
            ),
        };
        run(command, names);
        let page = folder.text(file);
        if page.contains("<&") || page.contains("&\"") {
            wrong.push(format!("{command}: a name is not escaped"));
        }
        let shown = shown.map(|name| name.replace("<&\"", "&lt;&amp;&quot;"));
        if shown.is_some_and(|escaped| !page.contains(&escaped)) {
            wrong.push(format!("{command}: no escaped name"));
        }
    }
    assert!(wrong.is_empty(), "{wrong:#?}");
}
