//! A board that plays a script: it answers commands, sends a frame per millisecond of its own time, and
//! has no control and no time limits.

use std::io::{ErrorKind, Read as _, Write as _};
use std::net::{Shutdown, TcpStream};
use std::sync::mpsc::Sender;
use std::time::{Duration, Instant};

use drivers::link::{
    FEATURES, Features, Frame, Hello, Index, LONGEST, Measured, Message, Rejected, Stored, Supply,
};
use drivers::{Command, Parser, Saved, Setting, Settings};
use haptic_control::{Mode, Request, Stop};

use crate::scripted::{Part, Script};

/// Frames that the board sends at a time.
const BURST: u32 = 10;

/// The frame of this number: its values follow from the number.
pub(super) fn frame(seq: u32, state: Mode, cause: Stop) -> Frame {
    Frame {
        seq,
        tick: 10 * seq,
        counts_large: 3 * seq,
        counts_small: 0_u32.wrapping_sub(seq),
        current: 0.5,
        current_small: -0.25,
        torque: 0.01,
        velocity_large: 1.5,
        velocity_small: -2.5,
        state: state as u8,
        cause: cause as u8,
        sigma_large: 0.125,
        estimator: 0,
        overruns: 0,
        drops: 0,
        rtt_drops: 0,
        cycles: 900,
    }
}

/// Commands to both motors from a frame on, A, in the scene of a board that measures currents: levels of
/// both signs, 12 ms each.
fn commands(seq: u32) -> [f32; 2] {
    let level = [1.0, -1.0, 0.4, 0.0, -0.4, 0.7, -0.7][seq as usize / 12 % 7];
    [0.3 * level, -0.15 * level]
}

/// The state of a board that plays a script.
struct Player<'a> {
    script: &'a Script,
    state: Mode,
    cause: Stop,
    rejected: Rejected,
    settings: Settings,
    /// Number of the next frame.
    seq: u32,
    /// Frame at which the first question came.
    asked: Option<u32>,
    /// Frame before which the board closes its end.
    last: Option<u32>,
    /// Frame at which the first command came after which the firmware starts again.
    starts_from: Option<u32>,
    /// Whether it has.
    has_started: bool,
    /// Frame at which the command `select` came.
    selected: Option<u32>,
    /// Frame at which the first command `disarm` came.
    disarmed: Option<u32>,
    /// Questions for the identity so far.
    questions: u32,
    /// Commands with a value so far.
    values: u32,
    /// Commands `select` so far.
    selections: u32,
    /// End of the pause.
    quiet_until: Option<Instant>,
    /// An answer that waits for the next question.
    late: Vec<u8>,
    /// Bytes to be sent.
    bytes: Vec<u8>,
}

impl<'a> Player<'a> {
    fn new(script: &'a Script) -> Self {
        Self {
            script,
            state: script.begin,
            cause: Stop::None,
            rejected: script.rejected,
            settings: script.settings,
            // The board has run for some time.
            seq: 50,
            asked: None,
            last: None,
            starts_from: None,
            has_started: false,
            selected: None,
            disarmed: None,
            questions: 0,
            values: 0,
            selections: 0,
            quiet_until: None,
            late: Vec::new(),
            bytes: Vec::new(),
        }
    }

    /// Bytes of a message, with the noise before it.
    fn message(&self, message: Message) -> Vec<u8> {
        let mut buffer = [0; LONGEST];
        let frame = message.encode(&mut buffer).unwrap();
        let frame = match message {
            Message::Hello(_) => appended(frame, &self.script.appended),
            _ => frame.to_vec(),
        };
        [&self.script.noise[..], &frame].concat()
    }

    fn take(&mut self, command: Command) {
        if let Some((from, frames)) = self.script.hang_up
            && command == from
        {
            self.last.get_or_insert(self.seq + frames);
        }
        if let Some((from, _)) = self.script.starts_again
            && command == from
        {
            self.starts_from.get_or_insert(self.seq);
        }
        match command {
            Command::Identify => {
                self.asked.get_or_insert(self.seq);
                self.questions += 1;
                let parts = [
                    (Part::Identity, self.hello().into()),
                    (Part::Counts, self.rejected.into()),
                ];
                let sent = (parts.into_iter())
                    .filter(|(part, _)| self.script.loses != Some((self.questions, *part)));
                let answer: Vec<u8> = sent.flat_map(|(_, it)| self.message(it)).collect();
                let now = match self.script.answers_late {
                    true => std::mem::replace(&mut self.late, answer),
                    false => answer,
                };
                self.bytes.extend(now);
            }
            Command::Request(Request::Arm) => self.state = self.script.armed,
            Command::Request(Request::Disarm) => {
                let from = *self.disarmed.get_or_insert(self.seq);
                let after = self.script.disarms_after;
                if after.is_some_and(|frames| self.seq >= from + frames) {
                    (self.state, self.cause) = (Mode::Boot, Stop::None);
                }
            }
            Command::Request(Request::Select(_)) => {
                self.selected = Some(self.seq);
                self.selections += 1;
            }
            Command::Tune { .. } | Command::Torque(_) | Command::Estimator(_) => {
                if self.value_arrives() {
                    self.rejected.out_of_bounds += u32::from(self.script.refuses);
                }
            }
            Command::Set { setting, value } => {
                if self.value_arrives()
                    && let Some(setting) = Setting::from_number(setting)
                {
                    self.settings.set(setting, value);
                }
            }
            Command::Settings => {
                for setting in Setting::ALL {
                    let message = drivers::link::Setting {
                        number: setting.number(),
                        value: self.settings.get(*setting),
                        count: Setting::ALL.len() as u8,
                    };
                    self.bytes.extend(self.message(message.into()));
                }
            }
            Command::Store => {
                let outcome = Saved::Stored as u8;
                self.bytes.extend(self.message(Stored { outcome }.into()));
            }
            Command::Request(_) => {}
        }
    }

    /// Whether the next command with a value arrives as it was sent.
    fn value_arrives(&mut self) -> bool {
        self.values += 1;
        let (first, last) = self.script.damages;
        let is_damaged = (first..=last).contains(&self.values);
        // The bytes of a command.
        self.rejected.garbage += if is_damaged { 12 } else { 0 };
        !is_damaged
    }

    /// The identity, with the features of the script.
    fn hello(&self) -> Hello {
        let bit = |has: bool, feature| {
            let bit = FEATURES.iter().position(|name| *name == feature);
            bit.filter(|_| has).map_or(0, |bit| 1 << bit)
        };
        let bits = bit(self.script.measures.is_some(), "current-monitor")
            | bit(self.script.turns.is_some(), "index-pulse")
            | bit(self.script.supply.is_some(), "supply-monitor");
        let mut hello = self.script.hello;
        hello.features = Features(hello.features.0 | bits);
        hello
    }

    /// The index pulses that are told after the frame of now.
    fn index(&self) -> Option<Index> {
        let [large, small] = self.script.turns?;
        let pulses = self.seq / 100;
        self.seq.is_multiple_of(100).then_some(Index {
            seq: self.seq,
            pulses_large: pulses,
            count_large: pulses * large,
            deviation_large: 0,
            position_large: 0,
            pulses_small: pulses,
            count_small: pulses * small,
            deviation_small: 0,
            position_small: 0,
        })
    }

    /// The frame of now, and the currents that are measured beside it.
    fn frame(&self) -> (Frame, Option<Measured>) {
        let frame = frame(self.seq, self.state, self.cause);
        let Some(measures) = self.script.measures else {
            return (frame, None);
        };
        // The mean over the millisecond before is that of the command before.
        let ended = |seq| {
            let end = self.selected.zip(self.script.strokes_end_after);
            end.is_some_and(|(from, frames)| seq >= from + frames)
        };
        let commands = |seq| match self.state {
            Mode::Running if !ended(seq) => commands(seq),
            _ => [0.0; 2],
        };
        let flowing = commands(self.seq - 1);
        let [large, small] =
            [0, 1].map(|motor| measures[motor].0 + measures[motor].1 * flowing[motor]);
        let [current, current_small] = commands(self.seq);
        let frame = Frame {
            counts_large: 0,
            counts_small: 0,
            current,
            current_small,
            ..frame
        };
        let seq = self.seq;
        (frame, Some(Measured { seq, large, small }))
    }

    /// Makes a frame.
    fn tick(&mut self) {
        let after =
            |selected: Option<u32>, frames| selected.is_some_and(|at| self.seq == at + frames);
        if let Some((frames, wait)) = self.script.pause
            && after(self.selected, frames)
        {
            let until = *self.quiet_until.get_or_insert(Instant::now() + wait);
            if Instant::now() < until {
                return;
            }
        }
        if self
            .script
            .starts_after
            .is_some_and(|frames| after(self.selected, frames))
        {
            self.state = Mode::Running;
        }
        if let Some((frames, mode, stop)) = self.script.stop
            && self.selections == self.script.stops_at
            && after(self.selected, frames)
        {
            (self.state, self.cause) = (mode, stop);
        }
        let number = self.asked.map(|asked| self.seq - asked);
        let is_lost = |(first, last)| number.is_some_and(|it| (first..=last).contains(&it));
        if !self.script.lost.is_some_and(is_lost) {
            let (frame, measured) = self.frame();
            self.bytes.extend(self.message(frame.into()));
            if let Some(measured) = measured {
                self.bytes.extend(self.message(measured.into()));
            }
            if let Some(volts) = self.script.supply {
                let seq = self.seq;
                self.bytes
                    .extend(self.message(Supply { seq, volts }.into()));
            }
            if let Some(index) = self.index() {
                self.bytes.extend(self.message(index.into()));
            }
        }
        if self.script.garbles && self.seq.is_multiple_of(100) {
            self.rejected.garbage += 1;
            let told = self.message(self.rejected.into());
            self.bytes.extend(told);
        }
        self.seq += 1;
        let starts_at = (self.starts_from.zip(self.script.starts_again))
            .map(|(from, (_, frames))| from + frames);
        if !self.has_started && starts_at.is_some_and(|at| self.seq >= at) {
            self.has_started = true;
            (self.seq, self.asked) = (0, None);
            (self.state, self.rejected) = (Mode::Boot, Rejected::default());
            self.settings = self.script.settings;
            // The answer to a question from before, ahead of the first frame.
            let told = [self.hello().into(), self.rejected.into()].map(|it| self.message(it));
            self.bytes.extend(told.concat());
        }
    }

    /// Whether the board has sent its last frame.
    fn is_through(&self) -> bool {
        self.last.is_some_and(|last| self.seq >= last)
    }
}

/// A frame of the link with more bytes in its payload: start, kind, length, payload, CRC-16/IBM-3740
/// over all but the start.
pub(super) fn appended(frame: &[u8], more: &[u8]) -> Vec<u8> {
    let (head, payload) = frame[..frame.len() - 2].split_at(3);
    let mut longer = vec![head[0], head[1], head[2] + more.len() as u8];
    longer.extend(payload);
    longer.extend(more);
    let crc = longer[1..].iter().fold(0xFFFF_u16, |crc, byte| {
        (0..8).fold(crc ^ u16::from(*byte) << 8, |crc, _| match crc & 0x8000 {
            0 => crc << 1,
            _ => crc << 1 ^ 0x1021,
        })
    });
    longer.extend(crc.to_le_bytes());
    longer
}

/// Plays the script for one connection, and reports the commands that come.
pub(super) fn play(mut stream: TcpStream, script: &Script, report: &Sender<Command>) {
    stream
        .set_read_timeout(Some(Duration::from_millis(2)))
        .unwrap();
    let mut parser = Parser::default();
    let mut player = Player::new(script);
    let mut is_open = true;
    loop {
        let mut bytes = [0; 256];
        let count = match stream.read(&mut bytes) {
            Ok(0) => return,
            Ok(count) => count,
            Err(error) if matches!(error.kind(), ErrorKind::WouldBlock | ErrorKind::TimedOut) => 0,
            Err(_) => return,
        };
        for command in bytes[..count].iter().filter_map(|byte| parser.take(*byte)) {
            // A test that has ended looks at no command.
            let _ = report.send(command);
            player.take(command);
        }
        for _ in 0..BURST {
            if !player.is_through() {
                player.tick();
            }
        }
        let made = std::mem::take(&mut player.bytes);
        let sent = script.instead.as_ref().unwrap_or(&made);
        if is_open && stream.write_all(sent).is_err() {
            return;
        }
        if is_open && player.is_through() {
            // What the tool says last is heard.
            is_open = stream.shutdown(Shutdown::Write).is_err();
        }
    }
}
