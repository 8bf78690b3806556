//! NUCLEO-F429ZI: the tasks on their interrupts. The only folder that names a pin or a timer.

#[allow(dead_code, reason = "an image without the wires measures nothing")]
mod ammeters;
#[allow(dead_code, reason = "an image without the wires converts nothing")]
mod converters;
#[allow(dead_code, reason = "an image without the wires captures nothing")]
mod edge;
mod enables;
mod encoder;
#[allow(dead_code, reason = "an image without the wires captures nothing")]
mod indices;
mod memory;
mod parts;
mod port;
mod reset;
#[allow(dead_code, reason = "an image without the wire measures nothing")]
mod supply;
mod tick;

firmware_rt::emergency_outputs!(timer: enables::TIMER);

#[rtic::app(device = stm32f4xx_hal::pac, peripherals = true)]
mod app {
    use super::memory::Flash;
    use super::parts::{Guard, Parts, start};
    use super::port::Usart;
    use crate::tasks::{ControlTask, IdleTask, Queues, tasks};

    #[shared]
    struct Shared {}

    #[local]
    struct Local {
        control: ControlTask<Parts>,
        idle: IdleTask<Guard, Usart, Flash>,
    }

    #[init(local = [queues: Queues = Queues::new()])]
    fn init(cx: init::Context) -> (Shared, Local, init::Monotonics) {
        let (parts, start) = start(cx.device);
        let (control, idle) = tasks(parts, start, cx.local.queues);
        (Shared {}, Local { control, idle }, init::Monotonics())
    }

    // The only interrupt. At priority 1 there is none to restore at its end.
    #[task(binds = TIM5, priority = 1, local = [control])]
    fn control(cx: control::Context) {
        cx.local.control.run();
    }

    #[idle(local = [idle])]
    fn idle(cx: idle::Context) -> ! {
        loop {
            cx.local.idle.run();
            cortex_m::asm::wfi();
        }
    }
}
