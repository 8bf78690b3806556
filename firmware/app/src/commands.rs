//! Commands: from the bytes of a channel to messages for the control task.

use drivers::{Command, Parser, Setting, Settings};
use haptic_control::{Refusal, Request, SceneKind};
use heapless::spsc::{Producer, Queue};

use crate::control::Message;
use crate::large::{Large, LargeEstimator as _};
use crate::reports::Reports;
use crate::scene::{self, Parameters, TORQUE_SCENE};

/// Places of the queue of messages, of which one stays empty.
const PLACES: usize = 8;
/// Messages that wait for the control task, which takes three in ten ticks at 10 kHz.
pub type Messages = Queue<Message, PLACES>;
/// Largest number of messages that wait.
pub const WAITING: usize = PLACES - 1;
/// Largest number of bytes that one call takes.
const BYTES: usize = 64;

/// Where commands come from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Channel {
    /// The debug probe.
    Rtt,
    /// The serial port.
    Port,
}

impl Channel {
    /// Number of channels.
    const COUNT: usize = Self::Port as usize + 1;
}

/// Counts of what was rejected since the start, modulo 2^32.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Rejected {
    /// Bytes outside any command.
    pub garbage: u32,
    /// Commands whose value is not finite.
    pub not_finite: u32,
    /// Commands whose value is out of bounds.
    pub out_of_bounds: u32,
    /// Commands that name an unknown scene, parameter, estimator or setting.
    pub unknown: u32,
    /// Selections of a scene in closed loop before the signs were verified.
    pub unverified: u32,
}

/// What commands have asked for since the last call of [`Commands::asked`].
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Asked {
    /// The identity of the image, and the counts of what was rejected.
    pub identity: bool,
    /// All settings.
    pub settings: bool,
    /// That the settings are stored.
    pub store: bool,
}

/// The receiving end of the command channels. Each channel has a parser of its own, and all of them
/// feed one queue.
pub struct Commands<'q> {
    parsers: [Parser; Channel::COUNT],
    parameters: Parameters,
    settings: Settings,
    queue: Producer<'q, Message>,
    rejected: Rejected,
    reports: Reports<Rejected>,
    asked: Asked,
    arms: bool,
    used: [bool; Channel::COUNT],
}

impl<'q> Commands<'q> {
    /// A receiver without received bytes, on a board with these settings.
    pub fn new(queue: Producer<'q, Message>, settings: Settings) -> Self {
        Self {
            parsers: [Parser::default(); Channel::COUNT],
            parameters: Parameters::default(),
            settings,
            queue,
            rejected: Rejected::default(),
            reports: Reports::default(),
            asked: Asked::default(),
            arms: false,
            used: [false; Channel::COUNT],
        }
    }

    /// Takes bytes of a channel from `next` until it has none, at most 64, while the queue has room
    /// for a message and nobody has asked for the identity: each such question has an answer of its own.
    pub fn receive(&mut self, channel: Channel, mut next: impl FnMut() -> Option<u8>) {
        for _ in 0..BYTES {
            if !self.queue.ready() || self.asked.identity {
                return;
            }
            let Some(byte) = next() else {
                break;
            };
            let Some(command) = self.parsers[channel as usize].take(byte) else {
                continue;
            };
            self.used[channel as usize] = true;
            if let Some(message) = self.follow(command) {
                let _ = self.queue.enqueue(message);
            }
        }
    }

    /// Whether a command has come over the channel.
    #[must_use]
    pub const fn is_used(&self, channel: Channel) -> bool {
        self.used[channel as usize]
    }

    /// The message of a command. Scenes are built here, at low priority.
    fn follow(&mut self, command: Command) -> Option<Message> {
        let message = match command {
            Command::Request(Request::Select(scene)) if !scene::has(scene) => Err(Refusal::Unknown),
            Command::Request(Request::Select(scene)) if !self.admits(scene) => {
                let count = &mut self.rejected.unverified;
                *count = count.wrapping_add(1);
                return None;
            }
            Command::Request(request) => {
                self.arms |= request == Request::Arm;
                return Some(Message::Request(request));
            }
            Command::Identify => {
                self.asked.identity = true;
                return None;
            }
            Command::Settings => {
                self.asked.settings = true;
                return None;
            }
            Command::Store => {
                self.asked.store = true;
                return None;
            }
            Command::Set { setting, value } => self.changed(setting, value),
            Command::Estimator(number) => Large::choice(number)
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
            Err(Refusal::NotFinite) => &mut self.rejected.not_finite,
            Err(Refusal::OutOfBounds) => &mut self.rejected.out_of_bounds,
            Err(Refusal::Unknown) => &mut self.rejected.unknown,
        };
        *count = count.wrapping_add(1);
        None
    }

    fn tuned(&mut self, scene: u8, parameter: u8, value: f32) -> Result<Message, Refusal> {
        self.parameters
            .set(scene, parameter, value)
            .map(Message::Tuned)
    }

    /// Changes a setting. What is on is switched off where the signs are no longer verified: it may be a scene in
    /// closed loop.
    fn changed(&mut self, setting: u8, value: f32) -> Result<Message, Refusal> {
        let setting = Setting::from_number(setting).ok_or(Refusal::Unknown)?;
        if !value.is_finite() {
            return Err(Refusal::NotFinite);
        }
        let verified = self.settings.are_signs_verified();
        if !self.settings.set(setting, value) {
            return Err(Refusal::OutOfBounds);
        }
        let request = match verified && !self.settings.are_signs_verified() {
            true => Request::Select(0),
            false => Request::KeepAlive,
        };
        Ok(Message::Settings(self.settings, request))
    }

    /// Whether the scene may be selected: a scene in closed loop needs verified signs.
    fn admits(&self, scene: u8) -> bool {
        let kind = SceneKind::ALL.get(usize::from(scene));
        self.settings.are_signs_verified() || !kind.is_some_and(|kind| kind.is_closed_loop())
    }

    /// The settings.
    #[must_use]
    pub const fn settings(&self) -> &Settings {
        &self.settings
    }

    /// What commands have asked for since the last call.
    pub fn asked(&mut self) -> Asked {
        core::mem::take(&mut self.asked)
    }

    /// Whether a command has asked to arm since the last call.
    pub fn take_arms(&mut self) -> bool {
        core::mem::take(&mut self.arms)
    }

    /// The counts of the last report and of now, at every 256th call if they differ. The caller
    /// calls this function once per frame.
    pub fn report(&mut self) -> Option<[Rejected; 2]> {
        self.reports.take(self.rejected())
    }

    /// The counts of now.
    #[must_use]
    pub fn rejected(&self) -> Rejected {
        let garbage = self.parsers.iter().map(Parser::garbage);
        Rejected {
            garbage: garbage.fold(0, u32::wrapping_add),
            ..self.rejected
        }
    }
}
