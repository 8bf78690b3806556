//! The part of a presets file that tuning keeps.

use std::path::Path;

use device_files::presets::Presets;
use toml_edit::DocumentMut;

/// The section `[image]` of the presets file at `path`, with its comments: tuning replaces the other
/// sections of a file, but the values for the control loop of a flash image were chosen by hand. The
/// text is empty if there is no regular file, or no such section in it.
///
/// # Errors
/// One line, if a file at `path` is no presets file, so that its `[image]` cannot be told.
pub fn image_section(path: &Path) -> Result<String, String> {
    // A device or a pipe keeps nothing.
    if !path.is_file() {
        return Ok(String::new());
    }
    let kept = || {
        let text = device_files::text(path)?;
        let name = path.display().to_string();
        if Presets::parse(&text, &name)?.image.is_empty() {
            return Ok(String::new());
        }
        let mut document: DocumentMut = text
            .parse()
            .map_err(|error: toml_edit::TomlError| format!("{name}: {}", error.message()))?;
        document.remove("preset");
        document.set_trailing("");
        Ok(document.to_string().trim_start().to_owned())
    };
    kept().map_err(|error: String| {
        format!("{error} (tuning would keep the section [image] of this file: correct or remove the file)")
    })
}
