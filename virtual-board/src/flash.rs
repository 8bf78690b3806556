//! What the flash of the board holds beside the firmware.

use std::ops::Range;
use std::path::Path;

use drivers::{SETTINGS_BYTES, SaveError, Settings, Store};
use embedded_storage::nor_flash::{
    ErrorType, NorFlash, NorFlashErrorKind, ReadNorFlash, check_erase, check_read, check_write,
};
use rigless::image::Image;

/// Address of sector 12, the first one of bank 2.
const SECTOR_12: u64 = 0x0810_0000;
/// Sectors 12 and 13, from the begin of the first one.
const SECTORS: [Range<u32>; 2] = [0..SECTOR, SECTOR..2 * SECTOR];
const SECTOR: u32 = 16 * 1024;

/// Address of the size of the flash, which the factory has programmed, KiB.
const SIZE_WORD: u64 = 0x1FFF_7A22;
/// Size of the flash of an STM32F429ZI, KiB.
const SIZE_KIB: u16 = 2048;

/// An image of the word with the flash's size.
///
/// # Errors
/// One line if the emulator does not take it.
pub(crate) fn size() -> Result<Image, String> {
    raw(SIZE_KIB.to_le_bytes().to_vec(), SIZE_WORD)
}

fn raw(bytes: Vec<u8>, address: u64) -> Result<Image, String> {
    Image::new(Path::new("factory.bin"), bytes, Some(address))
        .map_err(|error| format!("flash at {address:#x}: {error}"))
}

/// An image of the flash behind the firmware, in which these settings are the newest, after so many
/// records of older ones.
///
/// # Errors
/// One line if they do not fit.
pub(crate) fn with(settings: &Settings, older: u32) -> Result<Image, String> {
    let mut flash = Sectors(vec![0xFF; 2 * SECTOR as usize]);
    let full = |error| format!("settings in flash: {error:?}");
    let opened = Store::<SETTINGS_BYTES>::open(&mut flash, SECTORS);
    let (mut store, _) = opened.map_err(SaveError::Flash).map_err(full)?;
    for _ in 0..older {
        let record = Settings::DEFAULT.encode();
        store.save(&mut flash, &record).map_err(full)?;
    }
    store.save(&mut flash, &settings.encode()).map_err(full)?;
    raw(flash.0, SECTOR_12)
}

/// The two sectors.
struct Sectors(Vec<u8>);

impl Sectors {
    fn range(&mut self, offset: u32, length: usize) -> &mut [u8] {
        let start = offset as usize;
        &mut self.0[start..start + length]
    }
}

impl ErrorType for Sectors {
    type Error = NorFlashErrorKind;
}

impl ReadNorFlash for Sectors {
    const READ_SIZE: usize = 1;

    fn read(&mut self, offset: u32, bytes: &mut [u8]) -> Result<(), NorFlashErrorKind> {
        check_read(self, offset, bytes.len())?;
        bytes.copy_from_slice(self.range(offset, bytes.len()));
        Ok(())
    }

    fn capacity(&self) -> usize {
        self.0.len()
    }
}

impl NorFlash for Sectors {
    const WRITE_SIZE: usize = 1;
    const ERASE_SIZE: usize = SECTOR as usize;

    fn erase(&mut self, from: u32, to: u32) -> Result<(), NorFlashErrorKind> {
        check_erase(self, from, to)?;
        self.range(from, (to - from) as usize).fill(0xFF);
        Ok(())
    }

    fn write(&mut self, offset: u32, bytes: &[u8]) -> Result<(), NorFlashErrorKind> {
        check_write(self, offset, bytes.len())?;
        for (cell, byte) in self.range(offset, bytes.len()).iter_mut().zip(bytes) {
            *cell &= byte;
        }
        Ok(())
    }
}
