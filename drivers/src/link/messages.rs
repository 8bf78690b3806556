//! The messages: one list, from which encoder, decoder and the tables of docs/link.md are made.

use haptic_control::{Mode, Stop};

use super::features::Features;
use super::wire::{Label, Logged, Wire};
use super::{BAUD, CRC, HEADER, LONGEST_PAYLOAD, encode};

/// A message of the schema.
#[derive(Clone, Copy, Debug)]
pub struct MessageFacts {
    /// Kind, the second byte of its frame.
    pub kind: u8,
    /// Name.
    pub name: &'static str,
    /// Meaning, and when the board sends the message.
    pub meaning: &'static str,
    /// Fields, in the order of the payload.
    pub fields: &'static [FieldFacts],
}

/// A field of a message.
#[derive(Clone, Copy, Debug)]
pub struct FieldFacts {
    /// Name.
    pub name: &'static str,
    /// Type: `u8`, `u16`, `u32`, `i32`, `f32`, `bool` or `text`.
    pub wire: &'static str,
    /// Number of bytes.
    pub size: usize,
    /// Meaning and unit.
    pub meaning: &'static str,
}

macro_rules! messages {
    ($(
        $(#[doc = $doc:literal])+
        $name:ident = $kind:literal {
            $($(#[doc = $field_doc:literal])+ $field:ident: $type:ty;)+
        }
    )+) => {
        $(
            $(#[doc = $doc])+
            #[derive(Clone, Copy, Debug, Default, PartialEq)]
            pub struct $name {
                $($(#[doc = $field_doc])+ pub $field: $type,)+
            }

            impl $name {
                const SIZE: usize = 0 $(+ <$type as Wire>::SIZE)+;

                fn put(self, to: &mut [u8]) -> Option<()> {
                    $(let to = self.$field.put(to)?;)+
                    to.is_empty().then_some(())
                }

                /// The message, and the bytes after its fields.
                fn get(from: &[u8]) -> Option<(Self, &[u8])> {
                    $(let ($field, from) = <$type as Wire>::get(from)?;)+
                    Some((Self { $($field),+ }, from))
                }
            }

            const _: () = assert!($name::SIZE <= LONGEST_PAYLOAD, "no room in a frame");

            impl From<$name> for Message {
                fn from(message: $name) -> Self {
                    Self::$name(message)
                }
            }
        )+

        /// A message from the board.
        #[derive(Clone, Copy, Debug, PartialEq)]
        pub enum Message {
            $($(#[doc = $doc])+ $name($name),)+
        }

        impl Message {
            /// Writes the frame of the message to the begin of `buffer` and returns the frame; `None`
            /// if the buffer is too short. [`LONGEST`](super::LONGEST) bytes suffice for every message.
            #[must_use]
            pub fn encode(self, buffer: &mut [u8]) -> Option<&[u8]> {
                match self {
                    $(Self::$name(message) => {
                        encode(buffer, $kind, $name::SIZE as u8, |to| message.put(to))
                    })+
                }
            }

            /// The message of this kind; `None` if this protocol has none, or has other fields.
            pub(super) fn decode(kind: u8, payload: &[u8]) -> Option<Self> {
                match kind {
                    $($kind => {
                        let (message, rest) = $name::get(payload)?;
                        // A later protocol may append fields to this message alone.
                        (rest.is_empty() || kind == HELLO).then_some(Self::$name(message))
                    })+
                    _ => None,
                }
            }
        }

        /// The messages of this protocol, in the order of their kinds.
        pub const SCHEMA: &[MessageFacts] = &[$(
            MessageFacts {
                kind: $kind,
                name: stringify!($name),
                meaning: concat!($($doc),+),
                fields: &[$(
                    FieldFacts {
                        name: stringify!($field),
                        wire: <$type as Wire>::NAME,
                        size: <$type as Wire>::SIZE,
                        meaning: concat!($($field_doc),+),
                    }
                ),+],
            }
        ),+];
    };
}

/// Kind of [`Hello`].
const HELLO: u8 = 1;

macro_rules! all {
    ($format:literal; $($(#[doc = $doc:literal])* $name:ident: $type:ty, $old:literal, $csv:ident, $value:expr;)+) => {
        messages! {
            /// Identity of the image, sent at boot and as the answer to the command `identify`.
            Hello = 1 {
                /// Number of the protocol.
                protocol: u16;
                /// Version of the firmware.
                version: Label;
                /// Abbreviated hash of the commit of the firmware, or `unknown`.
                commit: Label;
                /// Features of the image, a bit for each.
                features: Features;
                /// Control rate, Hz.
                rate: u32;
                /// Hash of the device that the image is built for.
                device: u32;
                /// Hash of the tuned parameters that the image is built for.
                presets: u32;
                /// Cause of the reset, by its number.
                cause: u8;
                /// Whether the chip is reset below 2.7 V.
                brown_out_reset: bool;
            }
            /// A control tick, a thousand a second.
            Frame = 2 {
                $($(#[doc = $doc])* $name: <$type as Logged>::Wire;)+
            }
            /// The latest stamped edge of the large encoder, after a frame, by an image with
            /// `edge-capture`.
            Edge = 3 {
                /// Sequence number of the frame.
                seq: u32;
                /// Boundary: boundary e lies between counts e - 1 and e.
                bound: u32;
                /// Age when the counters were read, ticks of 84 MHz.
                age: u32;
            }
            /// Learned parameters per inertia, relative to the assumed values, after each 128th frame,
            /// by an image with `large-adaptive`.
            Learned = 4 {
                /// Sequence number of the frame.
                seq: u32;
                /// Damping of the coupler; 0.1 is 10 % more.
                damping: f32;
                /// Coulomb friction.
                friction: f32;
                /// Torque constant.
                torque_constant: f32;
            }
            /// Count of the reference encoder, after a frame, by an image with `reference`.
            Reference = 5 {
                /// Sequence number of the frame.
                seq: u32;
                /// Count, modulo 2^32.
                count: u32;
            }
            /// Rejected commands since boot, modulo 2^32, sent after each `Hello` and after a change,
            /// then at most once in 256 ms.
            Rejected = 6 {
                /// Command bytes outside any frame.
                garbage: u32;
                /// Commands whose value is not finite.
                not_finite: u32;
                /// Commands whose value is out of bounds.
                out_of_bounds: u32;
                /// Commands that name an unknown scene, parameter, estimator or setting.
                unknown: u32;
                /// Selections of a scene in closed loop before the signs were verified.
                unverified: u32;
            }
            /// A setting, as it is now. All of them answer the command `settings`, in the order of their
            /// numbers.
            Setting = 7 {
                /// Number of the setting.
                number: u8;
                /// Value, in the setting's unit.
                value: f32;
                /// Number of the settings of the image.
                count: u8;
            }
            /// Answer to the command `store`.
            Stored = 8 {
                /// Outcome: 0 stored; 1 the amplifiers are enabled or were a moment ago; 2 the flash is full
                /// until the next reset; 3 the flash refuses; 4 the flash does not hold what was written.
                outcome: u8;
            }
            /// Measured currents, after a frame, by an image with `current-monitor`.
            Measured = 9 {
                /// Sequence number of the frame.
                seq: u32;
                /// Mean current of the large motor since the frame before, A.
                large: f32;
                /// Mean current of the small motor since the frame before, A.
                small: f32;
            }
            /// Index pulses of both encoders, after a frame if one came since the frame before, and after
            /// each 128th frame, by an image with `index-pulse`.
            Index = 10 {
                /// Sequence number of the frame.
                seq: u32;
                /// Pulses of the large encoder since its reference was taken, the reference included; 0
                /// without a reference.
                pulses_large: u32;
                /// Count of the large encoder at its latest pulse, modulo 2^32.
                count_large: u32;
                /// Distance of this pulse from whole turns after the reference, counts.
                deviation_large: i32;
                /// Counts of the large encoder in the frame from its mechanical zero; 0 without a
                /// reference.
                position_large: i32;
                /// Pulses of the small encoder since its reference was taken, as above.
                pulses_small: u32;
                /// Count of the small encoder at its latest pulse, modulo 2^32.
                count_small: u32;
                /// Distance of this pulse from whole turns after the reference, counts.
                deviation_small: i32;
                /// Counts of the small encoder in the frame from its mechanical zero; 0 without a
                /// reference.
                position_small: i32;
            }
            /// Voltage of the amplifiers' supply, after a frame, by an image with `supply-monitor`.
            Supply = 11 {
                /// Sequence number of the frame.
                seq: u32;
                /// Voltage at the frame, V.
                volts: f32;
            }
        }
    };
}
crate::frame_fields!(all, frame, lost);

/// Bytes of a frame and of all that an image sends after each one.
const EACH_MILLISECOND: usize = {
    let payloads = [
        Frame::SIZE,
        Edge::SIZE,
        Reference::SIZE,
        Measured::SIZE,
        Supply::SIZE,
    ];
    let mut bytes = payloads.len() * (HEADER + CRC);
    let mut i = 0;
    while i < payloads.len() {
        bytes += payloads[i];
        i += 1;
    }
    bytes
};
// Ten bits a byte.
const _: () = assert!(
    10_000 * EACH_MILLISECOND <= BAUD as usize,
    "the port is too slow"
);
