//! The part of the Thumb-2 encoding that is needed to follow calls and to estimate cycles.

/// Whether an instruction that begins with this half is four bytes long.
#[must_use]
pub const fn is_wide(half: u16) -> bool {
    half >> 11 >= 0b1_1101
}

/// Bytes of the instruction of these halves.
#[must_use]
pub const fn length([first, _]: [u16; 2]) -> u64 {
    if is_wide(first) { 4 } else { 2 }
}

/// Addresses and both halves of the instructions in `code`; literals in it are decoded as
/// instructions too.
pub fn instructions(
    base: u64,
    code: &[u8],
) -> impl Iterator<Item = (u64, [u16; 2])> + Clone + use<> {
    let halves: Vec<u16> = code
        .as_chunks()
        .0
        .iter()
        .map(|pair| u16::from_le_bytes(*pair))
        .collect();
    let mut k = 0;
    std::iter::from_fn(move || {
        let first = *halves.get(k)?;
        let second = halves.get(k + 1).copied().unwrap_or(0);
        let address = base + 2 * k as u64;
        k += if is_wide(first) { 2 } else { 1 };
        Some((address, [first, second]))
    })
}

/// Targets of direct branches and calls in `code`.
pub fn branches(base: u64, code: &[u8]) -> impl Iterator<Item = u64> {
    instructions(base, code).filter_map(|(at, [first, second])| wide_branch(first, second, at))
}

/// Target of an unconditional wide branch or call (encodings T4 of B and T1 of BL).
#[must_use]
pub(crate) fn wide_branch(first: u16, second: u16, here: u64) -> Option<u64> {
    if first >> 11 != 0b11110 || !matches!(second >> 12 & 0b1101, 0b1001 | 0b1101) {
        return None;
    }
    let bit = |word: u16, n: u32| u32::from(word >> n & 1);
    let s = bit(first, 10);
    let i1 = 1 ^ bit(second, 13) ^ s;
    let i2 = 1 ^ bit(second, 11) ^ s;
    let offset = s << 24
        | i1 << 23
        | i2 << 22
        | u32::from(first & 0x3FF) << 12
        | u32::from(second & 0x7FF) << 1;
    let offset = i64::from((offset << 7) as i32 >> 7);
    here.checked_add_signed(4 + offset)
}

/// Addresses after each call through a register.
#[must_use]
pub fn after_indirect_calls(base: u64, code: &[u8]) -> Vec<u64> {
    instructions(base, code)
        .filter(|(_, [first, _])| first & 0xFF87 == 0x4780)
        .map(|(at, _)| at + 2)
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn code(halves: &[u16]) -> Vec<u8> {
        halves.iter().flat_map(|half| half.to_le_bytes()).collect()
    }

    #[test]
    fn calls_are_decoded_in_both_directions() {
        // push {r7, lr}; bl forwards by 0x2C40; bl to itself; beq.w; movw r0, #0x4780; blx r3
        let code = code(&[
            0xB580, 0xF002, 0xFE20, 0xF7FF, 0xFFFE, 0xF000, 0x8000, 0xF244, 0x7080, 0x4798,
        ]);
        let targets: Vec<u64> = branches(0x65E, &code).collect();
        assert_eq!(targets, [0x660 + 4 + 0x2C40, 0x664]);
        assert_eq!(after_indirect_calls(0x65E, &code), [0x65E + 20]);
    }
}
