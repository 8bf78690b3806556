//! The pace of an emulated board.

use std::time::{Duration, Instant};

use serde_json::{Value, json};

/// Lag from which on the clock is set back: the board then runs in slow motion and nothing is skipped,
/// instead of running too fast later.
const LAG: Duration = Duration::from_millis(20);
/// Interval over which the pace is measured.
const MEASURED: Duration = Duration::from_millis(500);

/// Holds virtual time at real time, and measures how far it stays behind.
pub(super) struct Pacer {
    /// An instant, and the virtual time then, ns.
    anchor: (Instant, u64),
    measured: (Instant, u64),
    /// Virtual time over real time.
    factor: f64,
    /// Share of the time that was not slept away.
    load: f64,
    slept: Duration,
}

impl Pacer {
    pub(super) fn new() -> Self {
        let start = (Instant::now(), 0);
        Self {
            anchor: start,
            measured: start,
            factor: 1.0,
            load: 0.0,
            slept: Duration::ZERO,
        }
    }

    /// Waits until real time has come to the virtual time `now_ns`.
    pub(super) fn wait(&mut self, now_ns: u64) {
        let (since, from_ns) = self.anchor;
        if now_ns < from_ns {
            *self = Self {
                anchor: (Instant::now(), now_ns),
                measured: (Instant::now(), now_ns),
                ..Self::new()
            };
            return;
        }
        let due = since + Duration::from_nanos(now_ns - from_ns);
        let now = Instant::now();
        if let Some(early) = due.checked_duration_since(now) {
            std::thread::sleep(early);
            self.slept += early;
        } else if now - due > LAG {
            self.anchor = (now, now_ns);
        }
        let (since, from_ns) = self.measured;
        let real = since.elapsed();
        if real >= MEASURED {
            self.factor = (now_ns - from_ns) as f64 * 1e-9 / real.as_secs_f64();
            self.load = 1.0 - (self.slept.as_secs_f64() / real.as_secs_f64()).min(1.0);
            self.measured = (Instant::now(), now_ns);
            self.slept = Duration::ZERO;
        }
    }

    /// For the status.
    pub(super) fn json(&self) -> Value {
        json!({ "factor": self.factor, "load": self.load })
    }
}
