//! `host-sim estimators`, `scenarios` and `device`: lists of the possible values of options.

use std::fmt::Write as _;

use catalogue::estimators::{Kind, Search};
use catalogue::parameters::{PlantKind, Preset, Presets};
use device_files::decimal;
use recordings::arguments::DeviceFile;
use simulation::scenario::ScenarioName;
use terminal::failure::Failure;
use terminal::output::{note, print_bytes};
use terminal::wording::wrapped;

/// Names, parameters and needs of the estimators.
pub(super) fn estimators() -> Result<(), Failure> {
    let mut text = String::new();
    let presets = Presets::shipped();
    let longest = Kind::all().iter().map(|kind| kind.name.len()).max();
    let width = longest.unwrap_or(0) + 2;
    for kind in Kind::all() {
        // Writing to a string cannot fail.
        let line = format!("{:<width$}{}", kind.name, kind.summary);
        let _ = writeln!(text, "{}", wrapped(&line, width));
        for (needed, what) in [
            (kind.needs.current, "the large motor's current"),
            (kind.needs.coupled, "the small encoder"),
            (kind.needs.edge, "edge time stamps"),
        ] {
            if needed {
                let _ = writeln!(text, "  needs {what}");
            }
        }
        if kind.varying_period {
            let _ = writeln!(text, "  takes rows at uneven times");
        }
        for p in kind.parameters {
            let unit = if p.unit.is_empty() {
                String::new()
            } else {
                format!(" {}", p.unit)
            };
            let line = format!(
                "  --set {}.{}=  {} ({} to {}{unit})",
                kind.name,
                p.name,
                p.meaning,
                decimal(p.lowest),
                decimal(p.highest)
            );
            let _ = writeln!(text, "{}", wrapped(&line, 8));
            let value = match p.search {
                Search::Fixed(value) => format!("        default {}", decimal(value)),
                _ => format!(
                    "        tuned to {}",
                    tuned(&presets, kind.name, p.name).join(", ")
                ),
            };
            let _ = writeln!(text, "{}", wrapped(&value, 8));
        }
    }
    print_bytes(text.as_bytes())
}

/// The values of a parameter in `presets` for the plant with friction, each with its control rate.
fn tuned(presets: &Presets, kind: &str, parameter: &str) -> Vec<String> {
    let with_friction = |preset: &&Preset| preset.plant == PlantKind::Friction;
    let values = presets.preset.iter().filter(with_friction);
    let values = values.filter_map(|preset| {
        let value = preset.estimators.get(kind)?.get(parameter)?;
        Some(format!("{} at {} Hz", decimal(*value), preset.rate_hz))
    });
    values.collect()
}

/// Names and descriptions of the scenarios.
pub(super) fn scenarios() -> Result<(), Failure> {
    let mut text = String::new();
    let names = ScenarioName::ALL.map(ScenarioName::as_str);
    let width = 2 + names.map(str::len).into_iter().max().unwrap_or(0);
    for scenario in ScenarioName::ALL {
        let line = format!("{scenario:<width$}{}", scenario.description());
        let _ = writeln!(text, "{}", wrapped(&line, width));
    }
    print_bytes(text.as_bytes())
}

/// All values of a device.
pub(super) fn device(file: &DeviceFile) -> Result<(), Failure> {
    let device = file.load()?;
    if let Err(why) = device.validate() {
        note(format!(
            "{}: commands that simulate refuse this device: {why}",
            file.name()
        ));
    }
    let text =
        toml::to_string(&device).map_err(|error| Failure::Input(format!("device: {error}")))?;
    print_bytes(text.as_bytes())
}
