//! What a device that runs is shown by: the channels of a row, rows of a recording, and rows as MCAP.

mod export;
mod list;
mod recorded;

pub use export::{McapWriter, mcap};
pub use list::{CHANNELS, Channel, Values};
pub use recorded::rows;
