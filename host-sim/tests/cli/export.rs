//! Recordings as MCAP files, by a build with the writer and by one without.

use crate::{Folder, HOST_SIM};

const LOG: &str = "t,counts_large\n0,0\n0.001,1\n0.002,2\n";

fn folder() -> Folder {
    let folder = Folder::new(HOST_SIM);
    folder.write("run.csv", LOG);
    folder
}

#[cfg(not(feature = "mcap"))]
#[test]
fn build_without_the_writer_names_the_one_with_it_and_writes_nothing() {
    let folder = folder();
    let output = folder.run(&["export", "run.csv", "--mcap", "run.mcap"]);
    assert_eq!(output.status.code(), Some(2));
    let said = String::from_utf8(output.stderr).unwrap();
    assert!(
        said.contains("cargo export instead of cargo sim export"),
        "{said}"
    );
    assert_eq!(folder.names(), ["run.csv".to_owned()].into());
}

#[cfg(feature = "mcap")]
#[test]
fn estimates_and_columns_are_in_the_file() {
    let folder = folder();
    let arguments = [
        "export",
        "run.csv",
        "--estimator",
        "pll",
        "--mcap",
        "run.mcap",
    ];
    folder.good(&arguments);
    let bytes = std::fs::read(folder.path().join("run.mcap")).unwrap();
    let has = |text: &str| bytes.windows(text.len()).any(|at| at == text.as_bytes());
    assert!(bytes.starts_with(b"\x89MCAP") && bytes.ends_with(b"MCAP0\r\n"));
    assert!(has("limpid.Estimates") && has("pll") && has("large_angle") && !has("low_pass"));
}

#[test]
fn log_that_cannot_be_read_leaves_no_file() {
    let folder = folder();
    folder.write("bad.csv", "t,counts_large\n0,0\n0.001,x\n");
    let output = folder.run(&["export", "bad.csv", "--mcap", "bad.mcap"]);
    assert_eq!(output.status.code(), Some(2));
    let said = String::from_utf8(output.stderr).unwrap();
    assert!(
        said.contains("line 3") && said.contains("counts_large"),
        "{said}"
    );
    assert_eq!(folder.names().len(), 2);
}

#[test]
fn options_of_a_recording_are_refused_without_one() {
    let folder = folder();
    for option in [
        "--column t=t",
        "--modulus 4096",
        "--row-rate 1000",
        "--drop-stale",
        "--resample 1000",
    ] {
        let arguments = format!("export --c --estimator pll {option}");
        let error = folder.refused(&arguments);
        assert!(error.contains("cannot be used with"), "{error}");
    }
    let counts = [
        "export",
        "--c",
        "--estimator",
        "pll",
        "--counts-per-rev",
        "500",
    ];
    assert!(folder.good(&counts).contains("500 counts per revolution"));
}

#[test]
fn constant_for_c_has_the_name_that_is_asked_for() {
    let folder = folder();
    let said = folder.good("export --c --estimator pll --constant wheel_2");
    assert!(
        said.contains("static const limpid_pll_t wheel_2 = {{"),
        "{said}"
    );
    assert!(said.contains("#define WHEEL_2_RATE_HZ 1000.0"), "{said}");
    for name in ["2wheel", "my-wheel", "_wheel", ""] {
        let error = folder.refused(&["export", "--c", "--estimator", "pll", "--constant", name]);
        assert!(
            error.contains("a name in C begins with a letter"),
            "{error}"
        );
    }
    for (name, owner) in [
        ("int", "C or C++"),
        ("class", "C or C++"),
        ("main", "C or C++"),
        ("limpid_pll_update", "limpid.h"),
        ("LIMPID_H", "limpid.h"),
    ] {
        let error = folder.refused(&["export", "--c", "--estimator", "pll", "--constant", name]);
        let said = format!("{name} has a meaning in {owner} already; take another name");
        assert!(error.contains(&said), "{error}");
    }
}

#[test]
fn option_for_c_without_c_is_refused_with_both_ways_out() {
    let folder = folder();
    for option in [
        "--rate 1000",
        "--edge-clock 1e6",
        "--constant wheel",
        "--out x.h",
    ] {
        let (name, _) = option.split_once(' ').unwrap();
        let said = format!("error: {name} is for the parameters in C; add --c, or leave it out: ");
        for others in ["", "run.csv ", "--mcap a.mcap ", "run.csv --mcap a.mcap "] {
            let error = folder.refused(&format!("export {others}{option}"));
            assert!(error.starts_with(&said), "{others}{option}: {error}");
        }
    }
    for (line, said) in [
        (
            "run.csv",
            "required arguments were not provided: --mcap <FILE.mcap>;",
        ),
        (
            "--c --rate 1000",
            "required arguments were not provided: --estimator <NAME>;",
        ),
        (
            "--rate --mcap a.mcap",
            "a value is required for '--rate <HZ>' but none",
        ),
    ] {
        let error = folder.refused(&format!("export {line}"));
        assert!(error.contains(said), "{line}: {error}");
    }
}
