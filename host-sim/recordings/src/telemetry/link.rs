//! Telemetry from the messages of the link.

use drivers::link::Message;
use haptic_control::Fingerprint;

use super::{Boot, EdgeLine, IndexLine, LearnedLine, MeasuredLine, SideLines, Telemetry};

impl Telemetry {
    /// Adds a message. Lines beside a frame that is missing are ignored, as in a log.
    ///
    /// The first identity gives the control rate. A later one may be an answer and not a start of the
    /// firmware; a start shows in sequence number and tick.
    pub fn add(&mut self, message: Message) {
        match message {
            Message::Hello(hello) if self.boots.is_empty() => self.boots.push(Boot {
                after: self.frames.len(),
                rate_hz: f64::from(hello.rate),
                device: Some(Fingerprint(hello.device)),
                presets: Some(Fingerprint(hello.presets)),
            }),
            Message::Hello(_) | Message::Rejected(_) | Message::Setting(_) | Message::Stored(_) => {
            }
            Message::Frame(frame) => match frame.try_into() {
                Ok(frame) => self.frames.push(frame),
                Err(error) => self.malformed.push(error),
            },
            Message::Edge(edge) => self.beside(edge.seq, |lines| {
                lines.edge = Some(EdgeLine {
                    boundary: edge.bound,
                    age: edge.age,
                });
            }),
            Message::Learned(learned) => self.beside(learned.seq, |lines| {
                lines.learned = Some(LearnedLine {
                    damping: decimal(learned.damping),
                    friction: decimal(learned.friction),
                    torque_constant: decimal(learned.torque_constant),
                });
            }),
            Message::Reference(reference) => self.beside(reference.seq, |lines| {
                lines.reference = Some(reference.count);
            }),
            Message::Measured(measured) => self.beside(measured.seq, |lines| {
                lines.measured = Some(MeasuredLine {
                    large: decimal(measured.large),
                    small: decimal(measured.small),
                });
            }),
            Message::Supply(supply) => self.beside(supply.seq, |lines| {
                lines.supply = Some(decimal(supply.volts));
            }),
            Message::Index(index) => self.beside(index.seq, |lines| {
                lines.index = Some([
                    IndexLine {
                        pulses: index.pulses_large,
                        count: index.count_large,
                        deviation: index.deviation_large,
                        position: index.position_large,
                    },
                    IndexLine {
                        pulses: index.pulses_small,
                        count: index.count_small,
                        deviation: index.deviation_small,
                        position: index.position_small,
                    },
                ]);
            }),
        }
    }

    fn beside(&mut self, seq: u32, set: impl FnOnce(&mut SideLines)) {
        let last = self.frames.last_mut();
        if let Some(frame) = last.filter(|frame| frame.seq == seq) {
            set(&mut frame.side_lines);
        }
    }
}

/// The number with the decimal digits that a log has, so that both give the same recording.
fn decimal(value: f32) -> f64 {
    value.to_string().parse().unwrap_or(f64::NAN)
}

#[cfg(test)]
mod tests {
    use drivers::link::{
        Edge, Frame, Hello, Index, Label, Learned, Measured, PROTOCOL, Reference, Supply,
    };

    use super::*;
    use crate::record::csv;

    fn frame(seq: u32) -> Frame {
        Frame {
            seq,
            tick: 10 * seq,
            counts_large: u32::MAX,
            counts_small: 7,
            current: -0.1,
            current_small: 0.25,
            torque: 0.01,
            velocity_large: 1e-7,
            velocity_small: -3.3,
            state: 2,
            cause: 13,
            sigma_large: 0.7,
            estimator: 1,
            overruns: 4,
            drops: 5,
            rtt_drops: 6,
            cycles: 900,
        }
    }

    const HELLO: Hello = Hello {
        protocol: PROTOCOL,
        version: Label::new("0.1.0"),
        commit: Label::new("unknown"),
        features: drivers::link::Features(0),
        rate: 10_000,
        device: 0x0012_ABCD,
        presets: 1,
        cause: 0,
        brown_out_reset: true,
    };

    #[test]
    fn link_and_log_give_the_same_recording() {
        let mut telemetry = Telemetry::default();
        telemetry.add(Message::Hello(HELLO));
        let mut log = "boot rate=10000 cause=0 brown-out-reset=true device=0012abcd \
                       presets=00000001\n"
            .to_owned();
        for seq in 3..6 {
            let frame = frame(seq);
            telemetry.add(Message::Frame(frame));
            log += &format!(
                "frame seq={seq} tick={} counts_large=4294967295 counts_small=7 current=-0.1 \
                 current_small=0.25 torque=0.01 velocity_large=0.0000001 velocity_small=-3.3 \
                 state=2 cause=13 sigma_large=0.7 estimator=1 overruns=4 drops=5 rtt_drops=6 \
                 cycles=900\n",
                frame.tick
            );
        }
        telemetry.add(Message::Edge(Edge {
            seq: 5,
            bound: 9,
            age: 84,
        }));
        telemetry.add(Message::Learned(Learned {
            seq: 5,
            damping: 0.1,
            friction: -0.2,
            torque_constant: 0.3,
        }));
        telemetry.add(Message::Reference(Reference { seq: 5, count: 11 }));
        telemetry.add(Message::Measured(Measured {
            seq: 5,
            large: 0.5,
            small: -0.1,
        }));
        telemetry.add(Message::Supply(Supply {
            seq: 5,
            volts: 23.9,
        }));
        telemetry.add(Message::Index(Index {
            seq: 5,
            pulses_large: 2,
            count_large: 4097,
            deviation_large: -1,
            position_large: 4096,
            pulses_small: 3,
            count_small: 4_294_967_295,
            deviation_small: 9,
            position_small: -7,
        }));
        log += "edge seq=5 bound=9 age=84\n\
                learned seq=5 damping=0.1 friction=-0.2 torque_constant=0.3\n\
                reference seq=5 count=11\n\
                measured seq=5 large=0.5 small=-0.1\n\
                supply seq=5 volts=23.9\n\
                index seq=5 pulses_large=2 count_large=4097 deviation_large=-1 position_large=4096 \
                pulses_small=3 count_small=4294967295 deviation_small=9 position_small=-7\n";
        let logged = Telemetry::text(log.as_bytes());
        assert_eq!(telemetry.frames, logged.frames);
        assert_eq!(telemetry.boots, logged.boots);
        let text = |telemetry: &Telemetry| csv(&telemetry.runs()[0], 1e4, |_| None);
        assert_eq!(text(&telemetry), text(&logged));
        assert!(text(&telemetry).ends_with(",23.9,0.1,-0.2,0.3\n"));
    }

    #[test]
    fn later_identity_and_a_line_of_a_missing_frame_change_nothing() {
        let mut telemetry = Telemetry::default();
        telemetry.add(Message::Hello(HELLO));
        telemetry.add(Message::Frame(frame(0)));
        telemetry.add(Message::Hello(Hello { rate: 1, ..HELLO }));
        telemetry.add(Message::Reference(Reference { seq: 1, count: 11 }));
        telemetry.add(Message::Frame(frame(1)));
        assert_eq!(telemetry.boots.len(), 1);
        assert_eq!(telemetry.frames[0].side_lines, SideLines::default());
        let [run] = &telemetry.runs()[..] else {
            panic!("one run");
        };
        assert_eq!((run.frames.len(), run.rate_hz()), (2, Some(1e4)));
    }

    #[test]
    fn frame_with_an_unknown_state_is_malformed() {
        let mut telemetry = Telemetry::default();
        telemetry.add(Message::Frame(Frame {
            state: 9,
            ..frame(0)
        }));
        assert!(telemetry.frames.is_empty());
        assert_eq!(telemetry.malformed, ["state=9 has no meaning"]);
    }
}
