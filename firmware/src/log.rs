//! Lines of the log, written at the lowest priority.

use estimator_core::Count;
use firmware_app::commands::Rejected;
use firmware_app::port::PortFaults;
use firmware_app::rest::Rest;
use firmware_app::telemetry::{DEPTH, Frame};
use haptic_control::{Currents, Volts};
use heapless::spsc::Consumer;

use crate::boards::Port;
use crate::link::Link;

/// Logs the frames that wait, and sends them over the link; whether there were any.
pub(crate) fn frames(
    frames: &mut Consumer<'static, Frame>,
    link: &mut Link<impl Port>,
    rest: &mut Rest,
) -> bool {
    let mut any = false;
    for _ in 0..DEPTH {
        let Some(frame) = frames.dequeue() else {
            break;
        };
        let lost = firmware_rt::lost();
        log(&frame, lost);
        link.frame(&frame, lost);
        rest.frame(&frame.record);
        any = true;
    }
    any
}

/// One line of all fields of a frame.
macro_rules! line {
    ($format:literal; $($(#[$doc:meta])* $name:ident: $type:ty, $old:literal, $csv:ident, $value:expr;)+) => {
        defmt::info!($format, $($value),+)
    };
}

fn log(frame: &Frame, lost: u32) {
    drivers::frame_fields!(line, frame, lost);
    if let Some(edge) = frame.edge() {
        defmt::info!(
            "edge seq={=u32} bound={=u32} age={=u32}",
            frame.seq,
            edge.boundary.0,
            edge.age.0
        );
    }
    if let Some(learned) = frame.learned() {
        defmt::info!(
            "learned seq={=u32} damping={=f32} friction={=f32} torque_constant={=f32}",
            frame.seq,
            learned.damping,
            learned.friction,
            learned.torque_constant
        );
    }
    if let Some(Currents { large, small }) = frame.measured() {
        defmt::info!(
            "measured seq={=u32} large={=f32} small={=f32}",
            frame.seq,
            large.get(),
            small.get()
        );
    }
    if let Some([large, small]) = frame.index() {
        defmt::info!(
            "index seq={=u32} pulses_large={=u32} count_large={=u32} deviation_large={=i32} position_large={=i32} pulses_small={=u32} count_small={=u32} deviation_small={=i32} position_small={=i32}",
            frame.seq,
            large.pulses,
            large.count.0,
            large.deviation,
            large.position.0,
            small.pulses,
            small.count.0,
            small.deviation,
            small.position.0
        );
    }
    if let Some(Volts(volts)) = frame.supply() {
        defmt::info!("supply seq={=u32} volts={=f32}", frame.seq, volts);
    }
    if let Some(Count(count)) = frame.reference {
        defmt::info!("reference seq={=u32} count={=u32}", frame.seq, count);
    }
}

/// Logs what was rejected since the last report.
pub(crate) fn rejected([before, now]: [Rejected; 2]) {
    if now.garbage != before.garbage {
        defmt::warn!("garbage bytes={=u32}", now.garbage);
    }
    let garbage = before.garbage;
    if (Rejected { garbage, ..now }) != before {
        defmt::warn!(
            "refused not-finite={=u32} out-of-bounds={=u32} unknown={=u32} unverified={=u32}",
            now.not_finite,
            now.out_of_bounds,
            now.unknown,
            now.unverified
        );
    }
}

/// Logs what has gone wrong on the serial port.
pub(crate) fn port(faults: PortFaults) {
    defmt::warn!("port errors={=u32} lost={=u32}", faults.errors, faults.lost);
}
