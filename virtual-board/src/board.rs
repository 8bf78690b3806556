//! The controller board: an STM32F42x with a DAC, its crystal, its supply.

use std::num::{NonZeroU32, NonZeroU64};

use rigless::device::{ErasedDevice, ResetCause};
use rigless::machine::{Board, Target, armv7m};
use rigless::mcu::{Mcu, Operate};
use rigless::snapshot::Store;
use rigless::soc::stm32f427::Stm32f427;
use rigless::soc::stm32f427::generated::rcc::{
    Register,
    cr::{HSEON, HSERDY},
    csr::BORRSTF,
};
use rigless::soc::{Bus, Error};
use rigless::time::VirtualNanos;

use crate::adc::{Adc, Common};
use crate::dac::Dac;
use crate::flash::{FlashInterface, MemoryMap};

const NAME: &str = "limpid";

/// Core clock, Hz.
pub const CORE_HZ: u64 = 168_000_000;

/// The emulated microcontroller with models of DAC and ADC, which the emulator does not have, and one of
/// the flash interface that programs.
#[derive(Debug)]
pub struct Part {
    /// The emulator's models of the other peripherals.
    pub stm32: Stm32f427,
    /// Whether the next reset is one of the brown-out detector, which the emulator does not model.
    pub(crate) brown_out: bool,
    dac: Dac,
    dac_slot: usize,
    /// Converters of the large and the small current monitor and of the supply, with their slots.
    adcs: [(Adc, usize); 3],
    adc_common: (Common, usize),
    pub(crate) flash: FlashInterface,
    flash_slot: usize,
    rcc_slot: usize,
}

impl Part {
    /// Codes on PA4 and PA5.
    #[must_use]
    pub(crate) fn dac_codes(&self) -> [Option<u16>; 2] {
        Dac::codes(self.stm32.bus().slots()[self.dac_slot].registers())
    }

    /// Levels on PA4 and PA5 with these loads to ground, ohm, as codes.
    pub(crate) fn dac_levels(&self, load_ohm: [f64; 2]) -> [Option<f64>; 2] {
        Dac::levels(
            self.stm32.bus().slots()[self.dac_slot].registers(),
            load_ohm,
        )
    }

    /// Sets the levels on the current monitors and on the divider of the supply, codes; `None` for a pin
    /// that is not analogue.
    pub(crate) fn drive_analog(&mut self, levels: [Option<f64>; 3]) {
        for ((adc, _), level) in self.adcs.iter_mut().zip(levels) {
            adc.drive(level);
        }
    }
}

impl Part {
    /// As [`FlashInterface::store`].
    pub(crate) fn store_to_flash(&mut self, now_ns: u64, offset: u32, bytes: &[u8]) -> u64 {
        let slot = self.stm32.bus_mut().slot_mut(self.flash_slot);
        self.flash
            .store(now_ns, offset, bytes, slot.registers_mut())
    }

    /// Starts a crystal that did not run, at this frequency.
    pub(crate) fn start_crystal(&mut self, hz: u64) {
        self.stm32.rcc.attach_crystals(hz, 0);
        let (_, registers) = self.stm32.clocks();
        let on = registers.get(Register::Cr) & HSEON.mask();
        if on != 0 {
            registers.restore(Register::Cr, HSERDY.mask(), HSERDY.mask());
        }
    }
}

impl Mcu for Part {
    fn bus(&self) -> &Bus {
        self.stm32.bus()
    }

    fn bus_mut(&mut self) -> &mut Bus {
        self.stm32.bus_mut()
    }

    fn reset(&mut self, at: VirtualNanos, cause: ResetCause) {
        self.stm32.reset(at, cause);
        for (adc, _) in &mut self.adcs {
            adc.reset();
        }
        let flash = self.stm32.bus_mut().slot_mut(self.flash_slot);
        self.flash.reset(flash.registers_mut());
        if std::mem::take(&mut self.brown_out) {
            let (_, registers) = self.stm32.clocks();
            let flag = BORRSTF.mask();
            registers.restore(Register::Csr, flag, flag);
        }
    }

    fn poll(&mut self, now: VirtualNanos) {
        self.stm32.poll(now);
    }

    fn split(&mut self, slot: usize) -> (&mut Bus, Option<&mut dyn ErasedDevice>) {
        if slot == self.rcc_slot && self.stm32.rcc.crystals().0 == 0 {
            // The emulator reports an oscillator without a crystal as ready.
            let (_, registers) = self.stm32.clocks();
            registers.restore(Register::Cr, HSERDY.mask(), 0);
        }
        let models: [(usize, &mut dyn ErasedDevice); 6] = {
            let [
                (large, large_slot),
                (small, small_slot),
                (supply, supply_slot),
            ] = &mut self.adcs;
            let (common, common_slot) = &mut self.adc_common;
            [
                (self.dac_slot, &mut self.dac),
                (*large_slot, large),
                (*small_slot, small),
                (*supply_slot, supply),
                (*common_slot, common),
                (self.flash_slot, &mut self.flash),
            ]
        };
        if let Some((_, model)) = models.into_iter().find(|(of, _)| *of == slot) {
            return (self.stm32.bus_mut(), Some(model));
        }
        self.stm32.split(slot)
    }
}

/// The board. Snapshots are not supported: every run starts from reset.
#[derive(Debug)]
pub struct ControllerBoard {
    /// The microcontroller.
    pub part: Part,
    memory: MemoryMap,
    instructions_per_second: NonZeroU64,
}

impl Store for ControllerBoard {}

impl ControllerBoard {
    /// A board whose crystal oscillates at `crystal_hz` (0: the crystal does not run) and whose
    /// core retires `instructions_per_second` of virtual time.
    ///
    /// # Errors
    /// The emulator's error on a microcontroller that cannot be assembled.
    pub fn new(crystal_hz: u64, instructions_per_second: NonZeroU64) -> Result<Self, Error> {
        let mut stm32 = Stm32f427::new()?;
        stm32.rcc.attach_crystals(crystal_hz, 0);
        stm32.set_supply(3300);
        let dac_slot = stm32.bus().slot("DAC")?;
        let rcc_slot = stm32.bus().slot("RCC")?;
        let flash_slot = stm32.bus().slot("FLASH")?;
        let bus = stm32.bus();
        // PA3 is channel 3, PC0 channel 10, PF3 channel 9.
        let adcs = [
            (Adc::new(3), bus.slot("ADC1")?),
            (Adc::new(10), bus.slot("ADC2")?),
            (Adc::new(9), bus.slot("ADC3")?),
        ];
        let adc_common = (Common, bus.slot("C_ADC")?);
        Ok(Self {
            memory: MemoryMap::new()?,
            part: Part {
                stm32,
                brown_out: false,
                dac: Dac,
                dac_slot,
                adcs,
                adc_common,
                flash: FlashInterface::new(),
                flash_slot,
                rcc_slot,
            },
            instructions_per_second,
        })
    }
}

impl Board for ControllerBoard {
    fn name(&self) -> &'static str {
        NAME
    }

    fn target_names(&self) -> Vec<&'static str> {
        vec![NAME]
    }

    fn mcu(&mut self, target: usize) -> Option<&mut dyn Mcu> {
        (target == 0).then_some(&mut self.part)
    }

    fn targets(&mut self) -> Vec<Target<'_>> {
        let lines = u32::from(self.part.cpu().interrupt_lines);
        let core = armv7m::Core {
            variant: armv7m::Variant::M4,
            clock_hz: NonZeroU64::new(CORE_HZ).expect("not zero"),
            interrupt_lines: NonZeroU32::new(lines).expect("a part with interrupts"),
            priority_bits: 4,
            refclk_divider: NonZeroU32::new(8).expect("not zero"),
            instructions_per_second: self.instructions_per_second,
            boot: "flash",
        }
        .spec_with_parts(
            &rigless::cpu::armv7m::windows(self.part.bus()),
            armv7m::Fpu::FpV4Sp,
            armv7m::MpuRegions::Eight,
        );
        // The emulator takes the memory of the core from here, and everything else from `mcu`.
        vec![Target::new(NAME, &mut self.memory, core)]
    }
}
