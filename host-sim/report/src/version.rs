//! Source that this program was built from.

/// Version, commit, date of the commit, and `modified` if files differed from the commit; the commit
/// is `unknown` if the build found no repository.
pub const VERSION: &str = concat!(env!("CARGO_PKG_VERSION"), " (", env!("LIMPID_SOURCE"), ")");
