//! Outputs that are inputs, and outputs that are one file.

use std::fs;

use crate::{Folder, HOST_SIM};

/// 2 s at 1 kHz of a shaft that turns back and forth.
fn log() -> String {
    let count = |k: i32| (2000.0 * (1.0 - (f64::from(k) * 5e-3).cos())).floor();
    let row = |k: i32| format!("{},{}\n", f64::from(k) * 1e-3, count(k));
    "t,counts_large\n".to_owned() + &(0..2000).map(row).collect::<String>()
}

#[test]
fn output_over_its_input_is_refused_and_the_input_is_kept() {
    let folder = Folder::new(HOST_SIM);
    folder.write("log.csv", log());
    folder.write("log.svg", log());
    folder.write("d.toml", "large.counts_per_rev = 4096\n");
    fs::create_dir(folder.path().join("deep")).unwrap();
    let absolute = folder.path().join("log.csv").display().to_string();
    let mut outputs = vec!["log.csv", "./log.csv", "deep/../log.csv", &absolute];
    #[cfg(unix)]
    {
        std::os::unix::fs::symlink("log.csv", folder.path().join("link.csv")).unwrap();
        outputs.push("link.csv");
    }
    for output in outputs {
        let line = folder.refused(&["replay", "log.csv", "--estimator", "pll", "--out", output]);
        let said = format!("--out {output}: would overwrite the input log.csv; name another file");
        assert!(line.contains(&said), "{line}");
    }
    let coarsen = "coarsen log.csv --counts-per-rev 1024 --fine-counts-per-rev 4096 --out log.csv";
    for command in [
        "replay log.csv --json log.csv",
        "replay log.csv --device d.toml --out d.toml",
        "recommend log.csv --json log.csv",
        "plot log.csv --out log.csv",
        "plot log.svg",
        "tune log.csv --out log.csv",
        "identify log.csv --clamped --out log.csv",
        "identify log.csv --clamped --device d.toml --json d.toml",
        "export log.csv --mcap log.csv",
        "record log.csv --out log.csv",
        coarsen,
    ] {
        let line = folder.refused(command);
        assert!(
            line.contains(": would overwrite the input "),
            "{command}: {line}"
        );
    }
    for name in ["log.csv", "log.svg"] {
        assert_eq!(folder.text(name), log(), "{name}");
    }
}

#[test]
fn device_file_of_identify_may_be_its_output() {
    let folder = Folder::new(HOST_SIM);
    folder.write("d.toml", "large.counts_per_rev = 4096\n");
    folder.write("log.csv", log());
    let command = "identify log.csv --clamped --device d.toml --out d.toml";
    let line = folder.refused(command);
    // The log has no column current.
    assert!(
        !line.contains("overwrite") && line.contains("current"),
        "{line}"
    );
}

#[test]
fn two_outputs_of_one_file_are_refused() {
    let folder = Folder::new(HOST_SIM);
    folder.write("log.csv", log());
    for command in [
        "replay log.csv --out new --json ./new",
        "identify log.csv --clamped --json new --out new",
        "real --json new --csv new",
    ] {
        let line = folder.refused(command);
        assert!(line.contains("new: is the file of --"), "{command}: {line}");
    }
    let (out, json) = (["--out", "/dev/null"], ["--json", "/dev/null"]);
    if cfg!(unix) {
        folder.good(
            &[
                &["replay", "log.csv", "--estimator", "pll"][..],
                &out,
                &json,
            ]
            .concat(),
        );
    }
}

#[test]
fn output_that_ends_as_a_folder_is_refused_before_the_run() {
    let folder = Folder::new(HOST_SIM);
    folder.write("log.csv", log());
    fs::create_dir(folder.path().join("there")).unwrap();
    for command in [
        "replay log.csv --estimator pll --out",
        "replay log.csv --estimator pll --json",
        "plot log.csv --out",
        "coarsen log.csv --counts-per-rev 1024 --fine-counts-per-rev 4096 --out",
        "tune log.csv --estimator low-pass --out",
        "simulate --scenario track --out",
    ] {
        for output in ["new/a/b/", "there/"] {
            let line = folder.refused(format!("{command} {output}").as_str());
            let said = format!("{output}: is a folder; choose the name of a file");
            assert!(line.contains(&said), "{command}: {line}");
        }
        let line = folder.refused(format!("{command} log.csv/b").as_str());
        let said = "log.csv/b: log.csv is no folder; choose another path";
        assert!(line.contains(said), "{command}: {line}");
    }
    assert!(!folder.path().join("new").exists());
}

#[test]
fn output_without_a_place_is_refused_before_the_work() {
    let folder = Folder::new(HOST_SIM);
    folder.write("file", "mine");
    folder.write("log.csv", log());
    // More work than a test has time for.
    let long = "--seconds 1e4 --rate 100000";
    for command in [
        "robust --devices 10000000 --out file".to_owned(),
        "robust --devices 10000000 --out file/".to_owned(),
        "robust --devices 10000000 --shard 1/2 --out file".to_owned(),
        "robust --devices 10000000 --out new --json file/x.json".to_owned(),
        format!("compare {long} --out file/deep/er"),
        format!("compare --closed-loop {long} --out file"),
        format!("compare {long} --no-report --json file/x.json"),
        format!("tune --estimator imm {long} --out file/x.toml"),
        format!("tune --estimator imm {long} --shard 1/2 --out file"),
        "zwidth --exact --out file".to_owned(),
        format!("sensitivity {long} --out file"),
        format!("feel {long} --out file"),
        format!("limit {long} --particles 1000000 --json file/x.json"),
        "real --out file".to_owned(),
        "recommend log.csv --report file".to_owned(),
        "identify log.csv --clamped --report file/page".to_owned(),
    ] {
        let line = folder.refused(&command);
        assert!(
            line.contains("file is no folder; choose"),
            "{command}: {line}"
        );
    }
    // The folder of a shard is there already, or not yet.
    let tune = "tune --estimator pll --scenario step --rate 100 --seconds 1 --seeds 1";
    folder.good(&format!("{tune} --shard 1/1 --out parts"));
    folder.good(&format!("{tune} --shard 1/1 --out parts"));
    folder.good("merge parts/shard-1-of-1.jsonl --out merged.toml");
}

#[test]
fn file_that_may_be_one_of_the_report_is_refused() {
    let folder = Folder::new(HOST_SIM);
    let run = "compare --scenario step --rate 1000 --seconds 1 --estimator pll";
    for (out, json) in [
        ("zz", "zz/scores.csv"),
        ("zz", "./zz/index.html"),
        (".", "scores.csv"),
        ("zz", "zz/scores.json"),
    ] {
        let line = folder.refused(&format!("{run} --out {out} --json {json}"));
        let said = format!("--json {json}: may be a file of --out {out}; choose another name");
        assert!(line.contains(&said), "{line}");
    }
    folder.good(&format!("{run} --out zz --json zz/rows.json"));
    // The folder without --out.
    let usual = "target/report/scores.json";
    let line = folder.refused(&format!("{run} --json {usual}"));
    let said = format!("--json {usual}: may be a file of the default --out target/report; choose");
    assert!(line.contains(&said), "{line}");
    folder.good(&format!("{run} --no-report --json {usual}"));
}

#[test]
fn report_does_not_replace_a_file_that_no_run_wrote() {
    let folder = Folder::new(HOST_SIM);
    for deep in ["mine", "drawn/figures"] {
        fs::create_dir_all(folder.path().join(deep)).unwrap();
    }
    folder.write("mine/index.html", "mine");
    folder.write("log.csv", log());
    let said = "mine/index.html was not written by an earlier run, or was changed since; choose another folder";
    // More work than a test has time for.
    for command in [
        "robust --devices 10000000 --out mine",
        "real --out mine",
        "compare --seconds 1e4 --out mine",
        "recommend log.csv --counts-per-rev 4096 --report mine",
    ] {
        let line = folder.refused(command);
        assert!(line.contains(said), "{command}: {line}");
    }
    assert_eq!(folder.text("mine/index.html"), "mine");
    // A file of another name is kept, and a run replaces the files of another one.
    fs::rename(
        folder.path().join("mine/index.html"),
        folder.path().join("mine/own.html"),
    )
    .unwrap();
    let run = "robust --scene off --rate 1000 --seconds 0.2 --out mine --devices";
    folder.good(&format!("{run} 0"));
    folder.good(&format!("{run} 1"));
    assert_eq!(folder.text("mine/own.html"), "mine");
    // A figure has no name that is known before the run.
    folder.write("drawn/figures/01.svg", "mine");
    let short = "compare --scenario step --rate 1000 --seconds 1 --estimator pll --out drawn";
    let line = folder.refused(short);
    assert!(line.contains("figures/01.svg was not written"), "{line}");
    assert_eq!(folder.text("drawn/figures/01.svg"), "mine");
    assert!(!folder.path().join("drawn/index.html").exists());
}

#[test]
fn default_folder_of_a_report_is_checked_before_the_run() {
    let folder = Folder::new(HOST_SIM);
    // More work than a test has time for.
    let long = "--seconds 1e4 --rate 100000";
    for (name, command) in [
        ("report", format!("compare {long}")),
        ("report", format!("compare --closed-loop {long}")),
        ("robust", "robust --devices 10000000".to_owned()),
        ("zwidth", "zwidth --exact".to_owned()),
        ("sensitivity", format!("sensitivity {long}")),
        ("feel", format!("feel {long}")),
    ] {
        let usual = format!("target/{name}");
        fs::create_dir_all(folder.path().join(&usual)).unwrap();
        folder.write(&format!("{usual}/index.html"), "mine");
        let line = folder.refused(&command);
        let said = format!("the default --out {usual}: ");
        assert!(line.contains(&said), "{command}: {line}");
        assert!(
            line.contains("was not written by an earlier run, or was changed since; choose"),
            "{command}: {line}"
        );
    }
    // No report is written.
    let short = "--scene off --rate 1000 --seconds 0.2";
    folder.good(&format!("robust {short} --only 0"));
    folder.good(&format!("robust {short} --devices 0 --json -"));
    folder.good("compare --scenario step --rate 1000 --seconds 1 --estimator pll --no-report");
}

#[test]
fn recording_that_is_given_twice_is_refused() {
    let folder = Folder::new(HOST_SIM);
    folder.write("log.csv", log());
    folder.write("copy.csv", log());
    for command in [
        "identify --clamped",
        "recommend --counts-per-rev 4096",
        "tune --counts-per-rev 4096 --estimator low-pass --out new.toml",
    ] {
        for (first, second) in [("log.csv", "./log.csv"), ("log.csv", "copy.csv")] {
            let line = folder.refused(&format!("{command} {first} {second}"));
            let said = format!("{second}: is already given by {first}; give each recording once");
            assert!(line.contains(&said), "{command}: {line}");
        }
    }
}
