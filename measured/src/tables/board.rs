//! Tables of the images and of the virtual board.

use crate::Table;

/// Run time of an update against the error of the velocity.
pub const PARETO: Table = Table {
    name: "pareto",
    page: "docs/benchmarks.md",
    columns: &[
        ("estimator", "estimator"),
        ("mean_3", "mean, `3`"),
        ("most_3", "most, `3`"),
        ("at_rest_3", "at rest, `3`"),
        ("mean_s", "mean, `s`"),
        ("most_s", "most, `s`"),
        ("cycles_3", "cycles, `3`"),
        ("code_3", "code, `3`"),
        ("state", "state"),
        ("rms_1khz_rad_s", "RMS, 1 kHz"),
        ("rms_10khz_rad_s", "RMS, 10 kHz"),
        ("front", "front"),
        ("rate_khz", "kHz"),
    ],
    digits: None,
    command: "cargo pareto",
};

/// The control task in every scene.
pub const CONTROL: Table = Table {
    name: "control",
    page: "docs/benchmarks.md",
    columns: &[
        ("scene", "scene"),
        ("estimator", "large motor by"),
        ("instructions_mean", "instructions, mean"),
        ("instructions_most", "most"),
        ("cycles_mean", "cycles, mean"),
        ("cycles_most", "most"),
        ("khz_instructions_mean", "kHz, instructions, mean"),
        ("khz_instructions_most", "most"),
        ("khz_cycles_mean", "kHz, cycles, mean"),
        ("khz_cycles_most", "most"),
    ],
    digits: None,
    command: "cargo pareto",
};

/// The longest path of every update.
pub const BOUNDS: Table = Table {
    name: "bounds",
    page: "docs/benchmarks.md",
    columns: &[
        ("estimator", "estimator"),
        ("bound_3", "bound, `3`"),
        ("most_3", "most seen, `3`"),
        ("bound_s", "bound, `s`"),
        ("most_s", "most seen, `s`"),
    ],
    digits: None,
    command: "cargo test --release --package acceptance --test pareto bound",
};

const BOARD: &str = "cargo test --release --package acceptance --test board";

/// Memory of every image, bytes.
pub const IMAGE_SIZES: Table = Table {
    name: "image-sizes",
    page: "docs/board.md",
    columns: &[
        ("image", "image"),
        ("text_bytes", "text"),
        ("data_bytes", "data"),
        ("bss_bytes", "bss"),
        ("stack_bytes", "stack"),
    ],
    digits: None,
    command: BOARD,
};

/// Code and memory of the controller of one scene alone, bytes.
pub const SCENE_SIZES: Table = Table {
    name: "scene-sizes",
    page: "docs/benchmarks.md",
    columns: &[
        ("scene", "scene"),
        ("text_3_bytes", "text, `3`"),
        ("text_s_bytes", "text, `s`"),
        ("controller_bytes", "controller"),
        ("state_bytes", "state"),
    ],
    digits: None,
    command: "cargo test --release --package acceptance --test core scene",
};

/// Instructions of the control task in the image of one scene alone.
pub const SCENE_INSTRUCTIONS: Table = Table {
    name: "scene-instructions",
    page: "docs/benchmarks.md",
    columns: &[
        ("scene", "scene"),
        ("instructions_mean", "instructions, mean"),
        ("instructions_most", "instructions, most"),
    ],
    digits: None,
    command: BOARD,
};

/// What faults do on the virtual board.
pub const FAULTS: Table = Table {
    name: "faults",
    page: "docs/faults.md",
    columns: &[
        ("fault", "fault"),
        ("description", "what happens"),
        ("off_ms", "off after, ms"),
        ("reset_ms", "reset after, ms"),
        ("force_mn", "force, mN"),
        ("cause", "cause"),
    ],
    digits: None,
    command: BOARD,
};

/// Time until a fault stops a scene while the hand presses, ms.
pub const SCENE_FAULT_TIME: Table = Table {
    name: "scene-fault-time",
    page: "docs/faults.md",
    columns: &[
        ("scene", "scene"),
        ("emergency-stop", "emergency-stop"),
        ("amplifier-fault", "amplifier-fault"),
        ("hung-control", "hung-control"),
        ("stuck-both", "stuck-both"),
        ("swapped", "swapped"),
        ("open-lead", "open-lead"),
        ("small-stuck", "small-stuck"),
        ("small-swapped", "small-swapped"),
        ("small-reversed", "small-reversed"),
        ("small-open-lead", "small-open-lead"),
    ],
    digits: None,
    command: BOARD,
};

/// Largest force of a fault until the amplifiers are off, mN.
pub const SCENE_FAULT_FORCE: Table = Table {
    name: "scene-fault-force",
    ..SCENE_FAULT_TIME
};
