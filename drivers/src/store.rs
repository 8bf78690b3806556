//! A record in flash that survives the loss of power at any instant.

use core::ops::Range;

use crc::{CRC_32_ISO_HDLC, Crc, NoTable};
use embedded_storage::nor_flash::{NorFlash, ReadNorFlash};

const CHECKSUM: Crc<u32, NoTable> = Crc::<u32, NoTable>::new(&CRC_32_ISO_HDLC);

/// Bytes of a number: the sequence number, the checksum.
const WORD: usize = 4;

/// Byte of erased flash.
const BLANK: u8 = 0xFF;

/// The newest of the records in two sectors of flash.
///
/// A record is a sequence number, `N` bytes, and the CRC-32 of both; numbers are little endian. Each
/// [`save`](Self::save) of other bytes writes a record behind the last one and erases nothing. When a sector is full, the
/// records go on in the other one. [`prepare`](Self::prepare) erases the sector without the newest record.
/// The newest valid record is therefore never erased, and a record that was not completed is not valid: a
/// loss of power leaves the record before or the new one.
///
/// Erasing takes up to a second, and the core may stand still meanwhile. It has a call of its own for this
/// reason: a controller makes it before it drives anything. Sectors of 16 KiB then hold at least 62 records
/// of 256 bytes until the next start.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Store<const N: usize> {
    sectors: [Sector; 2],
    newest: Option<Newest>,
}

/// Where the newest record is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Newest {
    /// Index of its sector.
    sector: usize,
    /// Its number.
    number: u32,
    /// Its first byte.
    at: u32,
}

/// A sector of the store.
#[derive(Clone, Debug, PartialEq, Eq)]
struct Sector {
    /// First byte, and the one behind the last one.
    range: Range<u32>,
    /// First byte behind the last record.
    free: u32,
}

/// Reason for a record not to be saved. The record before is kept.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SaveError<E> {
    /// No place is erased. [`Store::prepare`] makes one.
    Full,
    /// The flash has refused the access.
    Flash(E),
    /// The flash does not hold what was written.
    Mismatch,
}

impl<const N: usize> Store<N> {
    /// Bytes of a record.
    pub const RECORD: u32 = (N + 2 * WORD) as u32;

    /// Reads two sectors of `flash`; returns the store and the newest record, if there is one.
    ///
    /// # Errors
    /// That of the flash.
    pub fn open<F: ReadNorFlash>(
        flash: &mut F,
        sectors: [Range<u32>; 2],
    ) -> Result<(Self, Option<[u8; N]>), F::Error> {
        let mut store = Self {
            sectors: sectors.map(|range| Sector {
                free: range.start,
                range,
            }),
            newest: None,
        };
        let mut record = None;
        for i in 0..store.sectors.len() {
            let Range { start, end } = store.sectors[i].range;
            for at in (start..end).step_by(Self::RECORD as usize) {
                if at + Self::RECORD > end || is_blank(flash, at..at + Self::RECORD)? {
                    continue;
                }
                store.sectors[i].free = at + Self::RECORD;
                let Some((number, bytes)) = Self::read(flash, at)? else {
                    continue;
                };
                if store.newest.is_none_or(|newest| number > newest.number) {
                    store.newest = Some(Newest {
                        sector: i,
                        number,
                        at,
                    });
                    record = Some(bytes);
                }
            }
        }
        Ok((store, record))
    }

    /// The record at an address, with its number, if it is valid.
    fn read<F: ReadNorFlash>(flash: &mut F, at: u32) -> Result<Option<(u32, [u8; N])>, F::Error> {
        let (mut number, mut bytes, mut checksum) = ([0; WORD], [0; N], [0; WORD]);
        flash.read(at, &mut number)?;
        flash.read(at + WORD as u32, &mut bytes)?;
        flash.read(at + (WORD + N) as u32, &mut checksum)?;
        let is_valid = Self::checksum(number, &bytes) == checksum;
        Ok(is_valid.then_some((u32::from_le_bytes(number), bytes)))
    }

    fn checksum(number: [u8; WORD], bytes: &[u8; N]) -> [u8; WORD] {
        let mut digest = CHECKSUM.digest();
        digest.update(&number);
        digest.update(bytes);
        digest.finalize().to_le_bytes()
    }

    /// Writes a record and returns whether the flash holds it.
    fn write<F: NorFlash>(
        flash: &mut F,
        at: u32,
        number: u32,
        bytes: &[u8; N],
    ) -> Result<bool, F::Error> {
        let head = number.to_le_bytes();
        flash.write(at, &head)?;
        flash.write(at + WORD as u32, bytes)?;
        flash.write(at + (WORD + N) as u32, &Self::checksum(head, bytes))?;
        Ok(Self::read(flash, at)? == Some((number, *bytes)))
    }

    /// Whether [`Self::prepare`] would erase nothing.
    #[must_use]
    pub fn is_prepared(&self) -> bool {
        (0..self.sectors.len()).all(|i| self.is_usable(i))
    }

    /// Whether a sector has the newest record, or none. Bytes behind its last place are never used.
    fn is_usable(&self, sector: usize) -> bool {
        let Sector { range, free } = &self.sectors[sector];
        *free == range.start || self.newest.is_some_and(|newest| newest.sector == sector)
    }

    /// Erases the sector without the newest record, unless it is blank; both sectors if there is no record.
    ///
    /// # Errors
    /// That of the flash.
    pub fn prepare<F: NorFlash>(&mut self, flash: &mut F) -> Result<(), F::Error> {
        for i in 0..self.sectors.len() {
            let is_usable = self.is_usable(i);
            let Sector { range, free } = &mut self.sectors[i];
            if !is_usable {
                flash.erase(range.start, range.end)?;
                *free = range.start;
            }
        }
        Ok(())
    }

    /// Writes a record, unless the newest one has these bytes.
    ///
    /// # Errors
    /// [`SaveError`]; the record before is then still the newest.
    pub fn save<F: NorFlash>(
        &mut self,
        flash: &mut F,
        bytes: &[u8; N],
    ) -> Result<(), SaveError<F::Error>> {
        const {
            assert!(WORD.is_multiple_of(F::WRITE_SIZE) && N.is_multiple_of(F::WRITE_SIZE));
        }
        let (mut first, mut last) = (0, 0);
        if let Some(Newest { sector, number, at }) = self.newest {
            let record = Self::read(flash, at).map_err(SaveError::Flash)?;
            if record == Some((number, *bytes)) {
                return Ok(());
            }
            (first, last) = (sector, number);
        }
        for i in [first, 1 - first] {
            let Sector { range, free } = &mut self.sectors[i];
            let at = *free;
            let places = at..at + Self::RECORD;
            if places.end > range.end || !is_blank(flash, places).map_err(SaveError::Flash)? {
                continue;
            }
            // What was begun is not blank any more.
            *free = at + Self::RECORD;
            let number = last.wrapping_add(1);
            let kept = Self::write(flash, at, number, bytes).map_err(SaveError::Flash)?;
            if !kept {
                return Err(SaveError::Mismatch);
            }
            self.newest = Some(Newest {
                sector: i,
                number,
                at,
            });
            return Ok(());
        }
        Err(SaveError::Full)
    }
}

/// Whether a range of flash is erased.
fn is_blank<F: ReadNorFlash>(flash: &mut F, range: Range<u32>) -> Result<bool, F::Error> {
    let mut bytes = [0; 32];
    let mut at = range.start;
    while at < range.end {
        let length = bytes.len().min((range.end - at) as usize);
        let part = &mut bytes[..length];
        flash.read(at, part)?;
        if part.iter().any(|byte| *byte != BLANK) {
            return Ok(false);
        }
        at += length as u32;
    }
    Ok(true)
}
