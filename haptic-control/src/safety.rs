//! The firmware's safety state machine, pure.

use crate::monitor::Cause;
use crate::stop::Stop;

/// Where the device is.
///
/// ```text
/// boot -> armed <-> running          arm; select a scene (before or after), or off again
///  ^        |          |
///  +- disarm+----------+-> safe      any stop cause; latched until arm or disarm
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[repr(u8)]
pub enum Mode {
    /// Amplifiers disabled, nothing wrong.
    #[default]
    Boot = 0,
    /// Amplifiers enabled, no scene.
    Armed = 1,
    /// Amplifiers enabled, a scene on.
    Running = 2,
    /// Amplifiers disabled, because of the cause.
    Safe = 3,
}

/// What the world asks for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Request {
    /// Enable the amplifiers; the only way out of safe into armed.
    Arm,
    /// Disable the amplifiers; forgets the cause.
    Disarm,
    /// Put a scene on, by its number; 0 is off.
    Select(u8),
    /// Somebody is still there.
    KeepAlive,
}

/// What one tick found.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Findings {
    /// What the monitor found.
    pub monitor: Option<Cause>,
    /// An amplifier's fault input is active.
    pub amplifier_fault: bool,
    /// The clock is not the crystal's.
    pub clock_failure: bool,
    /// Torque and velocities are finite.
    pub finite: bool,
    /// Control ticks missed since the last one.
    pub missed: u32,
    /// Debug settings are on that would hold the outputs in a halt: a vector catch is set, or the
    /// watchdog is frozen in a halt.
    pub debugger: bool,
}

impl Findings {
    /// A tick at which all is well.
    pub const WELL: Self = Self {
        monitor: None,
        amplifier_fault: false,
        clock_failure: false,
        finite: true,
        missed: 0,
        debugger: false,
    };
}

/// What to do at the end of the tick.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Order {
    /// Amplifiers enabled; otherwise the currents are zero too.
    pub enable: bool,
    /// Start controller and monitor again, at rest.
    pub restart: bool,
    /// Select this scene from the next tick on.
    pub select: Option<u8>,
}

/// The state machine's parameters, in ticks.
///
/// ```
/// use haptic_control::{Findings, Mode, Request, Safety, Stop};
/// const SAFETY: Safety = Safety { silence: Some(5000), missed: 4, scenes: 8 };
/// let mut state = SAFETY.start(Stop::None);
/// assert!(SAFETY.tick(&mut state, &Findings::WELL, Some(Request::Arm)).enable);
/// let fault = Findings { amplifier_fault: true, ..Findings::WELL };
/// assert!(!SAFETY.tick(&mut state, &fault, None).enable);
/// assert_eq!((state.mode(), state.stop()), (Mode::Safe, Stop::AmplifierFault));
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Safety {
    /// Longest silence while running; `None` waits for ever.
    pub silence: Option<u32>,
    /// Missed ticks that stop the device: this many at once, or more than one in 16 for long.
    pub missed: u32,
    /// Scenes there are.
    pub scenes: u8,
}

/// State of a [`Safety`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SafetyState {
    mode: Mode,
    stop: Stop,
    silent: u32,
    /// Ticks missed, times 16, less one for each tick that came.
    debt: u32,
    /// The scene to put on when armed, chosen in boot.
    chosen: u8,
}

impl SafetyState {
    /// Where the device is.
    #[must_use]
    pub const fn mode(&self) -> Mode {
        self.mode
    }

    /// The latched cause.
    #[must_use]
    pub const fn stop(&self) -> Stop {
        self.stop
    }
}

/// What one missed tick weighs against ticks that came.
const MISSED_WEIGHT: u32 = 16;

impl Safety {
    /// State after a reset: safe if the reset had a cause.
    #[must_use]
    pub const fn start(&self, reset: Stop) -> SafetyState {
        SafetyState {
            mode: match reset {
                Stop::None => Mode::Boot,
                _ => Mode::Safe,
            },
            stop: reset,
            silent: 0,
            debt: 0,
            chosen: 0,
        }
    }

    /// One tick. What is wrong now comes before what is asked for.
    pub fn tick(
        &self,
        state: &mut SafetyState,
        findings: &Findings,
        request: Option<Request>,
    ) -> Order {
        let missed = findings.missed.saturating_mul(MISSED_WEIGHT);
        state.debt = state.debt.saturating_sub(1).saturating_add(missed);
        state.silent = match request {
            Some(_) => 0,
            None => state.silent.saturating_add(1),
        };
        let mut order = Order::default();
        match (state.mode, request) {
            (Mode::Boot | Mode::Safe, Some(Request::Arm)) => order = self.arm(state, findings),
            (Mode::Boot | Mode::Safe, Some(Request::Disarm)) => {
                (state.mode, state.stop) = (Mode::Boot, Stop::None);
                state.chosen = 0;
            }
            (Mode::Boot, Some(Request::Select(scene))) if scene < self.scenes => {
                state.chosen = scene;
            }
            (Mode::Boot | Mode::Safe, _) => {}
            (Mode::Armed | Mode::Running, request) => {
                let wrong = self.wrong(state, findings);
                if wrong != Stop::None {
                    (state.mode, state.stop) = (Mode::Safe, wrong);
                    order.restart = true;
                } else {
                    order = self.serve(state, request);
                }
            }
        }
        order.enable = matches!(state.mode, Mode::Armed | Mode::Running);
        order
    }

    fn arm(&self, state: &mut SafetyState, findings: &Findings) -> Order {
        // What the monitor latched and what was missed ends here; what is wrong still refuses.
        state.debt = 0;
        let now = Findings {
            monitor: None,
            missed: 0,
            ..*findings
        };
        let scene = core::mem::take(&mut state.chosen);
        state.stop = match self.wrong(state, &now) {
            Stop::None if findings.debugger => Stop::Debugger,
            wrong => wrong,
        };
        state.mode = match (state.stop, scene) {
            (Stop::None, 0) => Mode::Armed,
            (Stop::None, _) => Mode::Running,
            _ => Mode::Safe,
        };
        Order {
            enable: false,
            restart: true,
            select: (state.mode == Mode::Running).then_some(scene),
        }
    }

    fn serve(&self, state: &mut SafetyState, request: Option<Request>) -> Order {
        let mut order = Order::default();
        match request {
            Some(Request::Disarm) => {
                state.mode = Mode::Boot;
                order.restart = true;
            }
            Some(Request::Select(scene)) if scene < self.scenes => {
                state.mode = if scene == 0 {
                    Mode::Armed
                } else {
                    Mode::Running
                };
                state.stop = Stop::None;
                order.select = Some(scene);
            }
            _ if state.mode == Mode::Running
                && self.silence.is_some_and(|longest| state.silent > longest) =>
            {
                (state.mode, state.stop) = (Mode::Armed, Stop::CommandTimeout);
                order.select = Some(0);
            }
            _ => {}
        }
        order
    }

    fn wrong(&self, state: &SafetyState, findings: &Findings) -> Stop {
        if findings.clock_failure {
            Stop::ClockFailure
        } else if findings.amplifier_fault {
            Stop::AmplifierFault
        } else if let Some(cause) = findings.monitor {
            cause.into()
        } else if !findings.finite {
            Stop::NonFinite
        } else if state.debt >= self.missed.saturating_mul(MISSED_WEIGHT).max(1) {
            Stop::TickOverrun
        } else {
            Stop::None
        }
    }
}
