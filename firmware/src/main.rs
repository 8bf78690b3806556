//! The controller board's firmware.
#![no_std]
#![no_main]

mod board;
mod dac_code;
mod encoder;
mod scene;
mod telemetry;

use defmt_rtt as _;
use panic_probe as _;

#[rtic::app(device = stm32f4xx_hal::pac, peripherals = true)]
mod app {
    use estimator_core::Sample;
    use haptic_control::{Action, Currents};
    use heapless::spsc::Consumer;

    use crate::board::{self, Amplifiers, Board, CORE_HZ, Encoders, RATE_HZ, Tick};
    use crate::scene::Core;
    use crate::telemetry::{self, Frame, Frames, Record, Sender};

    const PERIOD: u32 = CORE_HZ / RATE_HZ;

    #[shared]
    struct Shared {}

    #[local]
    struct Local {
        tick: Tick,
        encoders: Encoders,
        amplifiers: Amplifiers,
        core: Core,
        sender: Sender,
        frames: Consumer<'static, Frame>,
    }

    #[init(local = [queue: Frames = Frames::new()])]
    fn init(mut cx: init::Context) -> (Shared, Local, init::Monotonics) {
        let mut board = Board::new(&mut cx.core, cx.device);
        let (producer, frames) = cx.local.queue.split();
        let first = board.encoders.sample(Default::default());
        defmt::info!("boot rate={=u32}", RATE_HZ);
        let local = Local {
            tick: board.tick,
            encoders: board.encoders,
            amplifiers: board.amplifiers,
            core: Core::start(&first),
            sender: Sender::new(producer),
            frames,
        };
        (Shared {}, local, init::Monotonics())
    }

    /// The control task: its deadline is the next tick, 100 us.
    #[task(
        binds = TIM5,
        priority = 15,
        local = [
            tick, encoders, amplifiers, core, sender,
            ticks: u32 = 0, last: u32 = 0, overruns: u32 = 0, cycles: u32 = 0,
            applied: Option<Currents> = None,
        ]
    )]
    fn control(cx: control::Context) {
        let local = cx.local;
        let entered = board::cycles();
        local.tick.acknowledge();
        let applied = local.applied.unwrap_or_default();
        let sample: Sample = local.encoders.sample(applied.large);
        if *local.ticks > 0 && entered.wrapping_sub(*local.last) > PERIOD + PERIOD / 2 {
            *local.overruns = local.overruns.wrapping_add(1);
        }
        *local.last = entered;
        if *local.ticks == RATE_HZ / 10 {
            local.amplifiers.enable(!local.amplifiers.is_faulty());
            local.core.select(1, &sample);
        }
        let action: Action = local.core.step(&sample);
        local.amplifiers.set(action.currents);
        *local.applied = Some(action.currents);
        local.sender.offer(Record {
            tick: *local.ticks,
            sample,
            action,
            state: if *local.ticks < RATE_HZ / 10 { 0 } else { 2 },
            cause: 0,
            overruns: *local.overruns,
            cycles: *local.cycles,
        });
        *local.ticks = local.ticks.wrapping_add(1);
        *local.cycles = board::cycles().wrapping_sub(entered);
    }

    #[idle(local = [frames])]
    fn idle(cx: idle::Context) -> ! {
        loop {
            telemetry::drain(cx.local.frames);
            cortex_m::asm::wfi();
        }
    }
}
