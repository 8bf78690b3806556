//! Estimated cycles of Cortex-M4 instructions, from the Technical Reference Manual, table 3-1, and
//! the table of the FPU. The estimate has no flash wait states and no waits for results.

/// A taken branch refills the pipeline: one to three cycles, here two.
const REFILL: u32 = 2;

/// Cycles of interrupt entry and return: 12 and 10, and 17 more each for the registers of an
/// interrupted task that uses the FPU.
pub(crate) const INTERRUPT: u32 = 12 + 10 + 2 * 17;

/// Cycles of the instruction of these halves; `taken` if it branches.
#[must_use]
pub fn of(first: u16, second: u16, taken: bool) -> u32 {
    let refill = if taken { REFILL } else { 0 };
    let registers = |list: u16| list.count_ones();
    let wide_load = first & 0x0010 != 0;
    refill
        + match first {
            // push, pop; ldm, stm
            half if half & 0xF600 == 0xB400 => 1 + registers(half & 0x1FF),
            half if half & 0xF000 == 0xC000 => 1 + registers(half & 0xFF),
            // Loads and stores of 16 bits: literal, register offset, immediate, stack.
            half if matches!(half >> 11, 0b0_1001..=0b1_0011) => 2,
            // ldm, stm, push, pop in 32 bits; then ldrd and strd
            half if half & 0xFE40 == 0xE800 => 1 + registers(second),
            half if half & 0xFE40 == 0xE840 => 3,
            // vldr and vstr; vldm and vstm of single registers
            half if half & 0xFE00 == 0xEC00 => match half & 0x0120 {
                0x0100 => 2,
                _ if half & 0x0FE0 == 0x0C40 => 2,
                _ => 1 + u32::from(second & 0xFF),
            },
            // Single loads and stores of 32 bits.
            half if half & 0xFE00 == 0xF800 => {
                if wide_load {
                    2
                } else {
                    1
                }
            }
            // mla, mls; smull and the like; sdiv and udiv (2 to 12)
            half if half & 0xFF80 == 0xFB00 => 1 + u32::from(second >> 12 != 0xF),
            half if matches!(half & 0xFFF0, 0xFB90 | 0xFBB0) => 12,
            // vdiv, vmla
            half if half & 0xFFB0 == 0xEE80 => 14,
            half if half & 0xFFB0 == 0xEE00 => 3,
            _ => 1,
        }
}

#[cfg(test)]
mod tests {
    use super::of;

    #[test]
    fn costs_agree_with_the_manual() {
        // From the listing of an image: instruction, halves, cycles.
        for (what, first, second, cycles) in [
            ("adds r0, #1", 0x3001, 0, 1),
            ("ldr r2, [r0, #4]", 0x6842, 0, 2),
            ("push {r4, r5, r6, r7, lr}", 0xB5F0, 0, 6),
            ("ldr r2, [r1], #4", 0xF851, 0x2B04, 2),
            ("ldrd r12, r11, [r0]", 0xE9D0, 0xCB00, 3),
            ("mul r2, r5, r11", 0xFB05, 0xF20B, 1),
            ("mls r8, r4, r12, r2", 0xFB04, 0x281C, 2),
            ("sdiv r4, r2, r10", 0xFB92, 0xF4FA, 12),
            ("vldr s0, [r0, #4]", 0xED90, 0x0A01, 2),
            ("vadd.f32 s0, s0, s2", 0xEE30, 0x0A01, 1),
            ("vmla.f32 s0, s4, s6", 0xEE02, 0x0A03, 3),
            ("vdiv.f32 s0, s2, s0", 0xEE81, 0x0A00, 14),
        ] {
            assert_eq!(of(first, second, false), cycles, "{what}");
        }
        assert_eq!(of(0xE7FE, 0, true), 3, "b");
    }
}
