//! Summary of the board's own estimates in a recording.

use recordings::health;
use recordings::recording::BoardColumns;
use recordings::telemetry::LearnedLine;
use scoring::score::{is_within_2_sigma, skipped};
use simulation::device::Device;
use simulation::trace::Trace;

/// Summary of the board's own estimates, of a recording that comes in parts.
#[derive(Clone, Debug, Default)]
pub struct BoardSummary {
    /// Number of rows so far, and of those after the start that have the board's estimate.
    rows: usize,
    scored: usize,
    inside: usize,
    learned: Option<LearnedLine>,
}

impl BoardSummary {
    /// Adds what the board learned.
    pub fn learn(&mut self, board: &BoardColumns) {
        self.learned = board.learned.or(self.learned);
    }

    /// Adds rows with a true velocity: `trace` ends with those of `board`.
    pub fn add(&mut self, trace: &Trace, board: &BoardColumns) {
        self.learn(board);
        let (Some(omega), Some(velocity), Some(sigma)) = (
            &trace.true_omega,
            board.column("velocity_large"),
            board.column("sigma_large"),
        ) else {
            return;
        };
        let skip = skipped(trace.rate_hz).saturating_sub(self.rows);
        self.rows += velocity.len();
        let omega = &omega[omega.len().saturating_sub(velocity.len())..];
        for ((velocity, sigma), omega) in velocity.iter().zip(sigma).zip(omega).skip(skip) {
            self.scored += 1;
            let inside = is_within_2_sigma(*velocity as f32, *sigma as f32, *omega);
            self.inside += usize::from(inside);
        }
    }

    /// One line each: the share of samples whose error is within two of the board's standard
    /// deviations, and the parameters that it learned relative to `device`.
    #[must_use]
    pub fn lines(&self, device: &Device) -> Vec<String> {
        let mut lines = Vec::new();
        if self.scored > 0 {
            let percent = 100.0 * self.inside as f64 / self.scored as f64;
            lines.push(format!(
                "the error of the board's velocity_large is within two sigma_large in {percent:.1} % \
                 of the samples"
            ));
        }
        if let Some(learned) = &self.learned {
            lines.extend(health::lines(learned, device));
        }
        lines
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Rows at 1 kHz with a truth of `omega`, of which every `every`th estimate is three deviations off.
    fn rows(rows: usize, omega: f64, every: usize) -> (Trace, BoardColumns) {
        let mut text = String::from("t,counts_large,velocity_large,sigma_large\n");
        for k in 0..rows {
            let off = if k % every == 0 { 0.75 } else { 0.375 };
            text += &format!("{},0,{},0.25\n", k as f64 * 1e-3, omega + off);
        }
        let trace = Trace {
            rate_hz: 1000.0,
            true_omega: Some(vec![omega; rows]),
            ..Trace::default()
        };
        (trace, BoardColumns::parse(text.as_bytes(), "r").unwrap())
    }

    /// What a board has learned is that of the latest part that tells it.
    #[test]
    fn latest_learned_parameters_are_compared() {
        let learned = |damping| {
            let mut board = BoardColumns::default();
            board.learned = Some(LearnedLine {
                damping,
                friction: 0.0,
                torque_constant: 0.0,
            });
            board
        };
        let mut summary = BoardSummary::default();
        for board in [learned(0.3), learned(-0.2), BoardColumns::default()] {
            summary.learn(&board);
        }
        let lines = summary.lines(&Device::default());
        assert!(lines[0].contains("-20.0 %"), "{lines:?}");
    }

    #[test]
    fn share_of_good_estimates_is_that_of_all_parts_after_the_start() {
        let mut summary = BoardSummary::default();
        // The first 100 rows are the start: all of the first part, and 40 rows of the second.
        let (trace, board) = rows(60, 1.0, 1);
        summary.add(&trace, &board);
        let (mut trace, board) = rows(140, -2.0, 4);
        // The trace begins with rows of the part before.
        let before = trace.true_omega.take().unwrap();
        trace.true_omega = Some([vec![50.0; 30], before].concat());
        summary.add(&trace, &board);
        assert_eq!((summary.scored, summary.inside), (100, 75));
        let lines = summary.lines(&Device::default());
        assert_eq!(lines.len(), 1, "{lines:?}");
        assert!(
            lines[0].ends_with("within two sigma_large in 75.0 % of the samples"),
            "{lines:?}"
        );
        // Of a recording without a truth or without standard deviations nothing is said.
        let mut none = BoardSummary::default();
        none.add(&Trace::default(), &board);
        assert_eq!(none.lines(&Device::default()), [""; 0]);
    }
}
