//! The two tasks of the firmware: control at the highest priority, the rest at the lowest.

use estimator_core::Amps;
use firmware_app::commands::{Commands, Messages};
use firmware_app::config::{AUTO_ARM, RATE_HZ};
use firmware_app::control::{Control, Inputs, Message};
use firmware_app::telemetry::{Frame, Frames, Sender};
use haptic_control::Request;
use heapless::spsc::Consumer;
use tuned::{DEVICE_FINGERPRINT, PRESETS_FINGERPRINT};

use crate::boards::{Board, Start, Watchdog};
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
pub(crate) fn tasks<W: Watchdog>(
    board: &mut impl Board,
    start: Start<W>,
    queues: &'static mut Queues,
) -> (ControlTask, IdleTask<W>) {
    let Start {
        watchdog,
        reset,
        brown_out_reset,
    } = start;
    let (to_log, frames) = queues.frames.split();
    let (to_control, messages) = queues.messages.split();
    let first = board.sample(Amps::ZERO);
    defmt::info!(
        "boot rate={=u32} cause={=u8} brown-out-reset={=bool} device={=u32:08x} presets={=u32:08x}",
        RATE_HZ,
        reset as u8,
        brown_out_reset,
        DEVICE_FINGERPRINT.0,
        PRESETS_FINGERPRINT.0
    );
    if AUTO_ARM && !brown_out_reset {
        defmt::warn!("auto-arm waits for a command: the brown-out level is not 3");
    }
    let control = ControlTask {
        messages,
        sender: Sender::new(to_log),
        control: Control::new(&first, reset, brown_out_reset),
    };
    let idle = IdleTask {
        frames,
        commands: Commands::new(to_control),
        watchdog,
    };
    (control, idle)
}

/// The control task: reads, steps, writes, enqueues.
pub(crate) struct ControlTask {
    messages: Consumer<'static, Message>,
    sender: Sender<'static>,
    control: Control,
}

impl ControlTask {
    /// One tick. Its deadline is the next tick, 100 us or 16 800 cycles; on the emulated board it
    /// takes an eighth of these as instructions at most (docs/benchmarks.md), and a quarter while
    /// one estimator takes over from another.
    #[inline(always)]
    pub(crate) fn run(&mut self, board: &mut impl Board) {
        let Self {
            messages,
            sender,
            control,
        } = self;
        let missed = board.begin_tick();
        let sample = board.sample(control.applied().large);
        let request = control.accept(messages.dequeue());
        let arms = AUTO_ARM || request == Some(Request::Arm);
        let inputs = Inputs {
            amplifier_fault: board.amplifier_fault(),
            clock_failure: board.clock_failure(),
            missed,
            debugger: arms && firmware_rt::debugger_interferes(),
            request,
        };
        board.apply(control.step(&sample, &inputs));
        if sender.is_due() {
            let record = control.record(&sample);
            sender.send(record, board.take_longest(), board.reference());
        }
        board.end_tick();
    }
}

/// Everything that may wait: commands, the log, the watchdog.
pub(crate) struct IdleTask<W> {
    frames: Consumer<'static, Frame>,
    commands: Commands<'static>,
    watchdog: W,
}

impl<W: Watchdog> IdleTask<W> {
    /// One look at the channels. The watchdog is fed if the control task has sent a frame.
    #[inline(always)]
    pub(crate) fn run(&mut self) {
        self.commands.receive(firmware_rt::receive);
        if log::frames(&mut self.frames) {
            self.watchdog.feed();
            firmware_rt::undo_debugger();
            if let Some(counts) = self.commands.report() {
                log::rejected(counts);
            }
        }
    }
}
