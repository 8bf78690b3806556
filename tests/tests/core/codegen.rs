//! What the compiler makes of the estimators for the board: every call that is left, read from
//! the object code of the package `codegen-probe`.

use crate::image::{Image, build};

/// The probe and the core.
fn image() -> Image {
    let libraries = build("codegen-probe", "codegen-probe", &["--features", "planted"]);
    assert_eq!(libraries.len(), 2, "probe and core: {libraries:?}");
    Image::read(&libraries)
}

#[test]
fn estimators_call_nothing_on_the_board() {
    let image = image();
    let reached = |function| image.reached(&[image.function("codegen_probe", function)]);

    // The look finds every fault that is there.
    for (planted, expected) in [
        ("planted_index", "panic_bounds_check"),
        ("planted_slice", "slice"),
        ("planted_unwrap", "unwrap_failed"),
        ("planted_indirect", "panic_bounds_check"),
        ("planted_double", "__aeabi_d"),
        ("planted_wide_division", "__aeabi_ldivmod"),
    ] {
        let foreign = reached(planted).foreign();
        assert!(
            foreign.iter().any(|symbol| symbol.contains(expected)),
            "{planted}: found only {foreign:?}"
        );
    }

    // And none in the estimators.
    let estimators = [
        "skip",
        "finite_difference",
        "low_pass",
        "low_pass_foaw",
        "foaw_1",
        "foaw_15_end",
        "foaw_15_best",
        "foaw_16_end",
        "foaw_128_end",
        "foaw_128_best",
        "triple",
        "motor",
        "table_triple",
        "table_motor",
        "steady_triple",
        "steady_motor",
        "late_motor",
        "pll",
        "m_over_t",
        "observer",
        "observer_edge",
        "observer_soft",
        "adaptive_soft",
        "adaptive",
        "adaptive_edge",
        "observer_held",
        "observer_blind",
        "adaptive_edge_held",
        "handover",
    ];
    let mut functions: Vec<String> = Vec::new();
    for estimator in estimators {
        functions.extend([format!("start_{estimator}"), format!("update_{estimator}")]);
    }
    functions.extend(["update_foaw_tuned".into(), "update_triple_tuned".into()]);
    for function in &functions {
        let foreign = reached(function).foreign();
        assert!(foreign.is_empty(), "{function} refers to {foreign:?}");
    }

    // `Skip` is an empty function: a return, with the frame that this target keeps for every
    // function. The smallest function that reads something is larger.
    let size = |function: &str| image.data("codegen_probe", function).len();
    let empty = size("empty");
    assert!(
        0 < empty && empty <= 6,
        "an empty function of {empty} bytes"
    );
    for function in ["start_skip", "update_skip"] {
        assert_eq!(size(function), empty, "{function}");
    }
    assert!(size("planted_not_empty") > empty);
}
