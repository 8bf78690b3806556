//! The flash that keeps the settings.

use core::ops::Range;

use drivers::{SETTINGS_BYTES, Saved, Settings, SettingsError, Store};
use embedded_storage::nor_flash::{ErrorType, NorFlash, ReadNorFlash};
use stm32f4xx_hal::flash::{FlashExt as _, UnlockedFlash};
use stm32f4xx_hal::pac::FLASH;

use crate::boards::Memory;

/// Sectors 12 and 13 of the flash, as offsets from its begin. They are in bank 2, and the image is in bank 1:
/// the core runs on while they are erased or programmed.
const SECTORS: [Range<u32>; 2] = [0x10_0000..0x10_4000, 0x10_4000..0x10_8000];

/// The settings in flash.
pub(super) struct Flash {
    flash: FLASH,
    /// `None` on a chip whose flash does not have the sectors.
    store: Option<Store<SETTINGS_BYTES>>,
}

impl Flash {
    /// Reads the settings; `None` if there are none that this image can read.
    pub(super) fn open(mut flash: FLASH) -> (Self, Option<Settings>) {
        let [_, last] = &SECTORS;
        let mut found = (None, None);
        if flash.len() < last.end as usize {
            defmt::warn!(
                "no settings: this chip has {=usize} bytes of flash",
                flash.len()
            );
        } else if let Ok((store, record)) = Store::open(&mut flash.unlocked(), SECTORS) {
            found = (Some(store), record.and_then(|record| decoded(&record)));
        }
        let (store, settings) = found;
        (Self { flash, store }, settings)
    }

    /// Makes place for settings. If a sector has to be erased, which takes up to 0.8 s once in some 60 times
    /// that settings are stored, `patient` runs this under a watchdog that waits for it.
    pub(super) fn prepare(&mut self, patient: impl FnOnce(&mut dyn FnMut())) {
        let Self {
            flash,
            store: Some(store),
        } = self
        else {
            return;
        };
        if store.is_prepared() {
            return;
        }
        patient(&mut || {
            if uncached(flash, &mut || (), |flash| store.prepare(flash)).is_err() {
                defmt::warn!("the flash of the settings cannot be erased");
            }
        });
    }
}

impl Memory for Flash {
    // In a frame of its own the copies of a record do not stay on the stack of the task of lowest priority.
    #[inline(never)]
    fn save(&mut self, settings: &Settings, between: &mut dyn FnMut()) -> Saved {
        match &mut self.store {
            Some(store) => uncached(&mut self.flash, between, |flash| {
                store.save(flash, &settings.encode()).into()
            }),
            None => Saved::Refused,
        }
    }
}

/// Changes the flash without the data cache, which would keep bytes of before. It may also hold wrong bytes
/// after a read from one bank while the other one is written (erratum 2.2.15 of ES0206). `between` is called
/// after each byte.
fn uncached<T>(
    flash: &mut FLASH,
    between: &mut dyn FnMut(),
    change: impl FnOnce(&mut ByteByByte<'_>) -> T,
) -> T {
    flash.acr().modify(|_, w| w.dcen().clear_bit());
    let result = change(&mut ByteByByte {
        flash: flash.unlocked(),
        between,
    });
    flash.acr().modify(|_, w| w.dcrst().set_bit());
    flash.acr().modify(|_, w| w.dcrst().clear_bit());
    flash.acr().modify(|_, w| w.dcen().set_bit());
    result
}

/// The flash, programmed a byte at a time. The HAL stores up to 16 bytes in a row, and a store while a byte is
/// being programmed holds the core on the bus, interrupts included, for 16 us and up to 100 us. Between single
/// bytes the core waits in a loop, which the control task interrupts.
struct ByteByByte<'a> {
    flash: UnlockedFlash<'a>,
    /// Called after each byte: the 256 bytes of a record take 4 ms, and up to 26 ms.
    between: &'a mut dyn FnMut(),
}

impl<'a> ErrorType for ByteByByte<'a> {
    type Error = <UnlockedFlash<'a> as ErrorType>::Error;
}

impl ReadNorFlash for ByteByByte<'_> {
    const READ_SIZE: usize = 1;

    fn read(&mut self, offset: u32, bytes: &mut [u8]) -> Result<(), Self::Error> {
        self.flash.read(offset, bytes)
    }

    fn capacity(&self) -> usize {
        self.flash.capacity()
    }
}

impl NorFlash for ByteByByte<'_> {
    const WRITE_SIZE: usize = 1;
    const ERASE_SIZE: usize = <UnlockedFlash<'_> as NorFlash>::ERASE_SIZE;

    fn erase(&mut self, from: u32, to: u32) -> Result<(), Self::Error> {
        NorFlash::erase(&mut self.flash, from, to)
    }

    fn write(&mut self, offset: u32, bytes: &[u8]) -> Result<(), Self::Error> {
        (offset..).zip(bytes).try_for_each(|(at, byte)| {
            let written = self.flash.write(at, &[*byte]);
            (self.between)();
            written
        })
    }
}

fn decoded(record: &[u8; SETTINGS_BYTES]) -> Option<Settings> {
    match Settings::decode(record) {
        Ok(settings) => return Some(settings),
        Err(SettingsError::Version(version)) => {
            defmt::warn!("settings not used: they are of version {=u16}", version);
        }
        Err(SettingsError::Value(setting)) => {
            defmt::warn!(
                "settings not used: number {=u8} is out of its range",
                setting.number()
            );
        }
    }
    None
}
