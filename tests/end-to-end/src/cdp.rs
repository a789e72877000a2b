//! The `DevTools` protocol by method name and JSON, over the pipe of a Chromium that this program has started.

use std::collections::HashMap;
use std::io::{BufRead, BufReader, Write};
use std::process::{ChildStdin, ChildStdout};
use std::sync::mpsc::{self, RecvTimeoutError, Sender};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::thread;
use std::time::Duration;

use anyhow::{Context, Result, anyhow};
use serde::{Deserialize, Serialize};
use serde_json::{Value, json};

use crate::document::Document;
use crate::wait::{WAIT_MAX, wait_until};

/// Gets method and parameters of each event of a session. It must not call the browser: the next message waits for it.
type Listener = Box<dyn Fn(&str, &Value) + Send>;

/// The connection to one browser.
pub struct Connection {
    commands: Mutex<ChildStdin>,
    pending: Arc<Mutex<Pending>>,
}

/// A call of a method.
#[derive(Serialize)]
struct Command<'a> {
    id: u64,
    method: &'a str,
    params: Value,
    #[serde(rename = "sessionId", skip_serializing_if = "Option::is_none")]
    session: Option<&'a str>,
}

/// The reply to a call, or an event.
#[derive(Deserialize)]
struct Message {
    /// Of the call; an event has none.
    id: Option<u64>,
    #[serde(default)]
    result: Value,
    error: Option<Refusal>,
    /// Of an event.
    method: Option<String>,
    #[serde(default)]
    params: Value,
    #[serde(rename = "sessionId")]
    session: Option<String>,
}

#[derive(Deserialize)]
struct Refusal {
    message: String,
}

/// The calls that wait for the browser, and the listeners.
#[derive(Default)]
struct Pending {
    has_ended: bool,
    calls: u64,
    /// Calls without a reply.
    waiting: HashMap<u64, Sender<Message>>,
    listeners: Vec<(String, Listener)>,
}

impl Connection {
    /// Reads the browser's messages from now on.
    pub fn new(commands: ChildStdin, messages: ChildStdout) -> Self {
        let pending = Arc::<Mutex<Pending>>::default();
        let reading = Arc::clone(&pending);
        thread::spawn(move || {
            for message in BufReader::new(messages).split(0).map_while(Result::ok) {
                match serde_json::from_slice(&message) {
                    Ok(message) => lock(&reading).take(message),
                    Err(error) => eprintln!("a message of Chromium is not understood: {error}"),
                }
            }
            lock(&reading).end();
        });
        Self {
            commands: Mutex::new(commands),
            pending,
        }
    }

    /// Calls a method of the browser, or of one session, and returns its result.
    pub fn call(
        &self,
        session: Option<&str>,
        wait_max: Duration,
        method: &str,
        params: Value,
    ) -> Result<Value> {
        let (answer, answered) = mpsc::channel();
        let id = lock(&self.pending)
            .expect(answer)
            .with_context(|| format!("the browser has ended before {method}"))?;
        let mut command = serde_json::to_vec(&Command {
            id,
            method,
            params,
            session,
        })?;
        command.push(0);
        lock(&self.commands)
            .write_all(&command)
            .with_context(|| format!("the browser does not take {method}"))?;
        let reply = answered.recv_timeout(wait_max).map_err(|why| match why {
            RecvTimeoutError::Timeout => {
                lock(&self.pending).waiting.remove(&id);
                anyhow!("no answer from Chromium to {method} in {wait_max:?}")
            }
            RecvTimeoutError::Disconnected => anyhow!("the browser has ended during {method}"),
        })?;
        match reply.error {
            Some(refusal) => Err(anyhow!("Chromium refused {method}: {}", refusal.message)),
            None => Ok(reply.result),
        }
    }

    fn listen(&self, session: &str, listener: impl Fn(&str, &Value) + Send + 'static) {
        let listener = (session.to_owned(), Box::new(listener) as Listener);
        lock(&self.pending).listeners.push(listener);
    }
}

impl Pending {
    /// The number of a new call.
    fn expect(&mut self, answer: Sender<Message>) -> Option<u64> {
        self.calls += 1;
        (!self.has_ended).then(|| {
            self.waiting.insert(self.calls, answer);
            self.calls
        })
    }

    fn take(&mut self, message: Message) {
        if let Some(id) = message.id {
            if let Some(waiting) = self.waiting.remove(&id) {
                // The caller may have stopped waiting in this moment.
                let _ = waiting.send(message);
            }
            return;
        }
        let (Some(method), params) = (message.method, message.params) else {
            return;
        };
        if method == "Target.detachedFromTarget" {
            let gone = at(&params, "/sessionId");
            self.listeners.retain(|(of, _)| gone != of);
        }
        let session = message.session.as_ref();
        for (_, listener) in self.listeners.iter().filter(|(of, _)| session == Some(of)) {
            listener(&method, &params);
        }
    }

    /// Every call that waits fails.
    fn end(&mut self) {
        self.has_ended = true;
        self.waiting.clear();
    }
}

/// The session of one tab or worker.
#[derive(Clone)]
pub struct Session {
    connection: Arc<Connection>,
    id: String,
    target: String,
    document: Arc<Mutex<Document>>,
}

impl Session {
    /// Attaches to a target of the browser.
    fn attach(connection: Arc<Connection>, target: &str) -> Result<Self> {
        let params = json!({ "targetId": target, "flatten": true });
        let attached = connection.call(None, WAIT_MAX, "Target.attachToTarget", params)?;
        Ok(Self {
            id: text_at(&attached, "/sessionId")?,
            target: target.to_owned(),
            connection,
            document: Arc::default(),
        })
    }

    /// A new empty tab, in front of all others.
    pub fn new_tab(connection: Arc<Connection>) -> Result<Self> {
        let blank = json!({ "url": "about:blank" });
        let created = connection.call(None, WAIT_MAX, "Target.createTarget", blank)?;
        let tab = Self::attach(connection, &text_at(&created, "/targetId")?)?;
        let (main_frame, document) = (tab.target.clone(), Arc::clone(&tab.document));
        tab.listen(move |method, event| lock(&document).record(&main_frame, method, event));
        // Performance measures from the start of a page.
        for domain in ["Page", "Performance"] {
            tab.call(&format!("{domain}.enable"), json!({}))?;
        }
        tab.call("Page.setLifecycleEventsEnabled", json!({ "enabled": true }))?;
        // A worker that is first attached to while its script loads never answers.
        let workers = json!({
            "autoAttach": true,
            "waitForDebuggerOnStart": false,
            "flatten": true,
            "filter": [{ "type": "service_worker", "exclude": true }, {}],
        });
        tab.call("Target.setAutoAttach", workers)?;
        Ok(tab)
    }

    /// Attaches to another target of the same browser.
    pub fn attach_to(&self, target: &str) -> Result<Self> {
        Self::attach(Arc::clone(&self.connection), target)
    }

    /// Ends the session; the target runs on.
    pub fn detach(&self) -> Result<()> {
        let params = json!({ "sessionId": self.id });
        self.connection
            .call(None, WAIT_MAX, "Target.detachFromTarget", params)
            .map(drop)
    }

    /// The ID of its tab or worker.
    pub fn target(&self) -> &str {
        &self.target
    }

    /// Calls `listener` with the method and the parameters of each event from now on.
    pub fn listen(&self, listener: impl Fn(&str, &Value) + Send + 'static) {
        self.connection.listen(&self.id, listener);
    }

    /// Loads a page into the tab.
    pub fn load(&self, wait_max: Duration, url: &str) -> Result<()> {
        let navigated = self.call_within(wait_max, "Page.navigate", json!({ "url": url }))?;
        if let Some(error) = at(&navigated, "/errorText").as_str() {
            return Err(anyhow!("{url} does not load: {error}"));
        }
        // A link within the document loads nothing.
        let Some(loader) = at(&navigated, "/loaderId").as_str() else {
            return Ok(());
        };
        self.wait_until_loaded(wait_max, url, |now| now == loader)
    }

    /// Loads the tab's page again.
    pub fn reload(&self) -> Result<()> {
        let before = lock(&self.document).loader.clone();
        self.call("Page.reload", json!({}))?;
        self.wait_until_loaded(WAIT_MAX, "the page again", |now| now != before)
    }

    fn wait_until_loaded(
        &self,
        wait_max: Duration,
        what: &str,
        is_expected: impl Fn(&str) -> bool,
    ) -> Result<()> {
        wait_until(&format!("{what} to load"), wait_max, || {
            let document = lock(&self.document);
            Ok(if document.is_loaded && is_expected(&document.loader) {
                Ok(())
            } else {
                Err("it loads".to_owned())
            })
        })
    }

    /// Calls a method and returns its result.
    pub fn call(&self, method: &str, params: Value) -> Result<Value> {
        self.call_within(WAIT_MAX, method, params)
    }

    /// Calls a method and returns its result, with a timeout.
    pub fn call_within(&self, wait_max: Duration, method: &str, params: Value) -> Result<Value> {
        self.connection
            .call(Some(&self.id), wait_max, method, params)
    }

    /// The value of a JavaScript expression in the page; a promise is awaited.
    pub fn evaluate(&self, expression: &str) -> Result<Value> {
        let params =
            json!({ "expression": expression, "returnByValue": true, "awaitPromise": true });
        value_of(&self.call("Runtime.evaluate", params)?)
            .with_context(|| format!("in the page: {expression}"))
    }

    /// The document in the tab, as events have told so far.
    pub fn document(&self) -> MutexGuard<'_, Document> {
        lock(&self.document)
    }

    /// The JavaScript object of a node.
    pub fn object_of(&self, node: i64) -> Result<String> {
        let resolved = self.call("DOM.resolveNode", json!({ "backendNodeId": node }))?;
        text_at(&resolved, "/object/objectId")
    }

    /// The value of a JavaScript function called with the object as `this`.
    pub fn call_on(&self, object: &str, function: &str, arguments: &[Value]) -> Result<Value> {
        let arguments: Vec<Value> = arguments
            .iter()
            .map(|value| json!({ "value": value }))
            .collect();
        let params = json!({
            "objectId": object,
            "functionDeclaration": function,
            "arguments": arguments,
            "returnByValue": true,
            "awaitPromise": true,
        });
        value_of(&self.call("Runtime.callFunctionOn", params)?)
    }
}

/// The part of a reply at a JSON pointer; null if there is none.
pub fn at<'a>(reply: &'a Value, pointer: &str) -> &'a Value {
    reply.pointer(pointer).unwrap_or(&Value::Null)
}

/// The IDs of targets, of a reply to `Target.getTargets`.
pub fn target_ids(reply: &Value) -> Vec<String> {
    let targets = at(reply, "/targetInfos").as_array();
    let ids = targets
        .into_iter()
        .flatten()
        .filter_map(|target| at(target, "/targetId").as_str());
    ids.map(str::to_owned).collect()
}

/// The text at a JSON pointer.
fn text_at(reply: &Value, pointer: &str) -> Result<String> {
    let text = at(reply, pointer).as_str();
    text.map(str::to_owned)
        .with_context(|| format!("no {pointer} in {reply}"))
}

fn value_of(reply: &Value) -> Result<Value> {
    if let Some(thrown) = reply.get("exceptionDetails") {
        let description = at(thrown, "/exception/description").as_str();
        return Err(anyhow!("{}", description.unwrap_or(&thrown.to_string())));
    }
    Ok(at(reply, "/result/value").clone())
}

fn lock<T>(shared: &Mutex<T>) -> MutexGuard<'_, T> {
    shared.lock().unwrap_or_else(PoisonError::into_inner)
}
