//! Control flow of an instruction: the part of the Thumb-2 encoding that a control-flow graph needs.

use std::collections::BTreeMap;

use crate::thumb::{self, length};

/// Successor of an instruction.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Flow {
    /// The next instruction.
    On,
    /// A target address, or the next instruction.
    Perhaps(u64),
    /// A target address.
    Jump(u64),
    /// A called function and, after its return, the next instruction.
    Call(u64),
    /// Return to the caller.
    Return,
    /// Return to the caller, or the next instruction.
    PerhapsReturn,
    /// An address from a register or a table.
    Unknown,
}

/// An instruction: its successor, and the address after it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Instruction {
    /// What it does to the control flow.
    pub flow: Flow,
    /// Address of the instruction behind it.
    pub next: u64,
}

/// Every instruction of `code` that is reached from its first; literals between them are not.
#[must_use]
pub fn of(base: u64, code: &[u8]) -> BTreeMap<u64, Instruction> {
    let end = base + code.len() as u64;
    let half = |at: u64| {
        let bytes = code.get((at - base) as usize..)?.first_chunk()?;
        Some(u16::from_le_bytes(*bytes))
    };
    let mut found = BTreeMap::new();
    // Address, and how many instructions from it on an IT instruction makes conditional.
    let mut open = vec![(base, 0u32)];
    while let Some((at, conditional)) = open.pop() {
        let Some(first) = half(at).filter(|_| !found.contains_key(&at)) else {
            continue;
        };
        let second = half(at + 2).unwrap_or(0);
        let next = at + length([first, second]);
        let flow = decode([first, second], at);
        let flow = match flow {
            Flow::Jump(to) if conditional > 0 => Flow::Perhaps(to),
            Flow::Return if conditional > 0 => Flow::PerhapsReturn,
            flow => flow,
        };
        found.insert(at, Instruction { flow, next });
        let left = match first {
            // IT: as many instructions as its mask says by its lowest bit.
            half if half & 0xFF00 == 0xBF00 && half & 0xF != 0 => 4 - (half & 0xF).trailing_zeros(),
            _ => conditional.saturating_sub(1),
        };
        if !matches!(flow, Flow::Jump(_) | Flow::Return | Flow::Unknown) {
            open.push((next, left));
        }
        if let Flow::Jump(to) | Flow::Perhaps(to) = flow
            && (base..end).contains(&to)
        {
            open.push((to, 0));
        }
    }
    found
}

/// Control flow of the instruction of these halves at `at`, which no instruction before it makes conditional.
pub(crate) fn decode([first, second]: [u16; 2], at: u64) -> Flow {
    let to = |offset: i32| at.wrapping_add_signed(4 + i64::from(offset));
    let first_bits = |low: u32, mask: u16| i32::from(first >> low & mask);
    match first {
        // B, conditional: 0xDE is undefined by design (a trap), 0xDF a call of a supervisor.
        0xDE00..=0xDEFF => Flow::Return,
        0xDF00..=0xDFFF => Flow::Unknown,
        0xD000..=0xDDFF => Flow::Perhaps(to(i32::from(first as i8) << 1)),
        0xE000..=0xE7FF => Flow::Jump(to(i32::from((first << 5) as i16) >> 4)),
        // CBZ, CBNZ
        half if half & 0xF500 == 0xB100 => {
            Flow::Perhaps(to(first_bits(9, 1) << 6 | first_bits(3, 0x1F) << 1))
        }
        // POP with pc, BX lr
        0xBD00..=0xBDFF | 0x4770 => Flow::Return,
        // BX, BLX; MOV and ADD to pc
        half if matches!(half & 0xFF87, 0x4700 | 0x4780 | 0x4487 | 0x4687) => Flow::Unknown,
        // LDM with pc, of the stack or not
        half if half & 0xFE50 == 0xE810 && second & 0x8000 != 0 => match half {
            0xE8BD => Flow::Return,
            _ => Flow::Unknown,
        },
        // LDR to pc, of the stack or not
        half if half & 0xFF70 == 0xF850 && second >> 12 == 0xF => match (half, second) {
            (0xF85D, 0xFB04) => Flow::Return,
            _ => Flow::Unknown,
        },
        // TBB, TBH
        half if half & 0xFFF0 == 0xE8D0 && second & 0xFFE0 == 0xF000 => Flow::Unknown,
        half if half >> 11 == 0b11110 => match second & 0xD000 {
            0x9000 => thumb::wide_branch(first, second, at).map_or(Flow::Unknown, Flow::Jump),
            0xD000 => thumb::wide_branch(first, second, at).map_or(Flow::Unknown, Flow::Call),
            // B.W, conditional; conditions from 14 on are other instructions.
            0x8000 if half >> 6 & 0xF < 14 => {
                let bit = |n: u32| i32::from(second >> n & 1);
                let offset = first_bits(10, 1) << 20
                    | bit(11) << 19
                    | bit(13) << 18
                    | first_bits(0, 0x3F) << 12
                    | i32::from(second & 0x7FF) << 1;
                Flow::Perhaps(to(offset << 11 >> 11))
            }
            _ => Flow::On,
        },
        _ => Flow::On,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn control_flow_of_instructions_agrees_with_the_manual() {
        // From the listing of an image: instruction, address, halves.
        for (what, at, first, second, flow) in [
            ("bne +0x24", 0x8000C94, 0xD112, 0, Flow::Perhaps(0x8000CBC)),
            ("bhs -0x96", 0x8000EEE, 0xD2B5, 0, Flow::Perhaps(0x8000E5C)),
            ("b +0x124", 0x8000CFA, 0xE092, 0, Flow::Jump(0x8000E22)),
            ("b -4", 0x100, 0xE7FE, 0, Flow::Jump(0x100)),
            (
                "cbnz r3, +6",
                0x8000E6E,
                0xB91B,
                0,
                Flow::Perhaps(0x8000E78),
            ),
            (
                "cbz r2, +0x66",
                0x8004140,
                0xB39A,
                0,
                Flow::Perhaps(0x80041AA),
            ),
            ("beq.w +0", 0x200, 0xF000, 0x8000, Flow::Perhaps(0x204)),
            (
                "bhi.w -0x13e",
                0x8000F94,
                0xF63F,
                0xAF61,
                Flow::Perhaps(0x8000E5A),
            ),
            ("bl to itself", 0x300, 0xF7FF, 0xFFFE, Flow::Call(0x300)),
            (
                "b.w -0xa8",
                0x8004268,
                0xF7FF,
                0xBFAC,
                Flow::Jump(0x80041C4),
            ),
            ("pop {r7, pc}", 0, 0xBD80, 0, Flow::Return),
            ("pop.w {r8, pc}", 0, 0xE8BD, 0x8100, Flow::Return),
            ("pop.w {r8-r11}", 0, 0xE8BD, 0x0F00, Flow::On),
            ("ldr pc, [sp], #4", 0, 0xF85D, 0xFB04, Flow::Return),
            ("ldr.w r2, [r1], #4", 0, 0xF851, 0x2B04, Flow::On),
            ("bx lr", 0, 0x4770, 0, Flow::Return),
            ("blx r3", 0, 0x4798, 0, Flow::Unknown),
            ("tbb [pc, r0]", 0, 0xE8DF, 0xF000, Flow::Unknown),
            ("strd r3, r1, [r9, #512]", 0, 0xE9C9, 0x3180, Flow::On),
            ("vmrs APSR_nzcv, fpscr", 0, 0xEEF1, 0xFA10, Flow::On),
            ("dmb", 0, 0xF3BF, 0x8F5F, Flow::On),
        ] {
            assert_eq!(decode([first, second], at), flow, "{what}");
        }
    }

    #[test]
    fn conditional_return_has_two_successors_and_literals_are_not_code() {
        // it eq; bxeq lr; movs r0, #1; bx lr; literal that would be a jump
        let halves: [u16; 5] = [0xBF08, 0x4770, 0x2001, 0x4770, 0xE000];
        let code: Vec<u8> = halves.iter().flat_map(|half| half.to_le_bytes()).collect();
        let flows: Vec<Flow> = of(0x40, &code).values().map(|one| one.flow).collect();
        assert_eq!(
            flows,
            [Flow::On, Flow::PerhapsReturn, Flow::On, Flow::Return]
        );
    }
}
