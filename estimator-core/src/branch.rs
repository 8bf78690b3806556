//! What the compiler should know of a branch.

/// Says that the branch it stands in is rare, or not one of the longest update: the others are then
/// laid out without jumps.
#[cold]
pub(crate) const fn unlikely() {}
