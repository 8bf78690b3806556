//! Absolute encoders and short counters: counts that wrap at a revolution or at 16 bits.

use super::Recording;
use super::options::{Column, ReadOptions};
use super::steps::Steps;
use estimator_core::{Count, WrapError};

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
pub(super) enum Found {
    /// The counts wrap at this modulus.
    Wraps(u32),
    /// The counts have an impossible jump, the first number, and span the second number of counts.
    Jumps(i64, i64),
    /// The counts wrap at this modulus and cannot be unwrapped.
    Refused(u32, WrapError),
}

impl Found {
    /// The note on the counts of the encoder with the index `motor`.
    pub(super) fn note(self, motor: usize, options: &ReadOptions) -> String {
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
            Self::Jumps(jump, span) => format!(
                "{column} jumps by {jump} from one row to the next and spans {span} counts, with {per_rev} \
                 counts per revolution: if the encoder is absolute, give its counts {}{}",
                options.counts_given[motor],
                match options.takes_modulus {
                    true => modulus_option(column, jump, span),
                    false => String::new(),
                }
            ),
            Self::Refused(modulus, error) => {
                format!("{column} wraps at {modulus} and is not unwrapped: {error}")
            }
        }
    }
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
pub(super) struct Extent {
    /// Least and largest count, and the last one.
    ends: Option<[i64; 2]>,
    last: i64,
    /// The largest step between two rows that is no wrap at each of the moduli.
    steps: [i64; 2],
}

impl Extent {
    /// Adds a count, and returns its distance from the last one.
    pub(super) fn add(&mut self, count: i64, moduli: [u32; 2]) -> i64 {
        let [least, most] = self.ends.unwrap_or([count; 2]);
        let step = self.ends.map_or(0, |_| count - self.last);
        self.ends = Some([least.min(count), most.max(count)]);
        self.last = count;
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
pub(super) fn found((jump, rows): (i64, f64), seen: &Extent, per_rev: u32) -> Option<Found> {
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
    let wraps = wraps.map(|(modulus, _)| modulus);
    let far = 2 * jump.abs() > i64::from(per_rev) && span < i64::from(SHORT);
    // An encoder of another modulus: one row passes most of the counts of the whole log.
    let far = far || (SPANS.contains(&span) && 4 * jump.abs() >= 3 * (span + 1));
    wraps
        .map(Found::Wraps)
        .or(far.then_some(Found::Jumps(jump, span + 1)))
}

/// Moduli at which counts are unwrapped without an option.
pub(super) fn moduli(per_rev: u32) -> [u32; 2] {
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
pub(super) fn centred(x: i64, modulus: u32) -> i64 {
    let modulus = i64::from(modulus);
    let half = modulus / 2;
    (x + half).rem_euclid(modulus) - half
}

#[cfg(test)]
mod tests {
    use simulation::device::Device;

    use super::*;

    /// A shaft that turns by `step` counts a row, read by an encoder that wraps.
    fn recording(step: i64, modulus: i64, least: i64) -> (Recording, Vec<u32>) {
        let mut text = String::from("t,counts_large,counts_small,edge_tick,edge_bound\n");
        let mut truth = Vec::new();
        for k in 0..3000_i64 {
            let at = 5 + step * k;
            let wrapped = (at - least).rem_euclid(modulus) + least;
            // The edge that a forward motion crossed last is the count itself.
            let tick = 84_000 * k;
            text += &format!("{},{wrapped},{k},{tick},{wrapped}\n", k as f64 * 1e-3);
            truth.push(at as u32);
        }
        (Recording::parse(text.as_bytes(), "r").unwrap(), truth)
    }

    fn encoder(counts: u32) -> ReadOptions {
        let mut device = Device::default();
        device.stages.large.counts_per_rev = counts;
        ReadOptions::of(&device)
    }

    #[test]
    fn counts_of_an_absolute_encoder_are_unwrapped() {
        for (counts, step, least) in [
            (4096, 3, 0),
            (4096, -700, 0),
            (16_384, 11, -8192),
            (3600, 200, 0),
        ] {
            let (mut recording, truth) = recording(step, counts, least);
            let said = recording.unwrap_counts(&encoder(counts as u32));
            let start = recording.trace.counts_large[0].wrapping_sub(truth[0]);
            let truth: Vec<_> = truth
                .iter()
                .map(|count| count.wrapping_add(start))
                .collect();
            assert_eq!(recording.trace.counts_large, truth, "{counts} {step}");
            let edges = recording.trace.edges.unwrap();
            let bounds: Vec<_> = edges.iter().map(|edge| edge.unwrap().boundary).collect();
            assert_eq!(bounds, truth, "{counts} {step}");
            assert_eq!(said.len(), 1, "{said:?}");
            assert!(
                said[0].contains(&format!("counts_large wraps at {counts}")),
                "{said:?}"
            );
        }
    }

    /// Rows of an encoder of 4096 counts, without the row at its wrap, and the counts of one without a wrap.
    fn wrap_in_a_gap(missing: std::ops::Range<usize>) -> [Vec<u32>; 2] {
        let rows = (0..200).filter(|k| !missing.contains(k));
        let text: String = rows
            .clone()
            .map(|k| format!("{},{}\n", k as f64 * 1e-3, (4000 + 2 * k) % 4096))
            .collect();
        let text = format!("t,counts_large\n{text}");
        let mut recording = Recording::parse(text.as_bytes(), "r").unwrap();
        let said = recording.unwrap_counts(&encoder(4096));
        let is_said = said.iter().any(|note| note.contains("wraps at 4096"));
        assert_eq!(is_said, missing.len() < 20, "{said:?}");
        let truth = rows.map(|k| 4000 + 2 * k as u32).collect();
        [recording.trace.counts_large, truth]
    }

    #[test]
    fn wrap_over_a_few_missing_rows_is_found() {
        for missing in [48..49, 40..58] {
            let [counts, truth] = wrap_in_a_gap(missing.clone());
            assert_eq!(counts, truth, "{missing:?}");
        }
        // Over more of them a shaft may have turned so far.
        let [counts, truth] = wrap_in_a_gap(40..70);
        assert_ne!(counts, truth);
    }

    #[test]
    fn fast_shaft_does_not_wrap_in_a_gap() {
        // 300 counts from row to row, and 3300 over ten missing rows, within a revolution.
        let text: String = (0..12_u32)
            .filter(|k| *k == 0 || *k == 11)
            .chain(12..14)
            .map(|k| format!("{},{}\n", f64::from(k) * 1e-3, 300 * k))
            .collect();
        let text = format!("t,counts_large\n{text}");
        let mut recording = Recording::parse(text.as_bytes(), "r").unwrap();
        let before = recording.trace.counts_large.clone();
        let _ = recording.unwrap_counts(&encoder(4096));
        assert_eq!(recording.trace.counts_large, before);
    }

    #[test]
    fn counts_of_a_16_bit_counter_are_unwrapped() {
        let (mut recording, truth) = recording(100, 65_536, 0);
        let said = recording.unwrap_counts(&encoder(4096));
        assert_eq!(recording.trace.counts_large, truth);
        assert!(said[0].contains("wraps at 65536"), "{said:?}");
    }

    #[test]
    fn encoder_that_differs_from_the_device_is_reported_and_not_unwrapped() {
        let (mut recording, _) = recording(11, 16_384, 0);
        let before = recording.trace.counts_large.clone();
        let said = recording.unwrap_counts(&encoder(4096));
        let words = "counts, with 4096 counts per revolution: if the encoder is absolute, give its counts \
                     with --counts-per-rev, or as large.counts_per_rev in the file of --device, or \
                     --modulus counts_large=16384 if";
        assert!(said[0].contains(words), "{said:?}");
        assert!(
            said[0].starts_with("counts_large jumps by -16373 "),
            "{said:?}"
        );
        assert_eq!(recording.trace.counts_large, before);
    }

    #[test]
    fn encoder_of_fewer_counts_than_the_device_is_reported() {
        for (modulus, step) in [(1024, 4), (64, 1), (1 << 24, 40_000)] {
            let (mut recording, _) = recording(step, modulus, 0);
            let said = recording.unwrap_counts(&encoder(4096));
            let option = format!("or --modulus counts_large={modulus} if");
            assert!(said[0].starts_with("counts_large jumps by -"), "{said:?}");
            assert!(said[0].contains(&option), "{said:?}");
        }
    }

    /// The modulus is not that of the device, but near it: the step over the wrap would be a jump.
    #[test]
    fn wrap_at_another_modulus_is_reported_and_not_unwrapped() {
        for (modulus, step) in [
            (4000, 7),
            (3600, -3),
            (4096 - 30, 2),
            (50_000, 40),
            (65_000, 40),
        ] {
            let (mut recording, _) = recording(step, modulus, 0);
            let before = recording.trace.counts_large.clone();
            let said = recording.unwrap_counts(&encoder(4096));
            assert_eq!(recording.trace.counts_large, before, "{modulus}");
            assert!(said[0].starts_with("counts_large jumps by "), "{said:?}");
            let power = u64::try_from(modulus).unwrap().next_power_of_two();
            let is_near = modulus > 4000 && modulus < 4096 || modulus == 65_000;
            let option = match is_near {
                true => format!("--modulus counts_large={power} if"),
                false => "--modulus counts_large=N, N about ".to_owned(),
            };
            assert!(said[0].contains(&option), "{said:?}");
        }
    }

    #[test]
    fn incremental_counts_are_not_changed() {
        // Over the wrap of 32 bits, and with a gap in which the shaft turns nearly a revolution.
        let text = "t,counts_large\n0,-2\n0.001,-1\n0.002,1\n0.003,2\n0.1,4000\n0.101,4001\n";
        let mut recording = Recording::parse(text.as_bytes(), "r").unwrap();
        let before = recording.trace.counts_large.clone();
        assert_eq!(
            recording.unwrap_counts(&encoder(4096)),
            Vec::<String>::new()
        );
        assert_eq!(recording.trace.counts_large, before);
        // Over 2^31, where a signed count wraps.
        let row = |k: i64| format!("{},{}\n", k as f64 * 1e-3, (1_i64 << 31) - 90 + 3 * k);
        let text = format!("t,counts_large\n{}", (0..60).map(row).collect::<String>());
        let mut recording = Recording::parse(text.as_bytes(), "r").unwrap();
        assert_eq!(
            recording.unwrap_counts(&encoder(4096)),
            Vec::<String>::new()
        );
    }
}
