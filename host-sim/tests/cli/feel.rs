//! `feel` as somebody types it.

use crate::{Folder, HOST_SIM, json};

#[test]
fn cause_without_which_no_device_is_left_is_left_out_with_a_note() {
    let folder = Folder::new(HOST_SIM);
    folder.write("d.toml", "[hand]\ndamping_nms_per_rad = 0.005\n");
    let run = "feel --scene wall --estimator pll --seconds 0.4 --device d.toml";
    let (rows, notes) = folder.ends(0, &format!("{run} --json -"));
    assert_eq!(notes.lines().count(), 1, "{notes}");
    let said = "cannot be simulated without \"9/10 of the handle's inertia\", ";
    assert!(notes.contains(said), "{notes}");
    assert!(
        notes.contains(": small.inertia_kg_m2 = 5e-7: too small"),
        "{notes}"
    );
    let rows = json(&rows);
    let without: Vec<_> = rows
        .iter()
        .filter(|row| !row["without"].is_null())
        .collect();
    assert_eq!(without.len(), 1 + 10);
    for row in without {
        let name = row["without"].as_str().unwrap();
        let is_left_out = name.contains("inertia") || name == "all of them";
        assert_eq!(row["parasitic_mn_rms"].is_null(), is_left_out, "{row}");
        assert_eq!(
            notes.contains(&format!("\"{name}\"")),
            is_left_out,
            "{name}"
        );
    }
    let table = folder.good(&format!("{run} --out page"));
    let row = |name: &str| {
        table
            .lines()
            .find(|line| line.trim_start().starts_with(name))
    };
    assert!(row("all of them").unwrap().contains(" -"), "{table}");
    assert!(
        folder
            .text("page/index.html")
            .contains("cannot be simulated without")
    );
    // The causes alone need no other device.
    let (_, notes) = folder.ends(0, &format!("{run} --causes-only --json -"));
    assert_eq!(notes, "");
}

#[test]
fn device_without_a_hand_is_refused() {
    let folder = Folder::new(HOST_SIM);
    let text = "[hand]\nstiffness_nm_per_rad = 0\ndamping_nms_per_rad = 0\n";
    folder.write("gone.toml", text);
    for command in [
        "feel --causes-only --scene wall --estimator pll --seconds 1 --json -",
        "compare --closed-loop --scene wall --estimator pll --seconds 1 --json -",
        "zwidth --estimator pll --rate 1000 --json -",
    ] {
        let error = folder.refused(&format!("{command} --device gone.toml"));
        let said = "hand.stiffness_nm_per_rad and hand.damping_nms_per_rad are both 0";
        assert!(error.contains(said), "{error}");
    }
}

/// The first 0.1 s are not scored, and a spectrum takes 0.25 s.
#[test]
fn run_that_is_too_short_for_a_spectrum_says_how_long_is_needed() {
    let folder = Folder::new(HOST_SIM);
    let run = "feel --causes-only --scene wall --estimator pll --rate 1000";
    let said = "the columns from 50 to 500 Hz need --seconds 0.35 or more";
    let (table, notes) = folder.ends(0, &format!("{run} --seconds 0.34 --out page"));
    assert!(table.contains(" -") && notes.contains(said), "{notes}");
    assert!(folder.text("page/index.html").contains(said));
    let (_, notes) = folder.ends(0, &format!("{run} --seconds 0.35 --json -"));
    assert_eq!(notes, "");
}
