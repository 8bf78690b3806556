//! The sectors of the settings: stores of the core become programmed bytes.

use rigless::emulator::{Hit, Host, Memory, Watch};
use rigless::session::Session;
use rigless::soc::Width;

use super::Lockstep;
use crate::board::ControllerBoard;
use crate::flash::{SECTOR, SECTOR_12, Sectors};

/// Control register of the flash interface.
pub(super) const CONTROL: u64 = 0x4002_3C10;
/// Bytes that a store of the core changes at most: it pushes or stores up to 16 registers.
const LONGEST_STORE: usize = 64;

/// Every store to the sectors.
pub(super) const STORES: Watch = Watch::Writes {
    address: SECTOR_12,
    length: 2 * SECTOR as u64,
};

impl Lockstep {
    /// A store to the sectors has landed as in RAM: gives it the effect that the flash interface has. A
    /// store that has to wait for the flash holds the core.
    pub(super) fn store_to_flash(
        &mut self,
        session: &mut Session<ControllerBoard>,
        host: &mut dyn Host,
        hit: &Hit,
    ) {
        let part = &mut session.board_mut().part;
        let offset = (hit.address - SECTOR_12) as usize;
        let before = &part.flash.sectors().bytes()[offset..];
        let landed: Vec<u8> = (hit.address..)
            .take(before.len().min(LONGEST_STORE))
            .map(|at| host.read(at, Width::W8).map_or(0, |byte| byte as u8))
            .collect();
        // Of a wider store, at least the bytes up to the last one that differs.
        let last = (1..landed.len()).rfind(|k| landed[*k] != before[*k]);
        let length = last.unwrap_or(0) + 1;
        let over_ns = part.store_to_flash(hit.at.0, offset as u32, &landed[..length]);
        place(part.flash.sectors(), offset..offset + length, host);
        if over_ns > hit.at.0 {
            host.hold(true);
            self.stalls.flash = Some(over_ns);
        }
    }

    /// Called after a write to the control register of the flash interface.
    pub(super) fn erase_flash(session: &mut Session<ControllerBoard>, host: &mut dyn Host) {
        let flash = &mut session.board_mut().part.flash;
        if let Some(change) = flash.take_erased() {
            place(flash.sectors(), change.range(), host);
        }
    }
}

/// Makes what the core reads that of the flash.
pub(super) fn place(sectors: &Sectors, range: std::ops::Range<usize>, memory: &mut dyn Memory) {
    for offset in range {
        let byte = sectors.bytes()[offset].into();
        // The sectors are memory that can be written.
        let _ = memory.write(SECTOR_12 + offset as u64, Width::W8, byte);
    }
}
