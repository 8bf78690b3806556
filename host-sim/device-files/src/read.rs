//! Text of an input file.

use std::path::Path;

/// The text of a regular file.
///
/// # Errors
/// One line that names the path, if it is not a readable file of UTF-8 text.
pub fn text(path: &Path) -> Result<String, String> {
    let named = |what: &dyn std::fmt::Display| format!("{}: {what}", path.display());
    let metadata = std::fs::metadata(path).map_err(|error| named(&error))?;
    if !metadata.is_file() {
        return Err(named(&"not a regular file; give a TOML file"));
    }
    std::fs::read_to_string(path).map_err(|error| named(&format_args!("cannot read: {error}")))
}
