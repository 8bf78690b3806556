//! The store against a flash that loses its power after any number of bytes.

use std::ops::Range;

use drivers::{SaveError, Store};
use embedded_storage::nor_flash::{
    ErrorType, NorFlash, NorFlashError, NorFlashErrorKind, ReadNorFlash,
};

const SECTOR: u32 = 256;
const SECTORS: [Range<u32>; 2] = [0..SECTOR, SECTOR..2 * SECTOR];
/// Three records and some bytes in a sector.
const N: usize = 72;

type Records = Store<N>;

/// Flash whose power fails after a number of bytes that are programmed or erased. The byte on which it
/// fails is left halfway.
#[derive(Clone)]
struct Flash {
    bytes: Vec<u8>,
    left: usize,
    erased: u32,
}

#[derive(Debug, PartialEq)]
struct PowerLost;

impl NorFlashError for PowerLost {
    fn kind(&self) -> NorFlashErrorKind {
        NorFlashErrorKind::Other
    }
}

impl Flash {
    fn blank() -> Self {
        Self {
            bytes: vec![0xFF; 2 * SECTOR as usize],
            left: usize::MAX,
            erased: 0,
        }
    }

    /// Changes a byte, completely or halfway.
    fn change(&mut self, at: usize, whole: u8, half: u8) -> Result<(), PowerLost> {
        if self.left == 0 {
            self.bytes[at] = half;
            return Err(PowerLost);
        }
        self.left -= 1;
        self.bytes[at] = whole;
        Ok(())
    }
}

impl ErrorType for Flash {
    type Error = PowerLost;
}

impl ReadNorFlash for Flash {
    const READ_SIZE: usize = 1;

    fn read(&mut self, offset: u32, bytes: &mut [u8]) -> Result<(), PowerLost> {
        let at = offset as usize;
        bytes.copy_from_slice(&self.bytes[at..at + bytes.len()]);
        Ok(())
    }

    fn capacity(&self) -> usize {
        self.bytes.len()
    }
}

impl NorFlash for Flash {
    const WRITE_SIZE: usize = 1;
    const ERASE_SIZE: usize = SECTOR as usize;

    fn erase(&mut self, from: u32, to: u32) -> Result<(), PowerLost> {
        self.erased += 1;
        for at in from as usize..to as usize {
            self.change(at, 0xFF, self.bytes[at] | 0x0F)?;
        }
        Ok(())
    }

    fn write(&mut self, offset: u32, bytes: &[u8]) -> Result<(), PowerLost> {
        for (at, byte) in (offset as usize..).zip(bytes) {
            // Programming clears bits and sets none.
            let before = self.bytes[at];
            self.change(at, before & byte, before & (byte | 0x55))?;
        }
        Ok(())
    }
}

/// What the controller does at its start.
fn start(flash: &mut Flash) -> (Records, Option<[u8; N]>) {
    let (mut store, record) = Records::open(flash, SECTORS).expect("readable");
    let (is_prepared, erased) = (store.is_prepared(), flash.erased);
    store.prepare(flash).expect("erased");
    assert_eq!(is_prepared, flash.erased == erased);
    assert!(store.is_prepared());
    (store, record)
}

#[test]
fn newest_record_is_found_after_every_restart() {
    let mut flash = Flash::blank();
    for k in 0..40u8 {
        let (mut store, record) = start(&mut flash);
        assert_eq!(record, k.checked_sub(1).map(|before| [before; N]), "{k}");
        assert_eq!(store.save(&mut flash, &[k; N]), Ok(()), "{k}");
    }
    // Three records a sector, and no erasure but before a sector is used again.
    assert_eq!(flash.erased, 12);
}

#[test]
fn store_takes_the_records_of_a_sector_and_a_half_between_two_restarts() {
    let mut flash = Flash::blank();
    let (mut store, _) = start(&mut flash);
    for k in 0..6 {
        assert_eq!(store.save(&mut flash, &[k; N]), Ok(()), "{k}");
    }
    assert_eq!(store.save(&mut flash, &[6; N]), Err(SaveError::Full));
    let (mut store, record) = start(&mut flash);
    assert_eq!(record, Some([5; N]));
    assert_eq!(store.save(&mut flash, &[6; N]), Ok(()));
}

/// A command that is repeated, because its answer was lost, wears the flash once.
#[test]
fn record_that_is_the_newest_already_is_not_written_again() {
    let mut flash = Flash::blank();
    let (mut store, _) = start(&mut flash);
    for k in [1, 2] {
        assert_eq!(store.save(&mut flash, &[k; N]), Ok(()));
    }
    let written = flash.bytes.clone();
    for _ in 0..20 {
        assert_eq!(store.save(&mut flash, &[2; N]), Ok(()));
        (store, _) = start(&mut flash);
    }
    assert_eq!(flash.bytes, written);
    // The one before the newest is written again.
    assert_eq!(store.save(&mut flash, &[1; N]), Ok(()));
    assert_eq!(start(&mut flash).1, Some([1; N]));
    // A newest record that has been damaged since is not taken for the same.
    let damaged = flash
        .bytes
        .iter()
        .rposition(|byte| *byte == 1)
        .expect("a record");
    let (mut store, _) = start(&mut flash);
    flash.bytes[damaged] = 0;
    assert_eq!(store.save(&mut flash, &[1; N]), Ok(()));
    assert_eq!(start(&mut flash).1, Some([1; N]));
}

/// Records of 64 bytes fill a sector to its last byte.
#[test]
fn record_that_ends_with_its_sector_is_found() {
    const N: usize = 56;
    let mut flash = Flash::blank();
    let (mut store, _) = Store::<N>::open(&mut flash, SECTORS).expect("readable");
    for k in 0..4 {
        assert_eq!(store.save(&mut flash, &[k; N]), Ok(()), "{k}");
    }
    let (_, record) = Store::<N>::open(&mut flash, SECTORS).expect("readable");
    assert_eq!(record, Some([3; N]));
}

#[test]
fn loss_of_power_leaves_the_record_before_or_the_new_one() {
    // From every number of records on, at every byte of what the next start and save change.
    for records in 0..8u8 {
        let mut before = Flash::blank();
        for k in 0..records {
            let (mut store, _) = start(&mut before);
            store.save(&mut before, &[k; N]).expect("saved");
        }
        let old = records.checked_sub(1).map(|k| [k; N]);
        for left in 0.. {
            let mut flash = before.clone();
            flash.left = left;
            let (mut store, found) = Records::open(&mut flash, SECTORS).expect("readable");
            assert_eq!(found, old);
            let erased = store.prepare(&mut flash);
            let saved = erased.is_ok() && store.save(&mut flash, &[0xA3; N]).is_ok();
            flash.left = usize::MAX;
            let (mut store, found) = start(&mut flash);
            let new = Some([0xA3; N]);
            assert!(found == new || !saved && found == old, "{records} {left}");
            // Everything works as before.
            assert_eq!(
                store.save(&mut flash, &[0x3A; N]),
                Ok(()),
                "{records} {left}"
            );
            assert_eq!(start(&mut flash).1, Some([0x3A; N]), "{records} {left}");
            if saved {
                break;
            }
        }
    }
}

#[test]
fn loss_of_power_after_loss_of_power_keeps_the_record() {
    let mut flash = Flash::blank();
    let (mut store, _) = start(&mut flash);
    store.save(&mut flash, &[7; N]).expect("saved");
    for k in 0..200 {
        flash.left = k * 37 % 331;
        let (mut store, found) = Records::open(&mut flash, SECTORS).expect("readable");
        assert_eq!(found, Some([7; N]), "{k}");
        let _ = store.prepare(&mut flash).map(|()| {
            // Never the last byte of a record.
            flash.left = flash.left.min(N + 7);
            store.save(&mut flash, &[8; N])
        });
    }
}

#[test]
fn flash_that_does_not_keep_what_is_written_is_noticed() {
    struct Worn(Flash);
    impl ErrorType for Worn {
        type Error = PowerLost;
    }
    impl ReadNorFlash for Worn {
        const READ_SIZE: usize = 1;
        fn read(&mut self, offset: u32, bytes: &mut [u8]) -> Result<(), PowerLost> {
            self.0.read(offset, bytes)
        }
        fn capacity(&self) -> usize {
            self.0.capacity()
        }
    }
    impl NorFlash for Worn {
        const WRITE_SIZE: usize = 1;
        const ERASE_SIZE: usize = SECTOR as usize;
        fn erase(&mut self, from: u32, to: u32) -> Result<(), PowerLost> {
            self.0.erase(from, to)
        }
        fn write(&mut self, offset: u32, bytes: &[u8]) -> Result<(), PowerLost> {
            self.0.write(offset, bytes)?;
            // A cell of the first record that cannot be cleared.
            self.0.bytes[20] |= 1;
            Ok(())
        }
    }
    let mut flash = Worn(Flash::blank());
    let (mut store, _) = Records::open(&mut flash, SECTORS).expect("readable");
    assert_eq!(store.save(&mut flash, &[2; N]), Err(SaveError::Mismatch));
    assert_eq!(store.save(&mut flash, &[2; N]), Ok(()));
    let (_, record) = Records::open(&mut flash, SECTORS).expect("readable");
    assert_eq!(record, Some([2; N]));
}
