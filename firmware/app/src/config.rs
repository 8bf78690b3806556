//! Rates, the device, and the options of an image that are no estimator and no scene.

use estimator_core::Hertz;
use haptic_control::DualStage;

/// Control ticks per second, 1000 to 20 000.
pub const RATE_HZ: u32 = 10_000;
const _: () = assert!(RATE_HZ >= 1000 && RATE_HZ <= 20_000);

/// The control rate.
pub const RATE: Hertz = Hertz(RATE_HZ as f64);

/// Telemetry frames per second.
pub const FRAMES_HZ: u32 = 1000;

/// The device that the image is designed for.
pub const DEVICE: DualStage = DualStage::DEFAULT;

/// Whether the image arms without a command.
pub const AUTO_ARM: bool = cfg!(feature = "auto-arm");
/// Whether the image reads the reference encoder.
pub const REFERENCE: bool = cfg!(feature = "reference");
/// Whether the image stamps the large encoder's edges.
pub const EDGES: bool = cfg!(feature = "edge-capture");
/// Longest silence of the command channel while running, ticks.
pub const SILENCE: Option<u32> = if AUTO_ARM { None } else { Some(RATE_HZ / 2) };
