//! Absolute encoders and short counters: counts that wrap at a revolution or at 16 bits.

mod sizes;

use crate::recording::Recording;
use crate::recording::options::{Column, ReadOptions};
use crate::recording::times::steps::Steps;
use estimator_core::{Count, WrapError};
use sizes::Sizes;

/// Modulus of a 16-bit counter.
const SHORT: u32 = 1 << 16;

/// Spans of counts whose jumps are judged by them. Fewer counts are passed in one row, and counts that wrap
/// at 2^32 span more.
const SPANS: std::ops::Range<i64> = 15..1 << 31;

impl Recording {
    /// Unwraps counts that wrap at a revolution or at 16 bits to counts modulo 2^32. Returns one line
    /// per changed column, and per column whose jumps do not fit the counts per revolution of
    /// `options`.
    #[must_use]
    pub fn unwrap_counts(&mut self, options: &ReadOptions) -> Vec<String> {
        let trace = &mut self.trace;
        let period = trace.period_s();
        let mut said = Vec::new();
        let [per_rev, small_per_rev] = options.counts_per_rev;
        let mut found = look(&trace.counts_large, &self.t, period, per_rev);
        if let Some(Found::Wraps(modulus)) = found {
            match unwrap(&mut trace.counts_large, modulus) {
                Err(error) => found = Some(Found::Refused(modulus, error)),
                Ok(raw) => {
                    for (k, edge) in trace.edges.iter_mut().flatten().enumerate() {
                        if let Some(edge) = edge {
                            let count = trace.counts_large[k];
                            edge.boundary = boundary(edge.boundary, raw[k], count, modulus);
                        }
                    }
                }
            }
        }
        said.extend(found.map(|found| found.note(0, options)));
        if let Some(counts) = &mut trace.counts_small {
            let mut found = look(counts, &self.t, period, small_per_rev);
            if let Some(Found::Wraps(modulus)) = found
                && let Err(error) = unwrap(counts, modulus)
            {
                found = Some(Found::Refused(modulus, error));
            }
            said.extend(found.map(|found| found.note(1, options)));
        }
        said
    }
}

/// Property of a column of counts that is worth a note.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Found {
    /// The counts wrap at this modulus.
    Wraps(u32),
    /// The counts have an impossible jump, the first number, and span the second number of counts.
    Jumps(i64, i64),
    /// The same, where the jumps have different sizes.
    Unequal(i64, i64),
    /// The counts are this one in a number of rows, and within a revolution in all others.
    Failed(i64, u64),
    /// The counts wrap at this modulus and cannot be unwrapped.
    Refused(u32, WrapError),
}

impl Found {
    /// The note on the counts of the encoder with the index `motor`.
    pub(crate) fn note(self, motor: usize, options: &ReadOptions) -> String {
        let column = Column::COUNTS[motor].name();
        let per_rev = options.counts_per_rev[motor];
        match self {
            Self::Wraps(modulus) => format!(
                "{column} wraps at {modulus} and is unwrapped: a {}",
                match modulus == per_rev {
                    true => "revolution of an absolute encoder",
                    false => "counter of 16 bits",
                }
            ),
            Self::Jumps(jump, span) if options.takes_options && is_fast(jump, span, per_rev) => {
                format!(
                    "{column} jumps by {jump} from one row to the next and spans {span} counts, with {per_rev} \
                 counts per revolution: if the encoder is absolute, it turns by more than a quarter of a revolution from \
                 row to row; give --modulus {column}={per_rev}"
                )
            }
            Self::Jumps(jump, span) => format!(
                "{column} jumps by {jump} from one row to the next and spans {span} counts, with {per_rev} \
                 counts per revolution: if the encoder is absolute, give its counts {}{}",
                options.counts_given[motor],
                match options.takes_options {
                    true => modulus_option(column, jump, span),
                    false => String::new(),
                }
            ),
            Self::Unequal(jump, span) => format!(
                "{column} jumps by {jump} from one row to the next and spans {span} counts; its jumps have different \
                 sizes, as of a counter that is set to zero or of bad counts, and not of an encoder that wraps"
            ),
            Self::Failed(count, rows) => format!(
                "{column} is {count} in {rows} {} and from 0 to {} in all others, as where readings of an absolute \
                 encoder failed: remove these rows; the counts are not unwrapped",
                if rows == 1 { "row" } else { "rows" },
                per_rev - 1
            ),
            Self::Refused(modulus, error) => {
                format!("{column} wraps at {modulus} and is not unwrapped: {error}")
            }
        }
    }
}

/// Whether counts that span `span` are those of one revolution, and a `jump` is not the wrap of a shaft that turns by
/// less than a quarter of it from row to row. The last counts before a wrap may not occur.
fn is_fast(jump: i64, span: i64, per_rev: u32) -> bool {
    let per_rev = i64::from(per_rev);
    span <= per_rev && 100 * (per_rev - span) <= per_rev && 4 * jump.abs() < 3 * per_rev
}

/// The option for an encoder that wraps at another number than its counts per revolution: the next power of two, if
/// the counts come near it. Empty where the counts do not look so.
fn modulus_option(column: &str, jump: i64, span: i64) -> String {
    let span = u64::try_from(span).unwrap_or(0);
    let power = span.next_power_of_two();
    let (modulus, about) = match 100 * (power - span) <= power {
        true => (power, power.to_string()),
        // The last counts before a wrap may not occur.
        false => (span, format!("N, N about {span},")),
    };
    match 4 * jump.unsigned_abs() >= 3 * modulus {
        true => format!(", or --modulus {column}={about} if it has other counts per revolution"),
        false => String::new(),
    }
}

/// Looks for jumps between rows of this `period`, s.
fn look(counts: &[u32], t: &[f64], period: f64, per_rev: u32) -> Option<Found> {
    let signed = |count: u32| i64::from(count as i32);
    let jump = Steps::with_counts(t, |k| signed(counts[k])).largest_jump(period, 0);
    let mut seen = Extent::default();
    for count in counts {
        seen.add(signed(*count), moduli(per_rev));
    }
    found(jump, &seen, per_rev)
}

/// What is kept of the counts of a column.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Extent {
    /// Least and largest count, and the last one.
    ends: Option<[i64; 2]>,
    last: i64,
    /// The largest step between two rows that is no wrap at each of the moduli.
    steps: [i64; 2],
    /// The first count that is outside of a revolution, and the number of rows with it.
    outside: Option<(i64, u64)>,
    /// Whether another count is outside of a revolution too.
    has_others: bool,
    sizes: Sizes,
}

impl Extent {
    /// Adds a count, and returns its distance from the last one.
    pub(crate) fn add(&mut self, count: i64, moduli: [u32; 2]) -> i64 {
        let [least, most] = self.ends.unwrap_or([count; 2]);
        let step = self.ends.map_or(0, |_| count - self.last);
        self.ends = Some([least.min(count), most.max(count)]);
        self.last = count;
        self.sizes.add(step);
        if !(0..i64::from(moduli[0])).contains(&count) {
            let (known, rows) = self.outside.get_or_insert((count, 0));
            match *known == count {
                true => *rows += 1,
                false => self.has_others = true,
            }
        }
        for (largest, modulus) in self.steps.iter_mut().zip(moduli) {
            if 4 * step.abs() <= i64::from(modulus) {
                *largest = step.abs().max(*largest);
            }
        }
        step
    }
}

/// Counts by which a wrap may be shorter or longer than the largest step, for positions that are rounded.
const ROUNDED: i64 = 4;

/// What the largest jump, over a number of rows, and the extent of a column tell.
pub(crate) fn found((jump, rows): (i64, f64), seen: &Extent, per_rev: u32) -> Option<Found> {
    let [least, most] = seen.ends?;
    let span = most - least;
    let wraps = |(modulus, largest): &(u32, i64)| {
        let modulus = i64::from(*modulus);
        // A shaft turns less than a quarter of a revolution from row to row, and not much faster over the wrap than
        // in all other rows: otherwise the counts are of another encoder.
        // An angle that is rounded to counts can be the modulus itself.
        let over_wrap = (modulus - jump.abs()).abs();
        span <= modulus
            && 4 * jump.abs() >= 3 * modulus
            && over_wrap as f64 <= 2.0 * rows * *largest as f64 + ROUNDED as f64
    };
    let wraps = moduli(per_rev).into_iter().zip(seen.steps).find(wraps);
    if let (Some((SHORT, largest)), Some((count, number)), false) =
        (wraps, seen.outside, seen.has_others)
    {
        // An encoder that wraps at a revolution, and whose jumps to one number are no steps of its motion. A counter of
        // 16 bits that passes zero has that number too, one step away.
        let [own, _] = seen.steps;
        let is_step =
            (i64::from(SHORT) - jump.abs()) as f64 <= 2.0 * rows * own as f64 + ROUNDED as f64;
        if per_rev < SHORT && 4 * largest >= 3 * i64::from(per_rev) && !is_step {
            return Some(Found::Failed(count, number));
        }
    }
    let wraps = wraps.map(|(modulus, _)| modulus);
    let far = 2 * jump.abs() > i64::from(per_rev) && span < i64::from(SHORT);
    // An encoder of another modulus: one row passes most of the counts of the whole log.
    let far = far || (SPANS.contains(&span) && 4 * jump.abs() >= 3 * (span + 1));
    let span = span + 1;
    let jumps = match 4 * jump.abs() >= 3 * span && seen.sizes.contradict(span) {
        true => Found::Unequal(jump, span),
        false => Found::Jumps(jump, span),
    };
    wraps.map(Found::Wraps).or(far.then_some(jumps))
}

/// Moduli at which counts are unwrapped without an option.
pub(crate) fn moduli(per_rev: u32) -> [u32; 2] {
    [per_rev, SHORT]
}

/// Unwraps `counts` and returns the original ones. An error leaves `counts` as they are.
fn unwrap(counts: &mut Vec<u32>, modulus: u32) -> Result<Vec<u32>, WrapError> {
    let raw = counts.clone();
    let mut last = None;
    let unwrapped = counts.iter().map(|&count| {
        let next = after(last, count, modulus)?;
        last = Some(next);
        Ok(next.0)
    });
    *counts = unwrapped.collect::<Result<_, _>>()?;
    Ok(raw)
}

/// The count after `last` of an encoder that wraps at `modulus` and reads `count`; the first count is
/// the reading.
///
/// # Errors
/// Those of [`Count::wrapped`].
pub fn after(last: Option<Count>, count: u32, modulus: u32) -> Result<Count, WrapError> {
    let reading = i64::from(count as i32).rem_euclid(i64::from(modulus)) as u32;
    last.map_or(Ok(Count(count)), |last| last.wrapped(reading, modulus))
}

/// The boundary of an edge beside the unwrapped `count`, given that beside its reading `raw`.
#[must_use]
pub fn boundary(boundary: u32, raw: u32, count: u32, modulus: u32) -> u32 {
    let away = i64::from(boundary as i32) - i64::from(raw as i32);
    count.wrapping_add(centred(away, modulus) as u32)
}

/// The number nearest to zero that differs from `x` by a multiple of `modulus`.
pub(crate) fn centred(x: i64, modulus: u32) -> i64 {
    let modulus = i64::from(modulus);
    let half = modulus / 2;
    (x + half).rem_euclid(modulus) - half
}

#[cfg(test)]
mod tests;
