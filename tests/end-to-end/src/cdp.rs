//! The `DevTools` protocol by method name and JSON.
//!
//! chromiumoxide has a type for every command, but its replies are closed enums of the protocol at its release: one
//! new accessibility property of a newer Chromium makes the reply unreadable. So commands with needed replies use
//! this module.

use std::future::Future;
use std::sync::Arc;
use std::time::Duration;

use anyhow::{Context, Result, anyhow};
use chromiumoxide::types::{Command, Method, MethodId};
use serde::{Serialize, Serializer};
use serde_json::{Value, json};
use tokio::runtime::Runtime;
use tokio::time::timeout;

use crate::wait::WAIT_MAX;

/// Any command of the protocol.
#[derive(Debug, Clone)]
struct AnyCommand {
    method: &'static str,
    params: Value,
}

impl Serialize for AnyCommand {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        self.params.serialize(serializer)
    }
}

impl Method for AnyCommand {
    fn identifier(&self) -> MethodId {
        self.method.into()
    }
}

impl Command for AnyCommand {
    type Response = Value;
}

/// Runs requests to Chromium and blocks until they end.
#[derive(Clone)]
pub struct Blocking(Arc<Runtime>);

impl Blocking {
    /// One thread for the connection; the waiting thread does the rest.
    pub fn new() -> Result<Self> {
        let runtime = tokio::runtime::Builder::new_multi_thread()
            .worker_threads(1)
            .enable_all()
            .build()
            .context("no thread to talk to Chromium")?;
        Ok(Self(Arc::new(runtime)))
    }

    /// Waits for `future`, at most for [`WAIT_MAX`].
    pub fn wait<T, E>(&self, what: &str, future: impl Future<Output = Result<T, E>>) -> Result<T>
    where
        E: std::error::Error + Send + Sync + 'static,
    {
        self.wait_for(what, WAIT_MAX, future)
    }

    /// Waits for `future`, at most for `wait_max`.
    pub fn wait_for<T, E>(
        &self,
        what: &str,
        wait_max: Duration,
        future: impl Future<Output = Result<T, E>>,
    ) -> Result<T>
    where
        E: std::error::Error + Send + Sync + 'static,
    {
        self.0
            .block_on(async { timeout(wait_max, future).await })
            .map_err(|_| anyhow!("no answer from Chromium to {what} in {wait_max:?}"))?
            .with_context(|| format!("Chromium refused {what}"))
    }

    /// Waits for a `future` that has its own timeout.
    pub fn wait_plain<T>(&self, future: impl Future<Output = T>) -> T {
        self.0.block_on(future)
    }

    /// Runs `future` in the background.
    pub fn spawn(&self, future: impl Future<Output = ()> + Send + 'static) {
        self.0.spawn(future);
    }
}

/// One tab's connection.
#[derive(Clone)]
pub struct Session {
    blocking: Blocking,
    tab: chromiumoxide::Page,
}

impl Session {
    /// A connection to this tab.
    pub fn new(blocking: Blocking, tab: chromiumoxide::Page) -> Self {
        Self { blocking, tab }
    }

    /// The runtime for the futures of [`Session::tab`].
    pub fn blocking(&self) -> &Blocking {
        &self.blocking
    }

    /// The tab, for functions of chromiumoxide itself.
    pub fn tab(&self) -> &chromiumoxide::Page {
        &self.tab
    }

    /// Calls a method and returns its result.
    pub fn call(&self, method: &'static str, params: Value) -> Result<Value> {
        self.call_within(WAIT_MAX, method, params)
    }

    /// Calls a method and returns its result, with a timeout.
    pub fn call_within(
        &self,
        wait_max: Duration,
        method: &'static str,
        params: Value,
    ) -> Result<Value> {
        let command = AnyCommand { method, params };
        let reply = self
            .blocking
            .wait_for(method, wait_max, self.tab.execute(command))?;
        Ok(reply.result)
    }

    /// The value of a JavaScript expression in the page; a promise is awaited.
    pub fn evaluate(&self, expression: &str) -> Result<Value> {
        let params =
            json!({ "expression": expression, "returnByValue": true, "awaitPromise": true });
        value_of(&self.call("Runtime.evaluate", params)?)
            .with_context(|| format!("in the page: {expression}"))
    }

    /// The value of a JavaScript function called with the node as `this`.
    pub fn call_on_node(&self, node: i64, function: &str, arguments: &[Value]) -> Result<Value> {
        let resolved = self.call("DOM.resolveNode", json!({ "backendNodeId": node }))?;
        let object = at(&resolved, "/object/objectId")
            .as_str()
            .context("the node is no object")?;
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

fn value_of(reply: &Value) -> Result<Value> {
    if let Some(thrown) = reply.get("exceptionDetails") {
        let description = at(thrown, "/exception/description").as_str();
        return Err(anyhow!("{}", description.unwrap_or(&thrown.to_string())));
    }
    Ok(at(reply, "/result/value").clone())
}
