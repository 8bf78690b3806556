//! Costs of a scene on the board: code and memory of the controller of each scene alone, read
//! from the libraries that the package `scene-images` builds.

use std::sync::LazyLock;

use haptic_control::{Role, SceneKind};
use measured::tables::SCENE_SIZES;

use crate::image::{Image, Reached, build};

/// Needs of a scene, from the catalogue.
#[derive(Clone, Copy, PartialEq)]
struct Needs {
    /// Parts: the handle's velocity, its acceleration, the large and the small motor, and currents
    /// that the scene commands directly.
    parts: [bool; 5],
    /// The large motor renders the scene.
    continuous: bool,
    /// The small motor renders the scene.
    transient: bool,
    /// The handle's velocity is estimated.
    handle: bool,
}

impl Needs {
    fn of(kind: SceneKind) -> Self {
        let facts = kind.facts();
        let needs = facts.needs;
        Self {
            parts: [
                needs.velocity,
                needs.acceleration,
                needs.continuous,
                needs.transient,
                facts.role == Role::Excitation,
            ],
            continuous: needs.continuous,
            transient: needs.transient,
            handle: needs.handle_estimator,
        }
    }

    /// Whether the other needs all of this and more.
    fn are_part_of(self, other: Self) -> bool {
        self.parts != other.parts && (0..5).all(|i| self.parts[i] <= other.parts[i])
    }
}

/// The library of the switchboard of all scenes.
const ALL: &str = "all";

/// Name, module in the package `scene-images` and needs of every scene and of the switchboard, in
/// the order of the table: scenes that need less come first.
static SCENES: LazyLock<Vec<(&str, String, Needs)>> = LazyLock::new(|| {
    let mut scenes: Vec<_> = SceneKind::ALL
        .into_iter()
        .map(|kind| (kind.name(), format!("{kind:?}"), Needs::of(kind)))
        .collect();
    scenes.sort_by_key(|(_, _, needs)| {
        let [velocity, acceleration, continuous, transient, open_loop] = needs.parts;
        [acceleration, velocity, continuous, transient, open_loop]
    });
    let everything = Needs {
        parts: [true; 5],
        continuous: true,
        transient: true,
        handle: true,
    };
    scenes.push((ALL, ALL.to_owned(), everything));
    scenes
});

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
    let arguments = ["--lib", "--examples", "--config", level, "--config", units];
    let libraries = build("scene-images", &directory, &arguments);
    assert_eq!(
        libraries.len(),
        4,
        "scenes, the switchboard, control and core: {libraries:?}"
    );
    Image::read(&libraries)
}

static IMAGES: LazyLock<[Image; 2]> = LazyLock::new(|| LEVELS.map(image));

/// The symbol of a module's function or static.
fn symbol<'a>(image: &'a Image, module: &str, name: &str) -> &'a str {
    match module {
        ALL => image.function(ALL, name),
        _ => image.function("scene_images", &format!("{module}::{name}")),
    }
}

/// What firmware with the scene in this module alone calls of its controller, and all that this
/// calls.
fn reached<'a>(image: &'a Image, module: &str) -> Reached<'a> {
    let functions = match module {
        ALL => &["make", "start", "step", "select"][..],
        _ => &["make", "start", "step"],
    };
    let functions = functions.iter().map(|name| symbol(image, module, name));
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
    fn of(module: &str) -> Self {
        let text = IMAGES.each_ref().map(|image| reached(image, module).size());
        let ram = IMAGES.each_ref().map(|image| {
            let data = image.data(symbol(image, module, "RAM"));
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

#[test]
fn costs_of_a_scene_agree_with_the_table() {
    let row = |(scene, module, _): &(&str, String, Needs)| {
        let figures = Cost::of(module).figures().map(|bytes| bytes.to_string());
        [&[(*scene).to_owned()], &figures[..]].concat()
    };
    let rows: Vec<_> = SCENES.iter().map(row).collect();
    let same = |column: &str, then: f64, now: f64| {
        // Code may move a little with what has nothing to do with the scene, memory by two words.
        let slack = if column.starts_with("text") {
            32.0
        } else {
            8.0
        };
        (then - now).abs() <= (then / 10.0).floor().max(slack)
    };
    let checked = SCENE_SIZES.check(&[], &rows, same);
    checked.unwrap_or_else(|error| panic!("{error}"));
}

#[test]
fn a_scene_contains_what_it_needs_and_nothing_else() {
    for image in IMAGES.iter() {
        for (scene, module, needs) in SCENES.iter() {
            let symbols: Vec<&str> = reached(image, module).symbols().collect();
            let estimators = [
                ("large_start", needs.continuous),
                ("large_update", needs.continuous),
                ("handle_start", needs.handle),
                ("handle_update", needs.handle),
            ];
            for (function, needed) in estimators {
                let symbol = image.function("scene_images", function);
                assert_eq!(symbols.contains(&symbol), needed, "{scene}: {function}");
            }
            // These are methods of types that are not generic, in another crate, and not inlined: where
            // a stage is needed the image has their symbols.
            for (update, needed) in [
                ("5stage7limited", needs.continuous),
                ("14TransientStage6update", needs.transient),
            ] {
                let found = symbols.iter().any(|symbol| symbol.contains(update));
                assert_eq!(found, needed, "{scene}: {update}");
            }
            // A scene without a velocity has no other estimator: of the core it uses quantities
            // and samples alone.
            if !needs.handle {
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
        for (scene, module, _) in SCENES.iter() {
            let foreign = reached(image, module).foreign();
            assert!(foreign.is_empty(), "{scene} refers to {foreign:?}");
        }
    }
}

#[test]
fn a_scene_that_needs_less_costs_less() {
    let costs = SCENES
        .iter()
        .map(|(scene, module, needs)| (*scene, *needs, Cost::of(module)));
    let costs: Vec<_> = costs.collect();
    for (scene, needs, cost) in &costs {
        for (other, more, dearer) in &costs {
            // In one image of all, scenes share their parts, not their code, and the one that is
            // on is state.
            if needs.are_part_of(*more) && *other != ALL {
                let mut pairs = cost.figures().into_iter().zip(dearer.figures());
                assert!(
                    pairs.all(|(bytes, most)| bytes <= most),
                    "{scene} {cost:?}, {other} {dearer:?}"
                );
            }
            if *other == ALL {
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
fn scene_off_costs_almost_nothing_and_a_position_little() {
    let off = Cost::of("Off");
    assert!(off.text.iter().all(|&bytes| bytes <= 128), "{off:?}");
    assert!(off.controller <= 8 && off.state <= 8, "{off:?}");

    let wall = Cost::of("Wall");
    let total = |cost: &Cost| [cost.text[0], cost.text[1], cost.controller + cost.state];
    for (scene, times) in [("Off", 6), ("Detents", 2), ("Texture", 2)] {
        let cost = Cost::of(scene);
        let mut pairs = total(&cost).into_iter().zip(total(&wall));
        assert!(
            pairs.all(|(bytes, most)| bytes * times <= most),
            "{scene} {cost:?} is not far below {wall:?}"
        );
    }
}
