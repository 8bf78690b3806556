//! Interface of a board for the tasks, and the board of this image.
//!
//! A board is one folder beside `nucleo_f429zi`. It binds the two tasks to its interrupts and
//! implements [`Board`]; pins, timers, clocks, encoders and amplifiers are named nowhere else. To
//! add one: the folder, a feature in Cargo.toml that selects it and its chip, a line below, and its
//! memory map in build.rs.

use drivers::{Saved, Settings};
use estimator_core::{Amps, Count, Sample};
use firmware_app::ammeter::Measured;
use firmware_app::control::Faults;
use firmware_app::index::Pulses;
use firmware_app::port::PortFaults;
use firmware_app::supply::Reading;
use haptic_control::{Currents, Stop};

#[cfg(feature = "nucleo-f429zi")]
mod nucleo_f429zi;

#[cfg(not(feature = "nucleo-f429zi"))]
compile_error!("an image needs a board: --features nucleo-f429zi");

/// Inputs, outputs and tick of the control task. Each call is bounded and takes no lock.
pub(crate) trait Board {
    /// Acknowledges the tick's interrupt. Returns the number of ticks missed since the last one;
    /// a tick that the last task overran counts as missed.
    fn begin_tick(&mut self) -> u32;

    /// Reads the amplifiers' current monitors, if the image does.
    fn currents(&mut self) -> Measured;

    /// Reads the encoders. `current` is the large motor's current over the period just ended.
    fn sample(&mut self, current: Amps) -> Sample;

    /// Returns the index pulses since the last call, if the image captures them, by the counts of
    /// [`Self::sample`], which comes before.
    fn pulses(&mut self) -> Pulses;

    /// Reads the voltage of the amplifiers' supply, if the image does.
    fn supply(&mut self) -> Reading;

    /// Reads the reference encoder, if the image has one.
    fn reference(&mut self) -> Option<Count>;

    /// Faults of the hardware. Amplifiers may be not ready while they are disabled.
    fn faults(&mut self) -> Faults;

    /// Takes zero and gain of the current outputs from the settings.
    fn calibrate(&mut self, settings: &Settings);

    /// Commands both currents and enables the amplifiers; `None` disables them.
    fn apply(&mut self, currents: Option<Currents>);

    /// Returns the core cycles of the longest control task since the last call, counted from the
    /// instant at which the task was due.
    fn take_longest(&mut self) -> u32;

    /// Ends the control task.
    fn end_tick(&mut self);
}

/// The watchdog of a board.
pub(crate) trait Watchdog {
    /// Restarts the watchdog's time. A board that started without its crystal looks for it too, and
    /// restarts the chip when it runs.
    fn feed(&mut self);
}

/// The serial port to the host. Each call is bounded and waits for nothing.
pub(crate) trait Port {
    /// Passes on what waits to be sent, and ends errors of the line. Called at each look of the task
    /// of lowest priority.
    fn look(&mut self);

    /// Takes the next byte that has come.
    fn receive(&mut self) -> Option<u8>;

    /// Queues a frame to be sent, or counts it as lost if it does not fit.
    fn send(&mut self, frame: &[u8]);

    /// Returns what has gone wrong since the start.
    fn faults(&self) -> PortFaults;
}

/// The flash that keeps the settings.
pub(crate) trait Memory {
    /// Stores the settings, in 30 ms at most, which is longer than a watchdog may wait. `between` is called after
    /// every 0.1 ms at most. The amplifiers are disabled.
    fn save(&mut self, settings: &Settings, between: &mut dyn FnMut()) -> Saved;
}

/// A board that has just started.
pub(crate) struct Start<W, P, M> {
    pub(crate) watchdog: W,
    pub(crate) port: P,
    pub(crate) memory: M,
    /// Cause of the last reset.
    pub(crate) reset: Stop,
    /// The settings in flash; `None` if there are none that this image can read.
    pub(crate) settings: Option<Settings>,
    /// Whether a falling supply resets the chip and is named as the cause.
    pub(crate) brown_out_reset: bool,
}
