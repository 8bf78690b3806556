//! Which source this program was built from.

/// Version, commit, the commit's date, and `modified` where files differed from the commit; the
/// commit is `unknown` where the build found no repository.
pub const VERSION: &str = concat!(env!("CARGO_PKG_VERSION"), " (", env!("LIMPID_SOURCE"), ")");
