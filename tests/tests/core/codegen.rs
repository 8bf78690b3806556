//! What the compiler makes of the estimators for the board: every call that is left, read from
//! the object code of the package `codegen-probe`.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};
use std::process::Command;

use object::read::archive::ArchiveFile;
use object::{Object, ObjectSection, ObjectSymbol, RelocationTarget, SymbolKind};

const TARGET: &str = "thumbv7em-none-eabihf";

/// What an estimator may call outside of itself: copies and clears, and the conversion of 64 bits
/// to f32 (integers only; best-fit sums do not fit 32 bits).
fn is_allowed(symbol: &str) -> bool {
    let routine = symbol.strip_prefix("__aeabi_").unwrap_or(symbol);
    let memory = ["memcpy", "memmove", "memset", "memclr"];
    memory.iter().any(|name| {
        let rest = routine.strip_prefix(name);
        rest.is_some_and(|rest| matches!(rest, "" | "4" | "8"))
    }) || symbol == "__aeabi_l2f"
}

/// A function, or data that one refers to.
#[derive(Default)]
struct Item {
    size: u64,
    refers_to: BTreeSet<String>,
}

/// All there is in the libraries, by symbol.
#[derive(Default)]
struct Image {
    items: BTreeMap<String, Item>,
}

impl Image {
    fn read(libraries: &[PathBuf]) -> Self {
        let mut image = Self::default();
        for library in libraries {
            let bytes = std::fs::read(library).expect("library just built");
            let archive = ArchiveFile::parse(&*bytes).expect("an archive");
            for member in archive.members() {
                let member = member.expect("a whole archive");
                if member.name().ends_with(b".o") {
                    let data = member.data(&*bytes).expect("a whole archive");
                    image.read_object(data);
                }
            }
        }
        image
    }

    fn read_object(&mut self, data: &[u8]) {
        let file = object::File::parse(data).expect("an object file");
        // Every function has its own section, so that a section's relocations are its function's.
        let mut named: BTreeMap<usize, Vec<String>> = BTreeMap::new();
        for symbol in file.symbols() {
            let defines = matches!(symbol.kind(), SymbolKind::Text | SymbolKind::Data);
            if let (Some(section), true) = (symbol.section_index(), defines) {
                let name = symbol.name().expect("a name").to_owned();
                let item = self.items.entry(name.clone()).or_default();
                item.size = symbol.size();
                named.entry(section.0).or_default().push(name);
            }
        }
        for section in file.sections() {
            let Some(owners) = named.get(&section.index().0) else {
                continue;
            };
            for (_, relocation) in section.relocations() {
                let RelocationTarget::Symbol(index) = relocation.target() else {
                    continue;
                };
                let symbol = file.symbol_by_index(index).expect("a symbol");
                let mut targets = vec![symbol.name().expect("a name").to_owned()];
                if symbol.kind() == SymbolKind::Section {
                    let inside = symbol
                        .section_index()
                        .and_then(|section| named.get(&section.0));
                    targets = inside.cloned().unwrap_or_default();
                }
                for owner in owners {
                    let item = self.items.get_mut(owner).expect("just entered");
                    item.refers_to.extend(targets.iter().cloned());
                }
            }
        }
    }

    /// The symbol of the probe's function of this name.
    fn function(&self, name: &str) -> &str {
        let mangled = format!("{}{name}", name.len());
        let mut found = self.items.keys().filter(|symbol| {
            symbol.split_once(&mangled).is_some_and(|(before, after)| {
                before.contains("codegen_probe")
                    && !before.ends_with(|c: char| c.is_ascii_digit())
                    && (after.is_empty() || after.starts_with("17h") || after.starts_with('.'))
            })
        });
        let symbol = found
            .next()
            .unwrap_or_else(|| panic!("no function {name} in the probe"));
        assert!(found.next().is_none(), "several functions {name}");
        symbol
    }

    /// What is reached from a function, directly or not, that is neither here nor allowed.
    fn foreign<'a>(&'a self, symbol: &'a str) -> BTreeSet<&'a str> {
        let mut foreign = BTreeSet::new();
        let mut seen = BTreeSet::from([symbol]);
        let mut open = vec![symbol];
        while let Some(symbol) = open.pop() {
            match self.items.get(symbol) {
                Some(item) => {
                    let new = item.refers_to.iter().map(String::as_str);
                    open.extend(new.filter(|symbol| seen.insert(symbol)));
                }
                // Exception tables do not run.
                None if symbol.starts_with("__aeabi_unwind_cpp_pr") => {}
                None if is_allowed(symbol) => {}
                None => {
                    foreign.insert(symbol);
                }
            }
        }
        foreign
    }
}

/// Builds the probe for the board and returns the libraries that make it up.
fn build() -> Vec<PathBuf> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"))
        .parent()
        .expect("workspace");
    let cargo = std::env::var_os("CARGO").unwrap_or_else(|| env!("CARGO").into());
    let output = Command::new(cargo)
        .current_dir(root)
        .args(["rustc", "--release", "--package", "codegen-probe", "--lib"])
        .args(["--features", "planted", "--target", TARGET])
        // A directory of its own: cargo holds the lock of the usual one while it runs tests.
        .args([
            "--target-dir",
            "target/codegen-probe",
            "--message-format",
            "json",
        ])
        .env_remove("RUSTFLAGS")
        .env_remove("CARGO_ENCODED_RUSTFLAGS")
        .output()
        .expect("cargo runs");
    let errors = String::from_utf8_lossy(&output.stderr);
    let messages = String::from_utf8_lossy(&output.stdout);
    assert!(
        !messages.contains("can't find crate for `core`"),
        "the target is missing: run `rustup target add {TARGET}`"
    );
    assert!(
        output.status.success(),
        "the probe does not build:\n{errors}{messages}"
    );
    let mut libraries = Vec::new();
    for line in messages.lines() {
        let message: serde_json::Value = serde_json::from_str(line).expect("JSON");
        let files = message["filenames"].as_array().into_iter().flatten();
        let files = files.filter_map(|file| file.as_str());
        libraries.extend(
            files
                .filter(|file| file.ends_with(".rlib"))
                .map(PathBuf::from),
        );
    }
    assert_eq!(libraries.len(), 2, "probe and core: {libraries:?}");
    libraries
}

#[test]
fn estimators_call_nothing_on_the_board() {
    let image = Image::read(&build());

    // The look finds every fault that is there.
    for (planted, expected) in [
        ("planted_index", "panic_bounds_check"),
        ("planted_slice", "slice"),
        ("planted_unwrap", "unwrap_failed"),
        ("planted_indirect", "panic_bounds_check"),
        ("planted_double", "__aeabi_d"),
        ("planted_wide_division", "__aeabi_ldivmod"),
    ] {
        let foreign = image.foreign(image.function(planted));
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
        "steady_triple",
        "steady_motor",
        "late_motor",
        "pll",
    ];
    let mut functions: Vec<String> = Vec::new();
    for estimator in estimators {
        functions.extend([format!("start_{estimator}"), format!("update_{estimator}")]);
    }
    functions.extend(["update_foaw_tuned".into(), "update_triple_tuned".into()]);
    for function in &functions {
        let foreign = image.foreign(image.function(function));
        assert!(foreign.is_empty(), "{function} refers to {foreign:?}");
    }

    // `Skip` is an empty function: a return, with the frame that this target keeps for every
    // function. The smallest function that reads something is larger.
    let size = |function: &str| image.items[image.function(function)].size;
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
