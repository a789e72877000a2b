//! A connection to one worker of a page.

use anyhow::{Result, anyhow};
use serde_json::json;

use crate::cdp::{Session, target_ids};
use crate::page::Page;

impl Page {
    /// Lets the worker of this name run for ever without a pause: it handles no message, no timer and no byte any more.
    ///
    /// # Errors
    ///
    /// When there is no such worker, or it does not answer.
    pub fn hang_worker(&self, name: &str) -> Result<()> {
        self.with_worker(name, |worker| {
            // Not within the evaluation, which has a reply.
            worker
                .evaluate("setTimeout(() => { for (;;); }); 0")
                .map(drop)
        })
    }

    /// Does something with the worker of this name.
    pub(crate) fn with_worker<T>(
        &self,
        name: &str,
        act: impl Fn(&Session) -> Result<T>,
    ) -> Result<T> {
        for target in self.workers()? {
            let worker = self.session.attach_to(&target)?;
            let done = match worker.evaluate("self.name") {
                Ok(own) if own == name => Some(act(&worker)),
                Ok(_) => None,
                Err(error) => Some(Err(error)),
            };
            // A worker that has ended is detached already.
            let _ = worker.detach();
            if let Some(done) = done {
                return done;
            }
        }
        Err(anyhow!("the page has no worker {name:?}"))
    }

    /// The IDs of its workers.
    fn workers(&self) -> Result<Vec<String>> {
        // From the page's own session: the browser's session lists the workers of all pages.
        let filter = json!({ "filter": [{ "type": "worker" }] });
        let workers = self.session.call("Target.getTargets", filter)?;
        Ok(target_ids(&workers))
    }
}
