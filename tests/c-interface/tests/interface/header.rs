//! The committed header is the one of this library.

use std::path::Path;

#[test]
fn the_header_is_that_of_the_library() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../c/include/limpid.h");
    let header = limpid_dist::header().expect("cbindgen reads the library");
    if std::env::var_os("UPDATE_GOLDEN").is_some() {
        std::fs::write(&path, &header).expect("the header is writable");
    }
    let committed = std::fs::read_to_string(&path).expect("the header");
    assert!(
        committed == header,
        "c/include/limpid.h is old: cargo c-library header c/include/limpid.h writes it"
    );
}
