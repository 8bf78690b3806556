//! Side lines: lines that the firmware logs beside a frame, with the frame's sequence number.

use super::frame::{Fields, Frame};

/// The side lines of a frame. An image logs those that it has.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct SideLines {
    /// `edge`: the latest edge of the large encoder.
    pub edge: Option<EdgeLine>,
    /// `learned`: parameters that the large motor's estimator has learned.
    pub learned: Option<LearnedLine>,
    /// `reference`: count of the reference encoder.
    pub reference: Option<u32>,
    /// `measured`: measured currents.
    pub measured: Option<MeasuredLine>,
    /// `index`: index pulses of the large and the small encoder.
    pub index: Option<[IndexLine; 2]>,
    /// `supply`: voltage of the amplifiers' supply, V.
    pub supply: Option<f64>,
}

/// An edge of the large encoder.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct EdgeLine {
    /// The boundary crossed: boundary `e` lies between counts `e - 1` and `e`.
    pub boundary: u32,
    /// Its age when the counters were read, ticks of the clock that stamps edges.
    pub age: u32,
}

/// Learned parameters of the large motor per inertia, as relative errors of the image's constants.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LearnedLine {
    /// Damping of the coupler.
    pub damping: f64,
    /// Coulomb friction.
    pub friction: f64,
    /// Torque constant.
    pub torque_constant: f64,
}

/// Mean measured currents since the frame before, A.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MeasuredLine {
    /// Large motor.
    pub large: f64,
    /// Small motor.
    pub small: f64,
}

/// Index pulses of an encoder.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct IndexLine {
    /// Pulses since the reference was taken; 0 without a reference.
    pub pulses: u32,
    /// Count of the latest pulse.
    pub count: u32,
    /// Distance of the latest pulse from whole turns, counts.
    pub deviation: i32,
    /// Count of the frame less the one of the reference; 0 without a reference.
    pub position: i32,
}

/// Begins of side lines.
pub(super) const STARTS: [&str; 6] = [
    "edge seq=",
    "index seq=",
    "learned seq=",
    "measured seq=",
    "reference seq=",
    "supply seq=",
];

impl Frame {
    /// Reads a line that begins with one of [`STARTS`]. A side line of another frame, which is
    /// missing, is ignored.
    pub(super) fn take(&mut self, line: &str) -> Result<(), String> {
        let fields = Fields(line);
        if fields.number::<u32>("seq")? != self.seq {
            return Ok(());
        }
        let lines = &mut self.side_lines;
        match line.split(' ').next() {
            Some("edge") => {
                lines.edge = Some(EdgeLine {
                    boundary: fields.number("bound")?,
                    age: fields.number("age")?,
                });
            }
            Some("learned") => {
                lines.learned = Some(LearnedLine {
                    damping: fields.number("damping")?,
                    friction: fields.number("friction")?,
                    torque_constant: fields.number("torque_constant")?,
                });
            }
            Some("measured") => {
                lines.measured = Some(MeasuredLine {
                    large: fields.number("large")?,
                    small: fields.number("small")?,
                });
            }
            Some("index") => {
                lines.index = Some([
                    IndexLine {
                        pulses: fields.number("pulses_large")?,
                        count: fields.number("count_large")?,
                        deviation: fields.number("deviation_large")?,
                        position: fields.number("position_large")?,
                    },
                    IndexLine {
                        pulses: fields.number("pulses_small")?,
                        count: fields.number("count_small")?,
                        deviation: fields.number("deviation_small")?,
                        position: fields.number("position_small")?,
                    },
                ]);
            }
            Some("supply") => lines.supply = Some(fields.number("volts")?),
            _ => lines.reference = Some(fields.number("count")?),
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::telemetry::Telemetry;
    use crate::telemetry::frame::tests::LINE;

    #[test]
    fn side_lines_belong_to_the_frame_of_their_sequence_number() {
        let log = format!(
            "{LINE}\n[INFO ] edge seq=3 bound=4294967295 age=42 (firmware src/telemetry.rs:99)\n\
             learned seq=3 damping=0.1 friction=-0.2 torque_constant=0\nreference seq=3 count=9\n\
             measured seq=3 large=-0.25 small=1.5\nsupply seq=3 volts=23.75\n\
             index seq=3 pulses_large=2 count_large=4097 deviation_large=-1 position_large=4096 \
             pulses_small=0 count_small=7 deviation_small=9 position_small=0\n\
             {LINE}\nedge seq=4 bound=1 age=1\nedge seq=3 bound=x age=1\nedge seq=3 bound=1\n"
        );
        let telemetry = Telemetry::text(log.as_bytes());
        let [first, second] = &telemetry.frames[..] else {
            panic!("two frames");
        };
        let expected = SideLines {
            edge: Some(EdgeLine {
                boundary: u32::MAX,
                age: 42,
            }),
            learned: Some(LearnedLine {
                damping: 0.1,
                friction: -0.2,
                torque_constant: 0.0,
            }),
            reference: Some(9),
            measured: Some(MeasuredLine {
                large: -0.25,
                small: 1.5,
            }),
            index: Some([
                IndexLine {
                    pulses: 2,
                    count: 4097,
                    deviation: -1,
                    position: 4096,
                },
                IndexLine {
                    pulses: 0,
                    count: 7,
                    deviation: 9,
                    position: 0,
                },
            ]),
            supply: Some(23.75),
        };
        assert_eq!(first.side_lines, expected);
        assert_eq!(second.side_lines, SideLines::default());
        assert_eq!(telemetry.malformed.len(), 2, "{:?}", telemetry.malformed);
        assert_eq!(telemetry.log, [""; 0]);
    }
}
