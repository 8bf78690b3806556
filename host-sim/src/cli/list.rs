//! What there is to choose from.

use std::fmt::Write as _;

use crate::estimators::{Kind, Search};
use crate::failure::Failure;
use crate::output::print_bytes;
use crate::scenario::ScenarioName;

use super::arguments::DeviceFile;

/// Names, parameters and needs of the estimators.
pub(super) fn estimators() -> Result<(), Failure> {
    let mut text = String::new();
    for kind in Kind::all() {
        // Writing to a string cannot fail.
        let _ = writeln!(text, "{:<22}{}", kind.name, kind.summary);
        for (needed, what) in [
            (kind.needs.current, "the large motor's current"),
            (kind.needs.small, "the small encoder"),
            (kind.needs.edge, "edge time stamps"),
        ] {
            if needed {
                let _ = writeln!(text, "  needs {what}");
            }
        }
        for p in kind.parameters {
            let unit = if p.unit.is_empty() {
                String::new()
            } else {
                format!(" {}", p.unit)
            };
            let tuned = if matches!(p.search, Search::Fixed(_)) {
                ""
            } else {
                ", tuned"
            };
            let _ = writeln!(
                text,
                "  --set {}.{}=  {} ({} to {}{unit}{tuned})",
                kind.name, p.name, p.meaning, p.lowest, p.highest
            );
        }
    }
    print_bytes(text.as_bytes())
}

/// Names and descriptions of the scenarios.
pub(super) fn scenarios() -> Result<(), Failure> {
    let mut text = String::new();
    for scenario in ScenarioName::ALL {
        let _ = writeln!(text, "{:<12}{}", scenario.as_str(), scenario.description());
    }
    print_bytes(text.as_bytes())
}

/// A device with all its values.
pub(super) fn device(file: &DeviceFile) -> Result<(), Failure> {
    let text = toml::to_string(&file.load()?)
        .map_err(|error| Failure::Input(format!("device: {error}")))?;
    print_bytes(text.as_bytes())
}
