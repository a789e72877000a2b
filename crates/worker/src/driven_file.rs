//! Remembers what is driven on an adapter beyond the end of the worker, of the page and of the browser.
//!
//! A motor may keep its last command for ever when frames cease. So what is driven is written to a file before the
//! frame that drives it is given to the port, and is written again when a reply has confirmed standstill. The worker
//! that opens the adapter next stops these motors first. The file is opened and closed with the claim of the adapter
//! (`boot/adapters.js`).

use js_sys::{Array, Function, Reflect, Uint8Array};
use motorlink_bus::LeftDriven;
use motorlink_messages::{LeftBehind, NamedInFile};
use motorlink_protocol::family::Model;
use wasm_bindgen::{JsCast, JsValue};

/// The open file of an adapter, or none where the browser has no such files.
#[derive(Debug, Default)]
pub(crate) struct DrivenFile {
    /// The object of `boot/adapters.js`.
    file: Option<JsValue>,
    written: NamedInFile,
}

impl DrivenFile {
    pub(crate) fn of(file: JsValue) -> Self {
        Self {
            file: file.is_object().then_some(file),
            written: NamedInFile::default(),
        }
    }

    /// What workers that have ended left driven on adapters of this make; asked once. What cannot be read is left out:
    /// its motors are asked like all others, and what turns is reported.
    pub(crate) fn take_found(&mut self) -> LeftBehind {
        let found = self.file.as_ref().and_then(|file| {
            let found = Reflect::get(file, &"found".into()).ok()?;
            found.dyn_into::<Array>().ok()
        });
        let mut all = LeftBehind::default();
        while let Some(found) = found.as_ref().filter(|found| found.length() > 0) {
            let bytes = Uint8Array::new(&found.pop()).to_vec();
            if let Ok(Some(left)) = LeftBehind::of_file(&bytes) {
                all.learn(left);
            }
        }
        all
    }

    /// Writes what is driven and what was `left` driven, if it has changed. Returns false if it cannot be remembered.
    pub(crate) fn remember<I: Iterator<Item = LeftDriven>>(
        &mut self,
        model: Model,
        driven: impl Fn() -> I,
        left: &LeftBehind,
    ) -> bool {
        let Self { file, written } = self;
        written.update(model, driven, left, |all| {
            write(file.as_ref(), &all.to_file()).is_some() || all.motors.is_empty()
        })
    }
}

fn write(file: Option<&JsValue>, bytes: &[u8]) -> Option<()> {
    let file = file?;
    let write: Function = Reflect::get(file, &"write".into()).ok()?.dyn_into().ok()?;
    let written = write.call1(file, &Uint8Array::from(bytes)).ok()?;
    written.is_truthy().then_some(())
}
