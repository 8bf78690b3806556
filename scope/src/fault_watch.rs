//! What a fault does: the time until the amplifiers are off, the cause, the force.

use drivers::link::Frame;
use haptic_control::{Mode, Stop};
use serde_json::{Value, json};
use virtual_board::fault::Fault;

/// Virtual time for which a fault is watched, ns.
const WATCHED_NS: u64 = 1_000_000_000;

/// A fault that was injected, and what followed.
pub(crate) struct FaultWatch {
    fault: Fault,
    at_ns: u64,
    /// Whether an amplifier was enabled at the fault.
    was_on: bool,
    off_ns: Option<u64>,
    cause: Option<Stop>,
    /// Largest force at the fingertip since the fault, mN.
    peak_mn: f64,
    is_over: bool,
}

/// The first sentence of a text.
pub(crate) fn sentence(text: &str) -> &str {
    let text = text.trim();
    text.split_once(". ")
        .map_or(text, |(first, _)| first)
        .trim_end_matches('.')
}

impl FaultWatch {
    pub(crate) fn new(fault: Fault, at_ns: u64, was_on: bool) -> Self {
        Self {
            fault,
            at_ns,
            was_on,
            off_ns: None,
            cause: None,
            peak_mn: 0.0,
            is_over: false,
        }
    }

    /// Takes the changes of the enables.
    pub(crate) fn enables(&mut self, changes: &[(u64, [bool; 2])]) {
        let off = changes
            .iter()
            .find(|(at, on)| *at >= self.at_ns && *on == [false; 2]);
        self.off_ns = self.off_ns.or(off.map(|(at, _)| *at));
    }

    /// Takes a frame and the force at the fingertip, mN.
    pub(crate) fn frame(&mut self, now_ns: u64, frame: &Frame, force_mn: f64) {
        self.is_over |= now_ns >= self.at_ns + WATCHED_NS;
        if self.is_over {
            return;
        }
        if force_mn.is_finite() {
            self.peak_mn = self.peak_mn.max(force_mn.abs());
        }
        let stop = Stop::from_code(frame.cause).filter(|stop| *stop != Stop::None);
        if Mode::from_code(frame.state) == Some(Mode::Safe) || self.off_ns.is_some() {
            self.cause = self.cause.or(stop);
        }
    }

    /// The result for the page.
    pub(crate) fn json(&self) -> Value {
        json!({
            "name": self.fault.as_str(),
            "what": self.fault.description(),
            "was_on": self.was_on,
            "off_ms": self.off_ns.map(|at| (at - self.at_ns) as f64 * 1e-6),
            "cause": self.cause.map(Stop::as_str),
            "words": self.cause.map(|cause| sentence(cause.meaning())),
            "peak_mn": self.peak_mn,
            "is_over": self.is_over,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A fault at 1 ms.
    fn watch() -> FaultWatch {
        let fault = "stuck-a".parse().expect("a fault");
        FaultWatch::new(fault, 1_000_000, true)
    }

    fn frame(state: Mode, cause: Stop) -> Frame {
        Frame {
            state: state as u8,
            cause: cause as u8,
            ..Frame::default()
        }
    }

    #[test]
    fn time_until_off_is_that_of_both_amplifiers_since_the_fault() {
        let mut watch = watch();
        watch.enables(&[(500_000, [false; 2]), (600_000, [true; 2])]);
        watch.enables(&[(2_000_000, [false, true])]);
        assert!(watch.json()["off_ms"].is_null());
        watch.enables(&[(3_500_000, [false; 2]), (9_000_000, [false; 2])]);
        watch.enables(&[(12_000_000, [false; 2])]);
        assert_eq!(watch.json()["off_ms"], 2.5);
    }

    #[test]
    fn cause_is_the_first_one_after_which_the_board_is_off() {
        let mut watch = watch();
        for (state, cause) in [
            // A silence switched the scene off before.
            (Mode::Armed, Stop::CommandTimeout),
            (Mode::Safe, Stop::Stall),
            (Mode::Safe, Stop::Jump),
        ] {
            watch.frame(2_000_000, &frame(state, cause), 0.0);
        }
        assert_eq!(watch.json()["cause"], Stop::Stall.as_str());
    }

    #[test]
    fn peak_is_the_largest_force_to_either_side_within_a_second() {
        let mut watch = watch();
        let frame = frame(Mode::Running, Stop::None);
        for (ms, force_mn) in [(2, 3.0), (3, -7.0), (4, f64::NAN), (1001, 50.0)] {
            watch.frame(ms * 1_000_000, &frame, force_mn);
        }
        assert_eq!(watch.json()["peak_mn"], 7.0);
        assert_eq!(watch.json()["is_over"], true);
    }
}
