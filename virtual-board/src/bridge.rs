//! The serial port of the emulated board over TCP, in real time.

use std::collections::VecDeque;
use std::io::{ErrorKind, Read, Write};
use std::net::{Ipv4Addr, Shutdown, SocketAddr, TcpListener, TcpStream};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use drive::port::TAKEN;
use terminal::failure::Failure;
use terminal::output::note;

use crate::flash::Sectors;
use crate::image::Image;
use crate::live::Live;
use crate::objections;
use crate::port::Wire;
use crate::run::{Setup, emulate};

/// Bytes that one look takes from the client at most.
const CHUNK: usize = 4096;
/// Bytes on their way to the board while which no more are taken from the client: TCP holds them back.
pub const WAITING: usize = 256;
/// Virtual time from which on the run is in real time. The emulator translates the image's code before.
const STARTED: Duration = Duration::from_millis(100);
/// Largest lag that is made up for. After a larger one the board does not run faster than real time, for which its client
/// would be too slow.
const MADE_UP: Duration = Duration::from_millis(20);
/// Lag behind real time from which on it is told, s; then each time that it has doubled.
pub(crate) const LAG_S: f64 = 0.05;

/// A TCP port of this machine that is to be the serial port of an emulated board. One client is served
/// at a time, and one after the other.
#[derive(Debug)]
pub struct Bridge {
    listener: TcpListener,
    address: SocketAddr,
}

/// How a run in real time kept up.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Pace {
    /// Virtual time, s.
    pub seconds: f64,
    /// Largest lag of virtual time behind real time, s.
    pub lag_s: f64,
}

impl Bridge {
    /// Listens on this port of the loopback interface; 0 takes a free one.
    ///
    /// # Errors
    /// One line if the port cannot be had.
    pub fn bind(port: u16) -> Result<Self, String> {
        let failed = |error| format!("--link {port}: {error}; give a free port, or 0 for any");
        let listener = TcpListener::bind((Ipv4Addr::LOCALHOST, port)).map_err(failed)?;
        listener.set_nonblocking(true).map_err(failed)?;
        let address = listener.local_addr().map_err(failed)?;
        Ok(Self { listener, address })
    }

    /// Where a client connects to.
    #[must_use]
    pub fn address(&self) -> SocketAddr {
        self.address
    }

    /// Runs `image` with the port bridged, in real time, until the end of the setup or until `stop`.
    /// Only the last state is kept, so that a run may be long. A computer that is too slow makes the
    /// run slower; nothing is left out. Returns the content of the flash at the end too.
    ///
    /// # Errors
    /// As [`on_board`](crate::run::on_board) and [`Outcome::check`](crate::run::Outcome::check).
    pub fn run(
        self,
        image: &Image,
        setup: &Setup,
        stop: Arc<AtomicBool>,
    ) -> Result<(Pace, Sectors), Failure> {
        let served = Live::Bridge(Served::new(self.listener, stop));
        let (session, lockstep, _) = emulate(image, setup, Some(served), |_| ())?;
        objections::verdict(&objections::of(&session))?;
        let pace = match lockstep.live {
            Some(Live::Bridge(served)) => served.pace,
            _ => Pace::default(),
        };
        Ok((pace, session.board().part.flash.sectors().clone()))
    }
}

/// The client's side of a run.
#[derive(Debug)]
pub(crate) struct Served {
    listener: TcpListener,
    client: Option<TcpStream>,
    /// Clients that have come and are neither served nor refused.
    waiting: VecDeque<TcpStream>,
    /// Clients that have been refused and have not gone.
    refused: Vec<TcpStream>,
    stop: Arc<AtomicBool>,
    /// Real time at which virtual time was [`STARTED`], with the lag that is not made up for.
    since: Option<Instant>,
    /// The lag that is not made up for.
    slow: Duration,
    /// Lag that was told last, s.
    told_s: f64,
    pub(crate) pace: Pace,
}

impl Served {
    fn new(listener: TcpListener, stop: Arc<AtomicBool>) -> Self {
        Self {
            listener,
            client: None,
            waiting: VecDeque::new(),
            refused: Vec::new(),
            stop,
            since: None,
            slow: Duration::ZERO,
            pace: Pace::default(),
            told_s: 0.5 * LAG_S,
        }
    }

    /// Passes bytes between client and board, and waits until real time is `now_ns` too; whether the
    /// run goes on.
    pub(crate) fn look(&mut self, wire: &mut Wire, now_ns: u64) -> bool {
        let sent: Vec<u8> = wire.up.drain(..).map(|(_, byte)| byte).collect();
        // Before the client is read: a client that came after the last one had closed finds its end read.
        while let Ok((stream, _)) = self.listener.accept() {
            self.waiting.push_back(stream);
        }
        let mut is_read = true;
        let keeps = self.client.as_mut().is_none_or(|client| {
            // All that has come, so that the end of a client is seen before the next client.
            loop {
                let room = WAITING.saturating_sub(wire.down.len());
                is_read = room > 0;
                let Some(bytes) = take(client, room.min(CHUNK)) else {
                    return false;
                };
                if bytes.is_empty() {
                    return give(client, &sent);
                }
                wire.down.extend(bytes.iter().map(|byte| (now_ns, *byte)));
            }
        });
        if !keeps {
            self.client = None;
        }
        if is_read {
            self.admit();
        }
        let virtual_time = Duration::from_nanos(now_ns);
        self.pace.seconds = virtual_time.as_secs_f64();
        if virtual_time < STARTED {
            return true;
        }
        let since = self.since.get_or_insert_with(Instant::now);
        let real = since.elapsed() + STARTED;
        if let Some(early) = virtual_time.checked_sub(real) {
            std::thread::sleep(early);
        } else {
            let late = real - virtual_time;
            let lag = (self.slow + late).as_secs_f64();
            if late > MADE_UP {
                *since += late;
                self.slow += late;
            }
            self.pace.lag_s = self.pace.lag_s.max(lag);
            if lag > 2.0 * self.told_s {
                self.told_s = lag;
                note(format_args!(
                    "the board is {lag:.3} s behind real time at {:.3} s: this computer is busy or too slow",
                    self.pace.seconds
                ));
            }
        }
        !self.stop.load(Ordering::Relaxed)
    }

    /// Takes the first client, and refuses others.
    fn admit(&mut self) {
        while let Some(mut stream) = self.waiting.pop_front() {
            if stream.set_nonblocking(true).is_err() {
                continue;
            }
            if self.client.is_none() {
                let _ = stream.set_nodelay(true);
                self.client = Some(stream);
            } else if stream.write_all(TAKEN).is_ok() && stream.shutdown(Shutdown::Write).is_ok() {
                self.refused.push(stream);
            }
        }
        // A connection that is closed with bytes unread takes the refusal back.
        self.refused
            .retain_mut(|stream| take(stream, CHUNK).is_some());
    }
}

/// The bytes that have come, at most so many; `None` if the client has gone.
fn take(client: &mut TcpStream, room: usize) -> Option<Vec<u8>> {
    let mut bytes = vec![0; room];
    if room == 0 {
        return Some(bytes);
    }
    match client.read(&mut bytes) {
        Ok(0) => None,
        Ok(length) => {
            bytes.truncate(length);
            Some(bytes)
        }
        Err(error) if is_later(&error) => Some(Vec::new()),
        Err(_) => None,
    }
}

/// Sends bytes; whether the client is there. What a client does not read is lost, as on a serial line.
fn give(client: &mut TcpStream, mut bytes: &[u8]) -> bool {
    while !bytes.is_empty() {
        match client.write(bytes) {
            Ok(0) => return false,
            Ok(length) => bytes = &bytes[length..],
            Err(error) => return is_later(&error),
        }
    }
    true
}

fn is_later(error: &std::io::Error) -> bool {
    matches!(error.kind(), ErrorKind::WouldBlock | ErrorKind::Interrupted)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A client that has gone is no reason to refuse the next one, even if both are seen at one look.
    #[test]
    fn next_client_is_served_at_the_look_that_sees_the_end_of_the_first() {
        let bridge = Bridge::bind(0).unwrap();
        let address = bridge.address();
        let mut live = Served::new(bridge.listener, Arc::default());
        let mut wire = Wire::default();
        let first = TcpStream::connect(address).unwrap();
        while live.client.is_none() {
            live.look(&mut wire, 0);
        }
        drop(first);
        let served = live.client.as_ref().unwrap();
        while served.peek(&mut [0]).is_err() {}
        let mut second = TcpStream::connect(address).unwrap();
        second.write_all(b"!").unwrap();
        while wire.down.is_empty() && live.refused.is_empty() {
            live.look(&mut wire, 0);
        }
        assert_eq!(wire.down, [(0, b'!')]);
    }

    /// A client that is too fast for the serial port waits: its bytes are neither lost nor stored here.
    #[test]
    fn bytes_that_the_board_has_not_taken_hold_back_the_client() {
        let bridge = Bridge::bind(0).unwrap();
        let mut client = TcpStream::connect(bridge.address()).unwrap();
        let mut live = Served::new(bridge.listener, Arc::default());
        let mut wire = Wire::default();
        let sent: Vec<u8> = (0..=255).cycle().take(4 * WAITING).collect();
        client.write_all(&sent).unwrap();
        let mut came = Vec::new();
        while came.len() < sent.len() {
            while wire.down.len() < WAITING {
                live.look(&mut wire, 0);
            }
            live.look(&mut wire, 0);
            assert_eq!(wire.down.len(), WAITING);
            came.extend(wire.down.drain(..).map(|(_, byte)| byte));
        }
        assert_eq!(came, sent);
    }

    /// A computer that is busy for some time leaves a board that is not too fast for its client afterwards.
    #[test]
    fn lag_is_not_made_up_for() {
        let bridge = Bridge::bind(0).unwrap();
        let mut live = Served::new(bridge.listener, Arc::default());
        let mut wire = Wire::default();
        let mut look = |ms: u64| live.look(&mut wire, ms * 1_000_000);
        let stall = Duration::from_millis(300);
        look(100);
        std::thread::sleep(stall);
        look(101);
        let begin = Instant::now();
        for ms in 102..=200 {
            look(ms);
        }
        // A slower computer takes longer.
        assert!(begin.elapsed() >= Duration::from_millis(99) - MADE_UP);
        assert!(live.pace.lag_s >= 0.299, "{}", live.pace.lag_s);
    }
}
