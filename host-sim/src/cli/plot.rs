//! `host-sim plot`.
use super::arguments::Plot;
use crate::failure::Failure;
pub(super) fn run(_: &Plot) -> Result<(), Failure> {
    Ok(())
}
