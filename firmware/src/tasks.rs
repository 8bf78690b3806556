//! The two tasks of the firmware: control at the highest priority, the rest at the lowest.

use drivers::Saved;
use drivers::link::{Hello, Stored};
use estimator_core::Amps;
use firmware_app::commands::{Channel, Commands, Messages};
use firmware_app::config::AUTO_ARM;
use firmware_app::control::{Control, Inputs, Message};
use firmware_app::port::PortFaults;
use firmware_app::reports::Reports;
use firmware_app::rest::Rest;
use firmware_app::telemetry::{Frame, Frames, Sender};
use heapless::spsc::Consumer;

use crate::boards::{Board, Memory, Port, Start, Watchdog};
use crate::link::{COMMIT, Link, VERSION, identity};
use crate::log;

/// The queues between the tasks.
pub(crate) struct Queues {
    frames: Frames,
    messages: Messages,
}

impl Queues {
    /// Empty queues.
    pub(crate) const fn new() -> Self {
        Self {
            frames: Frames::new(),
            messages: Messages::new(),
        }
    }
}

/// Both tasks, on a board that has just started.
pub(crate) fn tasks<B: Board, W: Watchdog, P: Port, M: Memory>(
    mut board: B,
    start: Start<W, P, M>,
    queues: &'static mut Queues,
) -> (ControlTask<B>, IdleTask<W, P, M>) {
    let Start {
        watchdog,
        port,
        memory,
        reset,
        brown_out_reset,
        settings,
    } = start;
    let (to_log, frames) = queues.frames.split();
    let (to_control, messages) = queues.messages.split();
    let first = board.sample(Amps::ZERO);
    let identity = identity(reset, brown_out_reset);
    defmt::info!(
        "boot rate={=u32} cause={=u8} brown-out-reset={=bool} device={=u32:08x} presets={=u32:08x} version={=str} commit={=str} features={=str} protocol={=u16}",
        identity.rate,
        identity.cause,
        identity.brown_out_reset,
        identity.device,
        identity.presets,
        VERSION,
        COMMIT,
        env!("FEATURES"),
        identity.protocol
    );
    if settings.is_none() {
        defmt::warn!(
            "no settings in flash: bring-up has not been done, current limits are at 10 %"
        );
    }
    let settings = settings.unwrap_or_default();
    if !settings.are_signs_verified() {
        defmt::warn!("signs not verified: scenes in closed loop are refused");
    }
    if AUTO_ARM && !brown_out_reset {
        defmt::warn!("auto-arm waits for a command: the brown-out level is not 3");
    }
    let control = ControlTask {
        board,
        messages,
        sender: Sender::new(to_log),
        control: Control::new(&first, reset, brown_out_reset, &settings),
    };
    let mut idle = IdleTask {
        frames,
        commands: Commands::new(to_control, settings),
        rest: Rest::default(),
        watchdog,
        memory,
        link: Link { port, rtt: false },
        identity,
        port_first: false,
        reports: Reports::default(),
    };
    idle.link.send(identity);
    (control, idle)
}

/// The control task: reads, steps, writes, enqueues.
pub(crate) struct ControlTask<B> {
    board: B,
    messages: Consumer<'static, Message>,
    sender: Sender<'static>,
    control: Control,
}

impl<B: Board> ControlTask<B> {
    /// One tick. Its deadline is the next tick: 16 800 cycles at 10 kHz, the default rate. On the emulated
    /// board it takes an eighth of these as instructions at most (docs/benchmarks.md), and a quarter while
    /// one estimator takes over from another.
    #[inline(always)]
    pub(crate) fn run(&mut self) {
        let Self {
            board,
            messages,
            sender,
            control,
        } = self;
        let missed = board.begin_tick();
        let flow = control.flow(&board.currents());
        let sample = board.sample(flow.currents.large);
        let takes_message = control.check(&sample, &flow, &board.pulses());
        let message = if takes_message {
            messages.dequeue()
        } else {
            None
        };
        if let Some(Message::Settings(settings, _)) = &message {
            board.calibrate(settings);
        }
        let request = control.accept(message);
        let inputs = Inputs {
            faults: board.faults(),
            missed,
            debugger: firmware_rt::debugger_interferes,
            request,
        };
        let outputs = control.step(&sample, &inputs);
        board.apply(outputs.currents);
        if control.makes_frame() {
            let record = control.record(&sample, &outputs.action);
            let (measured, index) = (control.take_measured(), control.take_index(&sample));
            let supply = board.supply();
            control.watch(&supply);
            let (cycles, reference) = (board.take_longest(), board.reference());
            sender.send(record, measured, index, supply, cycles, reference);
        }
        board.end_tick();
    }
}

/// Everything that may wait: commands, the log, the watchdog.
pub(crate) struct IdleTask<W, P, M> {
    frames: Consumer<'static, Frame>,
    commands: Commands<'static>,
    rest: Rest,
    watchdog: W,
    memory: M,
    link: Link<P>,
    identity: Hello,
    /// Whether the last look began with the port.
    port_first: bool,
    reports: Reports<PortFaults>,
}

impl<W: Watchdog, P: Port, M: Memory> IdleTask<W, P, M> {
    /// One look at the channels. The watchdog is fed if the control task has sent a frame.
    #[inline(always)]
    pub(crate) fn run(&mut self) {
        let Self {
            link,
            commands,
            frames,
            rest,
            watchdog,
            ..
        } = self;
        link.port.look();
        // In turn: a channel that fills the queue of messages leaves the other its share.
        self.port_first = !self.port_first;
        let mut channels = [Channel::Port, Channel::Rtt];
        if !self.port_first {
            channels.reverse();
        }
        for channel in channels {
            commands.receive(channel, || match channel {
                Channel::Port => link.port.receive(),
                Channel::Rtt => firmware_rt::receive(),
            });
        }
        link.rtt = commands.is_used(Channel::Rtt);
        if commands.take_arms() {
            rest.arms();
        }
        let asked = commands.asked();
        if asked.identity {
            link.send(self.identity);
            link.rejected(commands.rejected());
        }
        if asked.settings {
            link.settings(commands.settings());
        }
        if asked.store {
            let saved = if rest.is_certain() {
                self.memory.save(commands.settings(), &mut || {
                    pass(frames, link, rest, watchdog);
                })
            } else {
                Saved::Enabled
            };
            link.send(Stored {
                outcome: saved as u8,
            });
        }
        if pass(frames, link, rest, watchdog) {
            if let Some([before, now]) = commands.report() {
                log::rejected([before, now]);
                link.rejected(now);
            }
            if let Some([_, faults]) = self.reports.take(link.port.faults()) {
                log::port(faults);
            }
        }
    }
}

/// Logs and sends the frames that wait. Feeds the watchdog if there were any: a control task that has stopped
/// sends none. Returns whether there were. A function of its own, so that the task has its code once.
#[inline(never)]
fn pass(
    frames: &mut Consumer<'static, Frame>,
    link: &mut Link<impl Port>,
    rest: &mut Rest,
    watchdog: &mut impl Watchdog,
) -> bool {
    let any = log::frames(frames, link, rest);
    if any {
        watchdog.feed();
        firmware_rt::undo_debugger();
    }
    any
}
