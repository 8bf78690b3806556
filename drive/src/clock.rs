//! Time by the ticks of a board.

use std::time::{Duration, Instant};

/// Time of a board since the first frame. The tick of a board that starts again begins at 0.
pub(crate) struct Clock {
    rate_hz: f64,
    last: Option<u32>,
    ticks: u64,
}

impl Clock {
    /// The clock of a board with this control rate.
    pub(crate) fn new(rate_hz: u32) -> Self {
        Self {
            rate_hz: f64::from(rate_hz.max(1)),
            last: None,
            ticks: 0,
        }
    }

    /// Seconds from the first frame to this tick.
    pub(crate) fn elapsed(&mut self, tick: u32) -> f64 {
        let step = self.last.map_or(0, |last| tick.wrapping_sub(last));
        self.last = Some(tick);
        // A step back is a start.
        if i32::try_from(step).is_ok() {
            self.ticks += u64::from(step);
        }
        self.ticks as f64 / self.rate_hz
    }
}

/// A limit that has passed once this machine's clock and the board's have both passed it: an emulated
/// board may run slower than real time, and frames of the past may wait to be read.
pub(crate) struct Limit {
    limit: Duration,
    begin: Instant,
    clock: Clock,
}

impl Limit {
    /// A limit that begins `now` and at the first frame.
    pub(crate) fn new(limit: Duration, rate_hz: u32, now: Instant) -> Self {
        Self {
            limit,
            begin: now,
            clock: Clock::new(rate_hz),
        }
    }

    /// Whether the limit has passed at the frame of this tick.
    pub(crate) fn is_over(&mut self, now: Instant, tick: u32) -> bool {
        let elapsed = self.clock.elapsed(tick);
        now >= self.begin + self.limit && elapsed >= self.limit.as_secs_f64()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn time_continues_over_a_wrap_and_a_start() {
        let mut clock = Clock::new(1000);
        let times = [u32::MAX - 9, u32::MAX, 990, 0, 1000].map(|tick| clock.elapsed(tick));
        assert_eq!(times, [0.0, 0.009, 1.0, 1.0, 2.0]);
    }

    #[test]
    fn limit_passes_by_both_clocks() {
        let second = Duration::from_secs(1);
        let begin = Instant::now();
        let limit = || Limit::new(second, 1000, begin);
        let mut fast = limit();
        assert!(!fast.is_over(begin, 0));
        assert!(!fast.is_over(begin, 5000));
        assert!(fast.is_over(begin + second, 5001));
        let mut slow = limit();
        assert!(!slow.is_over(begin, 0));
        assert!(!slow.is_over(begin + 5 * second, 999));
        assert!(slow.is_over(begin + 6 * second, 1000));
    }
}
