//! Errors of the velocity, on simulated and on real motion.

use measured::tables::{
    EVIDENCE_DVRK, EVIDENCE_MOTEUS, EVIDENCE_ODRIVE, EVIDENCE_OPENFFBOARD, EVIDENCE_SIMPLEFOC,
    EVIDENCE_VESC, REAL_MOTION, REAL_RESOLUTION, REFERENCE, SCENARIOS_1000HZ, WRONG_CONSTANTS,
    Z_WIDTH_SEEDS,
};
use measured::{Row, Table, digits};

use crate::{between, name, number, of, range, rows, says, span, tenths, whole};

const BENCHMARKS: &str = "docs/benchmarks.md";

#[test]
fn distances_of_estimators_from_counts_are_those_of_the_statements() {
    let rows = rows(&SCENARIOS_1000HZ);
    let all = |names: &[&str]| between(range(&rows, "all", 2, |row| names.contains(&name(row))));
    let banks = all(&["imm", "imm-edge", "imm-pair"]);
    let others = all(&[
        "observer-edge-blind",
        "low-pass",
        "pll",
        "tracking-differentiator",
    ]);
    says(
        BENCHMARKS,
        &[
            format!("the banks have {banks} % of it"),
            format!("`pll` and `tracking-differentiator` {others} %"),
        ],
    );
    let [texture, stochastic] = ["texture", "stochastic"].map(|scenario| {
        let rows = &rows;
        move |wanted: &str| digits::rounded(of(rows, wanted, scenario), 3)
    });
    let short = |text: String| whole([text.parse::<f64>().unwrap()])[0].clone();
    let [pll, imm, edge] =
        ["pll", "imm", "imm-edge"].map(|it| [texture(it), stochastic(it)].map(short));
    says(
        "docs/choosing.md",
        &[
            format!(
                "`pll` has {} % of the finite difference's distance and `imm` {} %, in stochastic {} and {} %",
                pll[0], imm[0], pll[1], imm[1]
            ),
            format!("`imm-edge` has {} and {} %", edge[0], edge[1]),
        ],
    );
    says(
        "docs/theory/imm.md",
        &[
            format!(
                "is {} % of that of finite difference, in stochastic {} %; `imm` has {} and {} %",
                edge[0], edge[1], imm[0], imm[1]
            ),
            format!("to {} % of that of finite difference", imm[0]),
        ],
    );
}

#[test]
fn errors_with_wrong_constants_are_those_of_the_statements() {
    let rows = rows(&WRONG_CONSTANTS);
    let [right, worst, disc, disc_worst] =
        ["right_pct", "worst_pct", "disc_right_pct", "disc_worst_pct"].map(|column| {
            let rows = &rows;
            // The file has two digits behind the point: a last five is rounded up.
            move |wanted: &str| digits::rounded(of(rows, wanted, column) + 1e-9, 2)
        });
    let edge = "adaptive-edge";
    says(
        BENCHMARKS,
        &[
            format!(
                "| counts only, all eight, right | 10 | {} |",
                right("adaptive")
            ),
            format!(
                "| 9 | {}, `adaptive-soft` {} |",
                worst("adaptive"),
                worst("adaptive-soft")
            ),
            format!(
                "| time stamps, any single wrong constant, moving | 5.5 | {} |",
                worst(edge)
            ),
            format!(
                "| 5.5 | {}, with the worst constants {} |",
                disc(edge),
                disc_worst(edge)
            ),
            format!("% instead of {} %, but", right("observer")),
            format!(
                "% instead of {} % with the worst constants",
                worst("observer")
            ),
        ],
    );
    says(
        "docs/theory/adaptive-observer.md",
        &[format!(
            "| {} % of finite difference at worst, moving, 1 kHz; `adaptive-soft` {} %, `adaptive-edge` {} %",
            worst("adaptive"),
            worst("adaptive-soft"),
            worst(edge)
        )],
    );
    says(
        "docs/theory/observer.md",
        &[format!(
            "has {} % of the error of the finite difference at 1 kHz, with right constants {} %",
            worst("observer"),
            right("observer")
        )],
    );
    says(
        "docs/choosing.md",
        &[format!(
            "it has less error, {} and {} % of the finite difference",
            worst("adaptive-held"),
            worst("imm-motor")
        )],
    );
}

#[test]
fn observer_that_does_not_learn_has_the_error_of_the_statement() {
    let rows = rows(&REAL_MOTION);
    let row = rows
        .iter()
        .find(|row| name(row) == "observer-held")
        .unwrap();
    let recordings = row.names().skip(REAL_MOTION.columns.len());
    let errors = span(recordings.filter_map(|column| number(row, column)));
    let times = errors.map(|error| digits::rounded(error / 100.0, 2));
    let said = format!(
        "it has {} times the error of the finite difference",
        between(times)
    );
    says("docs/choosing.md", &[said]);
}

/// Banks beside the best other estimator, by counts per revolution.
#[test]
fn banks_are_not_the_best_where_the_statements_say() {
    let rows = rows(&REAL_RESOLUTION);
    let mut largest = 0.0_f64;
    let mut time_stamps = Vec::new();
    for row in &rows {
        let counts = row.text("counts_per_rev").unwrap();
        for bank in ["imm", "imm_edge"] {
            let ratio = row.number(&format!("{bank}_ratio")).unwrap();
            largest = largest.max(ratio);
            let on = row.text(&format!("{bank}_on")).unwrap();
            let (recording, other) = on.split_once(", ").unwrap();
            if ratio <= 1.0 {
                continue;
            }
            let learns = other.starts_with("adaptive") && ["64", "256"].contains(&counts);
            let stamps = other.starts_with("m-over-t") && bank == "imm_edge" && counts != "256";
            assert!(learns || stamps, "{counts}, {bank}: {on}");
            if recording == "tue-own-ctrl-pop2" && stamps {
                time_stamps.push(counts);
            }
        }
    }
    let (last, first) = time_stamps.split_last().unwrap();
    says(
        "docs/theory/imm.md",
        &[
            format!("it has up to {largest:.2} times the error of the best one"),
            format!(
                "M/T is also better than `imm-edge` at {} and {last} counts per revolution",
                first.join(", ")
            ),
        ],
    );
}

#[test]
fn choice_by_the_reference_is_as_good_as_the_statement_says() {
    let rows = rows(&REFERENCE);
    let resolved = rows.iter().filter(|row| row.text("resolved") == Ok("yes"));
    let ratios =
        resolved.map(|row| row.number("chosen_pct").unwrap() / row.number("best_pct").unwrap());
    let [_, most] = span(ratios);
    says(
        "docs/your-log.md",
        &[format!(
            "has up to {most:.2} times the error of the best (the spindle in the table)"
        )],
    );
    let is_worst =
        |row: &&Row| row.number("chosen_pct").unwrap() / row.number("best_pct").unwrap() >= most;
    let worst = rows.iter().find(is_worst).unwrap();
    assert!(worst.text("recording").unwrap().contains("spindle"));
}

#[test]
fn stiffest_walls_by_seed_are_those_of_the_statements() {
    let rows = rows(&Z_WIDTH_SEEDS);
    let best = |wanted: &str| -> Vec<f64> {
        let column = |seed| format!("best_nm_per_rad_seed_{seed}");
        (1..=6)
            .map(|seed| of(&rows, wanted, &column(seed)))
            .collect()
    };
    let estimators = ["foaw-end-fit", "kalman-motor", "imm-pair", "adaptive"];
    let factors = estimators.map(|wanted| {
        let [least, most] = span(best(wanted));
        most / least
    });
    let [exact, foaw] = ["exact velocity", "foaw-end-fit"].map(best);
    let ratios = span(exact.iter().zip(&foaw).map(|(exact, foaw)| exact / foaw));
    let [exact, foaw] =
        ["exact velocity", "foaw-end-fit"].map(|it| of(&rows, it, "mean_nm_per_rad"));
    says(
        "docs/theory/z-width.md",
        &[
            format!(
                "differs by a factor of {} between six of them",
                between(tenths(span(factors)))
            ),
            format!(
                "on each of the six: {} times, {:.1} times in the mean",
                between(tenths(ratios)),
                exact / foaw
            ),
            format!("{:.1} times FOAW's mean of {foaw:.1}", 6.9 / foaw),
        ],
    );
    // The goal of 6.3 N·m/rad: the true velocity exceeds it on each seed, no estimator does in the mean.
    assert!(of(&rows, "exact velocity", "least_nm_per_rad") > 6.3);
    for wanted in estimators {
        assert!(of(&rows, wanted, "mean_nm_per_rad") < 6.3, "{wanted}");
    }
}

#[test]
fn bank_has_less_error_than_every_comparator() {
    for table in [
        EVIDENCE_MOTEUS,
        EVIDENCE_ODRIVE,
        EVIDENCE_VESC,
        EVIDENCE_SIMPLEFOC,
        EVIDENCE_OPENFFBOARD,
        EVIDENCE_DVRK,
    ] {
        let rows = rows(&table);
        for peer in rows.iter().filter(|row| name(row).starts_with("peer:")) {
            let counts = peer.text("counts_per_rev");
            let is = |row: &&Row| {
                name(row) == "imm"
                    && row.text("rate_khz") == Ok("1")
                    && row.text("counts_per_rev") == counts
            };
            let bank = rows.iter().find(is).expect("a row");
            for column in ["rms_pct", "p99_pct"] {
                let [ours, theirs] = [bank, peer].map(|row| row.number(column).unwrap());
                assert!(ours < theirs, "{}: {column}, {}", table.name, name(peer));
            }
        }
    }
}

/// RMS error of a row on a page for maintainers, % of finite difference.
fn rms(table: &Table, wanted: &str, counts: &str, khz: &str) -> f64 {
    let rows = rows(table);
    let is = |row: &&Row| {
        name(row) == wanted
            && row.text("counts_per_rev") == Ok(counts)
            && row.text("rate_khz") == Ok(khz)
    };
    let row = rows.iter().find(is);
    let row = row.unwrap_or_else(|| panic!("{}: no {wanted}", table.name));
    row.number("rms_pct").unwrap()
}

#[test]
fn comparators_compare_as_their_pages_say() {
    let moteus = |wanted, counts| rms(&EVIDENCE_MOTEUS, wanted, counts, "30");
    let times = moteus("peer:moteus", "4096") / moteus("imm", "4096");
    let said = format!("the default has {times:.1} times the RMS error of `imm` at 30 kHz");
    says("docs/evidence/moteus.md", &[said]);
    assert!(moteus("peer:moteus", "16384") < moteus("peer:moteus-tuned", "16384"));
    assert!(moteus("peer:moteus", "16384") > moteus("imm", "16384"));
    for counts in ["4096", "8192"] {
        let odrive = |wanted| rms(&EVIDENCE_ODRIVE, wanted, counts, "8");
        assert!(odrive("peer:odrive-tuned") < odrive("pll-tuned"));
        let vesc = |wanted| rms(&EVIDENCE_VESC, wanted, counts, "12.5");
        assert!(vesc("peer:vesc-pll") > 3.0 * vesc("peer:vesc-pll-tuned"));
        assert!(vesc("peer:vesc-pll-tuned") < vesc("pll-tuned"));
    }
    let simplefoc = |wanted| rms(&EVIDENCE_SIMPLEFOC, wanted, "4096", "1");
    assert!(simplefoc("m-over-t") < 0.7 * simplefoc("peer:simplefoc-encoder-tuned"));
    let wheel = |wanted, counts| rms(&EVIDENCE_OPENFFBOARD, wanted, counts, "1");
    assert!(wheel("peer:openffboard", "4096") < wheel("peer:openffboard-tuned", "4096"));
    assert!(wheel("peer:openffboard", "10000") > wheel("peer:openffboard-tuned", "10000"));
    let dvrk = |wanted| rms(&EVIDENCE_DVRK, wanted, "4096", "32");
    let part = dvrk("peer:dvrk-predicted") / dvrk("peer:dvrk-measured");
    assert!((0.45..0.55).contains(&part), "half are {part}");
}
