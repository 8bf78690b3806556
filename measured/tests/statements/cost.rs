//! Instructions and control rates.

use measured::tables::{C_COST, CONTROL, ESTIMATORS, EVIDENCE_COST, PARETO};
use measured::{Row, digits};

use crate::{between, name, number, of, rows, says, span, whole};

const CHOOSING: &str = "docs/choosing.md";

#[test]
fn banks_cost_what_the_statements_say() {
    let rows = rows(&PARETO);
    let mean = |wanted: &str| of(&rows, wanted, "mean_3");
    let share = mean("imm-pair") / mean("imm");
    assert!((0.7..0.8).contains(&share), "three quarters are {share}");
    says(
        CHOOSING,
        &["with three quarters of its instructions [`imm-pair`]".into()],
    );
    let member = 10.0 * (mean("imm") / 30.0).round();
    let said = format!("some {member} instructions a member and tick");
    says("docs/theory.md", std::slice::from_ref(&said));
    says(
        "docs/theory/imm.md",
        &["three quarters of the cost".into(), said],
    );
    // Rows of windows have their length in the name, and those of other libraries are of no estimator.
    let estimators = crate::rows(&ESTIMATORS);
    let is_filter = |row: &Row| {
        let is = |kind: &&Row| name(kind) == name(row) && kind.text("reads") == Ok("counts");
        estimators.iter().any(|kind| is(&kind)) && !name(row).starts_with("imm")
    };
    let filters = rows.iter().filter(|row| is_filter(row));
    let filters = between(whole(span(filters.filter_map(|row| number(row, "mean_3")))));
    says(
        CHOOSING,
        &[format!("the filters without a window {filters};")],
    );
}

#[test]
fn control_rates_are_those_of_the_statements() {
    let rows = rows(&PARETO);
    let rates = |is_one: &dyn Fn(&str) -> bool| {
        let found = rows.iter().filter(|row| is_one(name(row)));
        between(whole(span(found.filter_map(|row| number(row, "rate_khz")))))
    };
    let with_current =
        |name: &str| name.starts_with("imm-motor") || name.starts_with("imm-adaptive");
    let others = [
        "imm",
        "imm-edge",
        "imm-pair",
        "foaw-end-fit, n = 64",
        "algebraic, n = 64",
    ];
    let [fit] = whole([of(&rows, "foaw-best-fit, n = 64", "rate_khz")]);
    let said = [
        format!(
            "the banks that read the current exceed it first (from {} kHz on)",
            rates(&with_current)
        ),
        format!("the best fit over 64 intervals ({fit} kHz)"),
        format!(
            "whose cost grows with their length ({} kHz)",
            rates(&|name| others.contains(&name))
        ),
        format!(
            "The adaptive observers reach {} kHz",
            rates(&|name| name.starts_with("adaptive"))
        ),
        format!(
            "observers {} kHz",
            rates(&|name| name.starts_with("observer"))
        ),
    ];
    says(CHOOSING, &said);
    for row in rows
        .iter()
        .filter(|row| number(row, "rate_khz") < Some(10.0))
    {
        assert!(name(row).starts_with("robust-exact"), "{}", name(row));
    }
    // "For the two adaptive observers the figure is right within a tenth."
    for wanted in ["adaptive", "adaptive-edge"] {
        let control = crate::rows(&CONTROL);
        let images = control.iter().filter(|row| name(row) == wanted);
        let [measured, _] = span(images.filter_map(|row| number(row, "khz_cycles_most")));
        let ratio = of(&rows, wanted, "rate_khz") / measured;
        assert!((0.9..1.1).contains(&ratio), "{wanted}: {ratio}");
    }
}

#[test]
fn full_covariance_and_table_of_gains_cost_what_the_statements_say() {
    let rows = rows(&PARETO);
    let mean = |wanted: &str| of(&rows, wanted, "mean_3");
    for model in ["kalman-triple", "kalman-motor"] {
        let ratio = mean(model) / mean(&format!("{model}-steady"));
        assert!((1.9..=2.5).contains(&ratio), "{model}: {ratio}");
    }
    let [fifteen, sixty_four] = ["15", "64"].map(|n| {
        mean(&format!("foaw-best-fit, n = {n}")) / mean(&format!("foaw-end-fit, n = {n}"))
    });
    assert!((1.7..2.3).contains(&fifteen), "{fifteen}");
    assert!((3.7..4.3).contains(&sixty_four), "{sixty_four}");
}

#[test]
fn errors_beside_the_run_time_are_those_of_the_statements() {
    let rows = rows(&PARETO);
    let [slow, fast] = ["rms_1khz_rad_s", "rms_10khz_rad_s"].map(|column| {
        let rows = &rows;
        move |wanted: &str| format!("{:.3}", of(rows, wanted, column))
    });
    let [soft, adaptive_soft] = ["observer-soft", "adaptive-soft"].map(&slow);
    let [plain, adaptive] = ["observer", "adaptive"].map(&slow);
    let [fast_soft, fast_adaptive_soft] = ["observer-soft", "adaptive-soft"].map(&fast);
    let [fast_plain, fast_adaptive] = ["observer", "adaptive"].map(&fast);
    says(
        CHOOSING,
        &[
            format!(
                "({soft} and {adaptive_soft} rad/s; `observer` {plain}, `adaptive` {adaptive})"
            ),
            format!(
                "({fast_plain} and {fast_adaptive} rad/s; {fast_soft} and {fast_adaptive_soft})"
            ),
        ],
    );
    says(
        "docs/theory/truncated-gaussian.md",
        &[
            format!(
                "The errors are {soft} and {adaptive_soft} rad/s; `observer` has {plain} and `adaptive` {adaptive}."
            ),
            format!(
                "less, {fast_plain} and {fast_adaptive} rad/s instead of {fast_soft} and {fast_adaptive_soft}"
            ),
        ],
    );
    let [edge, adaptive_edge] = ["observer-edge", "adaptive-edge"].map(&slow);
    says(
        "docs/theory/edge-time-stamps.md",
        &[format!(
            "falls from {plain} to {edge} rad/s for `observer` and from {adaptive} to {adaptive_edge} rad/s"
        )],
    );
    let [slow, fast] = ["rms_1khz_rad_s", "rms_10khz_rad_s"]
        .map(|column| 100.0 * of(&rows, "observer", column) / of(&rows, "imm", column));
    let [slow, fast] = whole([slow, fast]);
    says(
        "docs/theory/imm.md",
        &[format!(
            "`observer` then has {slow} % of the RMS error of `imm` in simulation at 1 kHz, and {fast} % at 10 kHz"
        )],
    );
    // "Of the estimators without the current, only the banks have less RMS error than the finite difference."
    let difference = of(&rows, "finite-difference", "rms_1khz_rad_s");
    for row in &rows {
        let reads_current = [
            "kalman-motor",
            "linear-eso",
            "imm-motor",
            "imm-adaptive",
            "observer",
            "adaptive",
        ];
        let reads_current = name(row) != "observer-edge-blind"
            && reads_current
                .iter()
                .any(|family| name(row).starts_with(family));
        let is_less = number(row, "rms_1khz_rad_s") < Some(difference);
        assert!(
            !is_less || reads_current || name(row).starts_with("imm"),
            "{}",
            name(row)
        );
    }
}

/// More instructions in C than in Rust, at rest and in motion.
fn more(row: &Row) -> [f64; 2] {
    ["at_rest", "texture"].map(|trace| {
        let [c, rust] =
            ["c", "rust"].map(|language| row.number(&format!("{trace}_{language}")).unwrap());
        c - rust
    })
}

#[test]
fn source_costs_what_the_statement_says() {
    let rows = rows(&C_COST);
    let ratio = |row: &Row| {
        let [source, library] =
            ["source", "c"].map(|of| row.number(&format!("texture_{of}")).unwrap());
        source / library
    };
    let mut ratios: Vec<_> = rows.iter().map(|row| (ratio(row), name(row))).collect();
    ratios.sort_by(|a, b| a.0.total_cmp(&b.0));
    let (median, (most, of)) = (ratios[ratios.len() / 2].0, ratios[ratios.len() - 1]);
    let said = format!(
        "it takes {:.0} % more instructions than the library in the median, and at most {most:.1} times as many (`{of}`)",
        100.0 * (median - 1.0)
    );
    says("docs/c.md", &[said]);
}

#[test]
fn c_costs_what_the_statements_say() {
    let rows = rows(&C_COST);
    let [least, most] = [|it: [f64; 2]| it[0], |it: [f64; 2]| it[1]].map(|end| {
        let rows = &rows;
        move |is_one: &dyn Fn(&str) -> bool| {
            let found = rows.iter().filter(|row| is_one(name(row)));
            end(span(found.flat_map(more)))
        }
    });
    let at_most = |family: &str| most(&|name: &str| name.starts_with(family));
    let is_bank = |name: &str| {
        name.starts_with("imm")
            && !["imm_adaptive", "imm_adaptive_edge", "imm_motor_edge"].contains(&name)
    };
    let is_fewer =
        |name: &str| is_bank(name) || ["tracking_differentiator", "m_over_t"].contains(&name);
    let is_observer = |name: &str| name.starts_with("observer") || name.starts_with("adaptive");
    let said = [
        format!(
            "FOAW, {} more in motion for the end-fit, {} beyond 16 intervals, and up to {} for the best-fit",
            at_most("foaw_end_fit_15"),
            at_most("foaw_end_fit_64"),
            at_most("foaw_best_fit")
        ),
        format!(
            "`savitzky_golay`, {} more, `algebraic`, {} more",
            at_most("savitzky_golay"),
            at_most("algebraic")
        ),
        format!("observers, up to {} more", most(&is_observer)),
        format!(
            "`imm_adaptive_edge`, up to {} more, and `imm_motor_edge`, up to {}:",
            at_most("imm_adaptive_edge"),
            at_most("imm_motor_edge")
        ),
        format!(
            "and the other banks, up to {} fewer in C, `imm_adaptive` up to {} fewer.",
            -least(&is_fewer),
            -least(&|name| name == "imm_adaptive")
        ),
    ];
    says("docs/c.md", &said);
    let named = [
        "foaw",
        "savitzky",
        "algebraic",
        "robust",
        "imm",
        "tracking",
        "m_over_t",
    ];
    let is_other = |name: &str| {
        let is_named = named.iter().any(|family| name.starts_with(family));
        name == "m_over_t_learned" || !is_named && !is_observer(name)
    };
    assert!(most(&is_other) <= 6.0 && least(&is_other) >= -6.0);
}

#[test]
fn banks_cost_more_than_comparators() {
    let [ours, theirs] = [rows(&PARETO), rows(&EVIDENCE_COST)];
    for (column, times) in [("mean_3", 5.0), ("state", 2.0)] {
        let [_, most] = span(theirs.iter().filter_map(|row| number(row, column)));
        let ratio = of(&ours, "imm", column) / most;
        assert!(ratio > times, "{column}: {}", digits::rounded(ratio, 3));
    }
}
