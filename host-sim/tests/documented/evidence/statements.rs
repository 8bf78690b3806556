//! What the pages say beyond the figures of their tables.

use measured::Table;
use measured::tables::{
    EVIDENCE_DVRK, EVIDENCE_MOTEUS, EVIDENCE_ODRIVE, EVIDENCE_OPENFFBOARD, EVIDENCE_SIMPLEFOC,
    EVIDENCE_VESC,
};

use super::PROJECTS;

/// A figure of the row with this name and rate at a resolution, from the file of the table.
fn figure(table: &Table, name: &str, counts_per_rev: u32, rate_khz: &str, column: &str) -> f64 {
    let rows = table.read().unwrap_or_else(|error| panic!("{error}"));
    let row = rows.iter().find(|row| {
        row.text("estimator") == Ok(name)
            && row.text("counts_per_rev") == Ok(&counts_per_rev.to_string())
            && row.text("rate_khz") == Ok(rate_khz)
    });
    let row = row.unwrap_or_else(|| panic!("{}: no {name} at {rate_khz} kHz", table.name));
    row.number(column).unwrap_or_else(|error| panic!("{error}"))
}

#[test]
fn statements_of_the_pages_hold() {
    for project in &PROJECTS {
        let table = &project.table;
        for &counts in project.counts_per_rev {
            let imm = |column| figure(table, "imm", counts, "1", column);
            let rows = table.read().unwrap_or_else(|error| panic!("{error}"));
            let theirs = rows.iter().filter(|row| {
                let name = row.text("estimator").expect("a name");
                name.starts_with("peer:") && row.text("counts_per_rev") == Ok(&counts.to_string())
            });
            let mut seen = 0;
            for row in theirs {
                let number = |column| row.number(column).expect(column);
                // The bank has the smallest error, and every comparator is cheaper.
                assert!(number("rms_pct") > 1.15 * imm("rms_pct"), "{row:?}");
                assert!(number("p99_pct") > 1.15 * imm("p99_pct"), "{row:?}");
                assert!(
                    number("instructions") < 0.2 * imm("instructions"),
                    "{row:?}"
                );
                assert!(number("state") < 0.5 * imm("state"), "{row:?}");
                seen += 1;
            }
            assert!(seen >= 2, "{}", table.name);
        }
    }
    // Defaults of projects beside the shipped loop and triple integrator of this project.
    for (table, name, khz) in [
        (&EVIDENCE_MOTEUS, "peer:moteus", "30"),
        (&EVIDENCE_ODRIVE, "peer:odrive", "8"),
        (&EVIDENCE_VESC, "peer:vesc-fast", "12.5"),
        (&EVIDENCE_OPENFFBOARD, "peer:openffboard", "1"),
        (&EVIDENCE_DVRK, "peer:dvrk-predicted", "32"),
    ] {
        let theirs = figure(table, name, 4096, khz, "rms_pct");
        for ours in ["pll", "kalman-triple-steady"] {
            let ours = figure(table, ours, 4096, "1", "rms_pct");
            assert!(ours > 1.5 * theirs, "{name}: {theirs} {ours}");
        }
    }
    let moteus = |name, counts, khz, column| figure(&EVIDENCE_MOTEUS, name, counts, khz, column);
    let p99 = moteus("imm", 16_384, "30", "p99_pct");
    assert!(p99 > 1.1 * moteus("peer:moteus", 16_384, "30", "p99_pct"));
    assert!(p99 > 1.5 * moteus("imm", 16_384, "1", "p99_pct"));
    let rms = |name, counts| moteus(name, counts, "30", "rms_pct");
    assert!(rms("peer:moteus", 16_384) > 1.1 * rms("imm", 16_384));
    assert!(rms("peer:moteus", 16_384) < 0.9 * rms("peer:moteus-tuned", 16_384));
    assert!((2.5..2.75).contains(&(rms("peer:moteus", 4096) / rms("imm", 4096))));
    let board = |name, counts| figure(&EVIDENCE_OPENFFBOARD, name, counts, "1", "rms_pct");
    assert!(board("peer:openffboard", 4096) < 0.9 * board("peer:openffboard-tuned", 4096));
    assert!(board("peer:openffboard", 10_000) > 1.05 * board("peer:openffboard-tuned", 10_000));
    for counts in [4096, 10_000] {
        let ratio = board("peer:openffboard-tuned", counts) / board("pll-tuned", counts);
        assert!((ratio - 1.0).abs() < 0.05, "{ratio}");
    }
    let delay = |name, counts, khz| figure(&EVIDENCE_ODRIVE, name, counts, khz, "delay_ms");
    let default = [4096, 8192].map(|counts| delay("peer:odrive", counts, "8"));
    assert!(default[0] < 0.8 * delay("imm", 4096, "1"));
    assert!((default[1] / delay("imm", 8192, "1") - 1.0).abs() < 0.15);
    assert!(delay("imm", 4096, "8") < 0.95 * default[0]);
    assert!(delay("imm", 8192, "8") < 0.6 * default[1]);
    let odrive = |name, khz, column| figure(&EVIDENCE_ODRIVE, name, 4096, khz, column);
    let tuned = odrive("peer:odrive-tuned", "8", "rms_pct");
    assert!(tuned < 0.9 * odrive("pll-tuned", "8", "rms_pct"));
    let vesc = |name, khz, column| figure(&EVIDENCE_VESC, name, 4096, khz, column);
    let tuned = vesc("peer:vesc-pll-tuned", "12.5", "rms_pct");
    assert!(vesc("peer:vesc-pll", "12.5", "rms_pct") > 3.0 * tuned);
    assert!(vesc("pll-tuned", "12.5", "rms_pct") > 1.1 * tuned);
    assert_eq!(vesc("peer:vesc-pll", "12.5", "moving_at_rest_pct"), 0.0);
    let simplefoc = |name, column| figure(&EVIDENCE_SIMPLEFOC, name, 4096, "1", column);
    assert!(simplefoc("peer:simplefoc-sensor", "moving_at_rest_pct") > 1.0);
    assert_eq!(
        simplefoc("peer:simplefoc-encoder", "moving_at_rest_pct"),
        0.0
    );
    let least = simplefoc("peer:simplefoc-encoder-tuned", "rms_pct");
    assert!(simplefoc("m-over-t", "rms_pct") < 0.7 * least);
    let dvrk = |name, khz, column| figure(&EVIDENCE_DVRK, name, 4096, khz, column);
    let predicted = dvrk("peer:dvrk-predicted", "32", "rms_pct");
    assert!(predicted < 0.6 * dvrk("peer:dvrk-measured", "32", "rms_pct"));
    assert!(predicted > 1.1 * dvrk("m-over-t", "1", "rms_pct"));
    assert!(dvrk("peer:dvrk-predicted", "32", "delay_ms") < dvrk("m-over-t", "1", "delay_ms"));
    assert_eq!(dvrk("peer:dvrk-predicted", "32", "moving_at_rest_pct"), 0.0);
}
