//! `record` and `plot` as somebody types them.

use std::fmt::Write as _;

use crate::{Folder, HOST_SIM};

/// A log as `cargo firmware` prints it: 1 rad/s, over the wrap of the counts, in steps of `every`.
fn log(frames: impl Iterator<Item = u32>, boots: bool) -> String {
    let mut log = String::from("     Finished in 2.1s\n");
    if boots {
        log += "0.000000 [INFO ] boot rate=10000 cause=0 (firmware src/main.rs:50)\n";
    }
    for k in frames {
        let large = (652 * k / 1000).wrapping_sub(100);
        writeln!(
            log,
            "0.1 [INFO ] frame seq={k} tick={} large={large} small={} wl=1.1 ws=0.9 torque=0.01 \
             il=0.25 is=-0.125 state={} cause=0 overruns=0 drops=0 cycles=900 (firmware \
             src/telemetry.rs:93)",
            10 * k,
            3183 * k / 1000,
            1 + k / 100,
        )
        .unwrap();
    }
    log
}

#[test]
fn log_is_converted_replayed_and_drawn() {
    let folder = Folder::new(HOST_SIM);
    let log = log((0..200).filter(|k| !(50..60).contains(k)), true) + "frame seq=200 tick=2000 la";
    let (_, said) = folder.good_on(&["record", "--out", "run.csv"], log.as_bytes());
    assert!(
        said.contains("190 frames recorded, 10 missing at 1 place"),
        "{said}"
    );
    assert!(
        said.contains("1 piece of the stream not readable, the first: incomplete line"),
        "{said}"
    );
    folder.write("run.log", &log);
    let (printed, _) = folder.good_on(&["record", "run.log"], b"");
    assert_eq!(printed, folder.text("run.csv"));
    let replay = ["replay", "run.csv", "--estimator"];
    let uneven = "t is uneven in 0.53 % of steps (1 of 189), by up to 10000 us";
    let refused = folder.refused(&[&replay[..], &["pll"]].concat());
    assert!(
        refused.contains(uneven) && refused.contains("add --resample 1000"),
        "{refused}"
    );
    let (estimates, said) = folder.good_on(&[&replay[..], &["low-pass"]].concat(), b"");
    assert_eq!(estimates.lines().count(), 191);
    assert!(said.contains(uneven), "{said}");
    let even = [&replay[..], &["pll", "--resample", "1000"]].concat();
    let (estimates, said) = folder.good_on(&even, b"");
    // The ten missing rows are interpolated.
    assert_eq!(estimates.lines().count(), 201);
    assert!(said.contains("200 rows at 1000 Hz"), "{said}");
    // A count is 1.5 rad/s from row to row, so the estimate is right on average alone.
    let velocities = estimates.lines().skip(101);
    let velocities = velocities.map(|line| line.rsplit(',').next().unwrap().parse::<f64>());
    let mean = velocities.map(Result::unwrap).sum::<f64>() / 100.0;
    assert!((mean - 1.0).abs() < 0.1, "{mean} rad/s");

    let (path, _) = folder.good_on(&["plot", "run.csv"], b"");
    assert_eq!(path, "run.svg\n");
    let svg = folder.text("run.svg");
    assert!(svg.starts_with("<svg ") && svg.trim_end().ends_with("</svg>"));
    for word in [
        "angle, rad",
        "current, A",
        "torque, mN\u{b7}m",
        "the board",
        "running",
    ] {
        assert!(svg.contains(word), "{word}");
    }
    assert!(!svg.contains("truth"));
}

/// Stamps and what the board learned go from the log to the recording, and replay tells of both.
#[test]
fn side_lines_are_columns_and_health_lines() {
    let folder = Folder::new(HOST_SIM);
    let mut text = String::new();
    for (k, line) in log(0..200, true).lines().enumerate() {
        text += line;
        text += "\n";
        if let (true, Some(seq)) = (line.contains("frame seq="), k.checked_sub(2)) {
            let bound = (652 * seq / 1000).wrapping_sub(100);
            writeln!(text, "0.1 [INFO ] edge seq={seq} bound={bound} age=4200").unwrap();
        }
    }
    text += "learned seq=199 damping=-0.25 friction=0 torque_constant=0\n";
    let text = text.replace("torque=0.01", "sl=0.5 estimator=0 torque=0.01");
    folder.good_on(&["record", "--out", "run.csv"], text.as_bytes());
    let csv = folder.text("run.csv");
    let head = "sigma_large,edge_tick,edge_bound,learned_damping,learned_friction,\
        learned_torque_constant";
    assert!(csv.lines().next().unwrap().ends_with(head), "{csv}");
    assert!(
        csv.lines()
            .last()
            .unwrap()
            .ends_with(",0.5,16711800,29,-0.25,0,0"),
        "{csv}"
    );
    let (_, said) = folder.good_on(&["replay", "run.csv", "--estimator", "observer-edge"], b"");
    assert_eq!(said.matches("run.csv: health: ").count(), 4, "{said}");
    let damping =
        "health: damping b, N.m.s/rad: learned 7.2000e-4, identified 9.6000e-4, -25.0 %: changed";
    assert!(said.contains(damping), "{said}");
    // A device with the learned damping has not changed.
    let device = "[coupler]\ndamping_nms_per_rad = 0.72e-3\n";
    folder.write("found.toml", device);
    let found = [
        "replay",
        "run.csv",
        "--estimator",
        "pll",
        "--device",
        "found.toml",
    ];
    let (_, said) = folder.good_on(&found, b"");
    assert!(
        said.contains("+0.0 %") && !said.contains("changed"),
        "{said}"
    );
    // Somebody else's columns of the same names are nobody's business.
    let foreign = csv
        .replace("sigma_large", "x")
        .replace("learned_", "y_")
        .replace(",2,0,", ",run,none,");
    folder.write("foreign.csv", foreign);
    let (_, said) = folder.good_on(&["replay", "foreign.csv", "--estimator", "pll"], b"");
    assert!(!said.contains("health"), "{said}");
}

#[test]
fn measured_currents_are_columns_that_replay_and_plot_use_and_tell() {
    let folder = Folder::new(HOST_SIM);
    let mut text = String::new();
    for (k, line) in log(0..200, true).lines().enumerate() {
        writeln!(text, "{line}").unwrap();
        if let (true, Some(seq)) = (line.contains("frame seq="), k.checked_sub(2)) {
            writeln!(text, "measured seq={seq} large=0.25 small=-0.5").unwrap();
        }
    }
    folder.good_on(&["record", "--out", "run.csv"], text.as_bytes());
    let csv = folder.text("run.csv");
    assert!(csv.lines().last().unwrap().ends_with(",0.25,-0.5"), "{csv}");
    for command in [
        &["replay", "run.csv", "--estimator", "pll"][..],
        &["plot", "run.csv"],
    ] {
        let (_, said) = folder.good_on(command, b"");
        for (measured, command) in [
            ("current_measured", "current"),
            ("current_small_measured", "current_small"),
        ] {
            let line = format!(
                "run.csv: the current of each row is {measured} of the next row, not {command}\n"
            );
            assert!(said.contains(&line), "{said}");
        }
    }
}

#[test]
fn streams_that_cannot_be_recorded_or_drawn_are_refused_with_one_line() {
    let folder = Folder::new(HOST_SIM);
    let whole = log(0..3, true);
    let middle = log(7..20, false);
    let one = log(0..1, true);
    let cases: [(&[&str], &str, &str); 9] = [
        (
            &[],
            "",
            "standard input: no telemetry frame; a log of cargo firmware is expected",
        ),
        (&[], "\u{0}\u{a5}\n", "standard input: no telemetry frame"),
        (&["nowhere.log"], "", "nowhere.log: cannot read"),
        (&["--image", "nowhere"], &whole, "nowhere: cannot read"),
        (&[], &one, "has only one telemetry frame"),
        (
            &[],
            &middle,
            "begins after the boot line; give the control rate, for example --rate",
        ),
        (&["--rate", "1000"], &whole, "its boot line says rate=10000"),
        (&["--rate", "-1"], &middle, "a control rate of -1 Hz"),
        (&["--run", "2"], &whole, "--run 2: no such run; give 1 to 1"),
    ];
    for (arguments, input, said) in cases {
        let arguments = [&["record", "--out", "run.csv"], arguments].concat();
        let error = folder.refused_on(&arguments, input.as_bytes());
        assert!(error.contains(said), "{arguments:?}: {error}");
    }
    let (text, _) = folder.good_on(&["record", "--rate", "10000"], middle.as_bytes());
    assert_eq!(text.lines().count(), 14);

    folder.write("r.csv", &text);
    for (arguments, said) in [
        (&["nowhere.csv"][..], "nowhere.csv: cannot read"),
        (
            &["r.csv", "--from", "5"],
            "fewer than two rows from 5 to 0.012 s",
        ),
        (&["r.csv", "--estimator", "x"], "no estimator 'x'"),
        (&["r.csv", "--out", "r.csv/x.svg"], "r.csv is no folder"),
    ] {
        let error = folder.refused(&[&["plot"], arguments].concat());
        assert!(error.contains(said), "{arguments:?}: {error}");
    }
    folder.write("r.csv", text.replace("0.01,1.1", "wet,1.1"));
    let error = folder.refused(&["plot", "r.csv"]);
    assert!(
        error.contains("r.csv: line 2: column torque: 'wet' is not a number"),
        "{error}"
    );
}
