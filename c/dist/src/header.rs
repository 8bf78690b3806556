//! The C header `limpid.h`, made by cbindgen from the text that the library compiles.

use std::fmt::Write as _;

use cbindgen::{Builder, Config, DocumentationStyle, Language, Style};
use limpid::source;

/// First lines of the header: how to use it, and the guard against a second inclusion.
const INTRODUCTION: &str = include_str!("introduction.h");

/// Last lines of the header: what C alone can say.
const CONVENIENCES: &str = include_str!("conveniences.h");

/// The text of `limpid.h`.
///
/// # Errors
/// One line if cbindgen cannot read the sources.
pub fn header() -> Result<String, String> {
    let folder = tempfile::tempdir().map_err(|error| format!("no temporary folder: {error}"))?;
    let written = write_sources(folder.path()).and_then(|files| generate(&files));
    Ok(written?
        .replace("VERSION_OF_LIMPID", env!("CARGO_PKG_VERSION"))
        .replace("LIST_OF_ESTIMATORS", &list()))
}

/// The arguments of `LIMPID_ESTIMATORS`, one a line.
fn list() -> String {
    let mut lines = String::new();
    for name in source::NAMES {
        write!(lines, " \\\n    EACH({name})").expect("a string");
    }
    lines
}

fn write_sources(folder: &std::path::Path) -> Result<Vec<std::path::PathBuf>, String> {
    let problem = |error: std::io::Error| format!("{}: {error}", folder.display());
    std::fs::create_dir_all(folder).map_err(problem)?;
    let designs = format!("{}{}", source::DESIGN, source::DESIGNS);
    let texts = [
        ("sample.rs", source::SAMPLE),
        ("storage.rs", source::STORAGE),
        ("functions.rs", source::FUNCTIONS),
        ("designs.rs", &designs),
    ];
    texts
        .into_iter()
        .map(|(name, text)| {
            let file = folder.join(name);
            std::fs::write(&file, text).map_err(problem)?;
            Ok(file)
        })
        .collect()
}

fn generate(files: &[std::path::PathBuf]) -> Result<String, String> {
    let config = Config {
        language: Language::C,
        cpp_compat: true,
        style: Style::Type,
        documentation: true,
        documentation_style: DocumentationStyle::C,
        header: Some(INTRODUCTION.to_owned()),
        trailer: Some(CONVENIENCES.to_owned()),
        no_includes: true,
        sys_includes: vec!["stdint.h".to_owned()],
        line_length: 110,
        ..Config::default()
    };
    let builder = files
        .iter()
        .fold(Builder::new().with_config(config), |builder, file| {
            builder.with_src(file)
        });
    let mut text = Vec::new();
    builder
        .generate()
        .map_err(|error| format!("cbindgen: {error}"))?
        .write(&mut text);
    String::from_utf8(text).map_err(|error| error.to_string())
}
