//! A path through code, from stops at the starts of its straight pieces alone.

use std::collections::{BTreeMap, BTreeSet};

use crate::code::Code;
use crate::cycles;
use crate::fetch::{Fetch, Fetches};
use crate::flow::{Flow, decode};
use crate::thumb::{instructions, is_wide, length};

/// Instructions, and where straight pieces of them begin. The core runs a piece from its first to its last
/// instruction, and goes from there to the start of a piece or to other code.
#[derive(Clone, Debug, Default)]
pub struct Pieces {
    /// Both halves by address.
    code: BTreeMap<u64, [u16; 2]>,
    starts: BTreeSet<u64>,
}

impl Pieces {
    /// Those of the function at `address` and of all functions that it calls directly. More begin at `also`.
    #[must_use]
    pub fn reached(code: &Code, address: u64, also: &[u64]) -> Self {
        let mut pieces = Self::default();
        pieces.starts.extend(also);
        for function in code.reached(address) {
            pieces.starts.insert(function);
            let all = instructions(function, code.function(function));
            let all = all.map(|(at, halves)| (at, halves, decode(halves, at)));
            // It may go on at any of its instructions.
            let is_open = all.clone().any(|(.., flow)| flow == Flow::Unknown);
            for (at, halves, flow) in all {
                pieces.code.insert(at, halves);
                if is_open {
                    pieces.starts.insert(at);
                }
                if flow != Flow::On {
                    pieces.starts.insert(at + length(halves));
                }
                if let Flow::Perhaps(to) | Flow::Jump(to) | Flow::Call(to) = flow {
                    pieces.starts.insert(to);
                }
            }
        }
        let Self { code, starts } = &mut pieces;
        starts.retain(|at| code.contains_key(at));
        pieces
    }

    /// Addresses at which pieces begin.
    #[must_use]
    pub fn starts(&self) -> &BTreeSet<u64> {
        &self.starts
    }

    /// Addresses and both halves of the instructions of the piece that begins at `start`.
    fn piece(&self, start: u64) -> impl Iterator<Item = (u64, [u16; 2])> {
        let from = self.code.range(start..);
        let inside = from.take_while(move |(at, _)| **at == start || !self.starts.contains(at));
        inside.map(|(at, halves)| (*at, *halves))
    }
}

/// What the instructions of a path have cost so far.
#[derive(Debug, Default)]
pub struct Path {
    /// Start of the latest piece, which is not counted yet.
    at: Option<u64>,
    instructions: u32,
    cycles: u32,
    fetch: Fetch,
}

impl Path {
    /// The core has come to the start of a piece, or to other code.
    pub fn reach(&mut self, code: &Pieces, address: u64) {
        let Some(start) = self.at.replace(address) else {
            return;
        };
        let mut piece = code.piece(start).peekable();
        while let Some((at, halves)) = piece.next() {
            let next = piece.peek().map_or(address, |(at, _)| *at);
            self.count(at, halves, next);
        }
    }

    /// The path ends with the instruction that the core has come to.
    pub fn end(&mut self, code: &Pieces) {
        let last = self
            .at
            .take()
            .and_then(|at| Some((at, *code.code.get(&at)?)));
        if let Some((at, halves)) = last {
            self.count(at, halves, at + length(halves));
        }
    }

    fn count(&mut self, at: u64, halves: [u16; 2], next: u64) {
        let [first, second] = halves;
        self.instructions += 1;
        self.fetch.instruction(at, is_wide(first), self.cycles);
        self.cycles += cycles::of(first, second, next != at + length(halves));
    }

    /// Number of instructions.
    #[must_use]
    pub fn instructions(&self) -> u32 {
        self.instructions
    }

    /// Estimated cycles, without waits for flash.
    #[must_use]
    pub fn cycles(&self) -> u32 {
        self.cycles
    }

    /// Fetches from flash.
    #[must_use]
    pub(crate) fn fetches(&self) -> Fetches {
        self.fetch.fetches()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn code(functions: &[(u64, &[u16])]) -> Code {
        let bytes = |halves: &[u16]| halves.iter().flat_map(|half| half.to_le_bytes()).collect();
        let functions = functions.iter().map(|(at, halves)| (*at, bytes(halves)));
        functions.collect()
    }

    #[test]
    fn path_is_known_from_stops_at_the_starts_of_pieces() {
        // movs r0, #2; subs r0, #1; bne -6; bl 0x200; bx lr. At 0x200: ldr r1, [r0]; bx lr
        let caller = [0x2002, 0x3801, 0xD1FD, 0xF000, 0xF87B, 0x4770];
        let code = code(&[(0x100, &caller), (0x200, &[0x6801, 0x4770])]);
        let pieces = Pieces::reached(&code, 0x100, &[]);
        assert_eq!(*pieces.starts(), [0x100, 0x102, 0x106, 0x10A, 0x200].into());
        let mut path = Path::default();
        for at in [0x100, 0x102, 0x102, 0x106, 0x200, 0x10A] {
            path.reach(&pieces, at);
        }
        path.end(&pieces);
        // movs; twice subs and bne, taken once; bl; ldr; bx, taken; bx, whose target is not in the path
        let cycles = 1 + (1 + 3) + (1 + 1) + 3 + 2 + 3 + 1;
        assert_eq!((path.instructions(), path.cycles()), (9, cycles));
        // Lines from 0x100 and from 0x200.
        assert_eq!(path.fetches().lines, 2);
    }

    #[test]
    fn every_instruction_begins_a_piece_where_a_table_is_branched_to() {
        // tbb [pc, r0]; four bytes of table; movs r0, #1; movs r0, #2; bx lr
        let function = [0xE8DF, 0xF000, 0x0302, 0x0404, 0x2001, 0x2002, 0x4770];
        let code = code(&[(0x100, &function)]);
        let pieces = Pieces::reached(&code, 0x100, &[]);
        let every = [0x100, 0x104, 0x106, 0x108, 0x10A, 0x10C];
        assert_eq!(*pieces.starts(), every.into());
    }

    #[test]
    fn addresses_outside_the_code_begin_no_piece() {
        // movs r0, #1; bx lr
        let code = code(&[(0x100, &[0x2001, 0x4770])]);
        let pieces = Pieces::reached(&code, 0x100, &[0x102, 0x400]);
        assert_eq!(*pieces.starts(), [0x100, 0x102].into());
    }
}
