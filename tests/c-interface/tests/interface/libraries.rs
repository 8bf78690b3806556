//! The library for processors without this machine's operating system: what its functions call.

use std::collections::BTreeSet;

use limpid_dist::{BOARDS, Build, build};
use object::read::archive::ArchiveFile;
use object::{Object, ObjectSymbol};

/// Whether the compiler's own routines have this: copies and clears, conversions of 64 bits and, without
/// an FPU or a divider, the arithmetic of f32 and of integers.
fn is_allowed(symbol: &str, fpu: bool) -> bool {
    let routine = symbol.strip_prefix("__aeabi_").unwrap_or(symbol);
    let memory = ["memcpy", "memmove", "memset", "memclr"];
    if memory
        .iter()
        .any(|name| routine.trim_end_matches(['4', '8']) == *name)
    {
        return true;
    }
    let conversions = ["l2f", "__floatdisf"];
    let software = [
        "fadd",
        "fsub",
        "fmul",
        "fdiv",
        "i2f",
        "ui2f",
        "f2iz",
        "f2uiz",
        "uidiv",
        "idivmod",
        "lmul",
        "__clzsi2",
        "__addsf3",
        "__subsf3",
        "__mulsf3",
        "__divsf3",
        "__floatsisf",
        "__floatunsisf",
        "__fixsfsi",
        "__fixunssfsi",
        "__unordsf2",
    ];
    let comparisons = [
        "fcmp", "__eqsf2", "__nesf2", "__ltsf2", "__lesf2", "__gtsf2", "__gesf2",
    ];
    conversions.contains(&routine)
        || !fpu
            && (software.contains(&routine)
                || comparisons.iter().any(|name| routine.starts_with(name)))
}

/// Names that the library's own object defines and names that it takes from elsewhere.
fn symbols(one: &Build) -> [BTreeSet<String>; 2] {
    let bytes = std::fs::read(build(one).expect("the library")).expect("just built");
    let archive = ArchiveFile::parse(&*bytes).expect("an archive");
    let mut found = [BTreeSet::new(), BTreeSet::new()];
    for member in archive.members() {
        let member = member.expect("a member");
        // One object has all that is optimised together.
        if !member.name().starts_with(b"limpid-") {
            continue;
        }
        let object =
            object::File::parse(member.data(&*bytes).expect("its bytes")).expect("an object");
        for symbol in object.symbols() {
            let name = symbol.name().expect("UTF-8").to_owned();
            found[usize::from(symbol.is_undefined())].insert(name);
        }
    }
    found
}

#[test]
fn functions_call_no_panic_and_no_mathematical_library() {
    for one in &BOARDS {
        let (triple, fpu) = (one.folder, one.folder == "cortex-m4f");
        let [defined, elsewhere] = symbols(one);
        for name in limpid::source::NAMES {
            for what in ["start", "update"] {
                let function = format!("limpid_{name}_{what}");
                assert!(defined.contains(&function), "{triple}: no {function}");
            }
        }
        let foreign: Vec<_> = elsewhere
            .iter()
            .filter(|name| !name.is_empty() && !is_allowed(name, fpu))
            .collect();
        assert!(foreign.is_empty(), "{triple}: calls {foreign:?}");
        // A panic's functions would be in this object or outside of it.
        let panics: Vec<_> = defined
            .iter()
            .filter(|name| name.contains("panic") || name.contains("unwrap_failed"))
            .collect();
        assert!(panics.is_empty(), "{triple}: has {panics:?}");
        let designs = defined.iter().any(|name| name.ends_with("_design"));
        assert!(!designs, "{triple}: designs are for computers");
    }
}
