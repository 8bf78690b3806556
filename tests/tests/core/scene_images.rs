//! What a scene costs on the board: code and memory of the controller of each scene alone, read
//! from the libraries that the package `scene-images` builds.
//!
//! `UPDATE_GOLDEN=1 cargo test --release --package acceptance scene_images` writes the table in
//! docs/benchmarks.md anew.

use std::path::Path;
use std::sync::LazyLock;

use crate::image::{Image, Reached, build};

/// What a scene needs, as written down here: the types have to say the same.
#[derive(Clone, Copy, PartialEq)]
struct Needs {
    velocity: bool,
    acceleration: bool,
    continuous: bool,
    transient: bool,
    /// Whether it commands the currents itself.
    open_loop: bool,
}

impl Needs {
    const NOTHING: Self = Self {
        velocity: false,
        acceleration: false,
        continuous: false,
        transient: false,
        open_loop: false,
    };
    const SMALL_MOTOR: Self = Self {
        transient: true,
        ..Self::NOTHING
    };
    const BOTH_MOTORS: Self = Self {
        continuous: true,
        ..Self::SMALL_MOTOR
    };
    const VELOCITY: Self = Self {
        velocity: true,
        ..Self::BOTH_MOTORS
    };
    const ACCELERATION: Self = Self {
        acceleration: true,
        ..Self::BOTH_MOTORS
    };
    const EVERYTHING: Self = Self {
        acceleration: true,
        open_loop: true,
        ..Self::VELOCITY
    };
    const OPEN_LOOP: Self = Self {
        open_loop: true,
        ..Self::NOTHING
    };

    /// Whether the other needs all of this and more.
    fn are_part_of(self, other: Self) -> bool {
        self != other
            && self.velocity <= other.velocity
            && self.acceleration <= other.acceleration
            && self.continuous <= other.continuous
            && self.transient <= other.transient
            && self.open_loop <= other.open_loop
    }
}

/// Every library of the package `scene-images`, in the order of the table.
const SCENES: [(&str, Needs); 12] = [
    ("off", Needs::NOTHING),
    ("excite", Needs::OPEN_LOOP),
    ("detents", Needs::SMALL_MOTOR),
    ("texture", Needs::SMALL_MOTOR),
    ("free-air", Needs::BOTH_MOTORS),
    ("torque", Needs::BOTH_MOTORS),
    ("wall", Needs::VELOCITY),
    ("spring-damper", Needs::VELOCITY),
    ("viscous", Needs::VELOCITY),
    ("hold", Needs::VELOCITY),
    ("inertia", Needs::ACCELERATION),
    ("all", Needs::EVERYTHING),
];

/// Optimisation levels of the table's columns of text.
const LEVELS: [&str; 2] = ["3", "s"];

/// Our own code at one optimisation level.
fn image(level: &str) -> Image {
    let directory = format!("scene-images/{level}");
    let level = match level {
        "s" => "profile.release.opt-level=\"s\"",
        level => &format!("profile.release.opt-level={level}"),
    };
    let units = "profile.release.codegen-units=1";
    let arguments = ["--examples", "--config", level, "--config", units];
    let libraries = build("scene-images", &directory, &arguments);
    assert_eq!(
        libraries.len(),
        SCENES.len() + 3,
        "scenes, what they share, control and core: {libraries:?}"
    );
    Image::read(&libraries)
}

static IMAGES: LazyLock<[Image; 2]> = LazyLock::new(|| LEVELS.map(image));

/// What firmware with this scene alone calls of its controller, and all that this calls.
fn reached<'a>(image: &'a Image, scene: &str) -> Reached<'a> {
    let krate = scene.replace('-', "_");
    let functions = match scene {
        "all" => &["make", "start", "step", "select"][..],
        _ => &["make", "start", "step"],
    };
    let functions = functions.iter().map(|name| image.function(&krate, name));
    image.reached(&functions.collect::<Vec<_>>())
}

/// Figures of one scene, bytes.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Cost {
    /// Code and constant data by [`LEVELS`].
    text: [u64; 2],
    controller: u64,
    state: u64,
}

impl Cost {
    fn of(scene: &str) -> Self {
        let text = IMAGES.each_ref().map(|image| reached(image, scene).size());
        let ram = IMAGES.each_ref().map(|image| {
            let data = image.data(&scene.replace('-', "_"), "RAM");
            let words = [0, 4].map(|at| data[at..at + 4].try_into().expect("two words"));
            words.map(u32::from_le_bytes).map(u64::from)
        });
        assert_eq!(ram[0], ram[1], "types have one size");
        Self {
            text,
            controller: ram[0][0],
            state: ram[0][1],
        }
    }

    fn figures(&self) -> [u64; 4] {
        [self.text[0], self.text[1], self.controller, self.state]
    }
}

const BEGIN: &str = "<!-- scenes: written by the test scene_images -->";
const END: &str = "<!-- end of scenes -->";

const HEAD: &str = "\
| scene | text, `3` | text, `s` | controller | state | instructions, mean | instructions, most |
|---|---|---|---|---|---|---|
";

/// The cells of a row.
fn cells(row: &str) -> Vec<&str> {
    let cells = row.trim_matches('|').split('|');
    cells.map(str::trim).collect()
}

#[test]
fn a_scene_costs_what_the_table_says() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../docs/benchmarks.md");
    let text = std::fs::read_to_string(&path).expect("docs/benchmarks.md");
    let (before, rest) = text.split_once(BEGIN).expect("the table's beginning");
    let (table, after) = rest.split_once(END).expect("the table's end");
    let rows: Vec<Vec<&str>> = table.lines().map(cells).collect();
    let row = |scene: &str| rows.iter().find(|cells| cells[0] == scene);

    if std::env::var_os("UPDATE_GOLDEN").is_some_and(|value| value == "1") {
        let mut table = HEAD.to_owned();
        for (scene, _) in SCENES {
            let figures = Cost::of(scene).figures().map(|bytes| bytes.to_string());
            // Instructions are counted elsewhere.
            let instructions = match row(scene).and_then(|cells| cells.get(5..)) {
                Some([mean, most]) => [mean, most].map(|cell| (*cell).to_owned()),
                _ => ["later", "later"].map(String::from),
            };
            let cells = [&[scene.to_owned()], &figures[..], &instructions].concat();
            table += &format!("| {} |\n", cells.join(" | "));
        }
        let text = format!("{before}{BEGIN}\n\n{table}\n{END}{after}");
        std::fs::write(&path, text).expect("docs/benchmarks.md can be written");
        return;
    }

    assert!(table.contains(HEAD), "not the head of the table");
    let written = rows.iter().filter(|cells| cells.len() > 1).count();
    assert_eq!(written, SCENES.len() + 2, "head and a row for each scene");
    let mut moved = Vec::new();
    for (scene, _) in SCENES {
        let cells = row(scene).unwrap_or_else(|| panic!("no row for {scene}"));
        // Code may move a little with what has nothing to do with the scene, memory by two words.
        let slack = [32, 32, 8, 8];
        for ((cell, bytes), slack) in cells[1..5].iter().zip(Cost::of(scene).figures()).zip(slack) {
            let golden: u64 = cell.parse().expect("bytes");
            if bytes.abs_diff(golden) > slack.max(golden / 10) {
                moved.push(format!("{scene}: {golden} became {bytes}"));
            }
        }
    }
    assert!(
        moved.is_empty(),
        "{moved:#?}\nif that is meant, UPDATE_GOLDEN=1 writes the table anew"
    );
}

#[test]
fn a_scene_contains_what_it_needs_and_nothing_else() {
    for image in IMAGES.iter() {
        for (scene, needs) in SCENES {
            let symbols: Vec<&str> = reached(image, scene).symbols().collect();
            let estimators = [
                ("large_start", needs.continuous),
                ("large_update", needs.continuous),
                ("handle_start", needs.velocity || needs.continuous),
                ("handle_update", needs.velocity || needs.continuous),
            ];
            for (function, needed) in estimators {
                let symbol = image.function("scene_images", function);
                assert_eq!(symbols.contains(&symbol), needed, "{scene}: {function}");
            }
            // These are methods of plain types that other crates call, so they are not copied
            // into them: where they are needed they are found.
            for (update, needed) in [
                ("15ContinuousStage6update", needs.continuous),
                ("14TransientStage6update", needs.transient),
            ] {
                let found = symbols.iter().any(|symbol| symbol.contains(update));
                assert_eq!(found, needed, "{scene}: {update}");
            }
            // Nor is there an estimator that the scene keeps for itself: of the core it uses
            // quantities and samples.
            if !(needs.velocity || needs.continuous) {
                for symbol in &symbols {
                    let mut modules = symbol.split("14estimator_core").skip(1);
                    let quantity = |module: &str| {
                        module.starts_with("5units") || module.starts_with("6sample")
                    };
                    assert!(modules.all(quantity), "{scene}: {symbol}");
                }
            }
        }
    }
}

#[test]
fn a_scene_calls_nothing_on_the_board() {
    for image in IMAGES.iter() {
        for (scene, _) in SCENES {
            let foreign = reached(image, scene).foreign();
            assert!(foreign.is_empty(), "{scene} refers to {foreign:?}");
        }
    }
}

#[test]
fn a_scene_that_needs_less_costs_less() {
    let costs = SCENES.map(|(scene, needs)| (scene, needs, Cost::of(scene)));
    for (scene, needs, cost) in &costs {
        for (other, more, dearer) in &costs {
            // In one image of all, scenes share their parts, not their code, and the one that is
            // on is state.
            if needs.are_part_of(*more) && *other != "all" {
                let mut pairs = cost.figures().into_iter().zip(dearer.figures());
                assert!(
                    pairs.all(|(bytes, most)| bytes <= most),
                    "{scene} {cost:?}, {other} {dearer:?}"
                );
            }
            if *other == "all" {
                let mut pairs = cost.text.into_iter().zip(dearer.text);
                assert!(
                    pairs.all(|(bytes, most)| bytes <= most),
                    "{scene} {cost:?}, {other} {dearer:?}"
                );
            }
        }
    }
}

#[test]
fn off_costs_next_to_nothing_and_a_position_little() {
    let off = Cost::of("off");
    assert!(off.text.iter().all(|&bytes| bytes <= 128), "{off:?}");
    assert!(off.controller <= 8 && off.state <= 8, "{off:?}");

    let wall = Cost::of("wall");
    let total = |cost: &Cost| [cost.text[0], cost.text[1], cost.controller + cost.state];
    for (scene, times) in [("off", 6), ("detents", 2), ("texture", 2)] {
        let cost = Cost::of(scene);
        let mut pairs = total(&cost).into_iter().zip(total(&wall));
        assert!(
            pairs.all(|(bytes, most)| bytes * times <= most),
            "{scene} {cost:?} is not far below {wall:?}"
        );
    }
}
