//! Objections of the emulator to a run: accesses that it does not model, and conditions that its
//! models of clocks and flash report.

use rigless::session::Session;
use terminal::failure::Failure;

use crate::board::ControllerBoard;

/// One line for each access without a register, each access that a closed clock gate or a model
/// refuses, each access to a register without a model, each interrupt without a line, and each
/// condition that a model reports. No objection is allowed. DAC and ADC, which the emulator does not
/// have, have models in this crate.
pub(crate) fn of(session: &Session<ControllerBoard>) -> Vec<String> {
    let unmapped = session.unmapped().into_iter().map(|one| {
        format!(
            "unmapped: no register at {:#010x}, accessed from {:#010x}",
            one.address, one.program_counter
        )
    });
    let refused = session.refused().iter();
    let refused = refused.map(|(address, fault)| format!("refused: {address:#010x}, {fault}"));
    let unmodelled = session.unimplemented().iter().map(|(address, one)| {
        format!(
            "unimplemented: {}.{} at {address:#010x} has no model; {} reads, {} writes, the first from {:#010x}",
            one.instance, one.register, one.reads, one.writes, one.program_counter
        )
    });
    let undefined = session.undefined().iter().map(|(address, one)| {
        format!(
            "undefined: {} has no register at {address:#010x}; {} reads, {} writes, the first from {:#010x}",
            one.instance, one.reads, one.writes, one.program_counter
        )
    });
    let unrouted = session.unrouted().iter();
    let unrouted = unrouted
        .map(|(instance, line)| format!("unrouted: the core has no line {line} for {instance}"));
    let told = session.told().map(|one| {
        format!(
            "condition: {}.{} at {} ns, {}",
            one.instance, one.register, one.at.0, one.reason
        )
    });
    unmapped
        .chain(refused)
        .chain(unmodelled)
        .chain(undefined)
        .chain(unrouted)
        .chain(told)
        .collect()
}

/// Fails if the emulator has an objection.
pub(crate) fn verdict(objections: &[String]) -> Result<(), Failure> {
    if objections.is_empty() {
        return Ok(());
    }
    let all = objections.join("; ");
    Err(Failure::Check(format!(
        "the emulator objects to the run: {all}"
    )))
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use super::verdict;

    use crate::image::Image;
    use crate::run::{Setup, emulate};

    /// A program that writes each value to its address, reads it back and waits 100 us.
    fn program(writes: &[(u32, u32)]) -> Image {
        const FLASH: u32 = 0x0800_0000;
        const CODE: [u16; 12] = [
            0xA007, // 0x40: adr r0, 0x60
            0xC806, // 0x42: ldmia r0!, {r1, r2}
            0x2900, // 0x44: cmp r1, #0
            0xD006, // 0x46: beq 0x56
            0x600A, // 0x48: str r2, [r1]
            0x680B, // 0x4a: ldr r3, [r1]
            0x24FF, // 0x4c: movs r4, #255
            0x0164, // 0x4e: lsls r4, r4, #5
            0x3C01, // 0x50: subs r4, #1
            0xD1FD, // 0x52: bne 0x50
            0xE7F5, // 0x54: b 0x42
            0xE7FE, // 0x56: b 0x56
        ];
        let mut bytes = [0x2000_1000, FLASH + 0x41].map(u32::to_le_bytes).concat();
        bytes.resize(0x40, 0);
        bytes.extend(CODE.iter().flat_map(|half| half.to_le_bytes()));
        bytes.resize(0x60, 0);
        for (address, value) in writes.iter().chain(&[(0, 0)]) {
            bytes.extend([*address, *value].map(u32::to_le_bytes).concat());
        }
        let end = u64::from(FLASH) + 0x56;
        let placed = rigless::image::Image::new(Path::new("program"), bytes, Some(FLASH.into()));
        Image::bare(placed.unwrap(), end)
    }

    fn objections(writes: &[(u32, u32)]) -> Vec<String> {
        let setup = Setup {
            seconds: 2e-3,
            ..Setup::default()
        };
        let (session, ..) = emulate(&program(writes), &setup, None, |_| ()).unwrap();
        super::of(&session)
    }

    const AHB1_CLOCKS: (u32, u32) = (0x4002_3830, 0x10);
    const AHB2_CLOCKS: (u32, u32) = (0x4002_3834, 1 << 6);

    #[test]
    fn access_to_a_modelled_register_is_accepted() {
        assert_eq!(objections(&[AHB1_CLOCKS, (0x4002_1000, 1)]), [""; 0]);
    }

    #[test]
    fn unmodelled_accesses_are_reported() {
        for (writes, kind, named) in [
            // Between two blocks.
            (&[(0x4008_0000, 0)][..], "unmapped", "0x40080000"),
            // No clock: on the chip the write is lost and the read is 0.
            (&[(0x4000_0400, 1)], "refused", "TIM3"),
            (&[AHB2_CLOCKS, (0x5006_0800, 4)], "unimplemented", "RNG"),
            // In a block, behind its last register.
            (&[(0x4002_3C80, 0)], "unmapped", "0x40023c80"),
        ] {
            let found = objections(writes);
            assert_eq!(found.len(), 1, "{kind}: {found:?}");
            assert!(
                found[0].starts_with(kind) && found[0].contains(named),
                "{kind}: {found:?}"
            );
        }
    }

    /// 96 MHz from the internal oscillator, and no wait state of the flash.
    #[test]
    fn core_clock_above_the_flash_limit_is_reported() {
        let pll_on = (0x4002_3800, 0x0100_0083);
        let found = objections(&[pll_on, pll_on, pll_on, pll_on, pll_on, (0x4002_3808, 2)]);
        assert_eq!(found.len(), 1, "{found:?}");
        let failure = verdict(&found).unwrap_err();
        assert_eq!(failure.status(), 1);
        assert!(failure.to_string().ends_with(&found[0]), "{failure}");
        assert!(
            found[0].starts_with("condition: FLASH.") && found[0].contains("LATENCY"),
            "{found:?}"
        );
    }
}
