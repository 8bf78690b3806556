//! The bench image: built for the board, and where in it things are.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};
use std::process::Command;

use object::{Object, ObjectSection, ObjectSymbol, SymbolKind};

/// Optimisation level of an image.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Level {
    /// For speed, `opt-level = 3`.
    Speed,
    /// For size, `opt-level = "s"`.
    Size,
}

impl Level {
    /// Both.
    pub const ALL: [Self; 2] = [Self::Speed, Self::Size];

    /// As cargo calls it.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Speed => "3",
            Self::Size => "s",
        }
    }
}

/// A built image.
#[derive(Debug)]
pub struct Image {
    pub(crate) placed: rigless::image::Image,
    /// Functions by address: size and code.
    functions: BTreeMap<u64, Vec<u8>>,
    /// Function addresses by mangled name.
    names: BTreeMap<String, u64>,
    data: BTreeMap<String, u64>,
}

const TRIPLE: &str = "thumbv7em-none-eabihf";

impl Image {
    /// Builds the image in a target directory of its own, so that no other build waits for it.
    ///
    /// # Errors
    /// One line if cargo cannot build it.
    pub fn build(level: Level) -> Result<Self, String> {
        let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
        let target = root.join("target/bench-image").join(level.name());
        let optimise = match level {
            Level::Speed => "profile.release.opt-level=3",
            Level::Size => "profile.release.opt-level=\"s\"",
        };
        let cargo = std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into());
        let status = Command::new(cargo)
            .current_dir(&root)
            .args(["build", "--release", "--quiet", "--package", "bench-image"])
            .args([
                "--features",
                "image",
                "--target",
                TRIPLE,
                "--config",
                optimise,
            ])
            .args([
                "--config",
                "profile.release.codegen-units=1",
                "--target-dir",
            ])
            .arg(&target)
            .status()
            .map_err(|error| format!("cargo does not start: {error}"))?;
        if !status.success() {
            return Err("the bench image does not build".to_owned());
        }
        Self::read(&target.join(TRIPLE).join("release/bench-image"))
    }

    fn read(path: &PathBuf) -> Result<Self, String> {
        let problem = |error: &dyn std::fmt::Display| format!("{}: {error}", path.display());
        let elf = std::fs::read(path).map_err(|error| problem(&error))?;
        let file = object::File::parse(&*elf).map_err(|error| problem(&error))?;
        let (mut functions, mut names, mut data) =
            (BTreeMap::new(), BTreeMap::new(), BTreeMap::new());
        for symbol in file.symbols() {
            let name = symbol.name().map_err(|error| problem(&error))?.to_owned();
            if symbol.kind() == SymbolKind::Data {
                data.insert(name, symbol.address());
                continue;
            }
            let section = symbol
                .section_index()
                .and_then(|index| file.section_by_index(index).ok());
            let (SymbolKind::Text, Some(section)) = (symbol.kind(), section) else {
                continue;
            };
            let address = symbol.address() & !1;
            let code = section.data_range(address, symbol.size());
            if let Some(code) = code.map_err(|error| problem(&error))? {
                functions.insert(address, code.to_vec());
                names.insert(name, address);
            }
        }
        let placed =
            rigless::image::Image::new(path, elf.clone(), None).map_err(|error| problem(&error))?;
        Ok(Self {
            placed,
            functions,
            names,
            data,
        })
    }

    /// Address of the function of this path inside the bench crate.
    pub(crate) fn function(&self, path: &[&str]) -> Result<u64, String> {
        find(&self.names, path)
    }

    /// Address of the data of this path inside the bench crate.
    pub(crate) fn datum(&self, path: &[&str]) -> Result<u64, String> {
        find(&self.data, path)
    }

    /// Code of the function at `address`.
    pub(crate) fn code(&self, address: u64) -> &[u8] {
        self.functions.get(&address).map_or(&[], Vec::as_slice)
    }

    /// Mangled name of the function at `address`.
    pub(crate) fn name(&self, address: u64) -> &str {
        let mut named = self.names.iter().filter(|(_, at)| **at == address);
        named.next().map_or("code without a name", |(name, _)| name)
    }

    /// The function at `address` and all that it calls.
    pub(crate) fn reached(&self, address: u64) -> BTreeSet<u64> {
        let mut found = BTreeSet::new();
        let mut open = vec![address];
        while let Some(function) = open.pop() {
            if self.functions.contains_key(&function) && found.insert(function) {
                let code = self.code(function);
                open.extend(
                    crate::thumb::branches(function, code).filter(|target| {
                        !(function..function + code.len() as u64).contains(target)
                    }),
                );
            }
        }
        found
    }
}

fn find(names: &BTreeMap<String, u64>, path: &[&str]) -> Result<u64, String> {
    let parts: Vec<_> = path
        .iter()
        .map(|part| format!("{}{part}", part.len()))
        .collect();
    let mangled = parts.concat();
    let mut found = names.iter().filter(|(name, _)| name.contains(&mangled));
    match (found.next(), found.next()) {
        (Some((_, address)), None) => Ok(*address),
        (None, _) => Err(format!("no {} in the image", path.join("::"))),
        _ => Err(format!("more than one {} in the image", path.join("::"))),
    }
}
