//! Object code of the board: the symbols that a function refers to directly or indirectly, as a
//! linker that drops unreferenced symbols follows them.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};
use std::process::Command;

use object::read::archive::ArchiveFile;
use object::{Object, ObjectSection, ObjectSymbol, RelocationTarget, SectionKind, SymbolIndex};

const TARGET: &str = "thumbv7em-none-eabihf";

/// What our code may call outside of itself: copies and clears, and the conversion of 64 bits
/// to f32 (integers only; best-fit sums do not fit 32 bits).
fn is_allowed(symbol: &str) -> bool {
    let routine = symbol.strip_prefix("__aeabi_").unwrap_or(symbol);
    let memory = ["memcpy", "memmove", "memset", "memclr"];
    memory.iter().any(|name| {
        let rest = routine.strip_prefix(name);
        rest.is_some_and(|rest| matches!(rest, "" | "4" | "8"))
    }) || symbol == "__aeabi_l2f"
}

/// A function or data: every one has a section of its own, so that a section's relocations are
/// its own.
struct Section {
    names: Vec<String>,
    data: Vec<u8>,
    /// Also of data that is cleared at the start, which has no bytes here.
    size: u64,
    refers_to: BTreeSet<Reference>,
}

#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum Reference {
    /// In the same object: a section by its number in the image.
    Here(usize),
    /// In some other object, by symbol.
    Elsewhere(String),
}

/// All code and data of some libraries.
#[derive(Default)]
pub(crate) struct Image {
    sections: Vec<Section>,
    /// Section that defines a symbol.
    defined: BTreeMap<String, usize>,
}

/// Symbols reached from a set of functions.
pub(crate) struct Reached<'a> {
    image: &'a Image,
    sections: BTreeSet<usize>,
    /// Symbols that the image does not define.
    undefined: BTreeSet<&'a str>,
}

impl Image {
    pub(crate) fn read(libraries: &[PathBuf]) -> Self {
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
        // Exception tables do not run: they are of another kind.
        let mut numbers = BTreeMap::new();
        for section in file.sections().filter(|section| is_loaded(section.kind())) {
            numbers.insert(section.index().0, self.sections.len());
            self.sections.push(Section {
                names: Vec::new(),
                data: section.data().unwrap_or_default().to_vec(),
                size: section.size(),
                refers_to: BTreeSet::new(),
            });
        }
        let number = |symbol: &object::Symbol| Some(*numbers.get(&symbol.section_index()?.0)?);
        for symbol in file.symbols().filter(ObjectSymbol::is_global) {
            if let Some(number) = number(&symbol) {
                let name = symbol.name().expect("a name");
                self.sections[number].names.push(name.to_owned());
                // A weak symbol may be there again.
                self.defined.entry(name.to_owned()).or_insert(number);
            }
        }
        let reference = |index: SymbolIndex| {
            let symbol = file.symbol_by_index(index).expect("a symbol");
            match number(&symbol) {
                Some(number) => Reference::Here(number),
                None => Reference::Elsewhere(symbol.name().expect("a name").to_owned()),
            }
        };
        for section in file.sections() {
            let Some(&number) = numbers.get(&section.index().0) else {
                continue;
            };
            for (_, relocation) in section.relocations() {
                if let RelocationTarget::Symbol(index) = relocation.target() {
                    self.sections[number].refers_to.insert(reference(index));
                }
            }
        }
    }

    /// The section of this crate's function or static of this name.
    fn section(&self, krate: &str, name: &str) -> (&str, &Section) {
        let mut found = self
            .defined
            .iter()
            .filter(|(symbol, _)| is_named(symbol, krate, name));
        let (symbol, &number) = found
            .next()
            .unwrap_or_else(|| panic!("nothing named {name} in {krate}"));
        assert!(found.next().is_none(), "several named {name} in {krate}");
        (symbol, &self.sections[number])
    }

    /// The symbol of this crate's function of this name.
    pub(crate) fn function(&self, krate: &str, name: &str) -> &str {
        self.section(krate, name).0
    }

    /// The bytes of the function or static with this symbol.
    pub(crate) fn data(&self, symbol: &str) -> &[u8] {
        &self.sections[self.defined[symbol]].data
    }

    /// Everything that is reached from these functions, directly or not.
    pub(crate) fn reached(&self, functions: &[&str]) -> Reached<'_> {
        let mut reached = Reached {
            image: self,
            sections: BTreeSet::new(),
            undefined: BTreeSet::new(),
        };
        let mut open: Vec<usize> = functions.iter().map(|name| self.defined[*name]).collect();
        while let Some(number) = open.pop() {
            if !reached.sections.insert(number) {
                continue;
            }
            for reference in &self.sections[number].refers_to {
                match reference {
                    Reference::Here(number) => open.push(*number),
                    Reference::Elsewhere(symbol) => match self.defined.get(symbol) {
                        Some(&number) => open.push(number),
                        None => _ = reached.undefined.insert(symbol),
                    },
                }
            }
        }
        reached
    }
}

impl<'a> Reached<'a> {
    fn sections(&self) -> impl Iterator<Item = &'a Section> {
        self.sections
            .iter()
            .map(|&number| &self.image.sections[number])
    }

    /// Bytes of code and data.
    pub(crate) fn size(&self) -> u64 {
        self.sections().map(|section| section.size).sum()
    }

    /// Undefined symbols that are not allowed.
    pub(crate) fn foreign(&self) -> BTreeSet<&'a str> {
        let mut foreign = self.undefined.clone();
        foreign.retain(|symbol| !is_allowed(symbol));
        foreign
    }

    /// The symbols among what is reached.
    pub(crate) fn symbols(&self) -> impl Iterator<Item = &'a str> {
        self.sections()
            .flat_map(|section| section.names.iter().map(String::as_str))
    }
}

/// Whether a section is part of what the board is given.
fn is_loaded(kind: SectionKind) -> bool {
    matches!(
        kind,
        SectionKind::Text
            | SectionKind::Data
            | SectionKind::ReadOnlyData
            | SectionKind::ReadOnlyDataWithRel
            | SectionKind::ReadOnlyString
            | SectionKind::UninitializedData
    )
}

/// Whether a symbol is that of a plain function or static of this crate: `module::name`, or `name`
/// in whatever module. After the kinds of its parts and the crate's hash come the names, each behind
/// its length.
fn is_named(symbol: &str, krate: &str, name: &str) -> bool {
    let within_crate = || {
        let path = symbol.strip_prefix("_RNv")?.trim_start_matches("Nt");
        let (_hash, path) = path.strip_prefix("Cs")?.split_once('_')?;
        path.strip_prefix(&format!("{}{krate}", krate.len()))
    };
    let parts = name.split("::").map(|part| format!("{}{part}", part.len()));
    within_crate().is_some_and(|path| path.ends_with(&parts.collect::<String>()))
}

/// Builds for the board with further arguments, in a directory of its own below `target`: cargo
/// holds the lock of the usual one while it runs tests. Returns the libraries.
pub(crate) fn build(package: &str, directory: &str, arguments: &[&str]) -> Vec<PathBuf> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"))
        .parent()
        .expect("workspace");
    let cargo = std::env::var_os("CARGO").unwrap_or_else(|| env!("CARGO").into());
    let output = Command::new(cargo)
        .current_dir(root)
        .args(["build", "--release", "--package", package])
        .args([
            "--target",
            TARGET,
            "--message-format",
            "json-render-diagnostics",
        ])
        .args(["--target-dir", &format!("target/{directory}")])
        // Objects, whatever the firmware's profile says.
        .args(["--config", "profile.release.lto=\"off\""])
        .args(arguments)
        .env_remove("RUSTFLAGS")
        .env_remove("CARGO_ENCODED_RUSTFLAGS")
        .output()
        .expect("cargo runs");
    let errors = String::from_utf8_lossy(&output.stderr);
    let messages = String::from_utf8_lossy(&output.stdout);
    assert!(
        !errors.contains("can't find crate for `core`"),
        "the target is missing: run `rustup target add {TARGET}`"
    );
    assert!(
        output.status.success(),
        "{package} does not build:\n{errors}"
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
    libraries
}
