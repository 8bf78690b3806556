//! Telemetry as lines of text.

use drivers::NO_ESTIMATOR;
use drivers::link::{Frame, Hello};
use haptic_control::{Mode, Stop};

use crate::named::estimators;

/// Whether the amplifiers are enabled in a frame.
pub(crate) fn is_enabled(frame: &Frame) -> bool {
    // A state without a name may be an enabled one.
    Mode::from_code(frame.state).is_none_or(Mode::is_enabled)
}

/// Whether a frame has the state to which the command `disarm` leads.
pub(crate) fn is_disarmed(frame: &Frame) -> bool {
    Mode::from_code(frame.state) == Some(Mode::Boot) && frame.cause == Stop::None as u8
}

/// State and cause of a frame.
pub(crate) fn state(frame: &Frame) -> String {
    let state = Mode::from_code(frame.state).map(Mode::as_str);
    let state = state.map_or_else(|| frame.state.to_string(), str::to_owned);
    format!("state {state}, cause {}", cause(frame.cause))
}

/// Name of a cause by its number.
pub(crate) fn cause(code: u8) -> String {
    Stop::from_code(code).map_or_else(|| code.to_string(), |cause| cause.as_str().to_owned())
}

/// A frame of an image as a line with units; the time is that of the board. The voltage of the supply ends the
/// line, if the board has told one, V.
pub(crate) fn line(frame: &Frame, supply: Option<f32>, hello: &Hello) -> String {
    let t = f64::from(frame.tick) / f64::from(hello.rate.max(1));
    let estimator = match frame.estimator {
        NO_ESTIMATOR => "-".to_owned(),
        number => (estimators(hello).get(usize::from(number)))
            .map_or_else(|| number.to_string(), |name| (*name).to_owned()),
    };
    let supply = supply.map_or_else(String::new, |volts| format!(", supply {volts:.2} V"));
    format!(
        "{t:.3} s, {}; torque {:.4} N·m; large {} counts, {:.3} rad/s (sigma {:.3}), {:.3} A, \
         estimator {estimator}; handle {} counts, {:.3} rad/s, {:.3} A; overruns {}, lost frames {}{supply}",
        state(frame),
        frame.torque,
        frame.counts_large as i32,
        frame.velocity_large,
        frame.sigma_large,
        frame.current,
        frame.counts_small as i32,
        frame.velocity_small,
        frame.current_small,
        frame.overruns,
        frame.drops,
    )
}

/// Selects frames at equal intervals of the board's time.
pub(crate) struct Every {
    ticks: u32,
    last: Option<u32>,
}

impl Every {
    /// Intervals of this length.
    pub(crate) fn new(seconds: f64, rate_hz: u32) -> Self {
        Self {
            ticks: (seconds * f64::from(rate_hz)).round() as u32,
            last: None,
        }
    }

    /// Whether the frame is the first one or an interval after the last one that was selected.
    pub(crate) fn selects(&mut self, frame: &Frame) -> bool {
        let due = self
            .last
            .is_none_or(|last| frame.tick.wrapping_sub(last) >= self.ticks);
        if due {
            self.last = Some(frame.tick);
        }
        due
    }
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;
    use crate::named::tests::hello;

    pub(crate) const FRAME: Frame = Frame {
        seq: 5,
        tick: 12_345,
        counts_large: u32::MAX,
        counts_small: 7,
        current: -0.5,
        current_small: 0.25,
        torque: 0.01,
        velocity_large: 1.5,
        velocity_small: -2.25,
        state: 2,
        cause: 0,
        sigma_large: 0.125,
        estimator: 1,
        overruns: 3,
        drops: 4,
        rtt_drops: 6,
        cycles: 900,
    };

    #[test]
    fn line_has_every_quantity_with_its_unit() {
        assert_eq!(
            line(&FRAME, None, &hello(&[])),
            "1.234 s, state running, cause none; torque 0.0100 N·m; large -1 counts, 1.500 rad/s \
             (sigma 0.125), -0.500 A, estimator kalman-triple-steady; handle 7 counts, -2.250 rad/s, 0.250 A; \
             overruns 3, lost frames 4"
        );
        let with_supply = line(&FRAME, Some(23.996), &hello(&[]));
        assert!(
            with_supply.ends_with(", lost frames 4, supply 24.00 V"),
            "{with_supply}"
        );
        let odd = Frame {
            state: 200,
            cause: 99,
            ..FRAME
        };
        assert_eq!(state(&odd), "state 200, cause 99");
        assert!(is_enabled(&odd) && is_enabled(&FRAME));
        assert!(!is_enabled(&Frame { state: 3, ..FRAME }));
    }

    /// The command clears the cause: a frame with one is from before.
    #[test]
    fn board_is_disarmed_in_the_state_boot_without_a_cause() {
        for (state, cause, is) in [
            (Mode::Boot, Stop::None, true),
            (Mode::Boot, Stop::Stall, false),
            (Mode::Safe, Stop::None, false),
            (Mode::Armed, Stop::None, false),
        ] {
            let frame = Frame {
                state: state as u8,
                cause: cause as u8,
                ..FRAME
            };
            assert_eq!(is_disarmed(&frame), is, "{state:?} {cause:?}");
        }
    }

    #[test]
    fn frames_are_selected_at_intervals_of_the_board() {
        let mut every = Every::new(0.1, 10_000);
        let selected: Vec<u32> = (0..350)
            .map(|k| (10 * k as u32).wrapping_sub(500))
            .filter(|tick| {
                every.selects(&Frame {
                    tick: *tick,
                    ..FRAME
                })
            })
            .map(|tick| tick.wrapping_add(500))
            .collect();
        assert_eq!(selected, [0, 1000, 2000, 3000]);
    }
}
