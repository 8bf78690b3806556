//! Counts per revolution that the steps of the positions contradict.

use std::f64::consts::TAU;

use device_files::device::COUNTS_PER_REV;
use device_files::to_digits;

use super::Encoder;
use crate::recording::numbers::shown;

/// Distance from a whole count from which positions are reported as rounded.
const ROUNDED: f64 = 0.25;

/// Counts of the log in a step of its positions from which the step is reported.
const COARSE: f64 = 1.5;

/// Units of which a revolution is no whole number: no encoder has a decimal part of one as its step.
const IRRATIONAL: [&str; 2] = ["rad", "mrad"];

/// Largest relative difference of the last digit of a log from the step of its positions.
const DIGIT: f64 = 1e-3;

/// Least ratio of a step to that of a float of 32 bits which has it.
const RESOLVED: f64 = 1.5;

/// Largest distance of the steps of a revolution from a whole number, over it: behind a gear it may be none.
const WHOLE: f64 = 1e-3;

/// Part of a count by which the steps of a revolution differ from a whole number where it is none.
const PART: f64 = 0.02;

/// Largest distance of the steps of a revolution from a power of two that tells the unit.
const POWER: f64 = 0.1;

/// Least number of steps in a revolution of another unit that tells the unit, a power of two.
const TELLING: f64 = 64.0;

/// Revolutions in the units that are taken for one another.
const UNITS: [(&str, f64); 3] = [("deg", 360.0), ("rad", TAU), ("rev", 1.0)];

impl Encoder {
    /// What is wrong with `counts_per_rev`, which a user gives as `given` says, by the step of the positions.
    pub(super) fn stepped(&self, counts_per_rev: u32, given: &str) -> Option<String> {
        let step = self.grid.step();
        let step = step.filter(|step| !self.is_counts || step.fract() == 0.0);
        let coarse = step.filter(|step| *step >= COARSE);
        if let (Some(step), true) = (coarse, self.is_counts) {
            return Some(format!(
                "the count changes by multiples of {step} alone: divide the column and the counts per revolution by \
                 {step}, because the estimators take each count for one of the encoder"
            ));
        }
        if let (Some(step), Some((counts_per_unit, "rev"))) = (coarse, self.unit)
            && (step / counts_per_unit).fract() == 0.0
        {
            return Some(
                "positions are whole revolutions alone: if the numbers are counts, name their unit with --column \
                 OURS=THEIRS:counts"
                    .to_owned(),
            );
        }
        let off = match (coarse, self.rounded > ROUNDED) {
            (_, true) => format!(
                "positions are up to {:.2} counts from whole counts with {counts_per_rev} counts/rev and are rounded \
                 to the nearest",
                self.rounded
            ),
            (Some(step), false) => format!(
                "positions change by multiples of {} counts alone with {counts_per_rev} counts/rev",
                shown(to_digits(step, 4))
            ),
            (None, false) => return None,
        };
        // A step that 32 bits do not resolve is theirs.
        let resolved = step.filter(|step| *step > RESOLVED * self.float_step);
        let why = self.by_unit(step, resolved);
        let why = why.or_else(|| Some(self.by_counts(resolved?, counts_per_rev, given)));
        let unknown = || format!("if the encoder has more counts, give them {given}");
        Some(format!("{off}; {}", why.unwrap_or_else(unknown)))
    }

    /// What the unit of the positions tells of their step: its last digit, or that it is another unit.
    fn by_unit(&self, step: Option<f64>, resolved: Option<f64>) -> Option<String> {
        let (counts_per_unit, unit) = self.unit?;
        let digit = step.and_then(|step| power_of_ten(step / counts_per_unit));
        if let (Some(digit), true) = (digit, IRRATIONAL.contains(&unit)) {
            return Some(format!(
                "they are multiples of {} {unit}, the last digit of the log: log more digits",
                shown(digit)
            ));
        }
        let step = resolved? / counts_per_unit;
        let steps = |(_, per_rev): &(&str, f64)| {
            let steps = per_rev / step;
            let power = steps.log2().round().exp2();
            ((steps - power).abs() < POWER && power >= TELLING).then_some(power)
        };
        let own = UNITS.iter().find(|(name, _)| *name == unit)?;
        if steps(own).is_some() {
            return None;
        }
        let mut others = UNITS.iter().filter(|(name, _)| *name != unit);
        let (other, power) = others.find_map(|of| Some((of.0, steps(of)?)))?;
        Some(format!(
            "as {other} they would be multiples of 1/{power} revolution: if they are, name the unit with --column \
             OURS=THEIRS:{other}"
        ))
    }

    /// What the counts of a revolution are by a `step` of the positions, counts.
    pub(super) fn by_counts(&self, step: f64, counts_per_rev: u32, given: &str) -> String {
        let steps = f64::from(counts_per_rev) / step;
        let own = steps.round();
        if own == f64::from(counts_per_rev) && (steps - own).abs() > PART {
            return format!(
                "they are multiples of 1/{} revolution, and {own} is the nearest whole number",
                shown(to_digits(steps, 8))
            );
        }
        if own == f64::from(counts_per_rev) {
            return "the others have the steps of the encoder: remove the rows whose position is off them; if the \
                    first row is one, all others are off"
                .to_owned();
        }
        let finest = f64::from(*COUNTS_PER_REV.end());
        let halvings = (own / finest).log2().ceil().max(0.0);
        let fits = own / halvings.exp2();
        if halvings > 0.0 && fits == f64::from(counts_per_rev) {
            return format!(
                "they are multiples of 1/{own} revolution; at most {finest} counts/rev are read"
            );
        }
        match (steps - own).abs() < WHOLE * steps && own >= 2.0 {
            true if halvings > 0.0 && fits.fract() == 0.0 => format!(
                "they are multiples of 1/{own} revolution: if these are the encoder's counts, give {fits} counts/rev, \
                 because at most {finest} are read, {given}"
            ),
            true => format!(
                "they are multiples of 1/{own} revolution: if these are the encoder's counts, give {own} counts/rev \
                 {given}"
            ),
            false => format!(
                "they are multiples of 1/{} revolution, which is no part of one: check the unit, and whether a gear \
                 is between encoder and shaft",
                shown(to_digits(steps, 6))
            ),
        }
    }
}

/// The power of ten that `step` is; `None` if it is none.
pub(super) fn power_of_ten(step: f64) -> Option<f64> {
    let power = to_digits(step, 1);
    let is_power = (power.log10() - power.log10().round()).abs() < 1e-9;
    (is_power && (step / power - 1.0).abs() < DIGIT).then_some(power)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::recording::{ReadOptions, Recording, read_log};

    /// What is said of a swing of 1 kHz over 1.5 revolutions whose positions are multiples of `step` in their `unit`.
    fn note(unit: &str, per_rev: f64, step: f64) -> String {
        let mut text = "t,counts_large\n".to_owned();
        for k in 0..1000 {
            let t = 1e-3 * f64::from(k);
            let position = (per_rev * 0.75 * (5.0 * t).sin() / step).floor() * step;
            text += &format!("{t:.3},{position:.9}\n");
        }
        let recording = read_log(&text, &format!("counts_large=counts_large:{unit}")).unwrap();
        recording.notes.join("\n")
    }

    #[test]
    fn unit_is_told_by_steps_that_are_those_of_an_encoder_in_another_one() {
        let said = note("rad", 360.0, 360.0 / 8192.0);
        let other = "as deg they would be multiples of 1/8192 revolution: if they are, name the unit with --column \
                     OURS=THEIRS:deg";
        assert!(said.contains(other), "{said}");
        let said = note("deg", 1.0, 1.0 / 16_384.0);
        assert!(
            said.contains("as rev they would be multiples of 1/16384"),
            "{said}"
        );
        // In the stated unit they are steps of an encoder.
        let said = note("deg", 360.0, 360.0 / 1024.0);
        assert!(
            said.contains("they are multiples of 1/1024 revolution: if"),
            "{said}"
        );
    }

    #[test]
    fn steps_that_are_no_part_of_a_revolution_are_no_counts() {
        let said = note("rev", 1.0, 1.0 / 36.6);
        let none = "they are multiples of 1/36.6 revolution, which is no part of one: check the unit, and whether";
        assert!(said.contains(none), "{said}");
        // An encoder of 400 counts per revolution behind a gear of 17 to 3.
        let said = note("rev", 1.0, 3.0 / (17.0 * 400.0));
        assert!(said.contains("give 2267 counts/rev"), "{said}");
    }

    /// A drive that sends a position of 16 bits over 25 rad, and 20 bits behind a gear of 30.
    #[test]
    fn nearest_and_largest_counts_are_taken_where_no_others_fit() {
        let said = |per_rev: f64, counts: u32| {
            let mut text = "t,counts_large\n".to_owned();
            for k in 0..1000 {
                let t = 1e-3 * f64::from(k);
                let position = (33_000.0 * (5.0 * t).sin()).floor() * TAU / per_rev;
                text += &format!("{t:.3},{position:.12}\n");
            }
            let mut options = ReadOptions::default();
            options
                .add_columns("counts_large=counts_large:rad")
                .unwrap();
            options.counts_per_rev[0] = counts;
            let recording = Recording::parse_as(text.as_bytes(), "r.csv", &options).unwrap();
            recording.notes.join("\n")
        };
        let drive = 65_535.0 * TAU / 25.0;
        assert!(said(drive, 4096).contains("give 16471 counts/rev"));
        let nearest = said(drive, 16_471);
        let rounded = "they are multiples of 1/16470.7";
        assert!(
            nearest.contains(rounded)
                && nearest.contains("revolution, and 16471 is the nearest whole number"),
            "{nearest}"
        );
        let fine = said(31_457_280.0, 4096);
        assert!(
            fine.contains("give 3932160 counts/rev, because at most 4000000 are read, "),
            "{fine}"
        );
        let halved = said(31_457_280.0, 3_932_160);
        assert!(
            halved.contains("1/31457280 revolution; at most 4000000 counts/rev are read"),
            "{halved}"
        );
        assert!(!halved.contains("give"), "{halved}");
    }

    #[test]
    fn rows_off_the_steps_of_the_encoder_are_to_be_removed() {
        let mut text = "t,counts_large\n0,-1\n".to_owned();
        for k in 1..1000 {
            let t = 1e-3 * f64::from(k);
            let position = (3000.0 * (5.0 * t).sin()).floor() * 360.0 / 4096.0;
            text += &format!("{t:.3},{position:.9}\n");
        }
        let recording = read_log(&text, "counts_large=counts_large:deg").unwrap();
        let said = recording.notes.join("\n");
        assert!(
            said.contains("remove the rows whose position is off them"),
            "{said}"
        );
        assert!(!said.contains("give 4096"), "{said}");
    }
}
