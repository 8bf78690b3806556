//! The flash image: its bytes, and the addresses that the virtual board needs.

use std::collections::BTreeMap;
use std::ffi::OsStr;
use std::fs::{self, File};
use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::Arc;

use haptic_control::SceneKind;
use object::read::Symbol;
use object::{Object, ObjectSection, ObjectSymbol};

use crate::code::Code;
use crate::pieces::Pieces;
use crate::thumb::instructions;

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
    /// The instructions that the control task reaches.
    pub(crate) control: Arc<Pieces>,
    /// The instruction with which the task of lowest priority waits for an interrupt.
    pub(crate) wait: u64,
    /// An instruction that branches to itself.
    pub(crate) for_ever: u64,
    /// First instruction of the function that a failed assertion calls and that panics.
    pub(crate) panic: u64,
    /// Memory of the stack: lowest address, and the address after its end.
    pub(crate) stack: [u64; 2],
    /// Code and data.
    pub size: Size,
}

/// Sizes of an image, bytes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Size {
    /// Code, constants and vectors, without the initial values of data.
    pub text: u64,
    /// Data with initial values, which are also stored in flash.
    pub data: u64,
    /// Data that starts as zero or uninitialised.
    pub bss: u64,
}

/// The control tick's interrupt handler.
const CONTROL: &str = "TIM5";

/// Part of the symbol of the task of lowest priority.
const IDLE: &str = "3app4idle";

/// Part of the symbol of the function in which an emergency ends.
const EMERGENCY: &str = "9emergency4stop";

/// The function that a failed assertion of the firmware calls. It has no argument and panics.
const PANIC: &str = "_defmt_panic";

/// Wait for interrupt.
const WFI: u16 = 0xBF30;

/// Branch to itself.
const LOOP: u16 = 0xE7FE;

/// Command that builds the image, for messages.
pub const HOW_TO_BUILD: &str =
    "cargo build --profile firmware --package firmware --target thumbv7em-none-eabihf";

/// Folder of the tests' builds, from the top of the project, and their target.
const BUILT_IN: &str = "target/firmware-image";
const TARGET: &str = "thumbv7em-none-eabihf";

/// A lock of the builds in this folder, held until it is dropped: from the first line of cargo until the image
/// is read.
fn alone(target: &Path) -> Result<File, String> {
    let path = target.join("image.lock");
    let locked = fs::create_dir_all(target)
        .and_then(|()| File::create(&path))
        .and_then(|file| file.lock().map(|()| file));
    locked.map_err(|error| format!("{}: {error}", path.display()))
}

impl Image {
    /// Builds the firmware of this repository with these features, separated by commas, and reads
    /// it. The build has its own target directory, so that other builds do not wait for it.
    ///
    /// # Errors
    /// One line if cargo cannot build it.
    pub fn build(features: &str) -> Result<Self, String> {
        Self::build_with(features, &[])
    }

    /// Builds and reads an image with one scene.
    ///
    /// # Errors
    /// As [`Self::build`].
    pub fn build_one(scene: SceneKind) -> Result<Self, String> {
        Self::build_with("", &[("SCENE", scene.name().as_ref())])
    }

    /// The file that all builds write.
    #[must_use]
    pub fn built() -> PathBuf {
        let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
        root.join(BUILT_IN).join(TARGET).join("firmware/firmware")
    }

    /// As [`Self::build`], with environment variables: `SCENE` names the one scene of the image, `RATE` is
    /// the control rate in Hz, `DEVICE` and `PRESETS` name the files that it is built for. All builds write
    /// the same file: one waits for another, in whatever process.
    ///
    /// # Errors
    /// As [`Self::build`]; one line if the folder of the build cannot be written.
    pub fn build_with(features: &str, variables: &[(&str, &OsStr)]) -> Result<Self, String> {
        let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
        let target: PathBuf = root.join(BUILT_IN);
        let _alone = alone(&target)?;
        let cargo = std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into());
        let status = Command::new(cargo)
            .current_dir(&root)
            .args(["build", "--quiet", "--profile", "firmware"])
            .args(["--package", "firmware", "--features", features])
            .args(["--target", TARGET, "--target-dir"])
            .arg(&target)
            .env("SCENE", "")
            .env("RATE", "")
            .envs(variables.iter().copied())
            .status()
            .map_err(|error| format!("cargo does not start: {error}"))?;
        if !status.success() {
            return Err(format!(
                "firmware with '{features}' and {variables:?} does not build"
            ));
        }
        Self::read(&Self::built())
    }

    /// Reads an ELF file.
    ///
    /// # Errors
    /// One line with a remedy, if the file is missing or is not an image of this firmware.
    pub fn read(path: &Path) -> Result<Self, String> {
        let elf = fs::read(path).map_err(|error| {
            format!(
                "no image at {}: {error}; build it with `{HOW_TO_BUILD}`",
                path.display()
            )
        })?;
        Self::parse(path, elf).map_err(|error| {
            format!(
                "{}: not an image of this firmware: {error}; build one with `{HOW_TO_BUILD}`",
                path.display()
            )
        })
    }

    /// The bytes of the file.
    #[must_use]
    pub fn elf(&self) -> &[u8] {
        &self.elf
    }

    /// The handlers of exceptions by the address of their first instruction, each with its number,
    /// the lowest one of several, without the reset.
    pub(crate) fn handlers(&self) -> BTreeMap<u64, u16> {
        let file = object::File::parse(&*self.elf).ok();
        let table = file.as_ref().and_then(|file| {
            let section = file.section_by_name(".vector_table")?;
            section.data().ok()
        });
        let (words, _) = table.unwrap_or_default().as_chunks();
        let words = words.iter().map(|word| u32::from_le_bytes(*word));
        let mut handlers = BTreeMap::new();
        for (number, word) in (0..).zip(words).skip(2).filter(|(_, word)| word & 1 == 1) {
            handlers.entry(u64::from(word & !1)).or_insert(number);
        }
        handlers
    }

    /// A program without telemetry and control task, which ends in a loop at this address.
    #[cfg(test)]
    pub(crate) fn bare(placed: rigless::image::Image, end: u64) -> Self {
        const RAM: u64 = 0x2000_0000;
        Self {
            elf: Vec::new(),
            placed,
            rtt: RAM,
            entry: end,
            exits: Vec::new(),
            control: Arc::default(),
            wait: end,
            for_ever: end,
            panic: end,
            stack: [RAM + 0x800, RAM + 0x1000],
            size: Size {
                text: 0,
                data: 0,
                bss: 0,
            },
        }
    }

    fn parse(path: &Path, elf: Vec<u8>) -> Result<Self, String> {
        let file = object::File::parse(&*elf).map_err(|error| error.to_string())?;
        let symbol = |name: &str| {
            let found = file.symbols().find(|symbol| symbol.name() == Ok(name));
            found.ok_or_else(|| format!("no symbol {name}"))
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
        let idle = idle.ok_or("no task of lowest priority")?;
        let at = idle.address() & !1;
        let wait = instructions(at, code(&file, &idle)?).find(|(_, [first, _])| *first == WFI);
        let wait = wait.ok_or("the task of lowest priority never waits")?.0;
        let emergency = file.symbols().find(|symbol| named(symbol, EMERGENCY));
        let emergency = emergency.ok_or("no end of an emergency")?;
        let at = emergency.address() & !1;
        let mut for_ever = instructions(at, code(&file, &emergency)?);
        let for_ever = for_ever.find(|(_, [first, _])| *first == LOOP);
        let for_ever = for_ever.ok_or("an emergency ends")?.0;
        let panic = symbol(PANIC)?.address() & !1;
        let stack = [symbol("_stack_end")?, symbol("_stack_start")?].map(|symbol| symbol.address());
        let size = size(&file);
        let all = Code::of(&file).map_err(|error| error.to_string())?;
        let placed = rigless::image::Image::new(path, elf.clone(), None)
            .map_err(|error| error.to_string())?;
        Ok(Self {
            elf,
            placed,
            rtt,
            entry,
            control: Arc::new(Pieces::reached(&all, entry, &exits)),
            exits,
            wait,
            for_ever,
            panic,
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

/// Addresses of the instructions in `code` that return: `bx lr`, `pop {.., pc}` in both widths.
fn returns(base: u64, code: &[u8]) -> Vec<u64> {
    let leaves = |[first, second]: [u16; 2]| match first {
        0xE8BD => second & 0x8000 != 0,
        // ldr pc, [sp], #4
        0xF85D => second == 0xFB04,
        narrow => narrow == 0x4770 || narrow & 0xFF00 == 0xBD00,
    };
    let leaving = instructions(base, code).filter(|(_, halves)| leaves(*halves));
    leaving.map(|(at, _)| at).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn file_that_is_not_an_image_is_refused_with_a_remedy() {
        let path = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/Cargo.toml"));
        let Err(said) = Image::read(path) else {
            panic!("taken for an image");
        };
        assert!(
            said.contains("Cargo.toml: not an image")
                && said.ends_with(&format!("`{HOW_TO_BUILD}`")),
            "{said}"
        );
    }

    #[test]
    fn returns_are_found_and_not_inside_wide_instructions() {
        // push {r7, lr}; movw r0, #0x4770 as a second half; pop {r7, pc}; bx lr;
        // ldmia.w sp!, {r4, pc}
        let halves = [0xB580_u16, 0xF240, 0x4770, 0xBD80, 0x4770, 0xE8BD, 0x8010];
        let code: Vec<u8> = halves.iter().flat_map(|half| half.to_le_bytes()).collect();
        assert_eq!(returns(0x100, &code), [0x106, 0x108, 0x10A]);
    }
}
