//! Measures the memory of a page and its workers.

use std::sync::Arc;

use anyhow::{Context, Result, anyhow};
use chromiumoxide::cdp::browser_protocol::target::EventReceivedMessageFromTarget;
use futures::{Stream, StreamExt};
use serde_json::{Value, json};
use tokio::time::timeout;

use crate::cdp::{Session, at};
use crate::page::Page;
use crate::wait::WAIT_MAX;

/// Memory of a page or a worker in bytes, after garbage collection.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Memory {
    /// JavaScript: objects, and their memory outside the heap.
    pub script: u64,
    /// WebAssembly: its linear memories, which never shrink.
    pub wasm: u64,
}

impl Page {
    /// The memory of the page itself, without its workers.
    ///
    /// # Errors
    ///
    /// When it does not answer.
    pub fn memory(&self) -> Result<Memory> {
        self.drop_accessibility_tree()?;
        let call = &mut |method, params: &Value| self.session.call(method, params.clone());
        // In a page with the app, Chromium 156 never answers the search for its memories.
        let sum = json!({ "expression": "wasmBytes()" });
        let wasm = call("Runtime.evaluate", &sum)?;
        Ok(Memory {
            script: script_bytes(call)?,
            wasm: whole(at(&wasm, "/result/value").as_f64().context("no sum")?),
        })
    }

    /// Drops the accessibility tree. The browser builds it when a control is looked for; then it only grows, and every
    /// change of the page costs more.
    ///
    /// # Errors
    ///
    /// When the browser does not answer.
    pub fn drop_accessibility_tree(&self) -> Result<()> {
        // Disabling the domain frees it, but only if it was enabled explicitly.
        self.session.call("Accessibility.enable", json!({}))?;
        self.session.call("Accessibility.disable", json!({}))?;
        Ok(())
    }

    /// The memory of the worker of this name.
    ///
    /// # Errors
    ///
    /// When there is no such worker, or it does not answer.
    pub fn memory_of_worker(&self, name: &str) -> Result<Memory> {
        // From the page's own session: the browser's session lists the workers of all pages.
        let targets = self.session.call(
            "Target.getTargets",
            json!({ "filter": [{ "type": "worker" }] }),
        )?;
        let targets = at(&targets, "/targetInfos").as_array();
        for target in targets.map(Vec::as_slice).unwrap_or_default() {
            let mut worker = Worker::attach(&self.session, at(target, "/targetId"))?;
            let memory = worker.memory_if_named(name);
            worker.detach();
            if let Some(memory) = memory? {
                return Ok(memory);
            }
        }
        Err(anyhow!("the page has no worker {name:?}"))
    }
}

/// A connection to one worker. chromiumoxide only has sessions of pages, so messages to a worker are wrapped in
/// messages of its page's session.
struct Worker<'a> {
    page: &'a Session,
    session_id: String,
    received: Box<dyn Stream<Item = Arc<EventReceivedMessageFromTarget>> + Unpin>,
    next_call: u64,
}

impl<'a> Worker<'a> {
    fn attach(page: &'a Session, target_id: &Value) -> Result<Self> {
        let listening = page
            .tab()
            .event_listener::<EventReceivedMessageFromTarget>();
        let received = page.blocking().wait("a worker's messages", listening)?;
        let params = json!({ "targetId": target_id, "flatten": false });
        let attached = page.call("Target.attachToTarget", params)?;
        let session_id = at(&attached, "/sessionId").as_str();
        Ok(Self {
            page,
            session_id: session_id.context("a worker without a session")?.to_owned(),
            received: Box::new(received),
            next_call: 0,
        })
    }

    fn detach(self) {
        // A worker that has ended is detached already.
        let params = json!({ "sessionId": self.session_id });
        let _ = self.page.call("Target.detachFromTarget", params);
    }

    fn memory_if_named(&mut self, name: &str) -> Result<Option<Memory>> {
        let own = self.call("Runtime.evaluate", &json!({ "expression": "self.name" }))?;
        if at(&own, "/result/value") != name {
            return Ok(None);
        }
        let call = &mut |method, params: &Value| self.call(method, params);
        Ok(Some(Memory {
            script: script_bytes(call)?,
            wasm: wasm_bytes(call)?,
        }))
    }

    fn call(&mut self, method: &'static str, params: &Value) -> Result<Value> {
        self.next_call += 1;
        let id = self.next_call;
        let message = json!({ "id": id, "method": method, "params": params });
        let params = json!({ "sessionId": self.session_id, "message": message.to_string() });
        self.page.call("Target.sendMessageToTarget", params)?;
        let (received, session_id) = (&mut self.received, &self.session_id);
        self.page.blocking().wait_plain(async {
            let reply = timeout(WAIT_MAX, reply_to(id, session_id, received)).await;
            reply.map_err(|_| anyhow!("no answer from a worker to {method} in {WAIT_MAX:?}"))?
        })
    }
}

/// Calls a method of the protocol in a page or a worker.
type Call<'a> = dyn FnMut(&'static str, &Value) -> Result<Value> + 'a;

fn script_bytes(call: &mut Call) -> Result<u64> {
    call("HeapProfiler.collectGarbage", &json!({}))?;
    let heap = call("Runtime.getHeapUsage", &json!({}))?;
    let bytes = |part: &str| at(&heap, part).as_f64().unwrap_or(0.0);
    Ok(whole(
        bytes("/usedSize") + bytes("/embedderHeapUsedSize") + bytes("/backingStorageSize"),
    ))
}

/// The size of linear memories. The browser's statistics do not include them, but it finds them as objects.
fn wasm_bytes(call: &mut Call) -> Result<u64> {
    let prototype = json!({ "expression": "WebAssembly.Memory.prototype" });
    let prototype = call("Runtime.evaluate", &prototype)?;
    let prototype = json!({ "prototypeObjectId": at(&prototype, "/result/objectId") });
    let memories = call("Runtime.queryObjects", &prototype)?;
    let sum = "function () {
        return this.reduce((sum, memory) => sum + memory.buffer.byteLength, 0);
    }";
    let sum = json!({
        "objectId": at(&memories, "/objects/objectId"),
        "functionDeclaration": sum,
        "returnByValue": true,
    });
    let sum = call("Runtime.callFunctionOn", &sum)?;
    let bytes = at(&sum, "/result/value").as_f64();
    Ok(whole(bytes.context("it does not tell of its memories")?))
}

/// The result of a call, among all messages of workers.
async fn reply_to(
    id: u64,
    session_id: &str,
    received: &mut (impl Stream<Item = Arc<EventReceivedMessageFromTarget>> + Unpin),
) -> Result<Value> {
    while let Some(event) = received.next().await {
        if event.session_id.inner() != session_id {
            continue;
        }
        let reply: Value = serde_json::from_str(&event.message)?;
        if reply.get("id").and_then(Value::as_u64) == Some(id) {
            let result = reply.get("result").cloned();
            return result.with_context(|| format!("refused: {}", event.message));
        }
    }
    Err(anyhow!("the connection to the worker has ended"))
}

#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "sizes in bytes are whole and far under 2^53"
)]
fn whole(bytes: f64) -> u64 {
    bytes as u64
}
