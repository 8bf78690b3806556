//! A connection to a board: commands down, messages up.

use std::collections::VecDeque;
use std::fmt::Display;
use std::io;
use std::time::{Duration, Instant};

use drivers::link::{Frame, Hello, Message, PROTOCOL, Parser, Rejected};
use drivers::{Command, encode};
use haptic_control::{Request, SceneKind};
use terminal::failure::Failure;
use terminal::output::{note, print_to_reader};

use crate::clock::Limit;
use crate::named::explained;
use crate::patience::AGAIN;
use crate::port::Port;
use crate::questions::Questions;
use crate::refusal::{NOISE, compatible, has_started_again, is_damaged, refusal, silent};
use crate::sent::ATTEMPTS;
use crate::starts::Starts;
use crate::watch::{is_disarmed, is_enabled};

/// Bytes of a read at most: fewer than a system keeps for a serial port, so that a read that has fewer has left none.
const READ: usize = 1024;
/// Bytes that come in a row from a board that is understood at most: more than a system keeps for a connection.
const MOST_BEHIND: usize = 1 << 24;

/// A connected board. After [`Board::disarm_at_the_end`] a drop disarms the board.
pub(crate) struct Board {
    port: Port,
    parser: Parser,
    messages: VecDeque<Message>,
    /// Bytes that were read since a read has left nothing that had come.
    behind: usize,
    /// Begin of the latest read.
    read_at: Option<Instant>,
    asked: Questions,
    starts: Starts,
    /// Number of starts at the first change, which a later start loses.
    changed: Option<u32>,
    /// Longest wait for an answer, and longest silence.
    patience: Duration,
    /// Whether the end has to disarm.
    disarms: bool,
    /// Where lines for the person go; `None` is the terminal.
    listener: Option<Listener>,
}

/// What takes lines for the person in place of the terminal.
pub(crate) type Listener = Box<dyn FnMut(String)>;

/// The answer to the command `identify`.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Answer {
    /// Identity of the image.
    pub(crate) hello: Hello,
    /// Commands that were rejected so far; `None` from a board of another protocol.
    pub(crate) rejected: Option<Rejected>,
}

impl Board {
    /// The board at a port. Nothing has been sent.
    pub(crate) fn new(port: Port, patience: Duration) -> Self {
        Self {
            port,
            parser: Parser::default(),
            messages: VecDeque::new(),
            behind: 0,
            read_at: None,
            asked: Questions::new(patience),
            starts: Starts::default(),
            changed: None,
            patience,
            disarms: false,
            listener: None,
        }
    }

    /// From now on lines for the person go to a listener.
    pub(crate) fn speak_to(&mut self, listener: Listener) {
        self.listener = Some(listener);
    }

    /// Tells the person a result: a line of standard output.
    ///
    /// # Errors
    /// [`Failure`] if standard output takes none, also where its reader is gone: no motor moves on for
    /// results that nobody sees.
    pub(crate) fn print(&mut self, line: &str) -> Result<(), Failure> {
        if let Some(listener) = &mut self.listener {
            listener(line.to_owned());
            return Ok(());
        }
        match print_to_reader(format!("{line}\n").as_bytes())? {
            true => Ok(()),
            false => Err(Failure::Input(
                "nobody reads the lines any more: the procedure ends before its last check"
                    .to_owned(),
            )),
        }
    }

    /// Tells the person what to do or what has happened: a note beside the results.
    pub(crate) fn note(&mut self, text: impl Display) {
        match &mut self.listener {
            Some(listener) => listener(text.to_string()),
            None => note(text),
        }
    }

    /// Longest wait for an answer, and longest silence.
    pub(crate) const fn patience(&self) -> Duration {
        self.patience
    }

    /// Number of the questions whose answers may still come.
    pub(crate) fn asked(&mut self) -> u32 {
        self.asked.number(Instant::now())
    }

    /// Sends a command.
    ///
    /// # Errors
    /// [`Failure::Input`] if the connection is lost.
    pub(crate) fn send(&mut self, command: Command) -> Result<(), Failure> {
        if command == Command::Identify {
            self.asked.ask(Instant::now());
        }
        let sent = self.port.write(&encode(command));
        sent.map_err(|error| self.lost(&error))
    }

    /// The next message; `None` if none comes until then.
    ///
    /// # Errors
    /// [`Failure::Input`] if the connection is lost.
    pub(crate) fn next(&mut self, until: Instant) -> Result<Option<Message>, Failure> {
        loop {
            if let Some(message) = self.messages.pop_front() {
                match &message {
                    Message::Hello(_) => self.asked.answer(),
                    Message::Frame(frame) => self.starts.frame(frame),
                    _ => {}
                }
                return Ok(Some(message));
            }
            let mut bytes = [0; READ];
            self.read_at = Some(Instant::now());
            let read = self.port.read(&mut bytes);
            let count = read.map_err(|error| self.lost(&error))?;
            self.behind = match count < READ {
                true => 0,
                false => self.behind.saturating_add(count),
            };
            for byte in &bytes[..count] {
                let messages = &mut self.messages;
                self.parser
                    .take(*byte, |message| messages.push_back(message));
            }
            if self.messages.is_empty() && Instant::now() >= until {
                return Ok(None);
            }
        }
    }

    /// Sends a command again and again until `answer` takes a message; `None` if it takes none in
    /// time.
    ///
    /// # Errors
    /// [`Failure::Input`] if the connection is lost.
    pub(crate) fn ask<T>(
        &mut self,
        command: Command,
        mut answer: impl FnMut(Message) -> Option<T>,
    ) -> Result<Option<T>, Failure> {
        let mut again = Instant::now();
        let end = again + self.patience;
        while !self.is_over(end) {
            let now = Instant::now();
            if now >= again && now < end {
                self.send(command)?;
                again = now + AGAIN;
            }
            let message = self.next(end.min(again))?;
            if let Some(answer) = message.and_then(&mut answer) {
                return Ok(Some(answer));
            }
        }
        Ok(None)
    }

    /// Whether a wait until `end` is over. After a standstill of this process what has come by then counts, unless the
    /// other end sends faster than it is read.
    pub(crate) fn is_over(&self, end: Instant) -> bool {
        let has_looked = self.read_at.is_some_and(|at| at >= end);
        let has_read = self.behind == 0 && self.messages.is_empty();
        has_looked && (has_read || self.behind > MOST_BEHIND)
    }

    /// The identity of the board. Commands that were sent before have been processed by then.
    ///
    /// # Errors
    /// [`Failure::Input`] if the board does not answer.
    pub(crate) fn identify(&mut self) -> Result<Answer, Failure> {
        let mut identity: Option<Hello> = None;
        // Answers to questions from before those commands come first. If one is lost, the question is
        // asked again.
        let mut older = self.asked();
        let answer = self.ask(Command::Identify, |message| {
            match message {
                Message::Hello(_) if older > 0 => older -= 1,
                Message::Hello(hello) => identity = Some(hello),
                Message::Rejected(rejected) => {
                    return Some(Answer {
                        hello: identity?,
                        rejected: Some(rejected),
                    });
                }
                _ => {}
            }
            // The counts of another protocol may differ.
            let hello = identity.filter(|hello| hello.protocol != PROTOCOL)?;
            Some(Answer {
                hello,
                rejected: None,
            })
        })?;
        answer.ok_or_else(|| self.silent())
    }

    /// The identity of a board that speaks the protocol of this tool.
    ///
    /// # Errors
    /// [`Failure::Input`] if the board speaks another protocol or does not answer.
    pub(crate) fn compatible(&mut self) -> Result<Answer, Failure> {
        let answer = self.identify()?;
        compatible(self.port.name(), &answer.hello)?;
        Ok(answer)
    }

    /// Sends a command and checks that the board takes it. `what` names the command in the message. A command beside
    /// which bytes came that are no command is sent again: it may have been damaged.
    ///
    /// # Errors
    /// [`Failure::Check`] if the board refuses it, if such bytes come each time, or if the board starts again;
    /// [`Failure::Input`] if it does not answer.
    pub(crate) fn change(&mut self, command: Command, what: &str) -> Result<(), Failure> {
        let scene = match command {
            Command::Tune { scene, .. } => SceneKind::ALL.get(usize::from(scene)).copied(),
            _ => None,
        };
        self.changed.get_or_insert(self.starts.number);
        let mut before = self.identify()?.rejected;
        for _ in 0..ATTEMPTS {
            self.send(command)?;
            let after = self.identify()?.rejected;
            let Some((earlier, now)) = before.zip(after) else {
                return Ok(());
            };
            if let Some(reason) = refusal(&earlier, &now) {
                return Err(Failure::Check(format!(
                    "{what}: the board refuses it: {}",
                    explained(reason, scene)
                )));
            }
            if has_started_again(&earlier, &now) || self.has_lost_a_change() {
                return Err(Failure::Check(format!(
                    "{what}: the board has started again; find the cause of the reset, then run the command again"
                )));
            }
            if !is_damaged(&earlier, &now) {
                return Ok(());
            }
            before = after;
        }
        Err(Failure::Check(format!(
            "{what}: sent {ATTEMPTS} times, and not certain: each time bytes that are no command reached the \
             board; {NOISE}"
        )))
    }

    /// Whether the board has started again since the first change, which it has lost then.
    pub(crate) fn has_lost_a_change(&self) -> bool {
        self.changed.is_some_and(|at| at != self.starts.number)
    }

    /// The first frame that is as wanted.
    ///
    /// # Errors
    /// [`Failure::Check`] with `failed` of the last frame, [`Failure::Input`] if no frame comes.
    pub(crate) fn wait(
        &mut self,
        rate_hz: u32,
        wanted: impl Fn(&Frame) -> bool,
        failed: impl Fn(&Frame) -> String,
    ) -> Result<Frame, Failure> {
        let mut heard = Instant::now();
        let mut limit = Limit::new(self.patience, rate_hz, heard);
        loop {
            let end = heard + self.patience;
            let message = self.next(end)?;
            if let Some(Message::Frame(frame)) = message {
                if wanted(&frame) {
                    return Ok(frame);
                }
                heard = Instant::now();
                if limit.is_over(heard, frame.tick) {
                    return Err(Failure::Check(failed(&frame)));
                }
            } else if self.is_over(end) {
                return Err(self.silent());
            }
        }
    }

    /// From now on the end of the connection disarms the board, if [`Board::disarm`] has not.
    pub(crate) fn disarm_at_the_end(&mut self) {
        self.disarms = true;
    }

    /// Disarms the board and waits until a frame shows it. A frame that has a cause may be from before the command.
    ///
    /// # Errors
    /// [`Failure::Check`] if the amplifiers stay enabled, [`Failure::Input`] if no frame comes.
    pub(crate) fn disarm(&mut self) -> Result<Frame, Failure> {
        self.disarms = true;
        let mut last = None;
        let disarm = Command::Request(Request::Disarm);
        let shown = self.ask(disarm, |message| match message {
            Message::Frame(frame) => {
                last = Some(frame);
                is_disarmed(&frame).then_some(frame)
            }
            _ => None,
        })?;
        match shown.or(last) {
            Some(frame) if is_enabled(&frame) => Err(Failure::Check(format!(
                "{}: the amplifiers stay enabled after disarm; switch off their supply",
                self.port.name()
            ))),
            Some(frame) => {
                self.disarms = false;
                Ok(frame)
            }
            None => Err(self.silent()),
        }
    }

    /// The failure of a board that sends nothing that is understood.
    pub(crate) fn silent(&self) -> Failure {
        Failure::Input(silent(self.port.name(), &self.parser))
    }

    fn lost(&self, error: &io::Error) -> Failure {
        // Another program may keep the scene alive.
        let end = match self.disarms && !self.port.is_taken() {
            true => "; the board ends the scene by itself when no command comes",
            false => "",
        };
        Failure::Input(self.port.lost(error) + end)
    }
}

impl Drop for Board {
    fn drop(&mut self) {
        if self.disarms {
            // A lost connection cannot be told again.
            let _ = self.send(Command::Request(Request::Disarm));
            self.port.finish();
        }
    }
}

#[cfg(test)]
pub(crate) mod tests;
