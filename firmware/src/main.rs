//! The controller board's firmware: an RTIC application.
#![no_std]
#![no_main]

mod board;
#[allow(dead_code, reason = "an image without the wires captures nothing")]
mod edge;
mod encoder;
mod log;
mod reset;
mod tick;

#[rtic::app(device = stm32f4xx_hal::pac, peripherals = true)]
mod app {
    use estimator_core::Amps;
    use firmware_app::commands::{Commands, Messages};
    use firmware_app::config::{AUTO_ARM, RATE_HZ};
    use firmware_app::control::{Control, Inputs, Message};
    use firmware_app::telemetry::{Frame, Frames, Sender};
    use haptic_control::Request;
    use heapless::spsc::Consumer;
    use stm32f4xx_hal::watchdog::IndependentWatchdog;

    use crate::board::{Amplifiers, Board, Encoders, Tree};
    use crate::log;
    use crate::tick::Tick;

    #[shared]
    struct Shared {}

    #[local]
    struct Local {
        clock: Tree,
        tick: Tick,
        encoders: Encoders,
        amplifiers: Amplifiers,
        control: Control,
        messages: Consumer<'static, Message>,
        sender: Sender<'static>,
        frames: Consumer<'static, Frame>,
        commands: Commands<'static>,
        watchdog: IndependentWatchdog,
    }

    #[init(local = [log_queue: Frames = Frames::new(), message_queue: Messages = Messages::new()])]
    fn init(cx: init::Context) -> (Shared, Local, init::Monotonics) {
        let mut board = Board::new(cx.device);
        let (to_log, frames) = cx.local.log_queue.split();
        let (to_control, messages) = cx.local.message_queue.split();
        let first = board.encoders.sample(Amps::ZERO);
        defmt::info!(
            "boot rate={=u32} cause={=u8} brown-out-reset={=bool}",
            RATE_HZ,
            board.reset as u8,
            board.brown_out_reset
        );
        if AUTO_ARM && !board.brown_out_reset {
            defmt::warn!("auto-arm waits for a command: the brown-out level is not 3");
        }
        let local = Local {
            control: Control::new(&first, board.reset, board.brown_out_reset),
            clock: board.clock,
            tick: board.tick,
            encoders: board.encoders,
            amplifiers: board.amplifiers,
            messages,
            sender: Sender::new(to_log),
            frames,
            commands: Commands::new(to_control),
            watchdog: board.watchdog,
        };
        (Shared {}, local, init::Monotonics())
    }

    /// The control task: reads, steps, writes, enqueues. Its deadline is the next tick, 100 us or
    /// 16 800 cycles; on the emulated board it takes an eighth of these as instructions at most
    /// (docs/benchmarks.md), and a quarter while one estimator takes over from another.
    #[task(
        binds = TIM5,
        priority = 15,
        local = [clock, tick, encoders, amplifiers, control, messages, sender]
    )]
    fn control(cx: control::Context) {
        let control::LocalResources {
            clock,
            tick,
            encoders,
            amplifiers,
            control,
            messages,
            sender,
        } = cx.local;
        let missed = tick.enter();
        let sample = encoders.sample(control.applied().large);
        let request = control.hear(messages.dequeue());
        let inputs = Inputs {
            amplifier_fault: amplifiers.is_faulty(),
            clock_failure: clock.has_failed(),
            missed,
            debugger: (AUTO_ARM || request == Some(Request::Arm)) && bare::debugger_interferes(),
            request,
        };
        amplifiers.apply(control.step(&sample, &inputs));
        if sender.is_due() {
            sender.send(
                control.record(&sample),
                tick.take_longest(),
                encoders.reference(),
            );
        }
        tick.leave();
    }

    /// Everything that may wait. The watchdog is fed when the control task has sent something.
    #[idle(local = [frames, commands, watchdog])]
    fn idle(cx: idle::Context) -> ! {
        loop {
            cx.local.commands.receive(bare::receive);
            if log::frames(cx.local.frames) {
                cx.local.watchdog.feed();
                bare::undo_debugger();
                if let Some(counts) = cx.local.commands.report() {
                    log::rejected(counts);
                }
            }
            cortex_m::asm::wfi();
        }
    }
}
