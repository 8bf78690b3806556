//! The build for files that are wrong.

use std::path::Path;
use std::process::Command;

/// The errors themselves are tested in device-files; here, that they stop the build of an image.
#[test]
fn build_for_a_missing_device_file_stops_with_one_line() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).parent().unwrap();
    // As the virtual board builds images: cargo holds the usual target directory.
    let output = Command::new(std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into()))
        .current_dir(root)
        .args(["build", "--quiet", "--profile", "firmware"])
        .args(["--package", "tuned", "--target", "thumbv7em-none-eabihf"])
        .arg("--target-dir")
        .arg(root.join("target/firmware-image"))
        .env("DEVICE", "nowhere.toml")
        .output()
        .unwrap();
    let errors = String::from_utf8(output.stderr).unwrap();
    assert!(!output.status.success(), "{errors}");
    let file = root.join("nowhere.toml");
    let error = format!("DEVICE: no file {}; a relative path starts", file.display());
    let lines = errors.lines().filter(|line| line.contains("DEVICE"));
    assert_eq!(lines.count(), 1, "{errors}");
    assert!(errors.contains(&error), "{errors}");
}
