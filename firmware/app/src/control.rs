//! The control task without I/O: from the inputs of a tick to its outputs.

use drivers::Settings;
use estimator_core::Sample;
use haptic_control::{
    Action, Balance, BalanceState, Currents, Findings, Flow, Mode, Monitor, MonitorState, Request,
    Safety, SafetyState, Stop, Windings, WindingsState,
};

use crate::ammeter::{Ammeter, Measure as _, Measured};
use crate::config::{AUTO_ARM, DEVICE, RATE, RATE_HZ, SILENCE};
use crate::index::{Indexing as _, Indices, Pulses, Reported};
use crate::large::{Choice, Large, LargeEstimator as _};
use crate::scene::{Core, FIRST, SCENES, Tuned};
use crate::schedule::Phase;
use crate::supply::{Reading, Voltmeter, Watch as _};
use crate::telemetry::Record;

const MONITOR: Monitor = Monitor::new(&DEVICE, RATE);
const BALANCE: Balance = Balance::new(&DEVICE, RATE);
const WINDINGS: Windings = Windings::new(&DEVICE, RATE);
/// Control ticks from arming to the first scene, 20 ms: amplifiers take 1 to 10 ms until they
/// are ready and follow a command.
pub const SETTLE: u32 = RATE_HZ / 50;
const SAFETY: Safety = Safety {
    settle: SETTLE,
    silence: SILENCE,
    // Ten times the timeout of a running scene.
    disarm: match SILENCE {
        Some(longest) => Some(10 * longest),
        None => None,
    },
    missed: 4,
    scenes: SCENES,
};

/// Inputs of a tick besides its sample.
pub struct Inputs {
    /// Whether both amplifiers are ready.
    pub amplifiers_ready: bool,
    /// Whether the interlock loop is open, or was open since the amplifiers were last disabled.
    pub interlock: bool,
    /// Whether the core does not run on its crystal.
    pub clock_failure: bool,
    /// Control ticks missed since the last one.
    pub missed: u32,
    /// Debug settings are on that would hold the outputs in a halt.
    pub debugger: bool,
    /// Index pulses since the last tick.
    pub pulses: Pulses,
    /// A request to the safety machine.
    pub request: Option<Request>,
}

/// A command on its way to the control task.
#[derive(Clone, Copy)]
pub enum Message {
    /// A request to the safety state machine.
    Request(Request),
    /// A change of a scene's parameters.
    Tuned(Tuned),
    /// Selection of the large motor's estimator. An image of one estimator has no such message.
    Estimator(Choice),
    /// Changed settings.
    Settings(Settings),
}

/// The control core under its monitor and safety state.
pub struct Control {
    core: Core,
    monitor: MonitorState,
    balance: BalanceState,
    /// Outlives every restart.
    windings: WindingsState,
    ammeter: Ammeter,
    indices: Indices,
    voltmeter: Voltmeter,
    safety: SafetyState,
    /// Action of the latest tick.
    action: Action,
    /// Ticks so far, modulo 2^32.
    ticks: u32,
    /// Of the latest tick.
    phase: Phase,
    overruns: u32,
    /// Whether an image that arms without a command does so.
    auto_arm: bool,
}

impl Control {
    /// State at rest at the first sample, after a reset with the cause `reset`.
    ///
    /// `brown_out_reset` states whether a falling supply resets the chip with a cause of its own.
    /// Without this reset a dip of the supply looks like power-on. An image that arms by itself
    /// then waits for a command, so that the device does not drive again after a dip. It also waits
    /// until the signs have been verified.
    pub fn new(first: &Sample, reset: Stop, brown_out_reset: bool, settings: &Settings) -> Self {
        let mut core = Core::start(first);
        core.scale(settings.current_scale());
        // A number that this image does not have leaves its first estimator in charge.
        if let Some(choice) = Large::choice(settings.estimator()) {
            core.choose(choice);
        }
        let mut indices = Indices::start();
        indices.offset(settings.offsets());
        let phase = Phase::START;
        let (monitor, balance) = checks(first, phase);
        Self {
            core,
            monitor,
            balance,
            windings: WindingsState::cold(),
            ammeter: Ammeter::new(),
            indices,
            voltmeter: Voltmeter::unread(),
            safety: SAFETY.start(reset),
            action: Action::default(),
            ticks: 0,
            phase,
            overruns: 0,
            auto_arm: AUTO_ARM && brown_out_reset && settings.are_signs_verified(),
        }
    }

    /// Currents commanded over the period that ends now.
    pub fn applied(&self) -> Currents {
        self.action.currents
    }

    /// Whether the next tick takes a message, if one waits.
    pub const fn takes_message(&self) -> bool {
        self.phase.next().takes_message()
    }

    /// Whether the latest tick makes a telemetry frame.
    pub fn makes_frame(&self) -> bool {
        self.phase == Phase::FRAME
    }

    /// Mean measured currents since the last call.
    pub fn take_measured(&mut self) -> Measured {
        self.ammeter.take_means()
    }

    /// Index pulses, at the sample of the latest tick.
    pub fn take_index(&mut self, sample: &Sample) -> Reported {
        self.indices.take_reported(sample)
    }

    /// Takes a reading of the supply, one for each telemetry frame. The next tick has its finding.
    pub fn watch(&mut self, supply: &Reading) {
        self.voltmeter.take(supply);
    }

    /// Currents over the period that ends now: those measured, or those commanded in an image that
    /// measures none.
    pub fn flow(&mut self, readings: &Measured) -> Flow {
        let enabled = self.safety.mode().is_enabled();
        self.ammeter
            .update(readings, &self.action.currents, enabled)
    }

    /// Applies a message before the tick and returns the request for the safety state machine.
    /// Parameter changes also count as keep-alives.
    pub fn accept(&mut self, message: Option<Message>) -> Option<Request> {
        match message? {
            Message::Request(request) => Some(request),
            Message::Tuned(tuned) => {
                self.core.retune(tuned);
                Some(Request::KeepAlive)
            }
            Message::Estimator(choice) => {
                self.core.choose(choice);
                Some(Request::KeepAlive)
            }
            Message::Settings(settings) => {
                self.core.scale(settings.current_scale());
                self.indices.offset(settings.offsets());
                Some(Request::KeepAlive)
            }
        }
    }

    /// One tick, after the currents of [`Self::flow`]: the currents to apply, `None` with the
    /// amplifiers disabled.
    pub fn step(&mut self, sample: &Sample, flow: &Flow, inputs: &Inputs) -> Option<Currents> {
        let before = self.phase;
        self.phase = before.next();
        self.overruns = self.overruns.wrapping_add(inputs.missed);
        let overload = WINDINGS.check(&mut self.windings, &flow.currents);
        let lost_counts = self.indices.check(&inputs.pulses);
        if inputs.missed > 0 {
            self.balance.begin_after(before.until(Phase::BALANCE));
        }
        let unbalanced = BALANCE.check(&mut self.balance, sample);
        let mut action = self.core.step(sample);
        let findings = Findings {
            monitor: MONITOR
                .check(&mut self.monitor, sample)
                .or(overload)
                .or(flow.mismatch)
                .or(lost_counts)
                .or(unbalanced),
            amplifiers_ready: inputs.amplifiers_ready,
            interlock: inputs.interlock,
            clock_failure: inputs.clock_failure,
            finite: is_finite(&action),
            missed: inputs.missed,
            debugger: inputs.debugger,
            supply: self.voltmeter,
        };
        let request = inputs.request.or_else(|| self.auto_arm_request());
        let order = SAFETY.tick(&mut self.safety, &findings, request);
        if order.restart {
            self.core.restart(sample);
            (self.monitor, self.balance) = checks(sample, self.phase);
            self.ammeter.restart();
            self.indices.forget();
        }
        if let Some(scene) = order.select {
            self.core.select(scene, sample);
        }
        if order.restart || !order.enable {
            action.currents = Currents::default();
        }
        self.action = action;
        self.ticks = self.ticks.wrapping_add(1);
        order.enable.then_some(action.currents)
    }

    /// Telemetry record of the latest tick, whose sample is given. It is built on demand, because
    /// most ticks are not reported.
    pub fn record(&self, sample: &Sample) -> Record {
        Record {
            tick: self.ticks.wrapping_sub(1),
            sample: *sample,
            action: self.action,
            state: self.safety.mode(),
            cause: self.safety.stop(),
            overruns: self.overruns,
            estimation: self.core.estimation(),
            learned: self.core.learned(),
        }
    }

    /// Request of an image that arms without a command. It arms after boot, and not from the mode
    /// safe.
    fn auto_arm_request(&self) -> Option<Request> {
        const ARM: u32 = RATE_HZ / 10;
        const SELECT: u32 = ARM - 1;
        if !self.auto_arm {
            return None;
        }
        match (self.ticks, self.safety.mode()) {
            (SELECT, Mode::Boot) => Some(Request::Select(FIRST)),
            (ARM, Mode::Boot) => Some(Request::Arm),
            _ => None,
        }
    }
}

/// Monitor and balance at rest, at the sample of a tick of this phase.
fn checks(sample: &Sample, phase: Phase) -> (MonitorState, BalanceState) {
    let (mut monitor, mut balance) = (MONITOR.start(sample), BALANCE.start(sample));
    MONITOR.end_slot_after(&mut monitor, phase.until(Phase::SLOT));
    balance.begin_after(phase.until(Phase::BALANCE));
    (monitor, balance)
}

/// Currents cannot be anything else.
fn is_finite(action: &Action) -> bool {
    // A sum of finite numbers is finite or too large, that of others never.
    let sum = action.torque.0 + action.large_velocity.0 + action.handle_velocity.0;
    sum.is_finite() || are_finite(action)
}

fn are_finite(action: &Action) -> bool {
    action.torque.0.is_finite()
        && action.large_velocity.0.is_finite()
        && action.handle_velocity.0.is_finite()
}

#[cfg(test)]
mod tests {
    use super::*;
    use haptic_control::{NewtonMetres, RadPerS};

    #[test]
    fn action_with_one_non_finite_number_is_detected() {
        assert!(is_finite(&Action::default()));
        // A sum that is too large says nothing.
        assert!(is_finite(&Action {
            large_velocity: RadPerS(3e38),
            handle_velocity: RadPerS(3e38),
            ..Action::default()
        }));
        let zero = Action::default;
        for number in [f32::NAN, f32::INFINITY] {
            assert!(!is_finite(&Action {
                torque: NewtonMetres(number),
                ..zero()
            }));
            assert!(!is_finite(&Action {
                large_velocity: RadPerS(number),
                ..zero()
            }));
            assert!(!is_finite(&Action {
                handle_velocity: RadPerS(number),
                ..zero()
            }));
        }
    }
}
