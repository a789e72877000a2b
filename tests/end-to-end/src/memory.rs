//! Measures the memory of a page and its workers.

use anyhow::{Context, Result};
use serde_json::json;

use crate::cdp::{Session, at};
use crate::page::Page;

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
        // In a page with the app, Chromium 156 never answers the search for its memories.
        let wasm = self.session.evaluate("wasmBytes()")?;
        Ok(Memory {
            script: script_bytes(&self.session)?,
            wasm: whole(wasm.as_f64().context("no sum")?),
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
        self.with_worker(name, |worker| {
            Ok(Memory {
                script: script_bytes(worker)?,
                wasm: wasm_bytes(worker)?,
            })
        })
    }
}

fn script_bytes(of: &Session) -> Result<u64> {
    of.call("HeapProfiler.collectGarbage", json!({}))?;
    let heap = of.call("Runtime.getHeapUsage", json!({}))?;
    let bytes = |part: &str| at(&heap, part).as_f64().unwrap_or(0.0);
    Ok(whole(
        bytes("/usedSize") + bytes("/embedderHeapUsedSize") + bytes("/backingStorageSize"),
    ))
}

/// The size of linear memories. The browser's statistics do not include them, but it finds them as objects.
fn wasm_bytes(of: &Session) -> Result<u64> {
    let prototype = json!({ "expression": "WebAssembly.Memory.prototype" });
    let prototype = of.call("Runtime.evaluate", prototype)?;
    let prototype = json!({ "prototypeObjectId": at(&prototype, "/result/objectId") });
    let memories = of.call("Runtime.queryObjects", prototype)?;
    let sum = "function () {
        return this.reduce((sum, memory) => sum + memory.buffer.byteLength, 0);
    }";
    let sum = json!({
        "objectId": at(&memories, "/objects/objectId"),
        "functionDeclaration": sum,
        "returnByValue": true,
    });
    let sum = of.call("Runtime.callFunctionOn", sum)?;
    let bytes = at(&sum, "/result/value").as_f64();
    Ok(whole(bytes.context("it does not tell of its memories")?))
}

#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "sizes in bytes are whole and far under 2^53"
)]
fn whole(bytes: f64) -> u64 {
    bytes as u64
}
