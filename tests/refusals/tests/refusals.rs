//! Designs that the compiler refuses; each `.stderr` shows the words it does so with.

#[test]
fn bad_designs_do_not_compile() {
    let cases = trybuild::TestCases::new();
    // One case that builds makes the rest be built, not only checked: a window that no ring can
    // have shows only then.
    cases.pass("tests/cases/good.rs");
    cases.compile_fail("tests/cases/refuses_*.rs");
}
