//! The memory as the core sees it.

use rigless::device::{ErasedDevice, ResetCause};
use rigless::mcu::Mcu;
use rigless::soc::stm32f427::{CPU, MEMORY};
use rigless::soc::{Bus, Error, Region};
use rigless::time::VirtualNanos;

use super::{ERASED, SECTOR, SECTOR_12};

/// Bytes of both sectors of the settings, and of a bank.
const SETTINGS: u64 = 2 * SECTOR as u64;
const BANK: u64 = 1 << 20;

/// The emulator's memory, in which the sectors of the settings are RAM: the emulator drops stores to
/// flash. The lockstep watches the stores to these sectors and gives them the effect that
/// [`FlashInterface`](super::FlashInterface) states.
static SPLIT: [Region; 7] = {
    let [flash, ccm, system, sram, backup] = MEMORY;
    [
        Region::flash(flash.name, flash.base, BANK).erased_to(ERASED),
        Region::ram("settings", SECTOR_12, SETTINGS).erased_to(ERASED),
        Region::flash(
            "behind settings",
            SECTOR_12 + SETTINGS,
            flash.size - BANK - SETTINGS,
        )
        .erased_to(ERASED),
        ccm,
        system,
        sram,
        backup,
    ]
};

/// A part without peripherals, of which the emulator takes the memory of the core.
#[derive(Debug)]
pub(crate) struct MemoryMap(Bus);

impl MemoryMap {
    /// # Errors
    /// The emulator's error on a memory that cannot be assembled.
    pub(crate) fn new() -> Result<Self, Error> {
        Bus::builder(CPU, &SPLIT, []).build().map(Self)
    }
}

impl Mcu for MemoryMap {
    fn bus(&self) -> &Bus {
        &self.0
    }

    fn bus_mut(&mut self) -> &mut Bus {
        &mut self.0
    }

    fn reset(&mut self, _: VirtualNanos, _: ResetCause) {}

    fn poll(&mut self, _: VirtualNanos) {}

    fn split(&mut self, _: usize) -> (&mut Bus, Option<&mut dyn ErasedDevice>) {
        (&mut self.0, None)
    }
}
