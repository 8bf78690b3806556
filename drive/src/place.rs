//! The place of an output file, before a run that takes its time.

use std::path::Path;

use terminal::failure::Failure;

/// Checks that a file has a place, so that a run does not find out at its end.
///
/// # Errors
/// [`Failure::Input`] if the name is that of a folder, or lies in something that is none.
pub fn check(file: &Path) -> Result<(), Failure> {
    let name = file.display();
    if file.is_dir() {
        return Err(Failure::Input(format!(
            "{name}: is a folder; choose the name of a file"
        )));
    }
    let above = file.ancestors().skip(1).find(|path| path.exists());
    match above {
        Some(path) if !path.is_dir() => Err(Failure::Input(format!(
            "{name}: {} is no folder; choose another path",
            path.display()
        ))),
        _ => Ok(()),
    }
}
