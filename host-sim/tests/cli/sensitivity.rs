//! `sensitivity` as somebody types it, and the notes below tables of percentages.

use crate::{Folder, HOST_SIM, json};

#[test]
fn seed_that_is_given_twice_runs_once() {
    let folder = Folder::new(HOST_SIM);
    let run = "sensitivity --scenario step --seconds 0.5 --estimator low-pass --json -";
    let twice = folder.good(&format!("{run} --seed 1 --seed 1"));
    assert_eq!(twice, folder.good(&format!("{run} --seed 1")));
}

#[test]
fn percentage_without_a_reference_has_a_note() {
    let folder = Folder::new(HOST_SIM);
    // A hand so soft, and friction so large, that no count changes.
    folder.write("soft.toml", "[hand]\nstiffness_nm_per_rad = 0.1667\n");
    folder.write("rests.toml", "[large]\ncoulomb_nm = 0.04\n");
    let run = "sensitivity --scenario hold --scenario step --seconds 0.5 --estimator low-pass";
    let table = folder.good(&format!("{run} --device soft.toml --out page"));
    let note = "Finite difference has no error in hold: not in the means of percentages.";
    let line = table.lines().find(|line| line.contains("low-pass"));
    let second = line.unwrap().split_whitespace().nth(1);
    assert!(second.unwrap().parse::<f64>().is_ok(), "{table}");
    assert!(table.contains(note), "{table}");
    assert!(folder.text("page/index.html").contains(note));
    let run = "limit --scenario step --estimator pll --seconds 1 --particles 50";
    let table = folder.good(&format!("{run} --device rests.toml"));
    assert!(
        table.contains("\n-: finite difference or the limit has no error in step."),
        "{table}"
    );
    for table in [
        table,
        folder.good(&format!("{run} --device rests.toml --json -")),
    ] {
        assert!(!table.contains("NaN") && !table.contains("inf"), "{table}");
    }
    let rows = json(&folder.good(&format!("{run} --device rests.toml --json -")));
    assert!(rows.iter().all(|row| row["rms_pct"].is_null()));
}

#[test]
fn limit_with_too_few_particles_has_a_note() {
    let folder = Folder::new(HOST_SIM);
    let run =
        "limit --scenario stochastic --estimator observer-edge --seconds 1 --json - --particles";
    let (_, errors) = folder.ends(0, &format!("{run} 20"));
    for said in [
        "limit-edge has fewer than 10 of its particles near the encoder's count in ",
        "observer-edge is at 0.",
        "of the limit, so that the limit is wrong: 20 particles are too few; give more with --particles",
    ] {
        assert!(errors.contains(said), "{errors}");
    }
    assert_eq!(folder.ends(0, &format!("{run} 2000")).1, "");
}
