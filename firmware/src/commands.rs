//! Commands from RTT down channel 0 to the control task.

use drivers::{Command, Parser};
use haptic_control::Refusal;
use heapless::spsc::{Producer, Queue};

use crate::control::Message;
use crate::scene::{Settings, TORQUE_SCENE, choice};

/// Messages that wait for the control task, which takes one a tick.
pub(crate) type Messages = Queue<Message, 8>;
/// Bytes that one look takes at most.
const BYTES: usize = 64;

/// What was no command, or one that nobody can follow.
#[derive(Clone, Copy, Default, PartialEq, Eq)]
struct Refused {
    garbage: u32,
    not_finite: u32,
    out_of_bounds: u32,
    unknown: u32,
}

/// The receiving end of the command channel.
pub(crate) struct Commands {
    parser: Parser,
    settings: Settings,
    queue: Producer<'static, Message>,
    refused: Refused,
    reported: Refused,
    reports: u8,
}

impl Commands {
    /// A receiver that has seen nothing.
    pub(crate) fn new(queue: Producer<'static, Message>) -> Self {
        Self {
            parser: Parser::default(),
            settings: Settings::new(),
            queue,
            refused: Refused::default(),
            reported: Refused::default(),
            reports: 0,
        }
    }

    /// Takes what came down, while there is place for what it asks.
    pub(crate) fn receive(&mut self) {
        for _ in 0..BYTES {
            if !self.queue.ready() {
                return;
            }
            let Some(byte) = bare::receive() else {
                break;
            };
            if let Some(message) = self.parser.take(byte).and_then(|it| self.follow(it)) {
                let _ = self.queue.enqueue(message);
            }
        }
    }

    /// What the control task is to be told; scenes are built here, where there is time.
    fn follow(&mut self, command: Command) -> Option<Message> {
        let message = match command {
            Command::Request(request) => return Some(Message::Request(request)),
            Command::Estimator(number) => choice(number)
                .map(Message::Estimator)
                .ok_or(Refusal::Unknown),
            Command::Torque(torque) => self.tuned(TORQUE_SCENE, 0, torque),
            Command::Tune {
                scene,
                parameter,
                value,
            } => self.tuned(scene, parameter, value),
        };
        let count = match message {
            Ok(message) => return Some(message),
            Err(Refusal::NotFinite) => &mut self.refused.not_finite,
            Err(Refusal::OutOfBounds) => &mut self.refused.out_of_bounds,
            Err(Refusal::Unknown) => &mut self.refused.unknown,
        };
        *count = count.wrapping_add(1);
        None
    }

    fn tuned(&mut self, scene: u8, parameter: u8, value: f32) -> Result<Message, Refusal> {
        self.settings
            .set(scene, parameter, value)
            .map(Message::Tuned)
    }

    /// Says at times, not for every byte of a flood, what was refused.
    pub(crate) fn report(&mut self) {
        self.refused.garbage = self.parser.garbage();
        self.reports = self.reports.wrapping_add(1);
        if self.reports != 0 || self.refused == self.reported {
            return;
        }
        let Refused {
            garbage,
            not_finite,
            out_of_bounds,
            unknown,
        } = self.refused;
        if garbage != self.reported.garbage {
            defmt::warn!("garbage bytes={=u32}", garbage);
        }
        if (Refused {
            garbage: 0,
            ..self.refused
        }) != (Refused {
            garbage: 0,
            ..self.reported
        }) {
            defmt::warn!(
                "refused not-finite={=u32} out-of-bounds={=u32} unknown={=u32}",
                not_finite,
                out_of_bounds,
                unknown
            );
        }
        self.reported = self.refused;
    }
}
