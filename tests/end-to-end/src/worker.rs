//! A connection to one worker of a page.

use std::sync::Arc;

use anyhow::{Context, Result, anyhow};
use chromiumoxide::cdp::browser_protocol::target::EventReceivedMessageFromTarget;
use futures::{Stream, StreamExt};
use serde_json::{Value, json};
use tokio::time::timeout;

use crate::cdp::{Session, at};
use crate::page::Page;
use crate::wait::WAIT_MAX;

impl Page {
    /// Lets the worker of this name run for ever without a pause: it handles no message, no timer and no byte any more.
    ///
    /// # Errors
    ///
    /// When there is no such worker, or it does not answer.
    pub fn hang_worker(&self, name: &str) -> Result<()> {
        self.with_worker(name, |worker| {
            // Not within the evaluation, which has a reply.
            let hang = json!({ "expression": "setTimeout(() => { for (;;); }); 0" });
            worker.call("Runtime.evaluate", &hang).map(drop)
        })
    }

    /// Does something with the worker of this name.
    pub(crate) fn with_worker<T>(
        &self,
        name: &str,
        act: impl Fn(&mut Worker) -> Result<T>,
    ) -> Result<T> {
        // From the page's own session: the browser's session lists the workers of all pages.
        let targets = self.session.call(
            "Target.getTargets",
            json!({ "filter": [{ "type": "worker" }] }),
        )?;
        let targets = at(&targets, "/targetInfos").as_array();
        for target in targets.map(Vec::as_slice).unwrap_or_default() {
            let mut worker = Worker::attach(&self.session, at(target, "/targetId"))?;
            let is_it = worker.is_named(name);
            let done = match is_it {
                Ok(true) => Some(act(&mut worker)),
                Ok(false) => None,
                Err(error) => Some(Err(error)),
            };
            worker.detach();
            if let Some(done) = done {
                return done;
            }
        }
        Err(anyhow!("the page has no worker {name:?}"))
    }
}

/// chromiumoxide only has sessions of pages, so messages to a worker are wrapped in messages of its page's session.
pub(crate) struct Worker<'a> {
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

    fn is_named(&mut self, name: &str) -> Result<bool> {
        let own = self.call("Runtime.evaluate", &json!({ "expression": "self.name" }))?;
        Ok(at(&own, "/result/value") == name)
    }

    pub(crate) fn call(&mut self, method: &'static str, params: &Value) -> Result<Value> {
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
