//! Frames of the image as the CSV that `host-sim replay` reads.

use crate::run::{Outcome, RATE_HZ};

impl Outcome {
    /// One row a frame, time from the first. `true_omega` is the plant's.
    ///
    /// Counters of 16 bits are carried on to 32, so that a recording may run over their wrap.
    #[must_use]
    pub fn csv(&self) -> String {
        let mut text = "t,counts_large,counts_small,current,true_omega\n".to_owned();
        let Some(first) = self.telemetry.frames.first() else {
            return text;
        };
        let (mut last, mut counts) = (first, [first.large, first.small]);
        for frame in &self.telemetry.frames {
            let t = f64::from(frame.tick.wrapping_sub(first.tick)) / RATE_HZ;
            let moved = [(frame.large, last.large), (frame.small, last.small)]
                .map(|(now, before)| i32::from(now.wrapping_sub(before) as u16 as i16));
            counts = [0, 1].map(|n| counts[n].wrapping_add_signed(moved[n]));
            last = frame;
            let omega = self.tick(frame).map(|tick| tick.large.omega.to_string());
            let omega = omega.unwrap_or_default();
            let [large, small] = counts;
            text += &format!("{t:.4},{large},{small},{},{omega}\n", frame.il);
        }
        text
    }
}
