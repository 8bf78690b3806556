//! The link: messages to the host over the serial port and RTT, sent at the lowest priority.

use drivers::link::{
    Edge, Features, Frame as FrameMessage, Hello, Index, LONGEST, Label, Learned, Measured,
    Message, PROTOCOL, Reference, Rejected as RejectedMessage, Setting as SettingMessage, Supply,
};
use drivers::{Setting, Settings};
use estimator_core::Count;
use firmware_app::commands::Rejected;
use firmware_app::config::RATE_HZ;
use firmware_app::telemetry::Frame;
use haptic_control::{Currents, Stop, Volts};
use tuned::{DEVICE_FINGERPRINT, PRESETS_FINGERPRINT};

use crate::boards::Port;

/// Version of the firmware.
pub(crate) const VERSION: &str = env!("CARGO_PKG_VERSION");
/// Commit of the firmware.
pub(crate) const COMMIT: &str = env!("COMMIT");

macro_rules! bits {
    ($($name:literal;)+) => {
        Features::from_flags(&[$(cfg!(feature = $name)),+])
    };
}
/// Features of the image.
const FEATURES: Features = drivers::link_features!(bits);

/// Identity of the image, after this reset.
pub(crate) fn identity(reset: Stop, brown_out_reset: bool) -> Hello {
    Hello {
        protocol: PROTOCOL,
        version: const { Label::new(VERSION) },
        commit: const { Label::new(COMMIT) },
        features: FEATURES,
        rate: RATE_HZ,
        device: DEVICE_FINGERPRINT.0,
        presets: PRESETS_FINGERPRINT.0,
        cause: reset as u8,
        brown_out_reset,
    }
}

macro_rules! message {
    ($format:literal; $($(#[$doc:meta])* $name:ident: $type:ty, $old:literal, $csv:ident, $value:expr;)+) => {
        FrameMessage { $($name: $value),+ }
    };
}

/// Sends messages.
pub(crate) struct Link<P> {
    pub(crate) port: P,
    /// Whether a host has sent a command over RTT. RTT has no messages before: a host that shows the
    /// log alone would show their bytes too.
    pub(crate) rtt: bool,
}

impl<P: Port> Link<P> {
    /// Queues a message on each channel that has room for it.
    pub(crate) fn send(&mut self, message: impl Into<Message>) {
        let mut buffer = [0; LONGEST];
        // There is room for every message.
        let frame = message.into().encode(&mut buffer).unwrap_or_default();
        self.port.send(frame);
        if self.rtt {
            firmware_rt::send(frame);
        }
    }

    /// Sends the messages of a frame. `lost`: frames that RTT has lost.
    pub(crate) fn frame(&mut self, frame: &Frame, lost: u32) {
        self.send(drivers::frame_fields!(message, frame, lost));
        let seq = frame.seq;
        if let Some(edge) = frame.edge() {
            let (bound, age) = (edge.boundary.0, edge.age.0);
            self.send(Edge { seq, bound, age });
        }
        if let Some(learned) = frame.learned() {
            self.send(Learned {
                seq,
                damping: learned.damping,
                friction: learned.friction,
                torque_constant: learned.torque_constant,
            });
        }
        if let Some(Currents { large, small }) = frame.measured() {
            let (large, small) = (large.get(), small.get());
            self.send(Measured { seq, large, small });
        }
        if let Some([large, small]) = frame.index() {
            self.send(Index {
                seq,
                pulses_large: large.pulses,
                count_large: large.count.0,
                deviation_large: large.deviation,
                position_large: large.position.0,
                pulses_small: small.pulses,
                count_small: small.count.0,
                deviation_small: small.deviation,
                position_small: small.position.0,
            });
        }
        if let Some(Volts(volts)) = frame.supply() {
            self.send(Supply { seq, volts });
        }
        if let Some(Count(count)) = frame.reference {
            self.send(Reference { seq, count });
        }
    }

    /// Sends what was rejected since boot.
    pub(crate) fn rejected(&mut self, counts: Rejected) {
        let Rejected {
            garbage,
            not_finite,
            out_of_bounds,
            unknown,
            unverified,
        } = counts;
        self.send(RejectedMessage {
            garbage,
            not_finite,
            out_of_bounds,
            unknown,
            unverified,
        });
    }

    /// Sends all settings.
    pub(crate) fn settings(&mut self, settings: &Settings) {
        for setting in Setting::ALL {
            self.send(SettingMessage {
                number: setting.number(),
                value: settings.get(*setting),
                count: Setting::ALL.len() as u8,
            });
        }
    }
}
