//! Counts of 64 bits that wrap at a revolution or at 16 bits.

use estimator_core::Count;

use super::absolute::{self, Found};
use super::steps::Steps;

/// Unwraps the `counts` of the column `column` at the times `t`, s, as
/// [`Recording::unwrap_counts`](super::Recording::unwrap_counts) does for an encoder with `per_rev` counts
/// per revolution. Returns the same line; `remedy` says how other counts per revolution are given.
pub fn unwrap_long_counts(
    counts: &mut [i64],
    t: &[f64],
    per_rev: u32,
    column: &str,
    remedy: &str,
) -> Option<String> {
    let steps = Steps::with_counts(t, |k| counts[k]);
    let jump = steps.largest_jump(steps.period("").ok()?.0, 0);
    let span = counts.iter().max()? - counts.iter().min()?;
    let mut found = absolute::found(jump, span, per_rev)?;
    if let Found::Wraps(modulus) = found {
        let mut last = None;
        let unwrapped = counts.iter().map(|&count| {
            let next = absolute::after(last, count as u32, modulus)?;
            last = Some(next);
            Ok(next)
        });
        match unwrapped.collect::<Result<Vec<Count>, _>>() {
            Err(error) => found = Found::Refused(modulus, error),
            Ok(unwrapped) => {
                for (k, pair) in unwrapped.windows(2).enumerate() {
                    let step = pair[1].0.wrapping_sub(pair[0].0) as i32;
                    counts[k + 1] = counts[k] + i64::from(step);
                }
            }
        }
    }
    Some(match found {
        Found::Jumps(jump, span) => format!(
            "{column} jumps by {jump} from one row to the next and spans {span} counts, with {per_rev} \
             counts per revolution: if the encoder is absolute, give its counts {remedy}"
        ),
        found => found.note(column, "large", per_rev),
    })
}
