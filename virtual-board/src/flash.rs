//! What the flash of the board holds beside the firmware.

mod interface;
mod map;

use std::ops::Range;
use std::path::Path;

use drivers::{SETTINGS_BYTES, SaveError, Setting, Settings, Store};
use embedded_storage::nor_flash::{
    ErrorType, NorFlash, NorFlashErrorKind, ReadNorFlash, check_erase, check_read, check_write,
};
use rigless::image::Image;

pub(crate) use interface::FlashInterface;
pub(crate) use map::MemoryMap;

/// Address of sector 12, the first one of bank 2.
pub(crate) const SECTOR_12: u64 = 0x0810_0000;
/// Sectors 12 and 13, from the begin of the first one.
const SECTORS: [Range<u32>; 2] = [0..SECTOR, SECTOR..2 * SECTOR];
/// Bytes of a sector.
pub const SECTOR: u32 = 16 * 1024;
/// Byte of erased flash.
const ERASED: u8 = 0xFF;

/// Address of the size of the flash, which the factory has programmed, KiB.
const SIZE_WORD: u64 = 0x1FFF_7A22;
/// Size of the flash of an STM32F429ZI, KiB.
const SIZE_KIB: u16 = 2048;

/// What the factory has programmed: first address, and the one behind the end. The settings are placed when
/// a run begins.
pub(crate) const FACTORY: [u64; 2] = [SIZE_WORD, SIZE_WORD + 2];

/// An image of the word with the flash's size.
///
/// # Errors
/// One line if the emulator does not take it.
pub(crate) fn size() -> Result<Image, String> {
    let bytes = SIZE_KIB.to_le_bytes().to_vec();
    Image::new(Path::new("factory.bin"), bytes, Some(SIZE_WORD))
        .map_err(|error| format!("flash at {SIZE_WORD:#x}: {error}"))
}

/// How long the flash takes, of the table "Flash memory programming" of the data sheet of STM32F427 and
/// STM32F429 (DS9405), at a parallelism of x8.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct FlashTimes {
    /// Time to program a byte, ns.
    pub program_ns: u64,
    /// Time to erase a sector of 16 KiB, ns: at least the typical one, which is the emulator's.
    pub erase_ns: u64,
}

impl FlashTimes {
    /// Typical times.
    pub(crate) const TYPICAL: Self = Self {
        program_ns: 16_000,
        erase_ns: 400_000_000,
    };
    /// The longest times.
    pub const LONGEST: Self = Self {
        program_ns: 100_000,
        erase_ns: 800_000_000,
    };
}

/// A change of the sectors by the flash interface.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Change {
    /// A byte is programmed: bits that are 0 in `value` are cleared.
    Program {
        /// Place of the byte, from the begin of sector 12.
        offset: u32,
        /// The byte that was written.
        value: u8,
    },
    /// All bits of a sector are set.
    Erase {
        /// 0 is sector 12, 1 is sector 13.
        sector: u32,
    },
}

impl Change {
    /// Places of the bytes that change, from the begin of sector 12.
    #[must_use]
    pub fn range(self) -> Range<usize> {
        match self {
            Self::Program { offset, .. } => offset as usize..offset as usize + 1,
            Self::Erase { sector } => (sector * SECTOR) as usize..((sector + 1) * SECTOR) as usize,
        }
    }
}

/// Content of sectors 12 and 13, which keep the settings.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Sectors(Vec<u8>);

impl Sectors {
    /// Erased sectors.
    #[must_use]
    pub fn erased() -> Self {
        Self(vec![ERASED; 2 * SECTOR as usize])
    }

    /// Sectors in which these settings are the newest, after so many records of older ones.
    ///
    /// # Errors
    /// One line if they do not fit.
    pub fn with(settings: &Settings, older: u32) -> Result<Self, String> {
        let mut flash = Self::erased();
        for number in 1..=older {
            // No record is stored twice in a row.
            let mut other = Settings::DEFAULT;
            other.set(Setting::Serial, 1e6 + number as f32);
            flash.store(&other)?;
        }
        flash.store(settings)?;
        Ok(flash)
    }

    /// Does what a board does at its start and when it stores settings.
    ///
    /// # Errors
    /// One line if they are not stored.
    pub fn store(&mut self, settings: &Settings) -> Result<(), String> {
        let failed = |error| format!("settings in flash: {error:?}");
        let opened = Store::<SETTINGS_BYTES>::open(self, SECTORS);
        let (mut store, _) = opened.map_err(SaveError::Flash).map_err(failed)?;
        let prepared = store.prepare(self);
        prepared.map_err(SaveError::Flash).map_err(failed)?;
        store.save(self, &settings.encode()).map_err(failed)
    }

    /// The newest settings; `None` if there are none, or none that this version can read.
    #[must_use]
    pub fn settings(&self) -> Option<Settings> {
        let opened = Store::<SETTINGS_BYTES>::open(&mut self.clone(), SECTORS);
        Settings::decode(&opened.ok()?.1?).ok()
    }

    /// The bytes of both sectors.
    #[must_use]
    pub fn bytes(&self) -> &[u8] {
        &self.0
    }

    /// The bytes of both sectors, to be changed without the rules of a flash.
    pub fn bytes_mut(&mut self) -> &mut [u8] {
        &mut self.0
    }

    /// Makes a change completely.
    pub fn apply(&mut self, change: Change) {
        let cells = &mut self.0[change.range()];
        match change {
            Change::Program { value, .. } => cells[0] &= value,
            Change::Erase { .. } => cells.fill(ERASED),
        }
    }

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
        self.range(from, (to - from) as usize).fill(ERASED);
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
