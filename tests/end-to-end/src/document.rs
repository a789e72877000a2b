//! The document in a tab: whether it is loaded, and which of its nodes are known.

use std::collections::HashMap;
use std::time::Instant;

use serde_json::Value;

/// The document in a tab.
#[derive(Default)]
pub struct Document {
    /// Its loader, which tells it from the document before it.
    pub loader: String,
    pub is_loaded: bool,
    /// The node of the document itself, once it is known.
    pub root: Option<i64>,
    /// Controls that a query found, by role and name, each the only one.
    pub controls: HashMap<(String, String), Found>,
}

/// A node, and when a query found it.
#[derive(Clone, Copy)]
pub struct Found {
    pub node: i64,
    pub at: Instant,
}

impl Document {
    /// Records an event of the tab with this main frame.
    pub fn record(&mut self, main_frame: &str, method: &str, event: &Value) {
        let text = |pointer: &str| {
            let value = event.pointer(pointer);
            value.and_then(Value::as_str).unwrap_or_default()
        };
        if method == "Page.frameNavigated" && text("/frame/id") == main_frame {
            *self = Self {
                loader: text("/frame/loaderId").to_owned(),
                // Nothing more is said of a page that comes back whole.
                is_loaded: text("/type") == "BackForwardCacheRestore",
                ..Self::default()
            };
        }
        if method == "Page.lifecycleEvent" && text("/loaderId") == self.loader {
            self.is_loaded |= text("/name") == "load" && text("/frameId") == main_frame;
        }
    }
}
