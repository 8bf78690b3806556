//! A headless Chromium, driven over the DevTools protocol.
//!
//! The client is a plain socket: the protocol is JSON over WebSocket, which the tests of the server need
//! anyway, and five commands of it do.

use std::net::TcpStream;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::{Duration, Instant};

use serde_json::{Value, json};
use tungstenite::{Message, WebSocket};

use super::{LIMIT, scratch};

/// Names of the program.
const PROGRAMS: [&str; 3] = ["chromium", "chromium-browser", "google-chrome"];
/// Variable of the environment with which a missing browser is a failure, as in the gate. Without it the
/// README's test command passes on a machine that has none, and says what was not tested.
const REQUIRED: &str = "REQUIRE_BROWSER";

/// A browser.
pub(crate) struct Browser {
    child: Child,
    folder: PathBuf,
    socket: WebSocket<TcpStream>,
    number: u64,
    /// Messages of the console, exceptions and failed requests, one line each.
    pub(crate) complaints: Vec<String>,
    /// Addresses that were requested.
    pub(crate) requests: Vec<String>,
}

/// A tab of a browser, by its session.
#[derive(Clone)]
pub(crate) struct Tab {
    session: String,
    target: String,
}

impl Browser {
    pub(crate) fn start() -> Option<Self> {
        // A profile of its own: browsers that share one overwrite each other's port.
        static STARTED: AtomicUsize = AtomicUsize::new(0);
        let number = STARTED.fetch_add(1, Ordering::Relaxed);
        let folder = scratch(&format!("browser-{number}"));
        let _ = std::fs::remove_dir_all(&folder);
        std::fs::create_dir_all(&folder).expect("a folder");
        let child = PROGRAMS
            .iter()
            .find_map(|program| spawned(program, &folder).ok());
        let Some(child) = child else {
            let missing = "no Chromium; install it: apt-get update && apt-get install -y \
                           --no-install-recommends chromium";
            assert!(std::env::var_os(REQUIRED).is_none(), "{missing}");
            println!("the page is not tested: {missing}");
            return None;
        };
        let socket = connected(&folder);
        let patience = Some(Duration::from_millis(20));
        socket
            .get_ref()
            .set_read_timeout(patience)
            .expect("a timeout");
        Some(Self {
            child,
            folder,
            socket,
            number: 0,
            complaints: Vec::new(),
            requests: Vec::new(),
        })
    }

    /// The result of a command, which must succeed.
    fn call(&mut self, session: Option<&str>, method: &str, parameters: &Value) -> Value {
        self.answer(session, method, parameters)
            .unwrap_or_else(|error| panic!("{method}: {error}"))
    }

    /// Sends a command and waits for its answer: its result, or its error.
    fn answer(
        &mut self,
        session: Option<&str>,
        method: &str,
        parameters: &Value,
    ) -> Result<Value, Value> {
        self.number += 1;
        let number = self.number;
        let mut message = json!({"id": number, "method": method, "params": parameters});
        if let Some(session) = session {
            message["sessionId"] = session.into();
        }
        self.socket
            .send(Message::text(message.to_string()))
            .expect("DevTools");
        let end = Instant::now() + LIMIT;
        while Instant::now() < end {
            let Some(message) = self.read() else { continue };
            if message["id"] == number {
                return match &message["error"] {
                    Value::Null => Ok(message["result"].clone()),
                    error => Err(error.clone()),
                };
            }
        }
        panic!("{method}: no answer");
    }

    /// The next message, if one has come.
    fn read(&mut self) -> Option<Value> {
        let text = match self.socket.read() {
            Ok(Message::Text(text)) => text,
            Ok(_) => return None,
            Err(tungstenite::Error::Io(error))
                if matches!(
                    error.kind(),
                    std::io::ErrorKind::WouldBlock | std::io::ErrorKind::TimedOut
                ) =>
            {
                return None;
            }
            Err(error) => panic!("DevTools: {error}"),
        };
        let message: Value = serde_json::from_str(&text).expect("JSON");
        let parameters = &message["params"];
        match message["method"].as_str() {
            Some("Runtime.consoleAPICalled") => {
                let kind = parameters["type"].as_str().unwrap_or_default();
                if ["error", "warning", "assert"].contains(&kind) {
                    self.complaints
                        .push(format!("{kind}: {}", parameters["args"]));
                }
            }
            Some("Runtime.exceptionThrown") => {
                self.complaints
                    .push(parameters["exceptionDetails"].to_string());
            }
            Some("Log.entryAdded") => {
                let entry = &parameters["entry"];
                if entry["level"] == "error" || entry["level"] == "warning" {
                    self.complaints.push(format!(
                        "{}: {} {}",
                        entry["source"], entry["text"], entry["url"]
                    ));
                }
            }
            Some("Network.requestWillBeSent") => {
                self.requests.push(
                    parameters["request"]["url"]
                        .as_str()
                        .unwrap_or_default()
                        .to_owned(),
                );
            }
            Some("Network.webSocketCreated") => {
                self.requests
                    .push(parameters["url"].as_str().unwrap_or_default().to_owned());
            }
            _ => {}
        }
        Some(message)
    }

    /// A new tab of this size with a page.
    pub(crate) fn open(&mut self, url: &str, width: u32, height: u32) -> Tab {
        let made = self.call(
            None,
            "Target.createTarget",
            &json!({"url": "about:blank", "newWindow": true}),
        );
        let target = made["targetId"].as_str().expect("a target").to_owned();
        let attach = json!({"targetId": target, "flatten": true});
        let attached = self.call(None, "Target.attachToTarget", &attach);
        let tab = Tab {
            session: attached["sessionId"]
                .as_str()
                .expect("a session")
                .to_owned(),
            target,
        };
        for domain in ["Runtime", "Log", "Network", "Page"] {
            self.tell(&tab, &format!("{domain}.enable"), &json!({}));
        }
        self.size(&tab, width, height);
        self.tell(&tab, "Page.navigate", &json!({"url": url}));
        tab
    }

    pub(crate) fn close(&mut self, tab: &Tab) {
        self.call(None, "Target.closeTarget", &json!({"targetId": tab.target}));
    }

    pub(crate) fn size(&mut self, tab: &Tab, width: u32, height: u32) {
        let mobile = width < 500;
        let size =
            json!({"width": width, "height": height, "deviceScaleFactor": 1, "mobile": mobile});
        self.tell(tab, "Emulation.setDeviceMetricsOverride", &size);
    }

    /// A command of a tab.
    pub(crate) fn tell(&mut self, tab: &Tab, method: &str, parameters: &Value) -> Value {
        self.call(Some(&tab.session), method, parameters)
    }

    /// The value of an expression in a tab, whose page must stay meanwhile.
    pub(crate) fn value(&mut self, tab: &Tab, expression: &str) -> Value {
        self.evaluated(tab, expression)
            .unwrap_or_else(|error| panic!("{expression}: {error}"))
    }

    /// The value of an expression in a tab, or the error of DevTools.
    fn evaluated(&mut self, tab: &Tab, expression: &str) -> Result<Value, Value> {
        let parameters =
            json!({"expression": expression, "returnByValue": true, "awaitPromise": true});
        let result = self.answer(Some(&tab.session), "Runtime.evaluate", &parameters)?;
        assert!(
            result["exceptionDetails"].is_null(),
            "{expression}: {}",
            result["exceptionDetails"]
        );
        Ok(result["result"]["value"].clone())
    }

    /// Waits until an expression is true. A page that loads anew while it is asked counts as not yet true.
    pub(crate) fn wait(&mut self, tab: &Tab, expression: &str) {
        let end = Instant::now() + LIMIT;
        let mut last = Value::Null;
        while Instant::now() < end {
            let guarded = format!(
                "(() => {{ try {{ return {expression}; }} catch (e) {{ return String(e); }} }})()"
            );
            last = self.evaluated(tab, &guarded).unwrap_or_else(|error| error);
            if last == true {
                return;
            }
            std::thread::sleep(Duration::from_millis(20));
        }
        let status = self.value(
            tab,
            "JSON.stringify([window.scope?.status, window.scope?.role, document.title])",
        );
        panic!("{expression}: {last}; {status}; {:?}", self.complaints);
    }

    /// Clicks the middle of an element.
    pub(crate) fn click(&mut self, tab: &Tab, selector: &str) {
        self.wait(
            tab,
            &format!("!document.querySelector('{selector}').disabled"),
        );
        self.value(
            tab,
            &format!("document.querySelector('{selector}').click()"),
        );
    }

    pub(crate) fn mouse(&mut self, tab: &Tab, kind: &str, x: f64, y: f64) {
        let buttons = if kind == "mouseReleased" { 0 } else { 1 };
        self.tell(
            tab,
            "Input.dispatchMouseEvent",
            &json!({
                "type": kind, "x": x, "y": y, "button": "left", "buttons": buttons, "clickCount": 1,
            }),
        );
    }

    pub(crate) fn key(&mut self, tab: &Tab, key: &str) {
        for kind in ["keyDown", "keyUp"] {
            self.tell(
                tab,
                "Input.dispatchKeyEvent",
                &json!({"type": kind, "key": key, "code": key}),
            );
        }
    }

    /// Writes what a tab shows to a file beside the build.
    pub(crate) fn picture(&mut self, tab: &Tab, name: &str) {
        let shot = self.tell(tab, "Page.captureScreenshot", &json!({"format": "png"}));
        let text = shot["data"].as_str().expect("a picture");
        let bytes = data_encoding::BASE64
            .decode(text.as_bytes())
            .expect("base 64");
        let folder = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join("scope");
        std::fs::create_dir_all(&folder).expect("a folder");
        std::fs::write(folder.join(name), bytes).expect("a file");
    }
}

/// A browser with this profile.
fn spawned(program: &str, folder: &Path) -> std::io::Result<Child> {
    Command::new(program)
        .args([
            "--headless=new",
            "--no-sandbox",
            "--disable-gpu",
            "--no-first-run",
            "--disable-dev-shm-usage",
            "--disable-background-networking",
            "--disable-component-update",
            "--disable-background-timer-throttling",
            "--disable-renderer-backgrounding",
            "--disable-backgrounding-occluded-windows",
            "--hide-scrollbars",
            "--remote-debugging-port=0",
        ])
        .arg(format!("--user-data-dir={}", folder.display()))
        .arg("about:blank")
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .spawn()
}

/// A connection to the browser that has this profile, once it has written its port there and listens.
fn connected(folder: &Path) -> WebSocket<TcpStream> {
    let end = Instant::now() + LIMIT;
    let mut last = "it has written no port".to_owned();
    while Instant::now() < end {
        let text = std::fs::read_to_string(folder.join("DevToolsActivePort")).unwrap_or_default();
        if let Some((port, path)) = text.trim().split_once('\n') {
            let host = format!("127.0.0.1:{port}");
            match TcpStream::connect(&host) {
                Ok(stream) => match tungstenite::client(format!("ws://{host}{path}"), stream) {
                    Ok((socket, _)) => return socket,
                    Err(error) => last = error.to_string(),
                },
                Err(error) => last = error.to_string(),
            }
        }
        std::thread::sleep(Duration::from_millis(50));
    }
    panic!("Chromium does not start: {last}");
}

impl Drop for Browser {
    fn drop(&mut self) {
        let _ = self.child.kill();
        let _ = self.child.wait();
        let _ = std::fs::remove_dir_all(&self.folder);
    }
}
