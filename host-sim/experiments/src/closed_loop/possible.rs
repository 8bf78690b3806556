//! Estimators that a closed loop can have.

use catalogue::estimators::Kind;

/// Checks that no estimator of a closed loop needs edge time stamps.
///
/// # Errors
/// One line that names the first one that does.
pub fn check_stamps<'a>(mut kinds: impl Iterator<Item = &'a Kind>) -> Result<(), String> {
    match kinds.find(|kind| kind.needs.edge) {
        None => Ok(()),
        Some(kind) => Err(format!(
            "{}: needs edge time stamps, which the closed loop does not have; choose another estimator",
            kind.name
        )),
    }
}

/// Checks that `kind`, which `option` names, can estimate the velocity of the handle.
///
/// # Errors
/// One line that names the option.
pub fn check_handle(option: &str, kind: &Kind) -> Result<(), String> {
    if kind.needs.current {
        return Err(format!(
            "{option} {}: it models the large motor, not the handle; choose one without current",
            kind.name
        ));
    }
    check_stamps(std::iter::once(kind))
}
