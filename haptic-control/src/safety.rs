//! The safety state machine of the firmware, as a pure step.

mod findings;
mod mode;

use crate::stop::Stop;
use crate::supply::SupplyFinding;

pub use findings::Findings;
pub use mode::Mode;

/// A request to the state machine, from a command.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Request {
    /// Enable the amplifiers. Only this request changes the mode from safe to armed.
    Arm,
    /// Disable the amplifiers and clear the cause.
    Disarm,
    /// Select a scene by its number; 0 is off.
    Select(u8),
    /// The host is still connected.
    KeepAlive,
}

/// Actions at the end of a tick.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Order {
    /// Enable the amplifiers; otherwise the currents are zero, too.
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
/// const SAFETY: Safety =
///     Safety { settle: 200, silence: Some(5000), disarm: Some(50_000), missed: 4, scenes: 8 };
/// let mut state = SAFETY.start(Stop::None);
/// assert!(SAFETY.tick(&mut state, &Findings::WELL, Some(Request::Arm)).enable);
/// // An amplifier that has just been enabled may take some time until it is ready.
/// let not_ready = Findings { amplifiers_ready: false, ..Findings::WELL };
/// assert!(SAFETY.tick(&mut state, &not_ready, None).enable);
/// let open = Findings { interlock: true, ..Findings::WELL };
/// assert!(!SAFETY.tick(&mut state, &open, None).enable);
/// assert_eq!((state.mode(), state.stop()), (Mode::Safe, Stop::Interlock));
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Safety {
    /// Time after enabling the amplifiers in which no current is commanded. At its end the
    /// amplifiers have to be ready.
    pub settle: u32,
    /// Longest time without a command while running, after which the scene is switched off; `None`:
    /// no limit.
    pub silence: Option<u32>,
    /// Longest time without a command while armed, after which the amplifiers are disabled; `None`:
    /// no limit.
    pub disarm: Option<u32>,
    /// Number of missed ticks that stops the device if they are consecutive. A share of missed
    /// ticks above 1 in 16 stops the device after some time.
    pub missed: u32,
    /// Number of scenes.
    pub scenes: u8,
}

/// State of a [`Safety`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SafetyState {
    mode: Mode,
    stop: Stop,
    /// Ticks without a command at the end of the calm ticks.
    silent: u32,
    /// Number of ticks from now on in which only a finding or a request changes anything. The amplifiers are
    /// enabled throughout.
    calm: u32,
    /// Number of missed ticks times 16, less the number of ticks on time, at least 0.
    debt: u32,
    /// Remaining ticks of settling.
    settling: u32,
    /// The scene to select when the device is armed.
    chosen: u8,
}

impl SafetyState {
    /// State of the device.
    #[must_use]
    pub const fn mode(&self) -> Mode {
        self.mode
    }

    /// The latched cause.
    #[must_use]
    pub const fn stop(&self) -> Stop {
        self.stop
    }

    /// Ends the calm ticks because something is found: [`Safety::pass_calm`] leaves this tick to
    /// [`Safety::tick`].
    pub const fn end_calm(&mut self) {
        self.silent -= self.calm;
        self.calm = 0;
    }

    /// Whether the amplifiers have to be ready: from the last tick of settling on.
    const fn needs_amplifiers(&self) -> bool {
        match self.mode {
            Mode::Boot | Mode::Safe => false,
            Mode::Settling => self.settling <= 1,
            Mode::Armed | Mode::Running => true,
        }
    }
}

/// Restart at rest, without a selection.
const RESTART: Order = Order {
    enable: false,
    restart: true,
    select: None,
};

/// Number of ticks on time that offset one missed tick.
const MISSED_WEIGHT: u32 = 16;

impl Safety {
    /// State after a reset: safe if the reset has a cause.
    #[must_use]
    pub const fn start(&self, reset: Stop) -> SafetyState {
        SafetyState {
            mode: match reset {
                Stop::None => Mode::Boot,
                _ => Mode::Safe,
            },
            stop: reset,
            silent: 0,
            calm: 0,
            debt: 0,
            settling: 0,
            chosen: 0,
        }
    }

    /// One tick. A fault has priority over a request.
    #[inline]
    pub fn tick<S: SupplyFinding + Copy>(
        &self,
        state: &mut SafetyState,
        findings: &Findings<S>,
        request: Option<Request>,
    ) -> Order {
        if findings.are_well() && self.pass_calm(state, request) {
            return Order {
                enable: true,
                ..Order::default()
            };
        }
        self.eventful(state, findings, request)
    }

    /// Passes a tick without findings. Returns whether the amplifiers stay enabled and nothing else changes. If
    /// not, nothing was done, and the tick is left to [`Self::tick`]. A caller that has found something in this
    /// tick calls [`SafetyState::end_calm`] before.
    #[inline]
    pub fn pass_calm(&self, state: &mut SafetyState, request: Option<Request>) -> bool {
        let Some(left) = state.calm.checked_sub(1) else {
            return false;
        };
        match request {
            None => state.calm = left,
            Some(Request::KeepAlive) => self.begin_calm(state, 0),
            Some(_) => return false,
        }
        true
    }

    /// Begins the ticks in which time decides nothing, after this number of ticks without a command.
    #[cold]
    fn begin_calm(&self, state: &mut SafetyState, silent: u32) {
        let longest = match state.mode {
            _ if state.debt > 0 => Some(0),
            Mode::Boot | Mode::Safe | Mode::Settling => Some(0),
            Mode::Running => self.silence,
            Mode::Armed => self.disarm,
        };
        // Silence that may last for ever is not counted: its number would end.
        (state.silent, state.calm) = match longest {
            Some(longest) => (silent, longest.saturating_sub(silent)),
            None => (0, u32::MAX),
        };
        state.silent += state.calm;
    }

    /// A tick of which anything may have to be decided.
    #[cold]
    #[inline(never)]
    fn eventful<S: SupplyFinding + Copy>(
        &self,
        state: &mut SafetyState,
        findings: &Findings<S>,
        request: Option<Request>,
    ) -> Order {
        let missed = findings.missed.saturating_mul(MISSED_WEIGHT);
        state.debt = state.debt.saturating_sub(1).saturating_add(missed);
        state.silent = match request {
            Some(_) => 0,
            None => (state.silent - state.calm).saturating_add(1),
        };
        let mut order = Order::default();
        match (state.mode, request) {
            (Mode::Boot | Mode::Safe, Some(Request::Arm)) => order = self.arm(state, findings),
            (Mode::Boot | Mode::Safe, Some(Request::Disarm)) => {
                order = Self::disarm(state, Stop::None);
            }
            (Mode::Boot, Some(Request::Select(scene))) if scene < self.scenes => {
                state.chosen = scene;
            }
            (Mode::Boot | Mode::Safe, _) => {}
            (Mode::Settling | Mode::Armed | Mode::Running, request) => {
                let wrong = self.fault(state, findings);
                if wrong != Stop::None {
                    (state.mode, state.stop, state.chosen) = (Mode::Safe, wrong, 0);
                    order.restart = true;
                } else if state.mode == Mode::Settling {
                    order = self.settle(state, request);
                } else {
                    order = self.serve(state, request);
                }
            }
        }
        order.enable = state.mode.is_enabled();
        self.begin_calm(state, state.silent);
        order
    }

    fn arm<S: SupplyFinding + Copy>(
        &self,
        state: &mut SafetyState,
        findings: &Findings<S>,
    ) -> Order {
        // Arming clears the latched cause and the missed ticks. A present fault refuses it.
        state.debt = 0;
        let now = Findings {
            monitor: None,
            ..*findings
        };
        state.stop = match self.fault(state, &now) {
            Stop::None if findings.debugger => Stop::Debugger,
            wrong => wrong,
        };
        if state.stop != Stop::None {
            (state.mode, state.chosen) = (Mode::Safe, 0);
            return RESTART;
        }
        (state.mode, state.settling) = (Mode::Settling, self.settle);
        if self.settle == 0 {
            Self::settled(state)
        } else {
            RESTART
        }
    }

    /// One tick of settling.
    fn settle(&self, state: &mut SafetyState, request: Option<Request>) -> Order {
        match request {
            Some(Request::Disarm) => return Self::disarm(state, Stop::None),
            Some(Request::Select(scene)) if scene < self.scenes => state.chosen = scene,
            _ => {}
        }
        state.settling = state.settling.saturating_sub(1);
        if state.settling == 0 {
            Self::settled(state)
        } else {
            Order::default()
        }
    }

    /// The end of settling. Controller and monitor begin at rest here.
    fn settled(state: &mut SafetyState) -> Order {
        let scene = core::mem::take(&mut state.chosen);
        let select = (scene != 0).then_some(scene);
        state.mode = match select {
            Some(_) => Mode::Running,
            None => Mode::Armed,
        };
        Order { select, ..RESTART }
    }

    /// Amplifiers disabled, without a fault.
    fn disarm(state: &mut SafetyState, stop: Stop) -> Order {
        (state.mode, state.stop, state.chosen) = (Mode::Boot, stop, 0);
        RESTART
    }

    fn serve(&self, state: &mut SafetyState, request: Option<Request>) -> Order {
        let mut order = Order::default();
        match request {
            Some(Request::Disarm) => return Self::disarm(state, Stop::None),
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
            _ if self.disarm.is_some_and(|longest| state.silent > longest)
                && state.mode == Mode::Armed =>
            {
                return Self::disarm(state, Stop::CommandTimeout);
            }
            _ => {}
        }
        order
    }

    /// The cause of a stop among the findings. A cause that brings about others comes before them:
    /// missed ticks let hardware disable the amplifiers, and a disabled amplifier is not ready; an amplifier
    /// that lacks its supply reports a fault in the loop, and is not ready.
    fn fault<S: SupplyFinding>(&self, state: &SafetyState, findings: &Findings<S>) -> Stop {
        if findings.clock_failure {
            Stop::ClockFailure
        } else if findings.supply.is_outside() {
            Stop::Supply
        } else if findings.interlock {
            Stop::Interlock
        } else if state.debt >= self.missed.saturating_mul(MISSED_WEIGHT).max(1) {
            Stop::TickOverrun
        } else if !findings.amplifiers_ready && state.needs_amplifiers() {
            Stop::AmplifierFault
        } else if let Some(cause) = findings.monitor.or(findings.present) {
            cause
        } else if !findings.finite {
            Stop::NonFinite
        } else {
            Stop::None
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Without limits of silence a tick without command is calm after any time. The number of silent ticks
    /// ends after 5 days at 10 kHz.
    #[test]
    fn silence_without_a_limit_is_calm_for_ever() {
        let safety = Safety {
            settle: 0,
            silence: None,
            disarm: None,
            missed: 4,
            scenes: 8,
        };
        let mut state = safety.start(Stop::None);
        for request in [Request::Arm, Request::Select(1)] {
            safety.tick(&mut state, &Findings::WELL, Some(request));
            (state.silent, state.calm) = (u32::MAX, 0);
            assert!(safety.tick(&mut state, &Findings::WELL, None).enable);
            assert!(safety.pass_calm(&mut state, None), "{:?}", state.mode);
        }
    }
}
