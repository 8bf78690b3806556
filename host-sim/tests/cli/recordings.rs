//! Recordings as other tools write them, and what replay and plot say about them.

use crate::{DATA, Folder, HOST_SIM, json};

/// Standard error of a run that ended well, its standard output left aside.
fn notes(folder: &Folder, arguments: &str) -> String {
    let arguments: Vec<_> = arguments.split_whitespace().collect();
    let output = folder.run(&arguments);
    let errors = String::from_utf8(output.stderr).unwrap();
    assert_eq!(output.status.code(), Some(0), "{arguments:?}: {errors}");
    errors
}

#[test]
fn absolute_encoder_is_unwrapped_with_a_note() {
    let folder = Folder::new(HOST_SIM);
    let mut text = String::from("t,counts_large,true_omega\n");
    let per_count = std::f64::consts::TAU / 4096.0;
    for k in 0..2000_u32 {
        // 20 counts a row: 30.7 rad/s, 9 wraps.
        text += &format!(
            "{},{},{}\n",
            f64::from(k) * 1e-3,
            20 * k % 4096,
            20e3 * per_count
        );
    }
    folder.write("as5600.csv", text);
    let scores = "replay as5600.csv --estimator finite-difference --json -";
    let scores: Vec<_> = scores.split_whitespace().collect();
    let scores = json(&folder.good(&scores));
    let largest = scores[0]["max_rad_s"].as_f64().unwrap();
    assert!(largest < 1e-3, "{largest} rad/s off");
    for command in [
        "replay as5600.csv --estimator pll",
        "plot as5600.csv --out p.svg",
    ] {
        let said = notes(&folder, command);
        let note = "as5600.csv: counts_large wraps at 4096 and is unwrapped: a revolution of an \
                    absolute encoder";
        assert!(said.contains(note), "{said}");
    }
    // With another encoder it is not known at what the counts wrap.
    folder.write("mine.toml", "large.counts_per_rev = 2000\n");
    let said = notes(
        &folder,
        "replay as5600.csv --estimator pll --device mine.toml",
    );
    assert!(
        said.contains("if the encoder is absolute, give its counts"),
        "{said}"
    );
}

#[test]
fn presets_for_another_encoder_or_rate_are_reported() {
    let folder = Folder::new(HOST_SIM);
    let replay = format!("replay {DATA}/back-and-forth.csv --device {DATA}/hall-90.toml");
    let estimators = "--estimator pll --estimator finite-difference";
    let said = notes(&folder, &format!("{replay} {estimators}"));
    let warning = "back-and-forth.csv: parameters tuned in the shipped presets for 4096 counts/rev at \
                   1000 Hz are scaled to 90 counts/rev at 1000 Hz, far from there: pll; to be better, tune \
                   them with host-sim tune RECORDING or host-sim tune --rate 1000, with --device FILE.toml";
    assert!(said.contains(warning), "{said}");
    let said: Vec<_> = said.split_whitespace().collect();
    let said = said.join(" ");
    assert!(said.contains("1501 rows at 1000 Hz, 90 counts/rev (hall-90.toml), parameters: the"));
    let plot = replay.replace("replay", "plot") + " --out p.svg --estimator pll";
    assert!(notes(&folder, &plot).contains(warning));
    // A value set by name is what the user wants.
    let set = format!("{replay} {estimators} --set pll.bandwidth_hz=10");
    assert!(!notes(&folder, &set).contains("far from"));

    folder.write(
        "slow.toml",
        "[[preset]]\nrate_hz = 100\nplant = 'friction'\ncounts_per_rev = 90\n[preset.estimators.pll]\n\
         bandwidth_hz = 10\n",
    );
    let said = notes(
        &folder,
        &format!("{replay} {estimators} --presets slow.toml"),
    );
    let warning =
        "tuned in slow.toml for 90 counts/rev at 100 Hz are scaled to 90 counts/rev at 1000 Hz";
    assert!(said.contains(warning), "{said}");
    assert!(
        said.contains("parameters: slow.toml, then the shipped presets"),
        "{said}"
    );

    folder.write("r.csv", "t,counts_large\n0,1\n0.001,2\n");
    let said = notes(&folder, "replay r.csv --estimator pll");
    let header =
        "r.csv: 2 rows at 1000 Hz, 4096 counts/rev (the default device: no --device given)";
    assert!(
        said.split_whitespace()
            .collect::<Vec<_>>()
            .join(" ")
            .contains(header),
        "{said}"
    );
    assert!(!said.contains("far from"), "{said}");
}

#[test]
fn tuned_presets_name_their_encoder() {
    let folder = Folder::new(HOST_SIM);
    folder.write("mine.toml", "large.counts_per_rev = 512\n");
    let tune = "tune --rate 1000 --seeds 1 --seconds 1 --scenario step --estimator pll --device \
                mine.toml --out mine-presets.toml";
    folder.good(tune);
    folder.write("r.csv", "t,counts_large\n0,1\n0.001,2\n");
    let replay = "replay r.csv --estimator pll --presets mine-presets.toml";
    assert!(notes(&folder, replay).contains("for 512 counts/rev at 1000 Hz are scaled to 4096"));
    let right = notes(&folder, &format!("{replay} --device mine.toml"));
    assert!(!right.contains("far from"), "{right}");
}

#[test]
fn recordings_come_from_standard_input() {
    let folder = Folder::new(HOST_SIM);
    let recording = "t,counts_large\n0,1\n0.001,2\n0.002,3\n";
    folder.write("r.csv", recording);
    let from_stdin = |arguments: &[&str], text: &str| {
        let output = folder.run_on(arguments, text.as_bytes());
        let texts = [output.stdout, output.stderr].map(|text| String::from_utf8(text).unwrap());
        (output.status.code(), texts)
    };
    let (status, [estimates, said]) = from_stdin(&["replay", "-", "--estimator", "pll"], recording);
    assert_eq!(status, Some(0), "{said}");
    assert_eq!(
        estimates,
        folder.good(&["replay", "r.csv", "--estimator", "pll"])
    );
    let (status, [picture, said]) = from_stdin(&["plot", "-"], recording);
    assert_eq!(status, Some(0), "{said}");
    assert!(picture.starts_with("<svg "), "{picture}");
    let (status, [_, said]) = from_stdin(&["replay", "-"], "t,counts_large\n0,x\n");
    assert_eq!(status, Some(2));
    assert_eq!(
        said,
        "error: standard input: line 2: column counts_large: 'x' is not a number; remove the line if it has \
         the units, and state them with --column\n"
    );
    assert_eq!(folder.names().len(), 1);
}

#[test]
fn scores_of_a_coupler_need_a_recording_with_both_encoders() {
    let folder = Folder::new(HOST_SIM);
    let recording = |small: bool| {
        let mut text = String::from(if small {
            "t,counts_large,true_omega,counts_small\n"
        } else {
            "t,counts_large,true_omega\n"
        });
        for k in 0..500 {
            text += &format!(
                "{},{k},1.53{}\n",
                f64::from(k) * 1e-3,
                if small { ",0" } else { "" }
            );
        }
        text
    };
    for small in [false, true] {
        folder.write("r.csv", recording(small));
        let table = folder.good(&["replay", "r.csv", "--out", "v.csv"]);
        assert!(
            table.lines().all(|line| line.chars().count() <= 80),
            "{table}"
        );
        assert!(
            table.contains("chatter") && table.contains("pll"),
            "{table}"
        );
        for column in ["force", "outside"] {
            assert_eq!(table.contains(column), small, "{column}: {table}");
        }
    }
}

#[test]
fn modulus_of_a_counter_of_32_bits_is_not_needed() {
    let folder = Folder::new(HOST_SIM);
    folder.write(
        "log.csv",
        "t,counts_large\n0,4294967295\n0.001,0\n0.002,1\n",
    );
    let line = folder.refused("replay log.csv --modulus 4294967296");
    let said = "for example 4096; a counter of 32 bits needs no modulus";
    assert!(line.contains(said), "{line}");
}
