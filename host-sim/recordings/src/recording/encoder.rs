//! Counts of an encoder while its column is read.

pub(super) mod absolute;
mod clipped;
pub(super) mod finer;
pub(super) mod grid;
pub(super) mod held;
pub(crate) mod stale;
mod stepped;

use estimator_core::Count;
use terminal::failure::Failure;

use super::layout::Place;
use super::numbers::shown;
use super::options::units::Scale;
use super::options::{Column, ReadOptions};
use super::text::row::Row;
use clipped::Clipped;
use grid::Grid;
use held::Held;

/// Number of changes between 0 and 1 from which a column may be one line of an encoder. Fewer are those of a
/// shaft that is hardly turned.
const LINE: usize = 10;

/// Counts of an encoder.
#[derive(Default)]
pub(super) struct Encoder {
    pub(super) counts: Vec<u32>,
    /// The count of the latest row.
    pub(super) last: Option<u32>,
    /// The reading of the latest row: counts before they are unwrapped.
    pub(super) raw: i64,
    /// Distance of the first position from a whole count: where the zero of the angle is between two counts.
    origin: Option<f64>,
    /// Largest distance of a position from a whole number of counts behind the first one.
    rounded: f64,
    /// Counts in a unit of an angle, and the name of this unit.
    unit: Option<(f64, &'static str)>,
    /// Counts from the largest position to the next number of 32 bits.
    float_step: f64,
    /// The latest position, counts with a fraction, and the changes of the positions.
    exact: Option<f64>,
    grid: Grid,
    held: Held,
    clipped: Clipped,
    /// Whether the column has counts, not an angle.
    is_counts: bool,
    /// Number of rows whose reading differs from the row before.
    changes: usize,
    /// Whether a reading was neither 0 nor 1.
    has_counts: bool,
}

/// The reading of an encoder in a row.
#[derive(Clone, Copy, Debug)]
pub(super) struct Reading {
    /// Counts before they are unwrapped.
    pub(super) raw: i64,
    /// Counts with a fraction.
    exact: f64,
}

impl Encoder {
    /// The reading of a row, of which nothing is kept but how it is rounded.
    pub(super) fn reading(
        &mut self,
        row: &Row,
        at: Place,
        options: &ReadOptions,
        motor: usize,
    ) -> Result<Reading, Failure> {
        let column = at.column.name();
        self.is_counts = true;
        Ok(match at.unit.scale {
            Scale::PerRev(per_rev) => {
                self.is_counts = false;
                let position = row.number(column, at.place)?;
                let counts_per_unit = f64::from(options.counts_per_rev[motor]) / per_rev;
                let exact = position * counts_per_unit;
                self.unit = Some((counts_per_unit, at.unit.name()));
                if exact.abs() > 9e15 {
                    let position = shown(position);
                    return Err(row.failure(
                        column,
                        &format!("{position} is too large; correct the field, or remove the row"),
                    ));
                }
                let origin = *self.origin.get_or_insert(exact - (exact + 0.5).floor());
                let whole = (exact - origin + 0.5).floor();
                self.rounded = self.rounded.max((exact - origin - whole).abs());
                let float_step = f64::from(float_step(position as f32)) * counts_per_unit;
                self.float_step = self.float_step.max(float_step);
                Reading {
                    raw: whole as i64,
                    exact,
                }
            }
            _ => {
                let raw = row.count(column, at.place)?;
                self.clipped.add(raw);
                Reading {
                    raw,
                    exact: raw as f64,
                }
            }
        })
    }

    /// Adds the reading of a row and returns its count.
    pub(super) fn add(
        &mut self,
        Reading { raw, exact }: Reading,
        row: &Row,
        options: &ReadOptions,
        motor: usize,
    ) -> Result<u32, Failure> {
        if let Some(before) = self.exact.replace(exact) {
            self.grid.add(exact - before);
            self.held.add(exact != before);
        }
        self.changes += usize::from(self.last.is_some() && raw != self.raw);
        self.has_counts |= !(0..=1).contains(&raw);
        self.raw = raw;
        let count = match options.modulus[motor] {
            None => raw as u32,
            Some(modulus) => {
                let within = -i64::from(modulus) <= raw && raw < i64::from(modulus);
                let reading = raw.rem_euclid(i64::from(modulus)) as u32;
                let last = self.last.unwrap_or(reading);
                let next = Count(last).wrapped(reading, modulus);
                let refused = |why: &str| {
                    let column = Column::COUNTS[motor].name();
                    row.failure(column, &format!("{raw} with --modulus {modulus}: {why}"))
                };
                if !within {
                    let remedy = "raw must be below modulus; remove the row if the reading failed, or give the \
                                  encoder's own modulus";
                    return Err(refused(remedy));
                }
                next.map_err(|error| refused(error.message()))?.0
            }
        };
        self.last = Some(count);
        self.counts.push(count);
        Ok(count)
    }

    /// Notes on positions whose step is not that of a count, and on a column that may hold no counts.
    /// `motor` is the index of the encoder.
    pub(super) fn notes(
        &self,
        motor: usize,
        options: &ReadOptions,
    ) -> impl Iterator<Item = String> {
        let column = Column::COUNTS[motor].name();
        let step = self.stepped(options.counts_per_rev[motor], &options.counts_given[motor]);
        let step = step.map(|what| format!("{column}: {what}"));
        let line = (!self.has_counts && self.changes >= LINE).then(|| {
            format!(
                "{column} is 0 or 1 in all rows, and changes {} times: if it is one line of a quadrature encoder, \
                 count the edges of both lines with host-sim decode",
                self.changes
            )
        });
        let clipped = self.clipped.note(column);
        step.into_iter().chain(line).chain(clipped)
    }

    /// Note on a position that is held over several rows at `rate_hz`. Counts that change by one alone are those of a slow
    /// shaft.
    pub(super) fn held(&self, motor: usize, rate_hz: f64) -> Option<String> {
        let rows = self.held.rows().filter(|_| self.grid.is_varied())?;
        Some(held::note(Column::COUNTS[motor].name(), rows, rate_hz))
    }
}

/// Distance of a number of 32 bits from the next larger one.
fn float_step(number: f32) -> f32 {
    number.abs().next_up() - number.abs()
}

#[cfg(test)]
mod tests;
