//! The fields of a telemetry frame: the one list from which the firmware makes its log line, the host
//! its decoder and the columns of a recording, and the link the payload of
//! [`Frame`](crate::link::Frame).

/// Number of the estimator in a frame where none is in charge.
pub const NO_ESTIMATOR: u8 = u8::MAX;

/// Hands the list of fields to the macro `$then`: the format of the log line, then a row for each
/// field in the order of the format.
///
/// A row is `name: type on the host, "name in older logs", csv or log, value in the firmware;`. A field
/// marked `csv` is a column of that name in recordings. `$frame` is the firmware's `Frame`, `$lost`
/// the number of frames that RTT lost.
///
/// To add a field: its part of the format, its row, its line in docs/telemetry.md, its value in
/// firmware/app/src/telemetry.rs if the frame does not have it yet, and the next number of
/// [`PROTOCOL`](crate::link::PROTOCOL).
///
/// The firmware makes the message of the link from the same values:
///
/// ```ignore
/// macro_rules! message {
///     ($format:literal; $($(#[$doc:meta])* $name:ident: $type:ty, $old:literal, $csv:ident, $value:expr;)+) => {
///         drivers::link::Frame { $($name: $value),+ }
///     };
/// }
/// let message = drivers::frame_fields!(message, frame, lost);
/// ```
#[macro_export]
macro_rules! frame_fields {
    ($then:ident, $frame:ident, $lost:ident) => {
        $then! {
            "frame seq={=u32} tick={=u32} counts_large={=u32} counts_small={=u32} current={=f32} current_small={=f32} torque={=f32} velocity_large={=f32} velocity_small={=f32} state={=u8} cause={=u8} sigma_large={=f32} estimator={=u8} overruns={=u32} drops={=u32} rtt_drops={=u16} cycles={=u32}";
            /// Number of the frame from 0, modulo 2^32. Frames that were lost count.
            seq: u32, "seq", log, $frame.seq;
            /// Number of the control tick from 0, modulo 2^32.
            tick: u32, "tick", log, $frame.record.tick;
            /// Count of the large encoder, modulo 2^32.
            counts_large: u32, "large", csv, $frame.record.sample.count.0;
            /// Count of the small encoder, modulo 2^32.
            counts_small: u32, "small", csv, $frame.record.sample.coupled.0;
            /// Current of the large motor, commanded from this tick on, A.
            current: f32, "il", csv, $frame.record.action.currents.large.get();
            /// Current of the small motor, commanded from this tick on, A.
            current_small: f32, "is", csv, $frame.record.action.currents.small.get();
            /// Torque that the handle should feel by the scene, N·m.
            torque: f32, "torque", csv, $frame.record.action.torque.0;
            /// Estimated velocity of the large motor, rad/s; 0 where the scene needs none.
            velocity_large: f32, "wl", csv, $frame.record.action.large_velocity.0;
            /// Estimated velocity of the handle, rad/s; 0 where the scene needs none.
            velocity_small: f32, "ws", csv, $frame.record.action.handle_velocity.0;
            /// State of the safety machine, by its number.
            state: Mode, "state", csv, $frame.record.state as u8;
            /// Cause of the latest stop, by its number.
            cause: Stop, "cause", csv, $frame.record.cause as u8;
            /// Standard deviation of `velocity_large` by its estimator, rad/s; 0 where the scene needs
            /// no velocity. Older images do not have it.
            sigma_large: Option<f32>, "sl", csv, $frame.deviation();
            /// Number of the estimator that gives `velocity_large`; 255 while one takes over, and
            /// where the scene needs none. Older images do not have it.
            estimator: Option<u8>, "estimator", log, $frame.estimator();
            /// Control ticks missed or late since boot, modulo 2^32.
            overruns: u32, "overruns", log, $frame.record.overruns;
            /// Frames lost since boot, modulo 2^32.
            drops: u32, "drops", log, $frame.drops($lost);
            /// Those of `drops` that found no place in RTT, modulo 2^16; the others found none in the
            /// queue. Older images do not have it.
            rtt_drops: Option<u16>, "rtt_drops", log, $lost as u16;
            /// Core clock cycles of the longest control task since the frame before.
            cycles: u32, "cycles", log, $frame.cycles;
        }
    };
}
