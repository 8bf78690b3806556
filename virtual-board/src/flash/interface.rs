//! Model of the flash interface, RM0090 section 3, for the sectors of the settings.

use std::num::NonZeroU32;

use rigless::device::{Device, DeviceContext, RegisterFile};
use rigless::soc::stm32f427::generated::flash::{
    Register,
    cr::{PG, PSIZE, SER, SNB, STRT},
    optcr1::NWRP,
    sr::{BSY, PGPERR, PGSERR, WRPERR},
};
use rigless::soc::stm32f427::peripherals::flash::Flash;
use rigless::time::{EventId, VirtualNanos};

use super::{Change, FlashTimes, Sectors};

/// Rate of the buses after a reset, Hz, and the supply, mV.
const RESET_HZ: u64 = 16_000_000;
const SUPPLY_MV: NonZeroU32 = NonZeroU32::new(3300).expect("not zero");

/// Value of the field `SNB` of sector 12. Those of bank 2 begin with the bit of weight 16.
const SNB_12: u64 = 0b10000;

/// The interface. The emulator's model has the registers, the keys, the lock, and the typical time of an
/// erasure; this one adds the content of the two sectors, programming, and longer erasures.
///
/// * A byte is programmed by a store while `PG` is set and `PSIZE` is x8; it clears bits and sets none.
/// * A store without `PG` sets `PGSERR`, one with another `PSIZE` or of more than a byte sets `PGPERR`, and
///   one to a protected sector sets `WRPERR`. Nothing is programmed then.
/// * A store while a byte is being programmed waits, and so does the core.
/// * Programming does not set `EOP`: the firmware does not set `EOPIE`, without which no `EOP` is set.
#[derive(Debug)]
pub(crate) struct FlashInterface {
    inner: Flash,
    sectors: Sectors,
    times: FlashTimes,
    /// Changes so far, in their order.
    pub(crate) changes: Vec<Change>,
    /// Time until which a byte is being programmed, ns.
    busy_until: u64,
    /// Time until which a sector is being erased, ns.
    erases_until: u64,
    /// The event at that time, and the one at which the emulator's model would have ended the erasure.
    ends: Option<[EventId; 2]>,
    /// The erasure that begins, until the lockstep has asked for it.
    erased: Option<Change>,
}

impl FlashInterface {
    pub(crate) fn new() -> Self {
        Self {
            inner: fresh(),
            sectors: Sectors::erased(),
            times: FlashTimes::TYPICAL,
            changes: Vec::new(),
            busy_until: 0,
            erases_until: 0,
            ends: None,
            erased: None,
        }
    }

    /// The interface after a reset. The content and the option bytes stay; what was being programmed or
    /// erased is complete.
    pub(crate) fn reset(&mut self, registers: &mut RegisterFile) {
        let (optcr, optcr1) = self.inner.committed_options();
        self.inner = fresh();
        self.inner.keep_options(optcr, optcr1, registers);
        (self.busy_until, self.erases_until, self.ends) = (0, 0, None);
    }

    /// Places a content, as a run begins.
    pub(crate) fn place(&mut self, sectors: Sectors) {
        self.sectors = sectors;
    }

    /// Sets how long changes take, as a run begins.
    pub(crate) fn take(&mut self, times: FlashTimes) {
        self.times = times;
    }

    pub(crate) fn sectors(&self) -> &Sectors {
        &self.sectors
    }

    /// The erasure that has begun since the last call.
    pub(crate) fn take_erased(&mut self) -> Option<Change> {
        self.erased.take()
    }

    /// A store of the core at this place from the begin of sector 12. Returns the time at which the store
    /// is over: the present one, unless a byte is being programmed.
    pub(crate) fn store(
        &mut self,
        now_ns: u64,
        offset: u32,
        bytes: &[u8],
        registers: &mut RegisterFile,
    ) -> u64 {
        let control = registers.get(Register::Cr);
        let change = Change::Program {
            offset,
            value: bytes[0],
        };
        let error = if !PG.is_set(control) || BSY.is_set(registers.get(Register::Sr)) {
            Some(PGSERR)
        } else if PSIZE.get(control) != 0 || bytes.len() > 1 {
            Some(PGPERR)
        } else if is_protected(registers, change) {
            Some(WRPERR)
        } else {
            None
        };
        if let Some(error) = error {
            registers.set(Register::Sr, error.set(registers.get(Register::Sr), 1));
            return now_ns;
        }
        let from = now_ns.max(self.busy_until);
        self.busy_until = from + self.times.program_ns;
        self.apply(change);
        from
    }

    fn apply(&mut self, change: Change) {
        self.sectors.apply(change);
        self.changes.push(change);
    }
}

fn fresh() -> Flash {
    let mut flash = Flash::with_clock(RESET_HZ);
    flash.set_supply(SUPPLY_MV);
    flash
}

/// Whether the option bytes protect the sector of a change: its bit of `nWRP` is clear.
fn is_protected(registers: &RegisterFile, change: Change) -> bool {
    let sector = change.range().start as u32 / super::SECTOR;
    NWRP.get(registers.get(Register::Optcr1)) >> sector & 1 == 0
}

impl Device for FlashInterface {
    type Register = Register;

    fn read(
        &mut self,
        register: Register,
        registers: &mut RegisterFile,
        context: &mut DeviceContext<'_>,
    ) -> Option<u64> {
        let programs = register == Register::Sr && context.now().0 < self.busy_until;
        programs.then(|| BSY.set(registers.get(register), 1))
    }

    fn peek(&self, register: Register, registers: &RegisterFile, now: VirtualNanos) -> Option<u64> {
        let programs = register == Register::Sr && now.0 < self.busy_until;
        programs.then(|| BSY.set(registers.get(register), 1))
    }

    fn write(
        &mut self,
        register: Register,
        written: u64,
        registers: &mut RegisterFile,
        context: &mut DeviceContext<'_>,
    ) {
        let was_busy = BSY.is_set(registers.get(Register::Sr));
        self.inner.write(register, written, registers, context);
        let control = registers.get(Register::Cr);
        let begins = !was_busy && BSY.is_set(registers.get(Register::Sr)) && STRT.is_set(control);
        if register != Register::Cr || !begins {
            return;
        }
        let sector = SNB.get(control).checked_sub(SNB_12).filter(|n| *n < 2);
        if context.now().0 < self.busy_until {
            context.tell("CR", "an erasure begins while a byte is being programmed");
        }
        match sector.filter(|_| SER.is_set(control)) {
            Some(sector) => {
                let change = Change::Erase {
                    sector: sector as u32,
                };
                self.apply(change);
                self.erased = Some(change);
                self.erases_until = context.now().0 + self.times.erase_ns;
            }
            None => context.tell("CR", "flash beside the sectors of the settings is erased"),
        }
    }

    fn on_event(
        &mut self,
        event: EventId,
        registers: &mut RegisterFile,
        context: &mut DeviceContext<'_>,
    ) {
        let event = match self.ends {
            Some([end, inner]) if end == event => {
                self.ends = None;
                inner
            }
            _ if context.now().0 < self.erases_until => {
                let end = context.schedule(VirtualNanos(self.erases_until));
                self.ends = Some([end, event]);
                return;
            }
            _ => event,
        };
        self.inner.on_event(event, registers, context);
    }

    fn on_clock(&mut self, hz: u64, registers: &mut RegisterFile, context: &mut DeviceContext<'_>) {
        self.inner.on_clock(hz, registers, context);
    }
}

#[cfg(test)]
mod tests {
    use std::num::NonZeroU64;

    use rigless::device::ResetCause;
    use rigless::mcu::{Mcu as _, Operate as _};
    use rigless::soc::Width;

    use super::*;
    use crate::board::{CORE_HZ, ControllerBoard, Part};
    use crate::flash::SECTOR;

    /// Addresses of `KEYR`, `SR`, `CR` and `OPTCR1`, and the keys, RM0090 3.9 and 3.6.1.
    const KEYR: u64 = 0x4002_3C04;
    const SR: u64 = 0x4002_3C0C;
    const CR: u64 = 0x4002_3C10;
    const KEYS: [u64; 2] = [0x4567_0123, 0xCDEF_89AB];
    /// Bits and fields of `CR`, and flags of `SR`.
    const PG_SET: u64 = 1;
    const X32: u64 = 2 << 8;
    const LOCKED: u64 = 1 << 31;
    const ERASES_12: u64 = 1 << 16 | 0b10000 << 3 | 1 << 1;
    const BUSY: u64 = 1 << 16;
    const SEQUENCE: u64 = 1 << 7;
    const PARALLELISM: u64 = 1 << 6;
    const PROTECTION: u64 = 1 << 4;

    fn part() -> Part {
        let rate = NonZeroU64::new(CORE_HZ).unwrap();
        ControllerBoard::new(8_000_000, rate).unwrap().part
    }

    fn set(part: &mut Part, at_ns: u64, register: u64, value: u64) {
        let at = VirtualNanos(at_ns);
        part.write(at, register, Width::W32, value).unwrap();
    }

    fn get(part: &mut Part, at_ns: u64, register: u64) -> u64 {
        part.read(VirtualNanos(at_ns), register, Width::W32)
            .unwrap()
    }

    fn unlock(part: &mut Part, at_ns: u64) {
        for key in KEYS {
            set(part, at_ns, KEYR, key);
        }
    }

    /// A part whose interface is unlocked, with this value of `CR`.
    fn unlocked(control: u64) -> Part {
        let mut part = part();
        unlock(&mut part, 0);
        set(&mut part, 0, CR, control);
        part
    }

    #[test]
    fn programming_clears_bits_sets_none_and_takes_16_us() {
        let mut part = unlocked(PG_SET);
        assert_eq!(part.store_to_flash(0, 5, &[0x5A]), 0);
        assert_eq!(get(&mut part, 15_999, SR), BUSY);
        assert_eq!(get(&mut part, 16_000, SR), 0);
        // The next two are begun together: the second waits for the first.
        assert_eq!(part.store_to_flash(20_000, 5, &[0xF0]), 20_000);
        assert_eq!(part.store_to_flash(20_000, 6, &[0x81]), 36_000);
        assert_eq!(get(&mut part, 51_999, SR), BUSY);
        assert_eq!(get(&mut part, 52_000, SR), 0);
        assert_eq!(part.flash.sectors().bytes()[4..8], [0xFF, 0x50, 0x81, 0xFF]);
        assert_eq!(part.flash.changes.len(), 3);
    }

    #[test]
    fn store_in_another_mode_changes_nothing_and_sets_its_flag() {
        for (control, bytes, flag) in [
            (0, &[0][..], SEQUENCE),
            (PG_SET | X32, &[0], PARALLELISM),
            (PG_SET, &[0, 0], PARALLELISM),
        ] {
            let mut part = unlocked(control);
            assert_eq!(part.store_to_flash(0, 0, bytes), 0);
            assert_eq!(get(&mut part, 0, SR), flag, "{control:#x}");
            assert_eq!(part.flash.sectors(), &Sectors::erased());
            // A flag is cleared by writing 1.
            set(&mut part, 0, SR, flag);
            assert_eq!(get(&mut part, 0, SR), 0);
        }
        let mut part = unlocked(PG_SET);
        let protected = part.bus_mut().slot("FLASH").unwrap();
        let registers = part.bus_mut().slot_mut(protected).registers_mut();
        let bits = registers.get(Register::Optcr1) & !(1 << 17);
        registers.set(Register::Optcr1, bits);
        part.store_to_flash(0, SECTOR, &[0]);
        assert_eq!(get(&mut part, 0, SR), PROTECTION);
        part.store_to_flash(0, SECTOR - 1, &[0]);
        assert_eq!(part.flash.changes.len(), 1);
    }

    #[test]
    fn wrong_key_locks_until_a_reset_that_keeps_the_content() {
        let mut part = unlocked(PG_SET);
        part.store_to_flash(0, 0, &[0x12]);
        set(&mut part, 20_000, CR, LOCKED);
        for key in [KEYS[1], KEYS[0], KEYS[1]] {
            set(&mut part, 20_000, KEYR, key);
        }
        assert_eq!(get(&mut part, 20_000, CR) & LOCKED, LOCKED);
        part.reset(VirtualNanos(30_000), ResetCause::Pin);
        assert_eq!(get(&mut part, 30_000, CR), LOCKED);
        unlock(&mut part, 30_000);
        assert_eq!(get(&mut part, 30_000, CR), 0);
        assert_eq!(part.flash.sectors().bytes()[..2], [0x12, 0xFF]);
    }

    #[test]
    fn changes_take_the_longest_times_of_the_data_sheet_where_a_run_asks_for_them() {
        let mut part = unlocked(PG_SET);
        part.flash.take(FlashTimes::LONGEST);
        part.store_to_flash(0, 5, &[0x5A]);
        assert_eq!(get(&mut part, 99_999, SR), BUSY);
        assert_eq!(get(&mut part, 100_000, SR), 0);
        set(&mut part, 200_000, CR, ERASES_12);
        for (at_ns, flag) in [(800_199_999, BUSY), (800_200_000, 0)] {
            part.advance_to(VirtualNanos(at_ns));
            assert_eq!(get(&mut part, at_ns, SR), flag);
        }
        assert!(part.drain_told().is_empty());
    }

    #[test]
    fn erasure_sets_all_bits_of_its_sector_alone() {
        let mut part = unlocked(0);
        let mut full = Sectors::erased();
        full.bytes_mut().fill(0);
        part.flash.place(full);
        set(&mut part, 0, CR, ERASES_12);
        assert_eq!(get(&mut part, 0, SR), BUSY);
        let change = Change::Erase { sector: 0 };
        assert_eq!(part.flash.take_erased(), Some(change));
        let (first, second) = part.flash.sectors().bytes().split_at(SECTOR as usize);
        assert!(first.iter().all(|byte| *byte == 0xFF) && second.iter().all(|byte| *byte == 0));
        for (at_ns, flag) in [(399_999_999, BUSY), (400_000_000, 0)] {
            part.advance_to(VirtualNanos(at_ns));
            assert_eq!(get(&mut part, at_ns, SR), flag);
        }
        assert!(part.drain_told().is_empty());
    }

    #[test]
    fn erasure_while_a_byte_is_programmed_is_told() {
        for (at_ns, told) in [(15_999, 1), (16_000, 0)] {
            let mut part = unlocked(PG_SET);
            part.store_to_flash(0, 5, &[0x5A]);
            set(&mut part, at_ns, CR, ERASES_12);
            assert_eq!(part.drain_told().len(), told, "{at_ns}");
        }
    }

    #[test]
    fn erasure_of_the_image_is_told() {
        let mut part = unlocked(0);
        set(&mut part, 0, CR, 1 << 16 | 1 << 3 | 1 << 1);
        assert_eq!(part.flash.take_erased(), None);
        assert_eq!(part.drain_told().len(), 1);
    }
}
