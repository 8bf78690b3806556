//! Object code of the estimators for the board: every remaining call, read from
//! the object code of the package `codegen-probe`.

use estimator_catalogue::ROWS;

use crate::image::{Image, build};

/// The probe and the core.
fn image() -> Image {
    let libraries = build("codegen-probe", "codegen-probe", &["--features", "planted"]);
    assert!(libraries.len() >= 2, "probe and core: {libraries:?}");
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

    // And none in the estimators: the rows of the catalogue, and what no row has.
    let mut functions: Vec<String> = Vec::new();
    for row in ROWS {
        assert!(!row.variants.is_empty(), "{}: no variant", row.name);
        for variant in row.variants {
            let module = format!("rows::{}::{}", row.id, variant.id);
            functions.extend([format!("{module}::start"), format!("{module}::update")]);
        }
    }
    for more in [
        "low_pass_foaw",
        "foaw_1",
        "foaw_16_end",
        "foaw_128_end",
        "foaw_128_best",
        "table_motor",
        "late_motor",
        "adaptive_edge_held",
        "handover",
    ] {
        functions.extend([format!("start_{more}"), format!("update_{more}")]);
    }
    functions.extend(["update_foaw_tuned".into(), "update_triple_tuned".into()]);
    for function in &functions {
        let foreign = reached(function).foreign();
        assert!(foreign.is_empty(), "{function} refers to {foreign:?}");
    }
}
