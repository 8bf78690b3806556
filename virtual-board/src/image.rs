//! The flash image: its bytes, and where in it the things are that a probe needs to know.

use std::path::Path;

use object::{Object, ObjectSection, ObjectSymbol};

/// A built firmware image.
#[derive(Clone, Debug)]
pub struct Image {
    pub(crate) elf: Vec<u8>,
    pub(crate) placed: rigless::image::Image,
    pub(crate) rtt: u64,
    /// First instruction of the control task.
    pub(crate) entry: u64,
    /// Instructions that leave the control task.
    pub(crate) exits: Vec<u64>,
}

/// The control tick's interrupt handler.
const CONTROL: &str = "TIM5";

/// How to build the image, said where it is missing.
pub const HOW_TO_BUILD: &str =
    "cargo build --release --package firmware --target thumbv7em-none-eabihf";

impl Image {
    /// Reads an ELF file.
    ///
    /// # Errors
    /// One line, with what to do, on a file that is not there or not a firmware image of ours.
    pub fn read(path: &Path) -> Result<Self, String> {
        let elf = std::fs::read(path).map_err(|error| {
            format!(
                "no image at {}: {error}; build it with `{HOW_TO_BUILD}`",
                path.display()
            )
        })?;
        Self::parse(path, elf).map_err(|error| format!("{}: {error}", path.display()))
    }

    /// The file.
    #[must_use]
    pub fn elf(&self) -> &[u8] {
        &self.elf
    }

    fn parse(path: &Path, elf: Vec<u8>) -> Result<Self, String> {
        let file = object::File::parse(&*elf).map_err(|error| error.to_string())?;
        let symbol = |name: &str| {
            let found = file.symbols().find(|symbol| symbol.name() == Ok(name));
            found.ok_or_else(|| format!("no symbol {name}: not an image of this firmware"))
        };
        let rtt = symbol("_SEGGER_RTT")?.address();
        let control = symbol(CONTROL)?;
        let entry = control.address() & !1;
        let section = control
            .section_index()
            .and_then(|index| file.section_by_index(index).ok())
            .ok_or("the control task is in no section")?;
        let code = section
            .data_range(entry, control.size())
            .map_err(|error| error.to_string())?
            .ok_or("the control task has no code")?;
        let exits = returns(entry, code);
        if exits.is_empty() {
            return Err("the control task never returns".to_owned());
        }
        let placed = rigless::image::Image::new(path, elf.clone(), None)
            .map_err(|error| error.to_string())?;
        Ok(Self {
            elf,
            placed,
            rtt,
            entry,
            exits,
        })
    }
}

/// Addresses of the instructions in `code` that return: `bx lr`, `pop {.., pc}` in both widths.
fn returns(base: u64, code: &[u8]) -> Vec<u64> {
    let halves: Vec<u16> = code
        .as_chunks()
        .0
        .iter()
        .map(|pair| u16::from_le_bytes(*pair))
        .collect();
    let mut found = Vec::new();
    let mut k = 0;
    while k < halves.len() {
        let wide = halves[k] >> 11 >= 0b11101;
        let second = halves.get(k + 1).copied().unwrap_or(0);
        let leaves = match halves[k] {
            0x4770 => true,
            narrow if narrow & 0xFF00 == 0xBD00 => true,
            0xE8BD => second & 0x8000 != 0,
            // ldr pc, [sp], #4
            0xF85D => second == 0xFB04,
            _ => false,
        };
        if leaves {
            found.push(base + 2 * k as u64);
        }
        k += if wide { 2 } else { 1 };
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn returns_are_found_and_not_inside_wide_instructions() {
        // push {r7, lr}; movw r0, #0x4770 as a second half; pop {r7, pc}; bx lr;
        // ldmia.w sp!, {r4, pc}
        let halves = [0xB580_u16, 0xF240, 0x4770, 0xBD80, 0x4770, 0xE8BD, 0x8010];
        let code: Vec<u8> = halves.iter().flat_map(|half| half.to_le_bytes()).collect();
        assert_eq!(returns(0x100, &code), [0x106, 0x108, 0x10A]);
    }
}
