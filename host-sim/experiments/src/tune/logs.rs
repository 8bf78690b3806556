//! Search of the parameters on recordings.
//!
//! Blocks of [`BLOCK_S`] of each recording alternate: on the first, the third and so on the search
//! minimises the RMS error, on the others the result is compared with the parameters as they were. An
//! estimator runs over the whole recording. The first [`WARM_UP_S`] of each block are not scored, so
//! that no error of a block is due to the motion of the block before it.

use rayon::prelude::*;

use super::search::{best_values, ends_of_ranges};
use crate::reference::Reference;
use catalogue::estimators::{Kind, Lack, Setup, Values};
use catalogue::parameters::{Parameters, PlantKind, Preset};
use recordings::recording::Recording;
use simulation::device::Device;
use simulation::trace::Trace;
use terminal::failure::Failure;

/// Duration of a block, s.
const BLOCK_S: f64 = 1.0;

/// Duration at the start of each block that is not scored, s.
const WARM_UP_S: f64 = 0.1;

/// Shortest recording, in blocks.
const FEWEST_BLOCKS: f64 = 4.0;

/// Largest relative difference between the rates of the recordings.
const SAME_RATE: f64 = 0.01;

/// Result of tuning on recordings.
#[derive(Clone, Debug)]
pub struct LogTuning {
    /// The parameters, those of the estimators whose old ones are kept too.
    pub preset: Preset,
    /// The errors of each estimator.
    pub rows: Vec<LogRow>,
    /// One line for each parameter at a limit of its range, each estimator that is left out, and each
    /// recording without a true velocity.
    pub notes: Vec<String>,
}

/// RMS errors of one estimator, rad/s, in the tuned and in the held-out half.
#[derive(Clone, Debug)]
pub struct LogRow {
    /// Name of the estimator.
    pub estimator: &'static str,
    /// With the parameters as they were.
    pub before: [f64; 2],
    /// With the parameters that the search found.
    pub found: [f64; 2],
    /// Whether the parameters are kept as they were, because the found ones are not better in the
    /// held-out half.
    pub kept: bool,
}

/// A recording and the velocity that estimates are compared with, rad/s.
struct Track<'a> {
    trace: &'a Trace,
    omega: Vec<f64>,
}

/// Tunes the estimators `kinds`, which must have parameters, on recordings with their names, beginning
/// with the parameters `before`. Calls `done` after each.
///
/// # Errors
/// [`Failure::Input`] if a recording is too short, has another rate than the first or has neither a
/// true velocity nor enough motion to estimate one, or if no estimator has the columns that it needs.
pub fn tune_on_logs(
    recordings: &[(String, Recording)],
    device: &Device,
    kinds: &[&'static Kind],
    before: &Parameters,
    done: impl Fn() + Sync,
) -> Result<LogTuning, Failure> {
    let mut notes = Vec::new();
    let rate_hz = recordings.first().map_or(0.0, |(_, r)| r.trace.rate_hz);
    let mut tracks = Vec::new();
    for (name, recording) in recordings {
        let (trace, said) = track(name, recording, rate_hz, device)?;
        tracks.push(trace);
        notes.extend(said);
    }
    let setup = Setup::of(device, rate_hz);
    let mut rows = Vec::new();
    let mut preset = Preset {
        rate_hz,
        plant: PlantKind::Friction,
        counts_per_rev: Some(device.stages.large.counts_per_rev),
        estimators: Default::default(),
    };
    for &kind in kinds {
        if let Some(lack) = tracks.iter().find_map(|track| kind.lack(track.trace)) {
            let why = match lack {
                Lack::Column(_) => "it needs other columns",
                Lack::ConstantPeriod => "it assumes a constant period",
            };
            notes.push(format!("{}: left out, {why}", kind.name));
            done();
            continue;
        }
        let old = before.values(kind, &setup, PlantKind::Friction);
        let found = best_values(kind, &setup, |values, _| {
            errors(kind, &setup, &tracks, values)[0]
        });
        let [before, after] = [&old, &found].map(|values| errors(kind, &setup, &tracks, values));
        let kept = after[1] >= before[1];
        if !kept {
            notes.extend(ends_of_ranges(kind, &setup, &found));
        } else if old != found {
            notes.push(format!(
                "{}: the parameters are kept; the ones found are not better in the held-out half",
                kind.name
            ));
        }
        let names = kind.parameters.iter().map(|p| p.name.to_owned());
        let values = if kept { old } else { found };
        let values = names.zip(values).collect();
        preset.estimators.insert(kind.name.to_owned(), values);
        rows.push(LogRow {
            estimator: kind.name,
            before,
            found: after,
            kept,
        });
        done();
    }
    match rows.is_empty() {
        false => Ok(LogTuning {
            preset,
            rows,
            notes,
        }),
        true => Err(Failure::Input(format!(
            "{}: no estimator to tune has the columns that it needs; see host-sim estimators",
            recordings.first().map_or("", |(name, _)| name)
        ))),
    }
}

/// The recording's track, with a note if the velocity is not in the recording.
fn track<'a>(
    name: &str,
    recording: &'a Recording,
    rate_hz: f64,
    device: &Device,
) -> Result<(Track<'a>, Option<String>), Failure> {
    let trace = &recording.trace;
    let refused = |why: String| Err(Failure::Input(format!("{name}: {why}")));
    if (trace.rate_hz / rate_hz - 1.0).abs() > SAME_RATE {
        return refused(format!(
            "its rate is {} Hz and that of the first recording {rate_hz} Hz; give --resample, or tune each \
             rate on its own",
            trace.rate_hz
        ));
    }
    let seconds = trace.len() as f64 / trace.rate_hz;
    if seconds < FEWEST_BLOCKS * BLOCK_S {
        return refused(format!(
            "{seconds} s are too short; tuning needs {} s, of which every second one is held out",
            FEWEST_BLOCKS * BLOCK_S
        ));
    }
    let (omega, note) = match &trace.true_omega {
        Some(omega) => (omega.clone(), None),
        None => match Reference::of(recording, device.stages.large.counts_per_rev) {
            Err(why) => return refused(format!("no column true_omega, and no reference: {why}")),
            Ok(reference) => {
                let sd = reference.rms_sd(rate_hz);
                let note = format!(
                    "{name}: no column true_omega; errors are those against a smoother of the log itself, \
                     whose own standard deviation is {sd:.3} rad/s"
                );
                (reference.omega, Some(note))
            }
        },
    };
    Ok((Track { trace, omega }, note))
}

/// RMS errors in the tuned and in the held-out half, rad/s; infinite if the estimator's design refuses
/// the values or an estimate is not finite.
fn errors(kind: &Kind, setup: &Setup, tracks: &[Track], values: &Values) -> [f64; 2] {
    let Ok(estimator) = kind.build(setup, values) else {
        return [f64::INFINITY; 2];
    };
    let of_track = |track: &Track| {
        let velocity = estimator.run(track.trace);
        halves(&velocity, &track.omega, setup.rate.0)
    };
    let sums: Vec<_> = tracks.par_iter().map(of_track).collect();
    [0, 1].map(|half| {
        let squares: f64 = sums.iter().map(|sums| sums[half].0).sum();
        let samples: f64 = sums.iter().map(|sums| sums[half].1).sum();
        match (squares / samples).sqrt() {
            rms if rms.is_finite() => rms,
            _ => f64::INFINITY,
        }
    })
}

/// Sum of the squared errors and number of the scored samples of each half.
fn halves(velocity: &[f32], omega: &[f64], rate_hz: f64) -> [(f64, f64); 2] {
    let [block, warm_up] = [BLOCK_S, WARM_UP_S].map(|s| ((s * rate_hz).round() as usize).max(1));
    let mut halves = [(0.0, 0.0); 2];
    let blocks = velocity.chunks(block).zip(omega.chunks(block));
    for (number, (velocity, omega)) in blocks.enumerate() {
        let (squares, samples) = &mut halves[number % 2];
        for (velocity, omega) in velocity.iter().zip(omega).skip(warm_up) {
            *squares += (f64::from(*velocity) - omega).powi(2);
            *samples += 1.0;
        }
    }
    halves
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn samples_of_alternate_seconds_are_in_the_halves() {
        // Ten samples a second, of which the first is not scored.
        let velocity: Vec<f32> = (0..30)
            .map(|k| if k % 10 == 0 { 9.0 } else { 1.0 })
            .collect();
        let omega: Vec<_> = (0..30)
            .map(|k| if k / 10 == 1 { 3.0 } else { 0.0 })
            .collect();
        assert_eq!(halves(&velocity, &omega, 10.0), [(18.0, 18.0), (36.0, 9.0)]);
    }
}
