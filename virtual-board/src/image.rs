//! The flash image: its bytes, and where in it the things are that a probe needs to know.

use std::path::Path;

use object::read::Symbol;
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
    /// The instruction with which the task of lowest priority waits for an interrupt.
    pub(crate) wait: u64,
    /// An instruction that branches to itself.
    pub(crate) for_ever: u64,
    /// Memory that the stack may take: its lowest address and the one behind its highest.
    pub(crate) stack: [u64; 2],
    /// Code and data.
    pub size: Size,
}

/// What an image takes, bytes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Size {
    /// Code, constants and vectors, without the initial values of data.
    pub text: u64,
    /// Data with initial values, which are in flash too.
    pub data: u64,
    /// Data that starts as zero or as anything.
    pub bss: u64,
}

/// The control tick's interrupt handler.
const CONTROL: &str = "TIM5";

/// In the name of the task of lowest priority.
const IDLE: &str = "3app4idle";

/// Wait for interrupt.
const WFI: u16 = 0xBF30;

/// Branch to itself.
const LOOP: u16 = 0xE7FE;

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
        let exits = returns(entry, code(&file, &control)?);
        if exits.is_empty() {
            return Err("the control task never returns".to_owned());
        }
        let named = |symbol: &Symbol<'_, '_>, part: &str| {
            symbol.name().is_ok_and(|name| name.contains(part))
        };
        let idle = file.symbols().find(|symbol| named(symbol, IDLE));
        let idle = idle.ok_or("no task of lowest priority: not an image of this firmware")?;
        let at = idle.address() & !1;
        let wait = instructions(code(&file, &idle)?).find(|(_, first, _)| *first == WFI);
        let wait = wait.ok_or("the task of lowest priority never waits")?.0;
        let default = symbol("DefaultHandler_")?;
        let for_ever = instructions(code(&file, &default)?).find(|(_, first, _)| *first == LOOP);
        let for_ever = for_ever.ok_or("the default handler does not loop")?.0;
        let for_ever = (default.address() & !1) + for_ever;
        let stack = [symbol("_stack_end")?, symbol("_stack_start")?].map(|symbol| symbol.address());
        let size = size(&file);
        let placed = rigless::image::Image::new(path, elf.clone(), None)
            .map_err(|error| error.to_string())?;
        Ok(Self {
            elf,
            placed,
            rtt,
            entry,
            exits,
            wait: at + wait,
            for_ever,
            stack,
            size,
        })
    }
}

/// Bytes of a function.
fn code<'a>(file: &object::File<'a>, function: &Symbol<'_, '_>) -> Result<&'a [u8], String> {
    let section = function
        .section_index()
        .and_then(|index| file.section_by_index(index).ok())
        .ok_or("a task is in no section")?;
    section
        .data_range(function.address() & !1, function.size())
        .map_err(|error| error.to_string())?
        .ok_or_else(|| "a task has no code".to_owned())
}

fn size(file: &object::File<'_>) -> Size {
    let of = |wanted: &[&str]| {
        let sections = file.sections();
        let sections = sections.filter(|section| section.name().is_ok_and(|n| wanted.contains(&n)));
        sections.map(|section| section.size()).sum()
    };
    Size {
        text: of(&[".vector_table", ".text", ".rodata"]),
        data: of(&[".data"]),
        bss: of(&[".bss", ".uninit"]),
    }
}

/// Instructions in `code`: offset, first half and, of a wide one, second half.
fn instructions(code: &[u8]) -> impl Iterator<Item = (u64, u16, Option<u16>)> + use<> {
    let halves = code.as_chunks().0.iter();
    let halves: Vec<u16> = halves.map(|pair| u16::from_le_bytes(*pair)).collect();
    let mut k = 0;
    std::iter::from_fn(move || {
        let (at, first) = (k, *halves.get(k)?);
        let second = (first >> 11 >= 0b11101).then(|| halves.get(k + 1).copied().unwrap_or(0));
        k += 1 + usize::from(second.is_some());
        Some((2 * at as u64, first, second))
    })
}

/// Addresses of the instructions in `code` that return: `bx lr`, `pop {.., pc}` in both widths.
fn returns(base: u64, code: &[u8]) -> Vec<u64> {
    let leaves = |first: u16, second: Option<u16>| match (first, second) {
        (0x4770, None) => true,
        (narrow, None) => narrow & 0xFF00 == 0xBD00,
        (0xE8BD, Some(second)) => second & 0x8000 != 0,
        // ldr pc, [sp], #4
        (0xF85D, Some(second)) => second == 0xFB04,
        _ => false,
    };
    let leaving = instructions(code).filter(|(_, first, second)| leaves(*first, *second));
    leaving.map(|(at, ..)| base + at).collect()
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
