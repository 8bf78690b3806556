//! The bench image: build for the board, and addresses of its functions and data.

use std::collections::BTreeMap;
use std::path::Path;
use std::process::Command;

use bench_image::{SUBJECTS, Subject};
use object::{Object, ObjectSymbol, SymbolKind};
use virtual_board::code::Code;

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

    /// Name in cargo's settings.
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
    pub(crate) level: Level,
    pub(crate) placed: rigless::image::Image,
    pub(crate) code: Code,
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
        Self::read(level, &target.join(TRIPLE).join("release/bench-image"))
    }

    /// Reads an image for the same board.
    ///
    /// # Errors
    /// One line on a file that is no such image.
    pub fn read(level: Level, path: &Path) -> Result<Self, String> {
        let problem = |error: &dyn std::fmt::Display| format!("{}: {error}", path.display());
        let elf = std::fs::read(path).map_err(|error| problem(&error))?;
        let file = object::File::parse(&*elf).map_err(|error| problem(&error))?;
        let (mut names, mut data) = (BTreeMap::new(), BTreeMap::new());
        for symbol in file.symbols() {
            let name = symbol.name().map_err(|error| problem(&error))?.to_owned();
            match symbol.kind() {
                SymbolKind::Data => data.insert(name, symbol.address()),
                SymbolKind::Text => names.insert(name, symbol.address() & !1),
                _ => None,
            };
        }
        let code = Code::of(&file).map_err(|error| problem(&error))?;
        let placed =
            rigless::image::Image::new(path, elf.clone(), None).map_err(|error| problem(&error))?;
        Ok(Self {
            level,
            placed,
            code,
            names,
            data,
        })
    }

    /// Address of a subject's `update`. Where parameters are part of a state, those of two rates
    /// are the same code, and the compiler keeps one.
    pub(crate) fn update(&self, subject: &Subject) -> Result<u64, String> {
        let of = |subject: &Subject| self.function(&subject_path(subject, "update"));
        let same = |other: &&Subject| (other.name, other.window) == (subject.name, subject.window);
        let twins = SUBJECTS.iter().filter(same);
        of(subject).or_else(|missing| twins.filter_map(|twin| of(twin).ok()).next().ok_or(missing))
    }

    /// Address of the function of this path inside the bench crate.
    pub(crate) fn function(&self, path: &[&str]) -> Result<u64, String> {
        find(&self.names, path)
    }

    /// Address of the data of this path inside the bench crate.
    pub(crate) fn datum(&self, path: &[&str]) -> Result<u64, String> {
        find(&self.data, path)
    }

    /// Address of the function or the data of this name in C.
    pub(crate) fn symbol(&self, name: &str) -> Result<u64, String> {
        let found = self.names.get(name).or_else(|| self.data.get(name));
        found
            .copied()
            .ok_or_else(|| format!("no {name} in the image"))
    }

    /// Mangled name of the function at `address`.
    pub(crate) fn name(&self, address: u64) -> &str {
        let mut named = self.names.iter().filter(|(_, at)| **at == address);
        named.next().map_or("code without a name", |(name, _)| name)
    }
}

/// Path of a function of a subject's module inside the bench crate.
pub(crate) fn subject_path(subject: &Subject, function: &'static str) -> Vec<&'static str> {
    let modules = ["bench_image", "estimators"].into_iter();
    modules
        .chain(subject.path.iter().copied())
        .chain([function])
        .collect()
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
