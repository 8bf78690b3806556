//! The control task without I/O: from the inputs of a tick to its outputs.

mod exchange;

use drivers::Settings;
use estimator_core::Sample;
use haptic_control::{
    Action, Balance, BalanceState, Currents, Findings, Flow, Monitor, MonitorState, Order, Request,
    Safety, SafetyState, Stop, SupplyFinding as _, Windings, WindingsState,
};

use crate::ammeter::{Ammeter, Measure as _, Measured};
use crate::config::{AUTO_ARM, DEVICE, RATE, RATE_HZ, SILENCE};
use crate::index::{Indexing as _, Indices, Pulses, Reported};
use crate::large::{Large, LargeEstimator as _};
use crate::scene::{Core, FIRST, SCENES};
use crate::schedule::{Due, Phase};
use crate::supply::{Reading, Voltmeter, Watch as _};
use crate::telemetry::Record;

pub use exchange::{Faults, Inputs, Message, Outputs};

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

/// What becomes of the currents of a tick.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Decision {
    /// They are applied.
    Drive,
    /// The amplifiers are enabled without current.
    Enable,
    /// The amplifiers are disabled.
    Disable,
}

/// The control core under its monitor and safety state.
// The core may be large and comes last, so that a float load, which reaches 1020 bytes, reaches the rest.
#[repr(C)]
pub struct Control {
    /// Of the latest tick.
    phase: Phase,
    /// Periods of telemetry frames before the latest tick, modulo 2^32.
    period: u32,
    overruns: u32,
    safety: SafetyState,
    /// Finding of [`Self::check`] in the present tick, which is not calm then.
    found: Option<Stop>,
    /// Whether an image that arms without a command still has to.
    auto_arm: bool,
    monitor: MonitorState,
    /// Outlives every restart.
    windings: WindingsState,
    balance: BalanceState,
    ammeter: Ammeter,
    indices: Indices,
    voltmeter: Voltmeter,
    core: Core,
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
            found: None,
            phase,
            // The first tick begins period 0.
            period: u32::MAX,
            overruns: 0,
            auto_arm: AUTO_ARM
                && reset == Stop::None
                && brown_out_reset
                && settings.are_signs_verified(),
        }
    }

    /// Currents commanded over the period that ends now.
    pub const fn applied(&self) -> Currents {
        self.core.applied()
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
        let applied = self.applied();
        self.ammeter.update(readings, &applied, enabled)
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
            Message::Settings(settings, request) => {
                self.core.scale(settings.current_scale());
                self.indices.offset(settings.offsets());
                Some(request)
            }
        }
    }

    /// The checks of a tick, after the currents of [`Self::flow`]. Returns whether the tick takes a message, if
    /// one waits.
    #[inline]
    pub fn check(&mut self, sample: &Sample, flow: &Flow, pulses: &Pulses) -> bool {
        self.phase = self.phase.next();
        WINDINGS.add(&mut self.windings, &flow.currents);
        self.balance.add(sample);
        let jump = MONITOR.follow(&mut self.monitor, sample);
        self.note(jump);
        let mut takes_message = false;
        match self.phase.due() {
            Due::Nothing => {}
            Due::Frame => self.period = self.period.wrapping_add(1),
            Due::Balance(ticks) => self.pass_balance(sample, ticks),
            Due::Slot => self.end_slot(sample),
            Due::Message => takes_message = true,
            Due::Windings(ticks) => self.pass_windings(ticks),
            Due::All { frame, slot } => {
                self.period = self.period.wrapping_add(u32::from(frame));
                self.pass_balance(sample, 1);
                self.pass_windings(1);
                if slot {
                    self.end_slot(sample);
                }
                takes_message = true;
            }
        }
        self.note(flow.mismatch);
        let lost = self.indices.check(pulses);
        self.note(lost);
        takes_message
    }

    fn pass_balance(&mut self, sample: &Sample, ticks: u32) {
        let found = BALANCE.pass(&mut self.balance, sample, ticks);
        self.note(found);
    }

    fn end_slot(&mut self, sample: &Sample) {
        let found = MONITOR.end_slot(&mut self.monitor, sample);
        self.note(found);
    }

    fn pass_windings(&mut self, ticks: u32) {
        let found = WINDINGS.pass(&mut self.windings, ticks);
        self.note(found);
    }

    /// Keeps a finding, so that [`Self::step`] decides on it in this tick.
    fn note(&mut self, found: Option<Stop>) {
        if let Some(cause) = found {
            self.keep(cause);
        }
    }

    /// A function of its own, because few ticks call it.
    #[cold]
    #[inline(never)]
    fn keep(&mut self, cause: Stop) {
        self.found = self.found.or(Some(cause));
        self.safety.end_calm();
    }

    /// One tick, after [`Self::check`].
    // With an adaptive observer a tick that is one function takes 20 instructions less, with the other
    // estimators up to 8 more.
    #[cfg_attr(feature = "large-adaptive", inline(always))]
    #[cfg_attr(not(feature = "large-adaptive"), inline)]
    pub fn step(&mut self, sample: &Sample, inputs: &Inputs) -> Outputs {
        // The action is written where the task reads it: a tick copies it nowhere.
        let mut outputs = Outputs {
            action: self.core.step(sample),
            currents: None,
        };
        let action = &mut outputs.action;
        let request = match self.auto_arm {
            true if AUTO_ARM => self.arm_by_itself(inputs.request),
            _ => inputs.request,
        };
        let is_calm = inputs.faults == Faults::NONE
            && inputs.missed == 0
            && has_finite_sum(action)
            && !self.voltmeter.is_outside()
            && SAFETY.pass_calm(&mut self.safety, request);
        let decision = if is_calm {
            Decision::Drive
        } else {
            let findings = Findings {
                monitor: self.monitor.cause().or(self.found.take()),
                present: self.windings.overload().or(self.ammeter.mismatch()),
                amplifiers_ready: !inputs.faults.contain(Faults::NOT_READY),
                interlock: inputs.faults.contain(Faults::INTERLOCK),
                clock_failure: inputs.faults.contain(Faults::CLOCK),
                finite: are_finite(action),
                missed: inputs.missed,
                debugger: request == Some(Request::Arm) && (inputs.debugger)(),
                supply: self.voltmeter,
            };
            self.decide(*sample, findings, request)
        };
        if decision != Decision::Drive {
            self.core.withhold();
            action.currents = self.applied();
        }
        outputs.currents = (decision != Decision::Disable).then_some(action.currents);
        outputs
    }

    /// Decides in a tick in which something is found or requested, or which decides something by its time.
    #[cold]
    #[inline(never)]
    fn decide(
        &mut self,
        sample: Sample,
        findings: Findings<Voltmeter>,
        request: Option<Request>,
    ) -> Decision {
        if findings.missed > 0 {
            self.overruns = self.overruns.wrapping_add(findings.missed);
            self.balance.begin_after(self.phase.until(Phase::BALANCE));
            self.monitor.give_up_slot();
        }
        let order = SAFETY.tick(&mut self.safety, &findings, request);
        if order.restart {
            self.core.restart(&sample);
            (self.monitor, self.balance) = checks(&sample, self.phase);
            self.ammeter.restart();
            self.indices.forget();
        }
        if let Some(scene) = order.select {
            self.core.select(scene, &sample);
        }
        match order {
            Order { enable: false, .. } => Decision::Disable,
            Order { restart: true, .. } => Decision::Enable,
            Order { .. } => Decision::Drive,
        }
    }

    /// Telemetry record of the latest tick, whose sample and action are given. It is built on demand, because
    /// most ticks are not reported.
    pub fn record(&self, sample: &Sample, action: &Action) -> Record {
        Record {
            tick: self.tick(),
            sample: *sample,
            action: *action,
            state: self.safety.mode(),
            cause: self.safety.stop(),
            overruns: self.overruns,
            estimation: self.core.estimation(),
            learned: self.core.learned(),
        }
    }

    /// Number of the latest tick from 0, modulo 2^32.
    const fn tick(&self) -> u32 {
        self.phase.tick(self.period)
    }

    /// Request of an image that arms without a command, once after boot, or that of a command. A command that
    /// is more than a keep-alive takes over.
    #[cold]
    fn arm_by_itself(&mut self, command: Option<Request>) -> Option<Request> {
        const ARM: u32 = RATE_HZ / 10;
        const SELECT: u32 = ARM - 1;
        let is_alone = matches!(command, None | Some(Request::KeepAlive));
        self.auto_arm = is_alone && self.tick() != ARM;
        match self.tick() {
            SELECT if is_alone => Some(Request::Select(FIRST)),
            ARM if is_alone => Some(Request::Arm),
            _ => command,
        }
    }
}

/// Monitor and balance at rest, at the sample of a tick of this phase.
fn checks(sample: &Sample, phase: Phase) -> (MonitorState, BalanceState) {
    let (monitor, mut balance) = (MONITOR.start(sample), BALANCE.start(sample));
    balance.begin_after(phase.until(Phase::BALANCE));
    (monitor, balance)
}

/// A sum of finite numbers is finite or too large, that of others never. Currents cannot be anything else.
fn has_finite_sum(action: &Action) -> bool {
    (action.torque.0 + action.large_velocity.0 + action.handle_velocity.0).is_finite()
}

/// Whether torque and velocities are finite.
fn are_finite(action: &Action) -> bool {
    action.torque.0.is_finite()
        && action.large_velocity.0.is_finite()
        && action.handle_velocity.0.is_finite()
}

#[cfg(test)]
mod tests;
