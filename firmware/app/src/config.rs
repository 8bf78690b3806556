//! Rates, the device, and the options of an image that are no estimator and no scene.

use estimator_core::Hertz;
use haptic_control::DualStage;

/// Clock of the timers that make the control tick and stamp edges. The firmware compares it with
/// the clock tree.
pub const TIMER_HZ: u32 = 84_000_000;
/// The clock of edge stamps.
pub const TIMERS: Hertz = Hertz(TIMER_HZ as f64);

/// Control ticks per second: the number in the environment variable `RATE` at build time, or 10 000, the rate
/// at which the control task is counted.
pub const RATE_HZ: u32 = match u32::from_str_radix(env!("RATE_HZ"), 10) {
    Ok(rate) => rate,
    Err(_) => panic!("the build script passes a number on"),
};
const _: () = assert!(
    RATE_HZ >= 1000
        && RATE_HZ <= 40_000
        && RATE_HZ.is_multiple_of(FRAMES_HZ)
        && TIMER_HZ.is_multiple_of(RATE_HZ),
    "RATE: 1000 to 40000 Hz, a multiple of 1000 Hz that divides 84 MHz, for example 1000, 2000, 4000, \
     5000, 8000, 10000, 20000 or 40000"
);

/// The control rate.
pub const RATE: Hertz = Hertz(RATE_HZ as f64);

/// Telemetry frames per second.
const FRAMES_HZ: u32 = 1000;
/// Control ticks for one telemetry frame.
pub const DECIMATION: u32 = RATE_HZ / FRAMES_HZ;

/// The device that the image is designed for: the one of the file that the environment variable
/// `DEVICE` named at build time, or the default.
pub const DEVICE: DualStage = tuned::DEVICE;

/// Whether the image arms without a command.
pub const AUTO_ARM: bool = cfg!(feature = "auto-arm");
/// Whether the image reads the reference encoder.
pub const REFERENCE: bool = cfg!(feature = "reference");
/// Whether the image stamps the large encoder's edges.
pub const EDGES: bool = cfg!(feature = "edge-capture");
/// Longest silence of the command channel while running, ticks.
pub const SILENCE: Option<u32> = if AUTO_ARM { None } else { Some(RATE_HZ / 2) };
