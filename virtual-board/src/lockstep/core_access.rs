//! Loads and stores by the core for a test. A bus master cannot access the registers inside the
//! core.

use std::collections::VecDeque;

use rigless::emulator::{Host, Memory};
use rigless::soc::Width;

use crate::probe::schedule;
use crate::stack::Stack;

/// A load or a store of a word.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CoreAccess {
    /// Reads the word at this address.
    Load(u32),
    /// Writes this value to the word at this address.
    Store(u32, u32),
}

/// `push {r0, r1, r2}`; `ldr r0, address`; `ldr r1, value`; `ldr r2, result`.
const BEFORE: [u16; 4] = [0xB407, 0x4804, 0x4904, 0x4A05];
/// `str r1, [r2]`; `pop {r0, r1, r2}`; `nop`; `ldr.w pc, return`.
const AFTER: [u16; 5] = [0x6011, 0xBC07, 0xBF00, 0xF8DF, 0xF00C];
/// `ldr r1, [r0]`, `str r1, [r0]`.
const ACCESS: [u16; 2] = [0x6801, 0x6001];
/// Bytes before the literals, and before the word for the result.
const LITERALS: u64 = 20;
const RESULT: u64 = LITERALS + 16;
/// Words below the stack's top that are searched for the frame of an exception.
const SEARCHED: usize = 256;

/// The accesses of a run. Each is code in RAM that the task of lowest priority runs when it wakes.
#[derive(Debug)]
pub(crate) struct CoreAccesses {
    due: VecDeque<(u64, CoreAccess)>,
    stack: Stack,
    /// Stored and read values, in order of time.
    pub(crate) values: Vec<u32>,
    placed: bool,
}

impl CoreAccesses {
    pub(crate) fn new(accesses: &[(f64, CoreAccess)], stack: Stack) -> Self {
        Self {
            due: schedule(accesses.iter().copied()),
            stack,
            values: Vec::new(),
            placed: false,
        }
    }

    /// Redirects the return of the control task to the code of the access that is due. The control
    /// task has just woken the processor, which waited for an interrupt in the instruction before
    /// `behind`.
    pub(crate) fn wake(&mut self, now_ns: u64, behind: u64, host: &mut dyn Host) {
        // The stack does not reach its lowest words.
        let Some(code) = self.stack.words().next() else {
            return;
        };
        if std::mem::take(&mut self.placed) {
            let value = host.read(code + RESULT, Width::W32).unwrap_or(0);
            self.values.push(value as u32);
        }
        self.stack.paint_lowest(host);
        let Some((_, access)) = self.due.front().copied().filter(|(at, _)| *at <= now_ns) else {
            return;
        };
        let mut top = self.stack.words_down().take(SEARCHED);
        let Some(frame) = top.find(|at| host.read(*at, Width::W32).ok() == Some(behind)) else {
            return;
        };
        self.due.pop_front();
        self.placed = true;
        place(access, code, behind, host);
        // A write to RAM cannot fail.
        let _ = host.write(frame, Width::W32, code);
    }
}

/// Writes the code of `access` at `code`. The code ends with a jump to `behind`.
fn place(access: CoreAccess, code: u64, behind: u64, memory: &mut dyn Memory) {
    let (instruction, address, value) = match access {
        CoreAccess::Load(address) => (ACCESS[0], address, 0),
        CoreAccess::Store(address, value) => (ACCESS[1], address, value),
    };
    let halves = BEFORE.into_iter().chain([instruction]).chain(AFTER);
    for (at, half) in (code..).step_by(2).zip(halves) {
        let _ = memory.write(at, Width::W16, u64::from(half));
    }
    let literals = [address, value, (code + RESULT) as u32, behind as u32 | 1];
    for (at, word) in (code + LITERALS..).step_by(4).zip(literals) {
        let _ = memory.write(at, Width::W32, u64::from(word));
    }
}
