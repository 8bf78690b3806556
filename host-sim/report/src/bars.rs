//! Sizes of figures with a bar for each name, px.

/// Height of a bar.
pub(super) const BAR: f64 = 6.5;
/// Distance of the bars of one row from those of the next row.
pub(super) const BETWEEN: f64 = 12.0;
/// Distance of two panels.
pub(super) const GAP: f64 = 44.0;
