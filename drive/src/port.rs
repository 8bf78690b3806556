//! Ports: a serial port, a TCP connection to an emulated board or a debug server, or a pipe to another thread.

mod serial;

use std::collections::VecDeque;
use std::io::{self, ErrorKind, Read as _, Write as _};
use std::net::{Shutdown, TcpStream, ToSocketAddrs};
use std::path::PathBuf;
use std::sync::mpsc::{Receiver, RecvTimeoutError, Sender, channel};
use std::time::{Duration, Instant};

use serial2::SerialPort;
use terminal::failure::Failure;

/// Longest time of one read. The tool looks at the clock and at interrupts in between.
const READ: Duration = Duration::from_millis(10);
/// Longest time of one write.
const WRITE: Duration = Duration::from_secs(1);
/// Longest time for a TCP connection.
const CONNECT: Duration = Duration::from_secs(2);
/// Longest time that the other end of a TCP connection gets to take the last bytes.
const LINGER: Duration = Duration::from_millis(300);
/// Begin of the name of a TCP port.
pub const TCP: &str = "tcp:";
/// What the server of a board sends to a client while it serves another one, before it closes the connection.
pub const TAKEN: &[u8] = b"the board has a client already; one client at a time\n";

/// An open port.
pub struct Port {
    name: String,
    channel: Channel,
    /// The first bytes that were read, as many as [`TAKEN`] has.
    begin: Vec<u8>,
}

enum Channel {
    Serial(SerialPort),
    Tcp(TcpStream),
    Pipe {
        from: Receiver<Vec<u8>>,
        to: Sender<Vec<u8>>,
        /// Bytes that have come and were not read.
        rest: VecDeque<u8>,
    },
}

/// The other end of a pipe. When it is dropped, the connection is lost.
pub struct PipeEnd {
    /// Takes what the port reads.
    pub to: Sender<Vec<u8>>,
    /// Has what the port wrote.
    pub from: Receiver<Vec<u8>>,
}

/// The serial ports of this machine.
///
/// # Errors
/// [`Failure::Input`] if the system does not tell them.
pub(crate) fn list() -> Result<Vec<PathBuf>, Failure> {
    let mut ports = SerialPort::available_ports()
        .map_err(|error| Failure::Input(format!("serial ports: {error}; name one with --port")))?;
    ports.sort();
    Ok(ports)
}

impl Port {
    /// Opens the port of this name, by default the only serial port.
    ///
    /// # Errors
    /// [`Failure::Input`] if it cannot be opened, or if there is no default.
    pub fn open(name: Option<&str>) -> Result<Self, Failure> {
        let name = match name {
            Some(name) => name.to_owned(),
            None => only(&list()?)?,
        };
        if name.is_empty() {
            return Err(Failure::Input(
                "the name of the port is empty; give a serial port, or tcp:HOST:PORT".to_owned(),
            ));
        }
        let opened = match name.strip_prefix(TCP) {
            Some(address) => connect(address).map(Channel::Tcp),
            None => serial::open(&name).map(Channel::Serial),
        };
        match opened {
            Ok(channel) => Ok(Self {
                name,
                channel,
                begin: Vec::new(),
            }),
            Err(error) => Err(Failure::Input(unopened(&name, &error))),
        }
    }

    /// A port to another thread, which has the other end.
    #[must_use]
    pub fn pipe(name: &str) -> (Self, PipeEnd) {
        let ((to, theirs), (ours, from)) = (channel(), channel());
        let port = Self {
            name: name.to_owned(),
            channel: Channel::Pipe {
                from,
                to,
                rest: VecDeque::new(),
            },
            begin: Vec::new(),
        };
        let end = PipeEnd {
            to: ours,
            from: theirs,
        };
        (port, end)
    }

    /// Name for messages.
    #[must_use]
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Reads what has arrived, and waits a short time for it; 0 if nothing has.
    ///
    /// # Errors
    /// An error if the connection is lost.
    pub fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        let read = match &mut self.channel {
            Channel::Serial(port) => port.read(buffer),
            Channel::Tcp(stream) => stream.read(buffer),
            Channel::Pipe { from, rest, .. } => {
                if rest.is_empty() {
                    match from.recv_timeout(READ) {
                        Ok(bytes) => rest.extend(bytes),
                        Err(RecvTimeoutError::Timeout) => return Ok(0),
                        Err(RecvTimeoutError::Disconnected) => {}
                    }
                }
                // As much as there is: a reader takes fewer bytes for the end of what has come.
                while rest.len() < buffer.len()
                    && let Ok(bytes) = from.try_recv()
                {
                    rest.extend(bytes);
                }
                rest.read(buffer)
            }
        };
        match read {
            Ok(0) => Err(ErrorKind::UnexpectedEof.into()),
            Ok(count) => {
                let lacks = TAKEN.len() - self.begin.len();
                self.begin.extend(&buffer[..count.min(lacks)]);
                Ok(count)
            }
            Err(error) if is_silence(&error) => Ok(0),
            other => other,
        }
    }

    /// Whether the server of the board has told that it serves another client.
    #[must_use]
    pub fn is_taken(&self) -> bool {
        self.begin == TAKEN
    }

    /// The message about an error of this connection.
    #[must_use]
    pub fn lost(&self, error: &io::Error) -> String {
        let name = &self.name;
        match self.is_taken() {
            true => taken(name),
            false => format!(
                "{name}: connection lost: {error}; check cable and power, then run the command again"
            ),
        }
    }

    /// Writes all bytes.
    ///
    /// # Errors
    /// An error if the connection is lost or takes no bytes.
    pub fn write(&mut self, bytes: &[u8]) -> io::Result<()> {
        match &mut self.channel {
            Channel::Serial(port) => port.write_all(bytes),
            Channel::Tcp(stream) => stream.write_all(bytes),
            Channel::Pipe { to, .. } => {
                let sent = to.send(bytes.to_vec());
                sent.map_err(|_| ErrorKind::BrokenPipe.into())
            }
        }
    }

    /// Waits until the written bytes have left. A TCP connection that is closed while bytes wait to be
    /// read may discard what was written, so that they are read first.
    pub fn finish(&mut self) {
        match &mut self.channel {
            Channel::Serial(port) => drop(port.flush()),
            Channel::Pipe { .. } => {}
            Channel::Tcp(stream) => {
                let _ = stream.shutdown(Shutdown::Write);
                let end = Instant::now() + LINGER;
                let mut rest = [0; 4096];
                while Instant::now() < end {
                    match stream.read(&mut rest) {
                        Ok(0) => break,
                        Err(error) if !is_silence(&error) => break,
                        _ => {}
                    }
                }
            }
        }
    }
}

/// The default port.
fn only(ports: &[PathBuf]) -> Result<String, Failure> {
    let names: Vec<_> = ports.iter().map(|port| port.to_string_lossy()).collect();
    match &names[..] {
        [one] => Ok(one.to_string()),
        [] => Err(Failure::Input(
            "no serial port; connect the board, or give --port tcp:HOST:PORT".to_owned(),
        )),
        _ => Err(Failure::Input(format!(
            "more than one serial port; give --port with one of {}",
            names.join(", ")
        ))),
    }
}

/// The message about a port that another program has.
fn taken(name: &str) -> String {
    format!("{name}: another program has this port; end it first")
}

/// The message about a port that cannot be opened.
fn unopened(name: &str, error: &io::Error) -> String {
    let remedy = match error.kind() {
        ErrorKind::ResourceBusy => return taken(name),
        _ if name.starts_with("tcp://") => "write tcp:HOST:PORT, without slashes",
        _ if name.starts_with(TCP) => "start the board's server first, or give tcp:HOST:PORT",
        ErrorKind::PermissionDenied => {
            "add the user to the group of the port (dialout) and log in again"
        }
        _ if name.to_ascii_lowercase().starts_with(TCP) => "write tcp: in small letters",
        _ if is_address(name) => "for a TCP port, write tcp: before the address",
        _ => "cargo drive list shows the ports",
    };
    format!("{name}: cannot open: {error}; {remedy}")
}

/// Whether a name looks like `HOST:PORT`.
fn is_address(name: &str) -> bool {
    let number = name.rsplit_once(':').map(|(_, port)| port.parse::<u16>());
    number.is_some_and(|number| number.is_ok())
}

fn is_silence(error: &io::Error) -> bool {
    let kinds = [
        ErrorKind::TimedOut,
        ErrorKind::WouldBlock,
        ErrorKind::Interrupted,
    ];
    kinds.contains(&error.kind())
}

/// Connects to the first of the addresses of a name that has a server.
fn connect(name: impl ToSocketAddrs) -> io::Result<TcpStream> {
    let mut failed = ErrorKind::AddrNotAvailable.into();
    for address in name.to_socket_addrs()? {
        match TcpStream::connect_timeout(&address, CONNECT) {
            Ok(stream) => {
                stream.set_nodelay(true)?;
                stream.set_read_timeout(Some(READ))?;
                stream.set_write_timeout(Some(WRITE))?;
                return Ok(stream);
            }
            Err(error) => failed = error,
        }
    }
    Err(failed)
}

#[cfg(test)]
mod tests {
    use std::net::TcpListener;

    use super::*;

    #[test]
    fn address_is_told_from_the_name_of_a_serial_port() {
        for name in ["127.0.0.1:36907", "localhost:9090", "[::1]:80"] {
            assert!(is_address(name), "{name}");
        }
        for name in ["/dev/ttyACM0", "COM3", "tcp", "usb:x"] {
            assert!(!is_address(name), "{name}");
        }
    }

    #[test]
    fn name_that_is_almost_right_has_its_remedy() {
        for (name, said) in [
            (
                "",
                "the name of the port is empty; give a serial port, or tcp:HOST:PORT",
            ),
            (
                "tcp://127.0.0.1:1",
                "; write tcp:HOST:PORT, without slashes",
            ),
            ("TCP:127.0.0.1:1", "; write tcp: in small letters"),
            (
                "127.0.0.1:1",
                "; for a TCP port, write tcp: before the address",
            ),
            ("nope", "; cargo drive list shows the ports"),
        ] {
            let Err(error) = Port::open(Some(name)) else {
                panic!("{name} is open");
            };
            assert!(error.to_string().ends_with(said), "{error}");
            assert_eq!(error.status(), 2);
        }
    }

    #[test]
    fn port_that_the_system_refuses_has_its_remedy() {
        let said = |kind: ErrorKind| unopened("/dev/ttyACM0", &kind.into());
        let denied = said(ErrorKind::PermissionDenied);
        assert!(
            denied.ends_with("add the user to the group of the port (dialout) and log in again")
        );
        assert!(said(ErrorKind::NotFound).ends_with("cargo drive list shows the ports"));
    }

    /// A signal interrupts a read.
    #[test]
    fn nothing_that_came_and_a_signal_are_no_lost_connection() {
        let is_silent = |kind: ErrorKind| is_silence(&kind.into());
        for kind in [
            ErrorKind::TimedOut,
            ErrorKind::WouldBlock,
            ErrorKind::Interrupted,
        ] {
            assert!(is_silent(kind), "{kind}");
        }
        assert!(!is_silent(ErrorKind::ConnectionReset) && !is_silent(ErrorKind::BrokenPipe));
    }

    /// The name localhost may be that of an address without a server too.
    #[test]
    fn connection_is_to_the_address_that_has_a_server() {
        let listener = TcpListener::bind("127.0.0.1:0").unwrap();
        let closed = "127.0.0.1:1".parse().unwrap();
        let addresses = [closed, listener.local_addr().unwrap()];
        let stream = connect(&addresses[..]).unwrap();
        assert_eq!(stream.peer_addr().unwrap(), addresses[1]);
        assert!(connect(&addresses[..1]).is_err());
    }

    #[test]
    fn port_of_another_program_is_told_from_parts_of_a_line() {
        let (mut port, end) = Port::pipe("board");
        let (begin, rest) = TAKEN.split_at(10);
        for part in [begin, rest, b"more"] {
            end.to.send(part.to_vec()).unwrap();
            port.read(&mut [0; 100]).unwrap();
            assert_eq!(port.is_taken(), part != begin);
        }
    }

    #[test]
    fn only_port_is_the_default() {
        assert_eq!(only(&["/dev/ttyACM0".into()]).unwrap(), "/dev/ttyACM0");
        let two = only(&["/dev/ttyACM0".into(), "/dev/ttyUSB1".into()]).unwrap_err();
        assert!(two.to_string().contains("/dev/ttyACM0, /dev/ttyUSB1"));
        assert!(
            only(&[])
                .unwrap_err()
                .to_string()
                .contains("connect the board")
        );
    }
}
