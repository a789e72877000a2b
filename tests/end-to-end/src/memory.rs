//! Measures the memory of a page and its workers.

use anyhow::{Context, Result};
use serde_json::{Value, json};

use crate::cdp::at;
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
        self.with_worker(name, |worker| {
            let call = &mut |method, params: &Value| worker.call(method, params);
            Ok(Memory {
                script: script_bytes(call)?,
                wasm: wasm_bytes(call)?,
            })
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

#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "sizes in bytes are whole and far under 2^53"
)]
fn whole(bytes: f64) -> u64 {
    bytes as u64
}
