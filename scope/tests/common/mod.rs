//! A server as a process, and a client of its socket.

// Each test program uses a part.
#![allow(dead_code)]

pub(crate) mod devtools;
pub(crate) mod page;

use std::io::{BufRead as _, BufReader, Read as _, Write as _};
use std::net::TcpStream;
use std::path::PathBuf;
use std::process::{Child, Command, Stdio};
use std::sync::OnceLock;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::{Duration, Instant};

use haptic_control::Stop;
use serde_json::{Value, json};
use tungstenite::client::IntoClientRequest as _;
use tungstenite::{Message, WebSocket};
use virtual_board::image::Image;

/// Longest wait for a condition. The board's time decides, so that a slow machine, or one on which several
/// boards run, only takes longer.
pub(crate) const LIMIT: Duration = Duration::from_secs(300);

/// Attempts of a guided procedure.
pub(crate) const ATTEMPTS: usize = 4;

/// Whether a procedure failed because this machine stood still for seconds: the page was not heard, or the
/// board not commanded.
pub(crate) fn is_stalled(failure: &Value) -> bool {
    let failure = failure.to_string();
    let words = ["ended by the page", "the page was not heard"];
    words.iter().any(|words| failure.contains(words))
        || failure.contains(Stop::CommandTimeout.as_str())
}

/// A file of its own for this process in the folder of the build.
pub(crate) fn scratch(name: &str) -> PathBuf {
    let folder = PathBuf::from(env!("CARGO_TARGET_TMPDIR"));
    folder.join(format!("{}-{name}", std::process::id()))
}

/// The flash image, built once.
pub(crate) fn image() -> PathBuf {
    static IMAGE: OnceLock<PathBuf> = OnceLock::new();
    let path = IMAGE.get_or_init(|| {
        let image = Image::build("").expect("the firmware builds");
        let path = scratch("image.elf");
        std::fs::write(&path, image.elf()).expect("a file in the folder of the build");
        path
    });
    path.clone()
}

/// Servers that were started.
static STARTED: AtomicUsize = AtomicUsize::new(0);

/// A server.
pub(crate) struct Server {
    pub(crate) child: Child,
    pub(crate) port: u16,
    pub(crate) token: String,
    /// Its current folder.
    pub(crate) folder: PathBuf,
}

impl Server {
    /// A server with these arguments.
    pub(crate) fn start(arguments: &[&str]) -> Self {
        let number = STARTED.fetch_add(1, Ordering::Relaxed);
        let folder = scratch(&format!("folder-{number}"));
        let _ = std::fs::remove_dir_all(&folder);
        std::fs::create_dir_all(&folder).expect("a folder");
        let mut command = Command::new(env!("CARGO_BIN_EXE_scope"));
        command
            .current_dir(&folder)
            .arg("--no-open")
            .args(arguments)
            .stdout(Stdio::piped());
        let mut child = command.spawn().expect("the server starts");
        let mut line = String::new();
        let out = child.stdout.take().expect("a pipe");
        BufReader::new(out).read_line(&mut line).expect("a line");
        let port = line
            .trim()
            .trim_end_matches('/')
            .rsplit(':')
            .next()
            .unwrap_or_default();
        let port = port
            .parse()
            .unwrap_or_else(|_| panic!("no address: {line}"));
        let page = get(port, "/", &[]).1;
        let token = page
            .split("name=\"token\" content=\"")
            .nth(1)
            .expect("a token");
        let token = token.split('"').next().expect("a token").to_owned();
        Self {
            child,
            port,
            token,
            folder,
        }
    }

    /// A server of the virtual board.
    pub(crate) fn emulated() -> Self {
        Self::start(&["--image", image().to_str().expect("a path in UTF-8")])
    }

    /// Interrupts the server as Ctrl-C does, and waits for its end; whether its status is 0.
    pub(crate) fn interrupt(&mut self) -> bool {
        let id = self.child.id().to_string();
        let sent = Command::new("kill").args(["-INT", &id]).status();
        assert!(sent.expect("kill").success());
        self.child.wait().expect("an end").success()
    }

    pub(crate) fn url(&self) -> String {
        format!("http://127.0.0.1:{}/", self.port)
    }

    pub(crate) fn client(&self) -> Client {
        Client::connect(self.port, &format!("http://127.0.0.1:{}", self.port)).expect("a socket")
    }

    /// A client that has joined with the token.
    pub(crate) fn joined(&self) -> Client {
        let mut client = self.client();
        client.order(&json!({"do": "join", "token": self.token}));
        client
    }
}

impl Drop for Server {
    fn drop(&mut self) {
        let _ = self.child.kill();
        let _ = self.child.wait();
        let _ = std::fs::remove_dir_all(&self.folder);
    }
}

/// The status and the body of an answer.
pub(crate) fn get(port: u16, path: &str, headers: &[(&str, &str)]) -> (u16, String) {
    request("GET", port, path, headers)
}

/// The status and the body of an answer to a request with this method.
pub(crate) fn request(
    method: &str,
    port: u16,
    path: &str,
    headers: &[(&str, &str)],
) -> (u16, String) {
    let mut stream = TcpStream::connect(("127.0.0.1", port)).expect("a connection");
    let mut request = format!("{method} {path} HTTP/1.1\r\nConnection: close\r\n");
    if !headers.iter().any(|(name, _)| *name == "Host") {
        request += &format!("Host: 127.0.0.1:{port}\r\n");
    }
    for (name, value) in headers {
        request += &format!("{name}: {value}\r\n");
    }
    request += "\r\n";
    stream.write_all(request.as_bytes()).expect("a request");
    let mut answer = Vec::new();
    stream.read_to_end(&mut answer).expect("an answer");
    let answer = String::from_utf8_lossy(&answer).into_owned();
    let status = answer
        .split(' ')
        .nth(1)
        .and_then(|status| status.parse().ok());
    (status.expect("a status"), answer)
}

/// Whether nothing has come in a read.
fn is_pause(error: &std::io::Error) -> bool {
    use std::io::ErrorKind::{Interrupted, TimedOut, WouldBlock};
    matches!(error.kind(), WouldBlock | TimedOut | Interrupted)
}

/// A socket of the server.
pub(crate) struct Client {
    pub(crate) socket: WebSocket<TcpStream>,
    /// Whether the client says that it lives while it waits.
    pub(crate) lives: bool,
    alive: Instant,
    pub(crate) rows: u64,
    /// Number of the row after the last one, and rows that did not come.
    next: Option<f64>,
    pub(crate) lost: f64,
    /// The last row.
    pub(crate) row: Vec<f64>,
    pub(crate) facts: Value,
}

impl Client {
    pub(crate) fn connect(port: u16, origin: &str) -> Result<Self, String> {
        let mut request = format!("ws://127.0.0.1:{port}/ws")
            .into_client_request()
            .map_err(|e| e.to_string())?;
        if !origin.is_empty() {
            request
                .headers_mut()
                .insert("Origin", origin.parse().map_err(|_| "origin")?);
        }
        let stream = TcpStream::connect(("127.0.0.1", port)).map_err(|e| e.to_string())?;
        let (socket, _) = tungstenite::client(request, stream).map_err(|e| e.to_string())?;
        socket
            .get_ref()
            .set_read_timeout(Some(Duration::from_millis(50)))
            .map_err(|e| e.to_string())?;
        Ok(Self {
            socket,
            lives: false,
            alive: Instant::now(),
            rows: 0,
            next: None,
            lost: 0.0,
            row: Vec::new(),
            facts: Value::Null,
        })
    }

    pub(crate) fn order(&mut self, order: &Value) {
        let mut fields = order.as_object().expect("an order").clone();
        let name = fields.remove("do").expect("a name");
        let name = name.as_str().expect("a name");
        let order = if fields.is_empty() {
            json!(name)
        } else {
            json!({ name: fields })
        };
        self.text(&order.to_string());
    }

    pub(crate) fn text(&mut self, text: &str) {
        self.socket
            .send(Message::text(text))
            .expect("the server reads");
    }

    /// Says that the client lives, if that is due. A test that does something else for long calls this in between: a
    /// machine may be slow.
    pub(crate) fn live(&mut self) {
        if self.lives && self.alive.elapsed() > Duration::from_millis(50) {
            self.alive = Instant::now();
            self.order(&json!({"do": "alive"}));
        }
    }

    /// The next message in JSON, if one has come.
    pub(crate) fn next(&mut self) -> Option<Value> {
        self.live();
        match self.socket.read() {
            Ok(Message::Text(text)) => {
                let value: Value = serde_json::from_str(&text).expect("JSON");
                if value["type"] == "facts" {
                    self.facts = value.clone();
                }
                Some(value)
            }
            Ok(Message::Binary(bytes)) => {
                self.take(&bytes);
                None
            }
            Ok(_) => None,
            Err(tungstenite::Error::Io(error)) if is_pause(&error) => None,
            Err(error) => panic!("the socket ended: {error}"),
        }
    }

    /// Waits until the server has ended the socket, while another client lives.
    pub(crate) fn wait_for_the_end(&mut self, other: &mut Self) {
        let end = Instant::now() + LIMIT;
        while Instant::now() < end {
            other.live();
            match self.socket.read() {
                Ok(_) => {}
                Err(tungstenite::Error::Io(error)) if is_pause(&error) => {}
                Err(_) => return,
            }
        }
        panic!("the server did not end the socket within {LIMIT:?}");
    }

    fn take(&mut self, bytes: &[u8]) {
        let rows = u32::from_le_bytes(bytes[..4].try_into().expect("4 bytes"));
        let first = f64::from_le_bytes(bytes[8..16].try_into().expect("8 bytes"));
        self.lost += self.next.map_or(0.0, |next| first - next);
        self.next = Some(first + f64::from(rows));
        self.rows += u64::from(rows);
        let (values, _) = bytes[16..].as_chunks::<8>();
        let values: Vec<f64> = values
            .iter()
            .map(|value| f64::from_le_bytes(*value))
            .collect();
        self.row = values[values.len() - values.len() / rows as usize..].to_vec();
    }

    /// The value of a channel in the last row.
    pub(crate) fn value(&self, channel: &str) -> f64 {
        let channels = self.facts["channels"].as_array().expect("channels");
        let at = channels
            .iter()
            .position(|each| each["name"] == channel)
            .expect("a channel");
        self.row.get(at).copied().unwrap_or(f64::NAN)
    }

    /// Waits for a message that `wanted` takes.
    pub(crate) fn wait<T>(
        &mut self,
        what: &str,
        mut wanted: impl FnMut(&mut Self, &Value) -> Option<T>,
    ) -> T {
        let end = Instant::now() + LIMIT;
        let mut last = Value::Null;
        while Instant::now() < end {
            let Some(message) = self.next() else {
                continue;
            };
            if let Some(found) = wanted(self, &message) {
                return found;
            }
            if message["type"] == "status" {
                last = message;
            }
        }
        panic!("{what}: did not come within {LIMIT:?}; last status: {last}");
    }

    /// Waits for a status that is as wanted.
    pub(crate) fn status(&mut self, what: &str, wanted: impl Fn(&Value) -> bool) -> Value {
        self.wait(what, |_, message| {
            (message["type"] == "status" && wanted(message)).then(|| message.clone())
        })
    }

    /// Waits for a role.
    pub(crate) fn role(&mut self) -> Value {
        self.wait("a role", |_, message| {
            (message["type"] == "role").then(|| message.clone())
        })
    }
}
