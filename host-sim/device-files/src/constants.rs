//! The device file and the presets files as Rust constants, from which flash images are built.

use std::collections::{BTreeMap, BTreeSet};
use std::ffi::OsStr;
use std::fmt::Write as _;
use std::path::{Path, PathBuf};

use estimator_catalogue::ROWS;
use haptic_control::{DualStage, Fingerprint, Motor};

use crate::device::Device;
use crate::presets::{PlantKind, Preset, Presets, check_value, is_near};
use crate::read::{Step, at_line};

/// The constants of a build.
#[derive(Clone, Debug)]
pub struct Constants {
    /// Rust text that the package `tuned` includes.
    pub text: String,
    /// Warnings of the build.
    pub warning: Option<String>,
}

/// The file that the environment variable `name` with this value names. A relative path starts at
/// `root`.
///
/// # Errors
/// One line that names the variable, if it is empty or names no file.
pub fn named_file(name: &str, value: &OsStr, root: &Path) -> Result<PathBuf, String> {
    if value.is_empty() {
        return Err(format!("{name} is empty: name a TOML file, or unset it"));
    }
    let path = root.join(value);
    if !path.exists() {
        return Err(format!(
            "{name}: no file {}; a relative path starts at the top of the repository",
            path.display()
        ));
    }
    Ok(path)
}

/// The constants for the files that DEVICE and PRESETS name. Without a device file the device is
/// `DualStage::DEFAULT`. Values of the presets file replace the shipped ones.
///
/// # Errors
/// One line that names the variable, the file and what is wrong in it.
pub fn constants(device: Option<&Path>, presets: Option<&Path>) -> Result<Constants, String> {
    let device = match device {
        Some(path) => Device::read(path).map_err(|error| format!("DEVICE: {error}"))?,
        None => Device::default(),
    };
    let mut layers = vec![Presets::shipped()];
    if let Some(path) = presets {
        let read = || {
            let text = crate::text(path)?;
            let presets = Presets::parse(&text, &path.display().to_string())?;
            check(&presets, &text, &layers[0])?;
            Ok(presets)
        };
        let presets = read().map_err(|error: String| format!("PRESETS: {error}"))?;
        layers.insert(0, presets);
    }
    let counts_per_rev = device.stages.large.counts_per_rev;
    let warning = far_presets(&layers[0], counts_per_rev);
    let mut text = device_text(&device.stages);
    let _ = writeln!(
        text,
        "const PRESETS: Fingerprint = {:?};",
        fingerprint(&layers, counts_per_rev)
    );
    text += "static LAYERS: &[Layer] = &[\n";
    for layer in &layers {
        text += &layer_text(layer, counts_per_rev);
    }
    text += "];\n";
    Ok(Constants { text, warning })
}

/// Refuses estimators, parameters and values that the catalogue does not have, and in the section
/// of the image those that no image reads, which are not in the shipped file.
fn check(presets: &Presets, text: &str, shipped: &Presets) -> Result<(), String> {
    presets.check_values(text, check_estimator)?;
    for (motor, estimators) in &presets.image {
        let read = &shipped.image[motor];
        if let Some(estimator) = estimators.keys().find(|name| !read.contains_key(*name)) {
            let names: Vec<_> = read.keys().map(String::as_str).collect();
            let way = ["image", motor, estimator].map(Step::Key);
            let error = format!(
                "image.{motor}.{estimator}: no image reads it; there are {}",
                names.join(", ")
            );
            return Err(format!(
                "{}: {}",
                presets.source,
                at_line(text, &way, &error)
            ));
        }
    }
    Ok(())
}

fn check_estimator<'a>(
    estimator: &str,
    values: &'a BTreeMap<String, f64>,
) -> Result<(), (Option<&'a str>, String)> {
    let Some(row) = ROWS.iter().find(|row| row.name == estimator) else {
        let error = format!("no estimator '{estimator}'; host-sim estimators lists them");
        return Err((None, error));
    };
    for (name, &value) in values {
        let wrong = |error| Err((Some(name.as_str()), error));
        let Some(parameter) = row.parameters.iter().find(|p| p.name == name) else {
            let names: Vec<_> = row.parameters.iter().map(|p| p.name).collect();
            return wrong(format!(
                "{estimator} has no parameter '{name}'; there are {}",
                names.join(", ")
            ));
        };
        check_value(parameter, estimator, value).or_else(wrong)?;
    }
    Ok(())
}

/// The warning where all of the strongest presets were tuned for an encoder that is far from the
/// device's.
fn far_presets(presets: &Presets, counts_per_rev: u32) -> Option<String> {
    let tuned = presets
        .preset
        .iter()
        .filter_map(|preset| preset.counts_per_rev);
    let far = |tuned: &u32| !is_near(f64::from(*tuned), f64::from(counts_per_rev));
    let counts: BTreeSet<_> = tuned.collect();
    if !counts.is_empty() && counts.iter().all(far) {
        let counts: Vec<_> = counts.iter().map(u32::to_string).collect();
        return Some(format!(
            "{}: parameters tuned for {} counts/rev are scaled to {counts_per_rev}; to be better, tune them \
             with host-sim tune --device FILE.toml --out tuned.toml and build with PRESETS=tuned.toml",
            presets.source,
            counts.join(", "),
        ));
    }
    None
}

/// Presets that images use: those for the plant with friction.
fn of_images(layer: &Presets) -> impl Iterator<Item = &Preset> {
    let tuned = layer.preset.iter();
    tuned.filter(|preset| preset.plant == PlantKind::Friction)
}

/// Hash of the values that images read: those of every tuned rate, scaled to the encoder, and those of
/// the section of the image. A file that repeats the shipped presets has the hash of the shipped presets.
fn fingerprint(layers: &[Presets], counts_per_rev: u32) -> Fingerprint {
    let all = || layers.iter().flat_map(of_images);
    let mut hash = Fingerprint::EMPTY;
    let mut rates: Vec<_> = all().map(|preset| preset.rate_hz).collect();
    rates.sort_by(f64::total_cmp);
    rates.dedup();
    let names: BTreeSet<_> = all()
        .flat_map(|preset| &preset.estimators)
        .flat_map(|(estimator, values)| values.keys().map(move |name| (estimator, name)))
        .collect();
    for rate_hz in rates {
        for (estimator, name) in &names {
            let tuned = layers.iter().find_map(|layer| {
                let preset = layer.nearest(estimator, rate_hz, PlantKind::Friction)?;
                let row = ROWS.iter().find(|row| row.name == *estimator)?;
                let parameter = row.parameters.iter().find(|p| p.name == *name)?;
                preset.value(estimator, parameter, counts_per_rev, rate_hz)
            });
            let tuned = tuned.expect("a known parameter in one of the layers");
            hash = hash
                .number(rate_hz)
                .text(estimator)
                .text(name)
                .number(tuned);
        }
    }
    let mut image = BTreeSet::new();
    for (motor, estimators) in layers.iter().flat_map(|layer| &layer.image) {
        for (estimator, values) in estimators {
            image.extend(values.keys().map(|name| (motor, estimator, name)));
        }
    }
    for (motor, estimator, name) in image {
        let value = layers
            .iter()
            .find_map(|layer| of_the_image(layer, motor, estimator, name));
        // A tuned value is hashed above.
        if let Some(Value::Image(value)) = value {
            hash = hash.text(motor).text(estimator).text(name).number(value);
        }
    }
    hash
}

/// A value that an image reads from a file, as `tuned::image` does.
enum Value {
    /// A value of the section of the image.
    Image(f64),
    /// A value tuned for the large motor.
    Tuned,
}

fn of_the_image(layer: &Presets, motor: &str, estimator: &str, name: &str) -> Option<Value> {
    let image = || layer.image.get(motor)?.get(estimator)?.get(name);
    let tuned = || of_images(layer).find(|preset| preset.estimators.contains_key(estimator));
    match image() {
        Some(value) => Some(Value::Image(*value)),
        None if motor == "large" => tuned().map(|_| Value::Tuned),
        None => None,
    }
}

fn device_text(device: &DualStage) -> String {
    let motor = |motor: &Motor| format!("{motor:?}");
    // Debug of a float has all the digits that distinguish it.
    format!(
        "/// The device that images are built for.\npub const DEVICE: DualStage = DualStage {{ large: {}, \
         small: {}, damping: {:?}, amplifier_bandwidth: {:?} }};\n",
        motor(&device.large),
        motor(&device.small),
        device.damping,
        device.amplifier_bandwidth,
    )
}

fn layer_text(layer: &Presets, counts_per_rev: u32) -> String {
    let mut text = "Layer { image: &[".to_owned();
    for (motor, estimators) in &layer.image {
        for (estimator, values) in estimators {
            for (name, value) in values {
                let _ = write!(
                    text,
                    "({motor:?}, {estimator:?}, {name:?}, {value:?}),\n    "
                );
            }
        }
    }
    text += "], tuned: &[\n    ";
    for preset in of_images(layer) {
        for (estimator, values) in &preset.estimators {
            for (name, value) in values {
                let (rate, counts) = (preset.rate_hz, preset.counts_ratio(counts_per_rev));
                let _ = write!(
                    text,
                    "({rate:?}, {counts:?}, {estimator:?}, {name:?}, {value:?}),\n    "
                );
            }
        }
    }
    text + "] },\n"
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A tuned value is one of the large motor. What an image reads for the handle stands in its section.
    #[test]
    fn tuned_value_replaces_that_of_the_large_motor_alone() {
        let text = "[[preset]]\nrate_hz = 1000.0\nplant = 'friction'\n\
                    estimators = { pll = { bandwidth_hz = 10.0 }, low-pass = { bandwidth_hz = 11.0 } }\n\
                    [image.handle.pll]\nbandwidth_hz = 12.0\n";
        let layer = Presets::parse(text, "mine.toml").unwrap();
        let is_tuned = |motor, estimator| {
            let value = of_the_image(&layer, motor, estimator, "bandwidth_hz")?;
            Some(matches!(value, Value::Tuned))
        };
        for (estimator, handle, large) in [
            ("pll", Some(false), Some(true)),
            ("low-pass", None, Some(true)),
            ("foaw-end-fit", None, None),
        ] {
            assert_eq!(is_tuned("handle", estimator), handle, "{estimator}");
            assert_eq!(is_tuned("large", estimator), large, "{estimator}");
        }
    }
}
