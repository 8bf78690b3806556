//! A control without a board: counts that a test turns, and the ticks of its choice.

use core::f64::consts::TAU;

use drivers::Settings;
use estimator_core::{Amps, Count, Sample};
use firmware_app::ammeter::Measured;
use firmware_app::commands::{Channel, Commands, Messages};
use firmware_app::config::{DEVICE, RATE_HZ};
use firmware_app::control::{Control, Faults, Inputs, Message, Outputs};
use firmware_app::index::{Indexing, Indices, Pulses, Reported};
use firmware_app::supply::Reading;
use firmware_app::telemetry::Record;
use haptic_control::{Action, Currents, DualStage, Mode, Request, Stop};
use heapless::spsc::Consumer;

/// Counts per turn of the handle.
const SMALL: f64 = 20_000.0;
/// Counts per turn of the large motor.
const LARGE: f64 = 4096.0;

/// Ticks of a duration.
pub(crate) fn ticks(seconds: f64) -> u32 {
    (seconds * f64::from(RATE_HZ)) as u32
}

/// A tick at which nothing is wrong and nothing is asked for.
pub(crate) const CALM: Inputs = Inputs {
    faults: Faults::NONE,
    missed: 0,
    debugger: || false,
    request: None,
};

/// A control, its angles, rad, and the velocity of the large motor, which its current and the coupler's slip
/// drive. The handle turns as the test says.
pub(crate) struct Bench {
    pub(crate) control: Control,
    /// Of the latest tick.
    action: Action,
    pub(crate) handle: f64,
    pub(crate) large: f64,
    velocity: f64,
    /// Angle of the handle a tick ago.
    handle_before: f64,
    /// Whether the handle's encoder counts backwards.
    pub(crate) backwards: bool,
    /// Readings of the ammeters, if they are not those of the commanded currents.
    pub(crate) readings: Option<Currents>,
    /// Voltage of the supply, V.
    pub(crate) supply: f32,
    /// Index pulses since the latest tick.
    pub(crate) pulses: Pulses,
}

/// No index pulse.
pub(crate) const NO_PULSE: Pulses = <Indices as Indexing>::NONE;

impl Bench {
    /// After a reset without a cause, with the brown-out reset on.
    pub(crate) fn new() -> Self {
        Self::after(Stop::None, true)
    }

    /// After a reset, with the settings of a board after its bring-up.
    pub(crate) fn after(reset: Stop, brown_out_reset: bool) -> Self {
        Self::with(&Settings::COMMISSIONED, reset, brown_out_reset)
    }

    pub(crate) fn with(settings: &Settings, reset: Stop, brown_out_reset: bool) -> Self {
        let first = Sample::new(Count(0)).with_coupled(Count(0));
        Self {
            control: booted(Control::new(&first, reset, brown_out_reset, settings)),
            action: Action::default(),
            handle: 0.0,
            large: 0.0,
            velocity: 0.0,
            handle_before: 0.0,
            backwards: false,
            readings: None,
            supply: 24.0,
            pulses: NO_PULSE,
        }
    }

    /// The sample with this current of the large motor over the period before.
    fn sample(&self, current: Amps) -> Sample {
        let counts = |angle: f64, per_turn: f64| {
            Count(((angle / TAU * per_turn).floor() as i32).cast_unsigned())
        };
        let handle = if self.backwards {
            -self.handle
        } else {
            self.handle
        };
        Sample::new(counts(self.large, LARGE))
            .with_coupled(counts(handle, SMALL))
            .with_current(current)
    }

    /// One tick that takes a message, if it takes one and one waits. Returns the record of its frame, if it
    /// makes one.
    pub(crate) fn step_with(&mut self, waiting: &mut Consumer<'_, Message>) -> Option<Record> {
        self.tick(|control, takes_message| {
            let message = if takes_message {
                waiting.dequeue()
            } else {
                None
            };
            Inputs {
                request: control.accept(message),
                ..CALM
            }
        });
        self.control.makes_frame().then(|| self.record())
    }

    /// One tick with these inputs.
    pub(crate) fn step(&mut self, inputs: &Inputs) -> Option<Currents> {
        self.tick(|_, _| *inputs)
    }

    /// One tick with the inputs that `inputs` makes of whether the tick takes a message.
    fn tick(&mut self, inputs: impl FnOnce(&mut Control, bool) -> Inputs) -> Option<Currents> {
        let readings = readings(self.readings.unwrap_or(self.control.applied()));
        let flow = self.control.flow(&readings);
        let sample = self.sample(flow.currents.large);
        let takes_message = self.control.check(&sample, &flow, &self.pulses);
        self.pulses = NO_PULSE;
        let inputs = &inputs(&mut self.control, takes_message);
        let Outputs { currents, action } = self.control.step(&sample, inputs);
        self.action = action;
        if self.control.makes_frame() {
            self.control.watch(&supply(self.supply));
        }
        let DualStage { large, damping, .. } = DEVICE;
        let current = f64::from(currents.unwrap_or_default().large.get());
        let rate = f64::from(RATE_HZ);
        let slip = self.velocity - (self.handle - self.handle_before) * rate;
        self.handle_before = self.handle;
        let torque = large.torque_constant * current - damping * slip;
        self.velocity += torque / large.inertia / rate;
        self.large += self.velocity / rate;
        currents
    }

    /// One tick with this request.
    pub(crate) fn request(&mut self, request: Request) -> Option<Currents> {
        self.step(&Inputs {
            request: Some(request),
            ..CALM
        })
    }

    /// Ticks in which the command channel is alive.
    pub(crate) fn run(&mut self, ticks: u32) {
        for _ in 0..ticks {
            self.request(Request::KeepAlive);
        }
    }

    /// Ticks without a command.
    pub(crate) fn wait(&mut self, ticks: u32) {
        for _ in 0..ticks {
            self.step(&CALM);
        }
    }

    /// Arms with this scene chosen, and waits until it is on.
    pub(crate) fn start(scene: u8) -> Self {
        let mut bench = Self::new();
        bench.request(Request::Select(scene));
        bench.request(Request::Arm);
        bench.run(ticks(0.03));
        bench
    }

    pub(crate) fn record(&self) -> Record {
        let sample = self.sample(self.control.applied().large);
        self.control.record(&sample, &self.action)
    }

    /// What is reported of the indices.
    pub(crate) fn take_index(&mut self) -> Reported {
        let sample = self.sample(self.control.applied().large);
        self.control.take_index(&sample)
    }

    pub(crate) fn state(&self) -> (Mode, Stop) {
        let Record { state, cause, .. } = self.record();
        (state, cause)
    }

    /// Torque that the handle should feel, mN.m.
    pub(crate) fn torque_mnm(&self) -> f64 {
        1e3 * f64::from(self.record().action.torque.0)
    }
}

/// Messages of these command frames, as many as the queue takes at a time.
pub(crate) fn messages(frames: &[[u8; 11]]) -> Vec<Message> {
    let mut queue = Messages::new();
    let (producer, mut consumer) = queue.split();
    let mut commands = Commands::new(producer, Settings::COMMISSIONED);
    let mut bytes = frames.concat().into_iter();
    let mut messages = Vec::new();
    while bytes.len() > 0 {
        commands.receive(Channel::Rtt, || bytes.next());
        messages.extend(core::iter::from_fn(|| consumer.dequeue()));
    }
    messages
}

/// No current.
pub(crate) const ZERO: Currents = Currents {
    large: Amps::ZERO,
    small: Amps::ZERO,
};

/// Readings of ammeters at these currents.
#[cfg(feature = "current-monitor")]
pub(crate) fn readings(currents: Currents) -> Measured {
    currents
}
#[cfg(not(feature = "current-monitor"))]
pub(crate) fn readings(_: Currents) -> Measured {
    estimator_core::Skip
}

/// Index pulses of the large and the small encoder.
#[cfg(feature = "index-pulse")]
pub(crate) fn pulses(counts: [Option<Count>; 2]) -> Pulses {
    counts
}
#[cfg(not(feature = "index-pulse"))]
pub(crate) fn pulses(_: [Option<Count>; 2]) -> Pulses {
    estimator_core::Skip
}

/// A reading of the supply at this voltage, V.
#[cfg(feature = "supply-monitor")]
pub(crate) fn supply(volts: f32) -> Reading {
    haptic_control::Volts(volts)
}
#[cfg(not(feature = "supply-monitor"))]
pub(crate) fn supply(_: f32) -> Reading {
    estimator_core::Skip
}

/// A control after the time in which ammeters learn their zeros, and the supply is seen.
fn booted(mut control: Control) -> Control {
    for _ in 0..ticks(0.02) {
        control.flow(&readings(ZERO));
    }
    for _ in 0..3 {
        control.watch(&supply(24.0));
    }
    control
}
