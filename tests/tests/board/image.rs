//! The image, built once, and runs of it that several tests look at.

use std::path::PathBuf;
use std::process::Command;
use std::sync::OnceLock;

use virtual_board::image::Image;
use virtual_board::run::{Outcome, Setup, on_board};

/// Before this the image boots, is armed and settles, s.
pub(crate) const SETTLED_S: f64 = 0.4;

/// The image of this tree with these features. Each has a target directory of its own: cargo
/// holds the usual one, and two images may be built at once.
pub(crate) fn build(features: &str) -> Image {
    let root = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("..");
    let target = root.join("target/firmware-image").join(features);
    let triple = "thumbv7em-none-eabihf";
    let status = Command::new(env!("CARGO"))
        .current_dir(&root)
        .args(["build", "--release", "--package", "firmware"])
        .args(["--features", features, "--target", triple, "--target-dir"])
        .arg(&target)
        .status()
        .expect("cargo starts");
    assert!(status.success(), "the firmware does not build");
    Image::read(&target.join(triple).join("release/firmware")).unwrap()
}

/// The image of this tree.
pub(crate) fn image() -> &'static Image {
    static IMAGE: OnceLock<Image> = OnceLock::new();
    IMAGE.get_or_init(|| build(""))
}

/// Runs the image.
pub(crate) fn run(setup: &Setup) -> Outcome {
    on_board(image(), setup, |_| ()).unwrap()
}

/// Free air with a moving hand, 4 s.
pub(crate) fn free_air() -> &'static Outcome {
    static RUN: OnceLock<Outcome> = OnceLock::new();
    RUN.get_or_init(|| {
        run(&Setup {
            seconds: 4.0,
            ..Setup::default()
        })
    })
}
