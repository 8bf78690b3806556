//! The record of a run for another processor core: what the core asked of its surroundings, and what
//! they did to it.
//!
//! A trace begins with [`MAGIC`] and the hash of the image's file (64-bit FNV-1a), 8 bytes. Records follow in the
//! order of their events. A record is 20 bytes, little endian: kind (1 byte), width of an access in
//! bytes (1), number of an exception (2), address (4), value or length (4), and the number of
//! instructions that the core has retired (8), which includes the instruction that makes an access.
//! The kinds are those of [`Kind`]; after a record of memory follow as many bytes as its length says.
//!
//! The core answers accesses to its private registers from 0xE000_0000 itself, so they are absent,
//! except those of `DBGMCU` at 0xE004_2000. A transfer into RAM by DMA is absent, too. The address to
//! which an exception returns is not visible; whoever replays the trace finds it on the stack.

use std::collections::BTreeMap;

use rigless::device::Level;
use rigless::emulator::{
    Access, AccessKind, Error, Hit, HitKind, Host, InterruptLine, Memory, Settled, Watch,
};
use rigless::soc::{Endian, Width};
use terminal::checksum;

use crate::flash;
use crate::image::Image;

/// The first bytes of a trace; the digit is the version of the format.
pub const MAGIC: [u8; 16] = *b"limpid trace  1\n";

/// RAM of the image. The stack in it is not compared: a core may or may not store floating-point
/// registers at an exception.
const RAM: [u64; 2] = [0x2000_0000, 0x2003_0000];

/// What a record is about.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u8)]
pub enum Kind {
    /// Memory beside the image before the first instruction: the bytes that follow.
    Load = 1,
    /// The firmware read a value from a register of a peripheral.
    Read = 2,
    /// The firmware wrote a value to a register of a peripheral.
    Write = 3,
    /// The core entered the handler of an exception at this address.
    Entry = 4,
    /// The host, a debug probe, wrote the bytes that follow to RAM.
    HostWrite = 5,
    /// The host read the bytes that follow from RAM outside the stack.
    HostRead = 6,
    /// The microcontroller was reset.
    Reset = 7,
    /// The run ended.
    End = 8,
}

/// The trace of a run in the making.
#[derive(Debug)]
pub(crate) struct Trace {
    pub(crate) bytes: Vec<u8>,
    /// Exceptions by the first instruction of their handler.
    handlers: BTreeMap<u64, u16>,
    stack: [u64; 2],
    /// The latest record if bytes follow it: where it begins, its kind, its count, and the address
    /// behind its bytes.
    open: Option<(usize, Kind, u64, u64)>,
    /// Resets recorded so far.
    resets: usize,
}

impl Trace {
    pub(crate) fn new(image: &Image) -> Self {
        let mut bytes = MAGIC.to_vec();
        bytes.extend(checksum::sum(image.elf()).to_le_bytes());
        Self {
            bytes,
            handlers: image.handlers(),
            stack: image.stack,
            open: None,
            resets: 0,
        }
    }

    /// Watchpoints that show the entries of exceptions.
    pub(crate) fn watches(&self) -> impl Iterator<Item = Watch> {
        self.handlers.keys().map(|at| Watch::Instruction(*at))
    }

    fn record(&mut self, kind: Kind, [size, number]: [u16; 2], address: u64, value: u64, at: u64) {
        self.open = None;
        self.bytes.extend([kind as u8, size as u8]);
        self.bytes.extend(number.to_le_bytes());
        self.bytes.extend((address as u32).to_le_bytes());
        self.bytes.extend((value as u32).to_le_bytes());
        self.bytes.extend(at.to_le_bytes());
    }

    /// Appends to the latest record if the bytes continue it, and begins another one otherwise.
    fn memory(&mut self, kind: Kind, address: u64, bytes: &[u8], at: u64) {
        let begin = match self.open {
            Some((begin, of, when, end)) if (of, when, end) == (kind, at, address) => begin,
            _ => {
                self.record(kind, [0; 2], address, 0, at);
                self.bytes.len() - 20
            }
        };
        self.bytes.extend(bytes);
        let length = (self.bytes.len() - begin - 20) as u32;
        self.bytes[begin + 8..begin + 12].copy_from_slice(&length.to_le_bytes());
        self.open = Some((begin, kind, at, address + bytes.len() as u64));
    }

    /// Records an access of the core or the entry of an exception.
    pub(crate) fn settled(&mut self, settled: &Settled) {
        match settled {
            Settled::Access { access, value } => self.access(access, *value),
            Settled::Hit(Hit {
                kind: HitKind::Instruction,
                address,
                instruction_count,
                ..
            }) => {
                if let Some(number) = self.handlers.get(address) {
                    let number = [0, *number];
                    self.record(Kind::Entry, number, *address, 0, *instruction_count);
                }
            }
            _ => {}
        }
    }

    fn access(&mut self, access: &Access, read: u64) {
        let (kind, value) = match access.kind {
            AccessKind::Read => (Kind::Read, read),
            AccessKind::Write => (Kind::Write, access.value),
        };
        let bits = access.width.bits();
        let value = value & (u64::MAX >> (64 - bits));
        let size = [u16::from(bits / 8), 0];
        self.record(kind, size, access.address, value, access.instruction_count);
    }

    /// Records the resets up to this number of them.
    pub(crate) fn reset(&mut self, number: usize, at: u64) {
        for _ in self.resets..number {
            self.record(Kind::Reset, [0; 2], 0, 0, at);
        }
        self.resets = number;
    }

    /// Records what the flash holds beside the image and the settings.
    pub(crate) fn begin(&mut self, memory: &mut dyn Memory) {
        self.copy(Kind::Load, flash::FACTORY, memory, 0);
    }

    /// Records RAM outside the stack, and the end of the run.
    pub(crate) fn end(&mut self, memory: &mut dyn Memory, at: u64) {
        let [low, high] = self.stack;
        self.copy(Kind::HostRead, [RAM[0], low], memory, at);
        self.copy(Kind::HostRead, [high, RAM[1]], memory, at);
        self.record(Kind::End, [0; 2], 0, 0, at);
    }

    fn copy(&mut self, kind: Kind, [from, to]: [u64; 2], memory: &mut dyn Memory, at: u64) {
        for address in from..to {
            if let Ok(byte) = memory.read(address, Width::W8) {
                self.memory(kind, address, &[byte as u8], at);
            }
        }
    }
}

/// The host of a run, whose accesses to RAM are recorded.
pub(crate) struct Recorder<'a> {
    pub(crate) trace: &'a mut Trace,
    pub(crate) host: &'a mut dyn Host,
    /// Instructions that the core has retired.
    pub(crate) at: u64,
}

impl Recorder<'_> {
    fn memory(&mut self, kind: Kind, address: u64, width: Width, value: u64) {
        let bytes = value.to_le_bytes();
        let bytes = &bytes[..width.bits() as usize / 8];
        self.trace.memory(kind, address, bytes, self.at);
    }
}

impl Memory for Recorder<'_> {
    fn read(&mut self, address: u64, width: Width) -> Result<u64, Error> {
        let value = self.host.read(address, width)?;
        let ([low, high], [begin, end]) = (self.trace.stack, RAM);
        if (begin..end).contains(&address) && !(low..high).contains(&address) {
            self.memory(Kind::HostRead, address, width, value);
        }
        Ok(value)
    }

    fn write(&mut self, address: u64, width: Width, value: u64) -> Result<(), Error> {
        self.host.write(address, width, value)?;
        self.memory(Kind::HostWrite, address, width, value);
        Ok(())
    }

    fn program(&mut self, address: u64, width: Width, value: u64) -> Result<(), Error> {
        self.host.program(address, width, value)
    }

    fn endian(&self) -> Endian {
        self.host.endian()
    }
}

impl Host for Recorder<'_> {
    fn set_interrupt(&mut self, line: InterruptLine, level: Level) {
        self.host.set_interrupt(line, level);
    }

    fn request_reset(&mut self) {
        self.trace.reset(self.trace.resets + 1, self.at);
        self.host.request_reset();
    }

    fn hold(&mut self, held: bool) {
        self.host.hold(held);
    }

    fn save_state(&mut self) -> Result<Vec<u8>, Error> {
        self.host.save_state()
    }

    fn watch(&mut self, watch: Watch) -> bool {
        self.host.watch(watch)
    }

    fn unwatch(&mut self, watch: Watch) {
        self.host.unwatch(watch);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn empty() -> Trace {
        Trace {
            bytes: Vec::new(),
            handlers: BTreeMap::from([(0x0800_0100, 66)]),
            stack: [0x2000_1000, 0x2003_0000],
            open: None,
            resets: 0,
        }
    }

    #[test]
    fn accesses_and_entries_are_records_of_20_bytes() {
        let mut trace = empty();
        let access = Access::new(AccessKind::Write, 0x4000_7408, Width::W16, 0x1234_0ABC);
        let access = access.at(0x1_0000_0002, rigless::time::VirtualNanos(0));
        trace.settled(&Settled::Access {
            access,
            value: 0x1234_0ABC,
        });
        let hit = |address| {
            Settled::Hit(Hit {
                kind: HitKind::Instruction,
                address,
                at: rigless::time::VirtualNanos(0),
                instruction_count: 3,
            })
        };
        trace.settled(&hit(0x0800_0100));
        trace.settled(&hit(0x0800_0102));
        // Kind, width, number; address; value; count.
        let write = [
            3, 2, 0, 0, 0x08, 0x74, 0, 0x40, 0xBC, 0x0A, 0, 0, 2, 0, 0, 0, 1, 0, 0, 0,
        ];
        let entry = [4, 0, 66, 0, 0, 1, 0, 8, 0, 0, 0, 0, 3, 0, 0, 0, 0, 0, 0, 0];
        assert_eq!(trace.bytes, [write, entry].concat());
    }

    /// One record holds bytes that follow each other at one instant; another address, instant or
    /// direction begins another record.
    #[test]
    fn bytes_that_continue_a_record_are_appended() {
        let mut trace = empty();
        trace.memory(Kind::HostWrite, 0x2000_0000, &[1, 2], 5);
        trace.memory(Kind::HostWrite, 0x2000_0002, &[3], 5);
        trace.memory(Kind::HostRead, 0x2000_0003, &[4], 5);
        trace.memory(Kind::HostRead, 0x2000_0005, &[5], 5);
        trace.memory(Kind::HostRead, 0x2000_0006, &[6], 6);
        let lengths: Vec<u8> = [0, 23, 44, 65].map(|begin| trace.bytes[begin + 8]).into();
        assert_eq!(lengths, [3, 1, 1, 1]);
        assert_eq!(trace.bytes.len(), 23 + 3 * 21);
        assert_eq!(trace.bytes[20..23], [1, 2, 3]);
    }
}
