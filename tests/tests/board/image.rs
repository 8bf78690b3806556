//! The images, each built once, and runs of them that several tests look at.

use std::collections::HashMap;
use std::path::Path;
use std::sync::{Mutex, OnceLock, PoisonError};

use experiments::closed_loop::Hand;
use haptic_control::{Mode, SceneKind, Stop};
use virtual_board::command::Command;
use virtual_board::image::Image;
use virtual_board::run::{Outcome, Setup, on_board};

/// Before this the image boots, is armed and settles, s.
pub(crate) const SETTLED_S: f64 = 0.4;

/// Images by their features and their one scene.
type Images = HashMap<(&'static str, Option<SceneKind>), &'static Image>;

/// The images built so far.
static BUILT: Mutex<Option<Images>> = Mutex::new(None);

fn built(
    features: &'static str,
    scene: Option<SceneKind>,
    build: impl FnOnce() -> Result<Image, String>,
) -> &'static Image {
    let mut built = BUILT.lock().unwrap_or_else(PoisonError::into_inner);
    let built = built.get_or_insert_default();
    built
        .entry((features, scene))
        .or_insert_with(|| Box::leak(Box::new(build().unwrap())))
}

/// The image of this tree with these features, separated by commas. It is built in a target
/// directory of its own: cargo holds the usual one.
pub(crate) fn image(features: &'static str) -> &'static Image {
    built(features, None, || Image::build(features))
}

/// The image of this tree with one scene alone.
pub(crate) fn image_of_one(scene: SceneKind) -> &'static Image {
    built("", Some(scene), || Image::build_one(scene))
}

/// The image of all scenes, built for a device file and a presets file.
pub(crate) fn image_for(device: &Path, presets: &Path) -> Image {
    let files = [
        ("DEVICE", device.as_os_str()),
        ("PRESETS", presets.as_os_str()),
    ];
    Image::build_with("", &files).unwrap()
}

/// The image of all scenes with these features, at a control rate in Hz.
pub(crate) fn image_at(rate_hz: u32, features: &str) -> Result<Image, String> {
    Image::build_with(features, &[("RATE", rate_hz.to_string().as_ref())])
}

/// Runs the image of one scene alone.
pub(crate) fn run_one(scene: SceneKind, setup: &Setup) -> Outcome {
    run_checked(image_of_one(scene), setup)
}

/// Runs the image of all scenes.
pub(crate) fn run(setup: &Setup) -> Outcome {
    run_image("", setup)
}

/// Runs the image with these features.
pub(crate) fn run_image(features: &'static str, setup: &Setup) -> Outcome {
    run_checked(image(features), setup)
}

/// Every run of the tests: none may do what the emulator does not model.
pub(crate) fn run_checked(image: &Image, setup: &Setup) -> Outcome {
    let outcome = on_board(image, setup, |_| ()).unwrap();
    outcome.check().unwrap();
    outcome
}

/// State and cause in the last frame.
pub(crate) fn end(run: &Outcome) -> (Mode, Stop) {
    let last = run.telemetry.frames.last().expect("frames");
    (last.state, last.cause)
}

/// A scene from the start, in this hand.
pub(crate) fn of_scene(scene: SceneKind, hand: Hand, seconds: f64) -> Setup {
    Setup {
        hand,
        seconds,
        commands: vec![(0.05, Command::Scene(scene)), (0.1, Command::Arm)],
        ..Setup::default()
    }
}

/// A run that is made when somebody first asks for it.
macro_rules! shared {
    ($($(#[$doc:meta])* $name:ident = $run:expr;)+) => {$(
        $(#[$doc])*
        pub(crate) fn $name() -> &'static Outcome {
            static RUN: OnceLock<Outcome> = OnceLock::new();
            RUN.get_or_init(|| $run)
        }
    )+};
}

shared! {
    /// Free air with a moving hand, 10 s.
    free_air = run(&of_scene(SceneKind::FreeAir, Hand::Moving, 10.0));
    /// Free air with a hand that chirps and reverses, a minute.
    soak = run(&of_scene(SceneKind::FreeAir, Hand::Tracking, 60.2));
    /// A hand that pushes into the wall, 10 s.
    wall = run(&of_scene(SceneKind::Wall, Hand::Pushing, 10.0));
    /// Every scene in turn.
    tour = run(&touring());
    /// Free air with a moving hand, 10 s, the Kalman filter on the large motor.
    kalman_free_air = run_image("large-kalman", &of_scene(SceneKind::FreeAir, Hand::Moving, 10.0));
    /// Free air with a moving hand, 10 s, the learning observer on the large motor.
    adaptive_free_air = run_image("large-adaptive", &of_scene(SceneKind::FreeAir, Hand::Moving, 10.0));
    /// Free air with a hand that chirps and reverses, 10 s, the Kalman filter on the large motor.
    kalman_track = run_image("large-kalman", &of_scene(SceneKind::FreeAir, Hand::Tracking, 10.0));
}

/// How long a tour stays in a scene, s.
const STAY_S: f64 = 0.5;
/// When a tour puts on its first scene, s.
pub(crate) const FIRST_S: f64 = 0.1;

/// Every scene in its order, each for [`STAY_S`], in a hand that holds still: another would be deep
/// in the wall when it appears.
fn touring() -> Setup {
    let at = |k: usize| FIRST_S + k as f64 * STAY_S;
    let scenes = SceneKind::environments().enumerate();
    let mut commands: Vec<_> = scenes
        .map(|(k, scene)| (at(k), Command::Scene(scene)))
        .collect();
    commands.push((0.05, Command::Arm));
    Setup {
        hand: Hand::Still,
        seconds: at(SceneKind::environments().count()),
        commands,
        ..Setup::default()
    }
}
