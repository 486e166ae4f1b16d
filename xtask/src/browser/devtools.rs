//! A browser driven over its DevTools protocol: one process, one page at a time.

use std::collections::VecDeque;
use std::io::{BufRead, BufReader};
use std::net::TcpStream;
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

use base64::Engine;
use serde_json::{Value, json};
use tungstenite::stream::MaybeTlsStream;
use tungstenite::{Message, WebSocket};

/// No answer within this time is a failure.
const PATIENCE: Duration = Duration::from_secs(30);

/// A running browser without a window.
pub struct Browser {
    process: Child,
    socket: WebSocket<MaybeTlsStream<TcpStream>>,
    next_id: u64,
    session: String,
    events: VecDeque<Value>,
    _profile: tempfile::TempDir,
}

impl Browser {
    /// Starts a browser with an empty profile and opens an empty page.
    pub fn start(program: &Path, more_flags: &[&str]) -> Result<Self, String> {
        let profile = tempfile::tempdir().map_err(|e| e.to_string())?;
        let mut process = Command::new(program)
            .args(["--headless", "--no-sandbox", "--disable-gpu", "--no-first-run", "--disable-sync"])
            .args(["--disable-background-networking", "--disable-component-update", "--hide-scrollbars"])
            .args(["--remote-debugging-port=0", "--window-size=1280,800"])
            .arg(format!("--user-data-dir={}", profile.path().display()))
            .args(more_flags)
            .stdin(Stdio::null())
            .stdout(Stdio::null())
            .stderr(Stdio::piped())
            .spawn()
            .map_err(|e| format!("{}: {e}", program.display()))?;
        let address = match address(&mut process) {
            Ok(address) => address,
            Err(error) => {
                let _ = process.kill();
                return Err(error);
            }
        };
        let (socket, _) = tungstenite::connect(&address).map_err(|e| format!("{address}: {e}"))?;
        if let MaybeTlsStream::Plain(stream) = socket.get_ref() {
            stream.set_read_timeout(Some(PATIENCE)).map_err(|e| e.to_string())?;
        }
        let mut browser = Self {
            process,
            socket,
            next_id: 0,
            session: String::new(),
            events: VecDeque::new(),
            _profile: profile,
        };
        browser.open_page()?;
        Ok(browser)
    }

    /// Leaves the old page for a new one, in which nothing has happened yet.
    pub fn open_page(&mut self) -> Result<(), String> {
        self.session.clear();
        let target = self.call("Target.createTarget", json!({ "url": "about:blank" }))?;
        let parameters = json!({ "targetId": target["targetId"], "flatten": true });
        let session = self.call("Target.attachToTarget", parameters)?;
        self.session = session["sessionId"].as_str().ok_or("no session")?.to_owned();
        for domain in ["Page", "Runtime", "Log", "Network"] {
            self.call(&format!("{domain}.enable"), json!({}))?;
        }
        self.events.clear();
        Ok(())
    }

    /// Sends a command and waits for its result; events that come before are kept.
    pub fn call(&mut self, method: &str, parameters: Value) -> Result<Value, String> {
        self.next_id += 1;
        let mut message = json!({ "id": self.next_id, "method": method, "params": parameters });
        if !self.session.is_empty() {
            message["sessionId"] = json!(self.session);
        }
        self.socket.send(Message::text(message.to_string())).map_err(|e| format!("{method}: {e}"))?;
        loop {
            let answer = self.receive().map_err(|e| format!("{method}: {e}"))?;
            if answer["id"] == self.next_id {
                return match answer.get("error") {
                    Some(error) => Err(format!("{method}: {error}")),
                    None => Ok(answer["result"].clone()),
                };
            }
            self.events.push_back(answer);
        }
    }

    fn receive(&mut self) -> Result<Value, String> {
        loop {
            match self.socket.read().map_err(|e| e.to_string())? {
                Message::Text(text) => return serde_json::from_str(&text).map_err(|e| e.to_string()),
                Message::Close(_) => return Err("the browser closed the connection".into()),
                _ => {}
            }
        }
    }

    /// Loads a file and waits until it has drawn twice; the time from the start of the navigation.
    pub fn load(&mut self, file: &Path) -> Result<Duration, String> {
        // Of this page, not of the one before.
        let fired = |event: &Value| event["method"] == "Page.loadEventFired";
        self.events.retain(|event| !fired(event));
        let start = Instant::now();
        self.call("Page.navigate", json!({ "url": format!("file://{}", file.display()) }))?;
        while !self.events.iter().any(fired) {
            let event = self.receive()?;
            self.events.push_back(event);
            if start.elapsed() > PATIENCE {
                return Err(format!("{}: not loaded within {PATIENCE:?}", file.display()));
            }
        }
        self.settle()?;
        Ok(start.elapsed())
    }

    /// Waits until what was done is drawn.
    pub fn settle(&mut self) -> Result<(), String> {
        let frames =
            "new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(() => done(1))))";
        self.evaluate(frames).map(|_| ())
    }

    /// The value of an expression in the page; promises are awaited.
    pub fn evaluate(&mut self, expression: &str) -> Result<Value, String> {
        let parameters = json!({ "expression": expression, "awaitPromise": true, "returnByValue": true });
        let result = self.call("Runtime.evaluate", parameters)?;
        match result.get("exceptionDetails") {
            Some(details) => Err(format!("{expression}: {details}")),
            None => Ok(result["result"]["value"].clone()),
        }
    }

    /// The text of the first element that a selector finds.
    pub fn text(&mut self, selector: &str) -> Result<String, String> {
        let value = self.evaluate(&format!("document.querySelector({}).textContent", json!(selector)))?;
        Ok(value.as_str().unwrap_or_default().to_owned())
    }

    /// Moves the mouse to a place and clicks there.
    pub fn click(&mut self, [x, y]: [f64; 2]) -> Result<(), String> {
        for (kind, buttons) in [("mouseMoved", 0), ("mousePressed", 1), ("mouseReleased", 0)] {
            let button = if kind == "mouseMoved" { "none" } else { "left" };
            let event = json!({ "type": kind, "x": x, "y": y, "button": button, "buttons": buttons, "clickCount": 1 });
            self.call("Input.dispatchMouseEvent", event)?;
        }
        self.settle()
    }

    /// Touches a place with one finger.
    pub fn tap(&mut self, [x, y]: [f64; 2]) -> Result<(), String> {
        let points = json!([{ "x": x, "y": y }]);
        self.call("Input.dispatchTouchEvent", json!({ "type": "touchStart", "touchPoints": points }))?;
        self.call("Input.dispatchTouchEvent", json!({ "type": "touchEnd", "touchPoints": [] }))?;
        self.settle()
    }

    /// Presses a key that makes a character, or a named one such as `Escape`.
    pub fn press(&mut self, key: &str) -> Result<(), String> {
        // What the browser itself does at a key hangs on the key's number.
        let (text, code) = match key {
            "Enter" => ("\r", 13),
            "Tab" => ("", 9),
            _ if key.chars().count() == 1 => (key, 0),
            _ => ("", 0),
        };
        let event =
            |kind: &str| json!({ "type": kind, "key": key, "text": text, "windowsVirtualKeyCode": code });
        self.call("Input.dispatchKeyEvent", event("keyDown"))?;
        let up = json!({ "type": "keyUp", "key": key, "windowsVirtualKeyCode": code });
        self.call("Input.dispatchKeyEvent", up)?;
        self.settle()
    }

    /// The window's contents as PNG.
    pub fn screenshot(&mut self) -> Result<Vec<u8>, String> {
        let result = self.call("Page.captureScreenshot", json!({ "format": "png" }))?;
        let data = result["data"].as_str().ok_or("no screenshot")?;
        base64::engine::general_purpose::STANDARD.decode(data).map_err(|e| e.to_string())
    }

    /// Errors in the console, uncaught exceptions, and requests that left the machine.
    pub fn complaints(&self) -> Vec<String> {
        let complaint = |event: &Value| {
            let parameters = &event["params"];
            let found = match event["method"].as_str()? {
                "Runtime.exceptionThrown" => true,
                "Runtime.consoleAPICalled" => parameters["type"] == "error",
                "Log.entryAdded" => parameters["entry"]["level"] == "error",
                "Network.requestWillBeSent" => {
                    let url = parameters["request"]["url"].as_str().unwrap_or_default();
                    !["file:", "data:", "about:"].iter().any(|scheme| url.starts_with(scheme))
                }
                _ => false,
            };
            found.then(|| event.to_string())
        };
        self.events.iter().filter_map(complaint).collect()
    }
}

impl Drop for Browser {
    fn drop(&mut self) {
        let _ = self.process.kill();
        let _ = self.process.wait();
    }
}

/// Where the browser listens, which it says on stderr.
fn address(process: &mut Child) -> Result<String, String> {
    let mut lines = BufReader::new(process.stderr.take().ok_or("no stderr")?).lines();
    let mut said = Vec::new();
    for line in lines.by_ref().map_while(Result::ok) {
        if let Some((_, address)) = line.split_once("DevTools listening on ") {
            let address = address.trim().to_owned();
            // Its pipe must not fill up.
            std::thread::spawn(move || lines.for_each(drop));
            return Ok(address);
        }
        said.push(line);
    }
    Err(format!("the browser did not start: {}", said.join(" | ")))
}
