//! Branch hints for the compiler.

/// Marks the enclosing branch as cold, so that the hot path has no taken branches.
#[cold]
pub(crate) const fn unlikely() {}
