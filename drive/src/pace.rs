//! The pace of keep-alives.

use std::time::{Duration, Instant};

use firmware_app::config::{RATE_HZ, SILENCE};

/// Longest silence that a board takes while a scene runs, ms. An image with `auto-arm` takes any.
const SILENCE_MS: u64 = match SILENCE {
    Some(ticks) => ticks as u64 * 1000 / RATE_HZ as u64,
    None => 500,
};

/// Interval of keep-alives: a fifth of that silence, so that a few may be lost.
const INTERVAL: Duration = Duration::from_millis(SILENCE_MS / 5);

/// Says when a keep-alive is due: by the clock of this machine, or by that of the board, which may be
/// an emulated one that runs faster.
pub(crate) struct Pace {
    sent: Instant,
    /// Ticks of the interval.
    ticks: u32,
    tick: Option<u32>,
}

impl Pace {
    /// A pace of a board with this control rate, to which a command was sent `now`.
    pub(crate) fn new(rate_hz: u32, now: Instant) -> Self {
        let ticks = u64::from(rate_hz) * INTERVAL.as_millis() as u64 / 1000;
        Self {
            sent: now,
            ticks: u32::try_from(ticks).unwrap_or(u32::MAX).max(1),
            tick: None,
        }
    }

    /// When the next keep-alive is due by this machine's clock.
    pub(crate) fn next(&self) -> Instant {
        self.sent + INTERVAL
    }

    /// Whether a keep-alive is due, by the present time and the tick of the latest frame. If it is, it
    /// counts as sent.
    pub(crate) fn is_due(&mut self, now: Instant, tick: Option<u32>) -> bool {
        let passed = match (self.tick, tick) {
            (Some(before), Some(tick)) => tick.wrapping_sub(before) >= self.ticks,
            (None, Some(_)) => {
                self.tick = tick;
                false
            }
            (_, None) => false,
        };
        let due = passed || now >= self.next();
        if due {
            (self.sent, self.tick) = (now, tick);
        }
        due
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn keep_alive_is_due_five_times_in_the_longest_silence() {
        let start = Instant::now();
        let mut pace = Pace::new(10_000, start);
        let due: Vec<u64> = (1..=1000)
            .filter(|ms| pace.is_due(start + Duration::from_millis(*ms), None))
            .collect();
        assert_eq!(due, (1..=10).map(|n| n * 100).collect::<Vec<_>>());
    }

    #[test]
    fn keep_alive_follows_a_board_whose_time_runs_faster() {
        let start = Instant::now();
        let mut pace = Pace::new(10_000, start);
        // A frame every 10 ticks; the tick wraps.
        let ticks = (0..500_u32).map(|k| (k * 10).wrapping_sub(2000));
        let due = ticks.filter(|tick| pace.is_due(start, Some(*tick))).count();
        assert_eq!(due, 4);
    }
}
