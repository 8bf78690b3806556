//! The voltage of the amplifiers' supply, of an image that reads it.

use drivers::link::Hello;
use haptic_control::Supply;

use crate::check::Line;
use crate::strokes::Seen;

/// Feature of an image that reads the voltage.
const FEATURE: &str = "supply-monitor";

/// Whether an image reads the voltage.
pub(crate) fn is_read(hello: &Hello) -> bool {
    hello.features.has(FEATURE)
}

/// The line on the voltages of a time: their mean, and whether all of them are in the range in which the
/// board runs.
pub(crate) fn line(seen: &Seen) -> Line {
    ("supply", judged(&seen.supply))
}

fn judged(voltages: &[f32]) -> Result<String, String> {
    let [low, high] = Supply::RANGE_24_V;
    if voltages.is_empty() {
        return Err("no voltage came; check the connection".to_owned());
    }
    let mean = voltages.iter().map(|volts| f64::from(*volts)).sum::<f64>() / voltages.len() as f64;
    let least = voltages.iter().copied().fold(f32::INFINITY, f32::min);
    let most = voltages.iter().copied().fold(f32::NEG_INFINITY, f32::max);
    let found =
        format!("{mean:.2} V, from {least:.2} to {most:.2} V; {low} to {high} V are allowed");
    if voltages.iter().all(|volts| (low..=high).contains(volts)) {
        Ok(found)
    } else {
        Err(format!(
            "{found}: check the supply of the amplifiers, and the divider between it and the board"
        ))
    }
}

#[cfg(test)]
mod tests {
    use drivers::link::FEATURES;

    use super::*;

    #[test]
    fn feature_is_one_of_the_firmware() {
        assert!(FEATURES.contains(&FEATURE));
    }

    #[test]
    fn line_has_mean_ends_and_range() {
        let found = judged(&[23.5, 24.0, 24.5, 24.4]);
        let text = "24.10 V, from 23.50 to 24.50 V; 20.4 to 28.8 V are allowed";
        assert_eq!(found.as_deref(), Ok(text));
    }

    #[test]
    fn one_voltage_outside_of_the_range_fails() {
        for outside in [20.3, 28.9, 0.0, f32::NAN] {
            let error = judged(&[24.0, outside, 24.0]).unwrap_err();
            assert!(error.contains("check the supply"), "{error}");
        }
        assert!(judged(&[20.4, 28.8]).is_ok());
        assert!(judged(&[]).unwrap_err().contains("no voltage came"));
    }
}
