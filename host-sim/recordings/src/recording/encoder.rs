//! Counts of an encoder while its column is read.

use estimator_core::Count;
use terminal::failure::Failure;

use super::absolute::counts_option;
use super::layout::Place;
use super::numbers::shown;
use super::options::ReadOptions;
use super::row::Row;
use super::units::Scale;

/// Distance from a whole count from which positions are reported as rounded.
const ROUNDED: f64 = 0.25;

/// Counts of an encoder.
#[derive(Default)]
pub(super) struct Encoder {
    pub(super) counts: Vec<u32>,
    /// The count of the latest row.
    pub(super) last: Option<u32>,
    /// The reading of the latest row: counts before they are unwrapped.
    pub(super) raw: i64,
    /// Largest distance of a position from a whole count.
    rounded: f64,
}

impl Encoder {
    /// Adds the count of a row.
    pub(super) fn take(
        &mut self,
        row: &Row,
        at: Place,
        options: &ReadOptions,
        motor: usize,
    ) -> Result<(), Failure> {
        let column = at.column.name();
        let raw = match at.unit.scale {
            Scale::PerRev(per_rev) => {
                let position = row.number(column, at.place)?;
                let exact = position * f64::from(options.counts_per_rev[motor]) / per_rev;
                if exact.abs() > 9e15 {
                    let position = shown(position);
                    return Err(row.failure(
                        column,
                        &format!("{position} is too large; correct the field, or remove the row"),
                    ));
                }
                let whole = (exact + 0.5).floor();
                self.rounded = self.rounded.max((exact - whole).abs());
                whole as i64
            }
            _ => row.count(column, at.place)?,
        };
        self.raw = raw;
        let count = match options.modulus[motor] {
            None => raw as u32,
            Some(modulus) => {
                let within = -i64::from(modulus) <= raw && raw < i64::from(modulus);
                let reading = raw.rem_euclid(i64::from(modulus)) as u32;
                let last = self.last.unwrap_or(reading);
                let next = Count(last).wrapped(reading, modulus);
                let refused = |why: &str| {
                    row.failure(column, &format!("{raw} with --modulus {modulus}: {why}"))
                };
                if !within {
                    return Err(refused("raw must be below modulus"));
                }
                next.map_err(|error| refused(error.message()))?.0
            }
        };
        self.last = Some(count);
        self.counts.push(count);
        Ok(())
    }

    /// Note on positions that are far from whole counts; `None` if none is.
    pub(super) fn note(&self, column: &str, motor: &str, counts_per_rev: u32) -> Option<String> {
        (self.rounded > ROUNDED).then(|| {
            format!(
                "{column}: positions are up to {:.2} counts from a whole count with {counts_per_rev} \
                 counts/rev and are rounded to the nearest; if the encoder has more counts, give them {}",
                self.rounded,
                counts_option(motor)
            )
        })
    }
}
