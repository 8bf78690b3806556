//! Words that no command knows.

use crate::{Folder, HOST_SIM};

#[test]
fn invalid_arguments_are_refused_with_a_remedy() {
    let folder = Folder::new(HOST_SIM);
    folder.write("device.toml", "[large]\ninertia = 1\n");
    folder.write("negative.toml", "[large]\ninertia_kg_m2 = -1\n");
    let wide: Vec<u8> = "[large]\n".bytes().flat_map(|byte| [byte, 0]).collect();
    folder.write("wide.toml", [&[0xFF, 0xFE][..], &wide].concat());
    folder.write("latin.toml", b"# 5 \xB5s\n[large]\n");
    folder.write("file", "");
    for (arguments, said) in [
        (&["compare", "--scenario", "stp"][..], "step"),
        (&["compare", "--estimator", "kalman"], "kalman-triple"),
        (&["compare", "--rate", "0"], "rate"),
        (&["compare", "--rate", "nan"], "rate"),
        (&["compare", "--rate", "fast"], "--rate"),
        (&["compare", "--seconds", "-1"], "duration -1 s"),
        (
            &["simulate", "--seconds", "10000", "--out", "s.csv"],
            "duration 10000 s: must be from 0.0002 to 2000 s at 10000 Hz",
        ),
        (&["compare", "--seconds", "0.1"], "scores begin after 0.1 s"),
        (
            &["limit", "--seconds", "0.01"],
            "duration 0.01 s: scores begin after 0.1 s; give a longer --seconds",
        ),
        (
            &["sensitivity", "--seconds", "0.01"],
            "duration 0.01 s: scores begin after 0.1 s; give a longer --seconds",
        ),
        (
            &["tune", "--estimator", "pll", "--seconds", "0.05"],
            "duration 0.05 s: scores begin after 0.1 s; give a longer --seconds",
        ),
        (
            &["export", "--c", "--estimator", "pll", "--edge-clock", "nan"],
            "--edge-clock NaN: must be a number above 0, in Hz",
        ),
        (
            &[
                "simulate", "--scene", "wall", "--rate", "500", "--out", "s.csv",
            ],
            "--rate 500: a closed loop needs a control rate of 600 to 100000 Hz",
        ),
        (
            &["simulate", "--rate", "700", "--out", "s.csv"],
            "--rate 700: scene excite needs a control rate of 1 to 100 kHz",
        ),
        (
            &["feel", "--rate", "500"],
            "--rate 500: a closed loop needs a control rate of 600 to 100000 Hz",
        ),
        (&["compare", "--score", "beauty"], "rms_rad_s"),
        (&["compare", "--set", "foaw-end-fit.n=129"], "from 1 to 128"),
        (
            &[
                "replay",
                "file",
                "--set",
                "pll.bandwidth_hz=200",
                "--set",
                "pll.bandwidth_hz = 200",
            ],
            "--set pll.bandwidth_hz = 200: pll.bandwidth_hz is given twice; keep one",
        ),
        (
            &[
                "compare",
                "--set",
                "low-pass.cutoff_hz=600",
                "--rate",
                "1000",
            ],
            "cutoff must be between 1e-6 and 1/2 of the rate (Hz)",
        ),
        (
            &["compare", "--device", "none.toml"],
            "none.toml: cannot read",
        ),
        (
            &["compare", "--device", "wide.toml"],
            "wide.toml: is UTF-16, as > of Windows PowerShell writes it; save the file as UTF-8",
        ),
        (
            &["compare", "--device", "latin.toml"],
            "latin.toml: line 1: is not UTF-8 text; save the file as UTF-8",
        ),
        (&["compare", "--device", "device.toml"], "inertia"),
        (
            &["compare", "--device", "negative.toml"],
            "large.inertia_kg_m2",
        ),
        (
            &["compare", "--presets", "device.toml"],
            "device.toml: line 1",
        ),
        (
            &[
                "compare",
                "--seconds",
                "0.2",
                "--rate",
                "1000",
                "--scenario",
                "step",
                "--out",
                "file/x",
            ],
            "file/x",
        ),
        (&["compare", "--bogus"], "see host-sim compare --help"),
        (&["replay"], "TRACE.csv"),
        (
            &["tune", "--estimator", "finite-difference"],
            "nothing to tune",
        ),
        (&["tune", "--seeds", "0"], "--seeds"),
        (&["dance"], "host-sim --help"),
    ] {
        let line = folder.refused(arguments);
        assert!(line.contains(said), "{arguments:?}: {line}");
    }
}

#[test]
fn value_of_an_estimator_that_does_not_run_is_refused() {
    let folder = Folder::new(HOST_SIM);
    folder.write("log.csv", "t,counts_large\n0,0\n");
    let value = "--set low-pass.cutoff_hz=20";
    for command in [
        "compare --estimator pll --scenario step",
        "compare --closed-loop --estimator pll",
        "export --c --estimator pll",
        "feel --estimator pll",
        "limit --estimator pll",
        "plot log.csv",
        "real --estimator pll",
        "replay log.csv --estimator pll",
        "robust",
        "sensitivity --estimator pll",
        "zwidth --estimator pll",
    ] {
        let line = folder.refused(&format!("{command} {value}"));
        let said = "--set low-pass.cutoff_hz=20: low-pass is not run; add --estimator low-pass, or remove --set";
        assert!(line.contains(said), "{command}: {line}");
    }
    // The estimator of the handle runs too.
    let short = "--scene wall --rate 1000 --seconds 0.3 --estimator pll --set kalman-triple-steady.jerk=100 --json -";
    folder.good(&format!("compare --closed-loop {short}"));
    folder.good(&format!("feel --causes-only {short}"));
}

#[test]
fn control_characters_of_files_do_not_reach_the_terminal() {
    let folder = Folder::new(HOST_SIM);
    folder.write("d.toml", "[large]\n\"\\u001b[31mred\" = 1\n");
    for (name, said) in [
        ("d.toml", r"unknown field `\u{1b}[31mred`"),
        ("a\u{1b}[31mb.toml", r"a\u{1b}[31mb.toml: cannot read"),
    ] {
        let line = folder.refused(&["device", "--device", name]);
        assert!(line.contains(said), "{line:?}");
        assert!(!line.trim_end().contains(char::is_control), "{line:?}");
    }
    // The result and the notes of a run have the name of its recording.
    let name = "a\u{1b}[31mb.csv";
    folder.write(name, "t,counts_large\n0,1\n0.001,2\n0.002,3\n");
    let ran = folder.run(&["replay", name, "--estimator", "pll", "--out", "v.csv"]);
    for output in [ran.stdout, ran.stderr] {
        let text = String::from_utf8(output).unwrap();
        assert!(
            text.contains(r"a\u{1b}[31mb.csv: ") && !text.contains('\u{1b}'),
            "{text:?}"
        );
    }
}

/// A damping in mN.m.s/rad makes the coupler too stiff for the step of the plant, which not every command has.
#[test]
fn stiff_device_is_refused_only_by_commands_that_simulate_it() {
    let folder = Folder::new(HOST_SIM);
    folder.write("stiff.toml", "[coupler]\ndamping_nms_per_rad = 0.96\n");
    let said = "stiff.toml: line 2, coupler.damping_nms_per_rad = 0.96: too large: the large motor settles in 1.2e-5 \
                s, but the simulation needs 1e-4 s or more; did you mean 0.96e-3, which is 0.96 mN.m.s/rad?";
    for command in [
        "compare",
        "limit",
        "feel",
        "zwidth",
        "robust",
        "sensitivity",
        "tune",
    ] {
        let refused = folder.refused(&[command, "--device", "stiff.toml"]);
        assert!(refused.contains(said), "{command}: {refused}");
    }
    folder.good("simulate --scenario step --rate 1000 --seconds 1 --out log.csv");
    for arguments in [
        &["replay", "log.csv", "--estimator", "pll"][..],
        &["recommend", "log.csv"],
        &["plot", "log.csv", "--out", "log.svg"],
        &["export", "--c", "--estimator", "pll"],
    ] {
        folder.good(&[arguments, &["--device", "stiff.toml"]].concat());
    }
    let (_, notes) = folder.ends(0, "device --device stiff.toml");
    assert!(
        notes.contains("stiff.toml: commands that simulate refuse this device: coupler.damping_nms_per_rad = 0.96"),
        "{notes}"
    );
}
