//! Frames of one start of the firmware.

use super::{Boot, Frame, Telemetry};

/// The frames between two resets.
#[derive(Clone, Debug)]
pub struct Run<'a> {
    /// The start of the firmware; `None` if the stream begins after its boot line.
    pub boot: Option<Boot>,
    /// Frames, with their ticks from the first.
    pub frames: Vec<(u64, &'a Frame)>,
    /// Missing frames.
    pub gaps: Gaps,
}

/// Missing and damaged frames of a run.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Gaps {
    /// Number of places with missing frames.
    pub places: u64,
    /// Number of missing frames, from the sequence numbers.
    pub frames: u64,
    /// Number of damaged frames, whose sequence number or tick does not fit their neighbours.
    pub strays: u64,
}

impl Telemetry {
    /// The runs, in order.
    ///
    /// A run ends at a boot line, or where sequence number and tick restart. A frame whose numbers
    /// fit neither its predecessor nor its successor is damaged and left out. The first frame of the firmware
    /// begins a run even if no frame follows it: a session ends there.
    #[must_use]
    pub fn runs(&self) -> Vec<Run<'_>> {
        let decimations = self.decimations();
        let of_boot = |boot: Option<&Boot>| {
            let rate = boot.map(|boot| boot.rate_hz);
            let found = decimations.iter().find(|(of, _)| *of == rate);
            found.map_or(1, |(_, decimation)| *decimation)
        };
        let mut decimation = of_boot(None);
        let mut runs: Vec<Run> = Vec::new();
        let mut boots = self.boots.iter().peekable();
        for (at, frame) in self.frames.iter().enumerate() {
            let mut booted = None;
            while let Some(boot) = boots.next_if(|boot| boot.after <= at) {
                booted = Some(*boot);
                decimation = of_boot(Some(boot));
            }
            if let (None, Some(run)) = (booted, runs.last_mut()) {
                if run.take(frame, decimation) {
                    continue;
                }
                let boots_next = boots.peek().is_some_and(|boot| boot.after <= at + 1);
                let next = self.frames.get(at + 1).filter(|_| !boots_next);
                let last = run.frames.last().map_or(frame, |(_, last)| last);
                let begins =
                    |next| !follows(last, next, decimation) && follows(frame, next, decimation);
                let goes_on = next.is_some_and(|next| follows(last, next, decimation));
                if !next.is_some_and(begins) && (goes_on || !is_first(frame, decimation)) {
                    run.gaps.strays += 1;
                    continue;
                }
            }
            // Without a boot line the image has not changed.
            let boot = booted.or_else(|| runs.last().and_then(|run| run.boot));
            runs.push(Run {
                boot,
                frames: vec![(0, frame)],
                gaps: Gaps::default(),
            });
        }
        runs
    }

    /// Control ticks from frame to frame, for each control rate of a boot line: the most frequent difference in the
    /// frames after such lines.
    fn decimations(&self) -> Vec<(Option<f64>, u32)> {
        let mut apart: Vec<(Option<f64>, Vec<u32>)> = Vec::new();
        let (mut begin, mut rate) = (0, None);
        let ends = self
            .boots
            .iter()
            .map(|boot| (boot.after, Some(boot.rate_hz)));
        for (end, next) in ends.chain([(self.frames.len(), None)]) {
            let frames = self.frames.get(begin..end).unwrap_or_default();
            let neighbours = frames.windows(2).filter_map(|pair| {
                let [ticks, frames] = steps(&pair[0], &pair[1])?;
                (frames == 1).then_some(ticks)
            });
            match apart.iter_mut().find(|(of, _)| *of == rate) {
                Some((_, all)) => all.extend(neighbours),
                None => apart.push((rate, neighbours.collect())),
            }
            (begin, rate) = (end, next);
        }
        let most_frequent = |mut apart: Vec<u32>| {
            apart.sort_unstable();
            let longest = apart.chunk_by(u32::eq).max_by_key(|same| same.len());
            longest.map_or(1, |same| same[0])
        };
        let each = apart.into_iter();
        each.map(|(rate, apart)| (rate, most_frequent(apart)))
            .collect()
    }
}

impl<'a> Run<'a> {
    /// Control rate from the boot line, Hz.
    #[must_use]
    pub fn rate_hz(&self) -> Option<f64> {
        self.boot.map(|boot| boot.rate_hz)
    }

    /// Adds the next frame if it belongs to this run.
    fn take(&mut self, frame: &'a Frame, decimation: u32) -> bool {
        let Some((tick, last)) = self.frames.last().copied() else {
            return false;
        };
        if !follows(last, frame, decimation) {
            return false;
        }
        let Some([ticks, frames]) = steps(last, frame) else {
            return false;
        };
        self.gaps.places += u64::from(frames > 1);
        self.gaps.frames += u64::from(frames - 1);
        self.frames.push((tick + u64::from(ticks), frame));
        true
    }
}

/// Differences of tick and sequence number from `a` to the later `b`; both numbers wrap.
fn steps(a: &Frame, b: &Frame) -> Option<[u32; 2]> {
    let by = [b.tick.wrapping_sub(a.tick), b.seq.wrapping_sub(a.seq)];
    let forward = by.iter().all(|by| (1..=i32::MAX as u32).contains(by));
    forward.then_some(by)
}

/// Whether a frame has the numbers of the first one after a reset.
fn is_first(frame: &Frame, decimation: u32) -> bool {
    frame.seq == 0 && frame.tick <= decimation
}

/// Whether `b` can follow `a`: the number of periods is that of the frames, except that a wrap of
/// the tick shortens one period.
fn follows(a: &Frame, b: &Frame, decimation: u32) -> bool {
    steps(a, b).is_some_and(|by| {
        let [ticks, frames, decimation] = [by[0], by[1], decimation].map(u64::from);
        let longest = frames * decimation;
        ticks == longest || (b.tick < a.tick && ticks < longest && ticks + decimation > longest)
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::telemetry::Boot;

    fn frames(numbers: &[[u32; 2]]) -> Telemetry {
        let frame = |[seq, tick]: &[u32; 2]| Frame {
            seq: *seq,
            tick: *tick,
            ..Frame::default()
        };
        Telemetry {
            frames: numbers.iter().map(frame).collect(),
            ..Telemetry::default()
        }
    }

    fn ticks(run: &Run) -> Vec<u64> {
        run.frames.iter().map(|(tick, _)| *tick).collect()
    }

    #[test]
    fn gaps_are_counted_and_time_continues_over_them() {
        let telemetry = frames(&[[7, 70], [8, 80], [11, 110], [12, 120], [14, 140]]);
        let runs = telemetry.runs();
        assert_eq!(runs.len(), 1);
        assert_eq!(ticks(&runs[0]), [0, 10, 40, 50, 70]);
        let gaps = Gaps {
            places: 2,
            frames: 3,
            strays: 0,
        };
        assert_eq!(runs[0].gaps, gaps);
    }

    #[test]
    fn sequence_number_and_tick_wrap() {
        let max = u32::MAX;
        let telemetry = frames(&[
            [max - 1, max - 15],
            [max, max - 5],
            [0, 0],
            [1, 10],
            [2, 20],
        ]);
        let runs = telemetry.runs();
        assert_eq!(runs.len(), 1);
        assert_eq!(ticks(&runs[0]), [0, 10, 16, 26, 36]);
    }

    #[test]
    fn reset_starts_a_run_with_and_without_a_boot_line() {
        let mut telemetry = frames(&[[5, 50], [6, 60], [0, 0], [1, 10], [0, 0], [1, 10], [2, 20]]);
        telemetry.boots = vec![Boot {
            after: 4,
            rate_hz: 1e4,
            device: None,
            presets: None,
        }];
        let runs = telemetry.runs();
        let lengths: Vec<_> = runs.iter().map(|run| run.frames.len()).collect();
        assert_eq!(lengths, [2, 2, 3]);
        assert_eq!(
            [0, 1, 2].map(|n| runs[n].rate_hz()),
            [None, None, Some(1e4)]
        );
    }

    #[test]
    fn run_without_a_boot_line_is_of_the_image_before() {
        let mut telemetry = frames(&[[0, 0], [1, 20], [2, 40], [0, 0], [1, 20]]);
        telemetry.boots = vec![Boot {
            after: 0,
            rate_hz: 2e4,
            device: None,
            presets: None,
        }];
        let runs = telemetry.runs();
        let rates: Vec<_> = runs.iter().map(Run::rate_hz).collect();
        assert_eq!(rates, [Some(2e4); 2]);
    }

    /// Two images in one log: each boot line states the rate of its frames.
    #[test]
    fn sessions_of_two_control_rates_are_runs_without_damage() {
        let mut telemetry = frames(&[
            [0, 0],
            [1, 10],
            [2, 20],
            [3, 30],
            [0, 0],
            [1, 20],
            [2, 40],
            [0, 5],
            [1, 15],
        ]);
        let boot = |after, rate_hz| Boot {
            after,
            rate_hz,
            device: None,
            presets: None,
        };
        telemetry.boots = vec![boot(0, 1e4), boot(4, 2e4), boot(7, 1e4)];
        let runs = telemetry.runs();
        let found: Vec<_> = runs.iter().map(|run| (run.rate_hz(), ticks(run))).collect();
        let expected = [
            (Some(1e4), vec![0, 10, 20, 30]),
            (Some(2e4), vec![0, 20, 40]),
            (Some(1e4), vec![0, 10]),
        ];
        assert_eq!(found, expected);
        assert!(runs.iter().all(|run| run.gaps == Gaps::default()));
    }

    #[test]
    fn first_frame_after_a_reset_is_a_run_although_the_stream_ends_there() {
        // A frame is sent each ten ticks, the first one after ten at most.
        for tick in [0, 9, 10] {
            let telemetry = frames(&[[5, 50], [6, 60], [7, 70], [0, tick]]);
            let runs = telemetry.runs();
            assert_eq!([0, 1].map(|n| ticks(&runs[n]).len()), [3, 1], "{tick}");
            assert!(runs.iter().all(|run| run.gaps == Gaps::default()));
        }
        for other in [[3, 9], [0, 11]] {
            let telemetry = frames(&[[5, 50], [6, 60], [7, 70], other]);
            let runs = telemetry.runs();
            assert_eq!((runs.len(), runs[0].gaps.strays), (1, 1), "{other:?}");
        }
    }

    #[test]
    fn damaged_frame_is_left_out_and_starts_no_run() {
        for wrong in [
            [9, 4_000_000_000],
            [3, 20],
            [3, 31],
            [2_000_000_000, 30],
            [0, 0],
        ] {
            let telemetry = frames(&[[0, 0], [1, 10], [2, 20], wrong, [4, 40], [5, 50]]);
            let runs = telemetry.runs();
            assert_eq!(runs.len(), 1, "{wrong:?}");
            assert_eq!(ticks(&runs[0]), [0, 10, 20, 40, 50]);
            assert_eq!((runs[0].gaps.strays, runs[0].gaps.frames), (1, 1));
        }
    }
}
