//! Summary of the board's own estimates in a recording.

use recordings::health;
use recordings::recording::BoardColumns;
use recordings::telemetry::LearnedLine;
use scoring::evaluation::is_within_2_sigma;
use scoring::score::SKIP_S;
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
        let skip = ((SKIP_S * trace.rate_hz).round() as usize).saturating_sub(self.rows);
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
