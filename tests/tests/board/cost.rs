//! Instructions of the control task, and when it begins.

use std::sync::OnceLock;

use haptic_control::{Mode, SceneKind, Stop};
use measured::Row;
use measured::control_rate::NONE;
use measured::tables::{CONTROL, SCENE_INSTRUCTIONS};
use virtual_board::budget;
use virtual_board::fetch::{CACHED, Fetches};
use virtual_board::run::{ControlTick, Outcome, Setup};
use virtual_board::score::Range;

use crate::image::{FIRST_S, SETTLED_S, free_air, image, run_image, run_one, tour};

/// Instructions may move by a tenth.
fn same(_column: &str, then: f64, now: f64) -> bool {
    (then - now).abs() <= 0.1 * then
}

/// A run of the image of one scene alone.
pub(crate) struct Alone {
    /// The scene.
    pub(crate) scene: SceneKind,
    /// A run of its image.
    pub(crate) run: Outcome,
}

/// Images of one scene alone.
pub(crate) fn alone() -> &'static [Alone] {
    static RUNS: OnceLock<Vec<Alone>> = OnceLock::new();
    RUNS.get_or_init(|| {
        let run = |scene| Alone {
            scene,
            run: healthy(scene, run_one(scene, &Setup::playing(scene, 1.0))),
        };
        SceneKind::ALL.into_iter().map(run).collect()
    })
}

/// Instructions of the control task between two instants, s.
fn between(run: &Outcome, from_s: f64, to_s: f64) -> Range {
    let inside = |tick: &&ControlTick| {
        let t = tick.at_ns as f64 * 1e-9;
        t >= from_s && t < to_s
    };
    let ticks = run.ticks.iter().filter(inside);
    Range::of(ticks.map(|tick| u64::from(tick.instructions))).expect("ticks")
}

/// A second of a scene.
fn playing(features: &'static str, scene: SceneKind) -> Outcome {
    healthy(scene, run_image(features, &Setup::playing(scene, 1.0)))
}

/// A run of a scene that was not stopped.
fn healthy(scene: SceneKind, run: Outcome) -> Outcome {
    let last = run.telemetry.frames.last().expect("frames");
    let state = if scene == SceneKind::Off {
        Mode::Armed
    } else {
        Mode::Running
    };
    assert_eq!((last.state, last.cause), (state, Stop::None), "{scene}");
    run
}

/// Mean, rounded, and largest.
fn figures(range: Range) -> [u64; 2] {
    [range.mean.round() as u64, range.max]
}

#[test]
fn instructions_of_a_single_scene_agree_with_the_table() {
    let all = between(tour(), FIRST_S, f64::INFINITY);
    let row = |name: &str, range: Range| {
        let [mean, most] = figures(range).map(|figure| figure.to_string());
        vec![name.to_owned(), mean, most]
    };
    let alone = alone().iter();
    let alone =
        alone.map(|Alone { scene, run }| row(scene.name(), between(run, SETTLED_S, f64::INFINITY)));
    let rows: Vec<_> = alone.chain([row("all", all)]).collect();
    let checked = SCENE_INSTRUCTIONS.check(&[], &rows, same);
    checked.unwrap_or_else(|error| panic!("{error}"));
}

/// What a scene does not need it does not pay for: a scene without the velocity loop costs the same with one
/// estimator in the image, but for the choice between two in the image of the table.
#[test]
fn two_estimators_cost_scenes_without_the_large_velocity_no_more_than_the_choice() {
    let rows = CONTROL.read().unwrap();
    let small: Vec<_> = SceneKind::environments()
        .filter(|scene| !scene.facts().needs.continuous)
        .collect();
    assert!(small.len() > 2, "{small:?}");
    for scene in small {
        let is_own = |row: &&Row| row.text("scene") == Ok(scene.name());
        let two = rows.iter().find(is_own).expect("a row");
        assert_eq!(two.text("estimator"), Ok(NONE));
        let one = between(&playing("large-kalman", scene), SETTLED_S, f64::INFINITY);
        let more = two.number("instructions_mean").unwrap() - one.mean;
        // The rest is laid out differently by the linker's optimisation, which moves instructions: 7 of 470
        // were seen.
        assert!((-10.0..40.0).contains(&more), "{scene}: {more} more");
    }
}

/// docs/benchmarks.md states these figures: the cache holds less than the control task, and most lines that it
/// does not hold are read ahead.
#[test]
fn lines_of_flash_are_more_than_the_cache_holds_and_most_are_read_ahead() {
    for (scene, lines) in [(SceneKind::Off, 65..90), (SceneKind::Wall, 130..160)] {
        let found = budget::measure(image("large-kalman"), &Setup::playing(scene, 0.7)).unwrap();
        let Fetches { lines: all, waits } = found.fetches_most;
        println!(
            "{scene}: {all} lines, {waits} cycles of {}",
            found.cycles_most
        );
        assert!(
            lines.contains(&all) && all > CACHED as u32,
            "{scene}: {all}"
        );
        let share = f64::from(waits) / f64::from(found.cycles_most);
        assert!((0.12..0.26).contains(&share), "{scene}: {share}");
    }
}

/// Every tick wakes the processor, so nothing delays one: zero instructions off the grid. At work
/// it would be late by whatever cannot be interrupted, and the test would have to say by how much.
#[test]
fn control_task_starts_on_the_tick() {
    let ticks = &free_air().ticks;
    let first_ns = ticks[0].at_ns;
    for (k, tick) in ticks.iter().enumerate() {
        let wanted = first_ns + 100_000 * k as u64;
        assert!(tick.asleep, "tick {k} preempts something");
        // An instruction is 6 ns.
        assert_eq!(tick.at_ns, wanted, "tick {k}");
    }
    assert!(ticks.len() > 99_000);
}
